"""Random sequential placement of spheres in a box."""

from __future__ import annotations

import math
from collections import defaultdict

import numpy as np
from numpy.typing import NDArray

from rdpm.config.rule import RuleError

__all__ = ["place_at_random"]

Floats = NDArray[np.float64]

_SATURATED = 0.38  # equal spheres placed at random jam at 0.384 of the volume [1]
_TRIES = 20_000  # failed tries in a row after which there is hardly a hole left
_BLOCK = 512


def place_at_random(
    diameter: Floats,
    box: Floats,
    periodic: NDArray[np.bool_],
    min_gap: float,
    seed: int,
    obstacles: tuple[Floats, Floats],
) -> Floats:
    """Place spheres one after the other, the largest first, none touching.

    Parameters
    ----------
    diameter : ndarray, (N,), [m]
    box : ndarray, (3,), [m]
    periodic : ndarray of bool, (3,)
    min_gap : float, [m]
        Least distance between surfaces, sides of the box included.
    seed : int
        The same seed gives the same centres.
    obstacles : tuple of ndarray (M, 3) and (M,), [m]
        Centres and diameters of spheres already there.

    Returns
    -------
    ndarray, (N, 3), [m]
        Centres.

    Raises
    ------
    RuleError
        They do not fit, or no hole was found for one of them.

    References
    ----------
    .. [1] Torquato, Random Heterogeneous Materials (2002), Sec. 3.4: random sequential addition.
    """
    with np.errstate(over="ignore"):
        fraction = float(
            (np.pi / 6.0 * (diameter / box[0]) * (diameter / box[1]) * (diameter / box[2])).sum()
        )
    if fraction > _SATURATED:
        raise RuleError(
            f"must fill at most {_SATURATED} of the box, not {fraction:.3g}",
            "random placement finds no more holes",
            "Ask for fewer bodies, or use a lattice.",
        )
    low = np.where(periodic, 0.0, 0.5 * diameter[:, None] + min_gap)
    room = np.where(periodic, box, box - 2.0 * low)
    if (room < 0.0).any():
        raise RuleError(
            "must leave room for a body and min_gap between the sides",
            "the box is too narrow",
            "Lower min_gap, or enlarge domain.size.",
            at=("min_gap",),
            value=min_gap,
        )
    holes = _Holes(box, periodic, max(float(d.max()) for d in (diameter, *obstacles[1:]) if len(d)), min_gap)
    for centre, size in zip(obstacles[0].tolist(), obstacles[1].tolist(), strict=True):
        holes.fill(centre, size)
    rng = np.random.default_rng(seed)
    placed = np.empty((len(diameter), 3))
    draws: list[list[float]] = []
    for done, body in enumerate(np.argsort(-diameter, kind="stable")):
        size = float(diameter[body])
        for _ in range(_TRIES):
            if not draws:
                draws = rng.random((_BLOCK, 3)).tolist()
            draw = draws.pop()
            centre = [float(low[body, a] + draw[a] * room[body, a]) for a in range(3)]
            if holes.is_free(centre, size):
                break
        else:
            raise RuleError(
                f"must fit the box: {done} of {len(diameter)} bodies were placed, then {_TRIES} tries in a "
                "row failed",
                "hardly a hole is left",
                "Ask for fewer bodies or a smaller min_gap, or use a lattice.",
            )
        holes.fill(centre, size)
        placed[body] = centre
    return placed


class _Holes:
    """Spheres sorted into cells no smaller than their reach."""

    def __init__(self, box: Floats, periodic: NDArray[np.bool_], largest: float, min_gap: float) -> None:
        self.box, self.periodic, self.min_gap = box.tolist(), periodic.tolist(), min_gap
        self.cells = [int(min(max(1.0, length // (largest + min_gap)), 1e6)) for length in self.box]
        self.content: defaultdict[tuple[int, int, int], list[tuple[list[float], float]]] = defaultdict(list)

    def _cell(self, centre: list[float]) -> tuple[int, int, int]:
        i, j, k = (
            min(int(c / length * n), n - 1) for c, length, n in zip(centre, self.box, self.cells, strict=True)
        )
        return i, j, k

    def fill(self, centre: list[float], size: float) -> None:
        self.content[self._cell(centre)].append((centre, size))

    def is_free(self, centre: list[float], size: float) -> bool:
        cell = self._cell(centre)
        near = [{(cell[a] + step) % self.cells[a] for step in (-1, 0, 1)} for a in range(3)]
        for i in near[0]:
            for j in near[1]:
                for k in near[2]:
                    for other, other_size in self.content.get((i, j, k), ()):
                        if self._distance(centre, other) < 0.5 * (size + other_size) + self.min_gap:
                            return False
        return True

    def _distance(self, a: list[float], b: list[float]) -> float:
        total = 0.0
        for x, y, length, is_periodic in zip(a, b, self.box, self.periodic, strict=True):
            d = x - y
            if is_periodic:
                d -= length * round(d / length)
            total += d * d
        return math.sqrt(total)
