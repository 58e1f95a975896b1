"""Random sequential placement of spheres in a box."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rdpm.config.overlaps import wrapped
from rdpm.config.rule import RuleError

__all__ = ["place_at_random"]

Floats = NDArray[np.float64]

_SATURATED = 0.38  # equal spheres placed at random jam at 0.384 of the volume [1]
_TRIES = 20_000  # failed tries in a row after which there is hardly a hole left
_BLOCK = 2048


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
        Least distance between surfaces, faces of the box included.
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
    low, room = _room(diameter, box, periodic, min_gap)
    tries = _Tries(box, periodic, min_gap, *obstacles)
    rng = np.random.default_rng(seed)
    placed = np.empty((len(diameter), 3))
    done = 0
    for size in np.unique(diameter)[::-1]:
        bodies = np.flatnonzero(diameter == size)
        start, length = low[bodies[0]], room[bodies[0]]
        found, failed, block = 0, 0, 64
        while found < len(bodies):
            draws = wrapped(start + rng.random((block, 3)) * length, box, periodic)
            centres = tries.keep(draws, float(size), len(bodies) - found)
            placed[bodies[found : found + len(centres)]] = centres
            found += len(centres)
            failed = 0 if len(centres) else failed + block
            if failed >= _TRIES:
                raise RuleError(
                    f"must fit the box: {done + found} of {len(diameter)} bodies were placed, "
                    f"then {failed} tries in a row failed",
                    "hardly a hole is left",
                    "Ask for fewer bodies or a smaller min_gap, or use a lattice.",
                )
            block = min(_BLOCK, 2 * block)  # one tree serves a block
        done += found
    return placed


def _room(
    diameter: Floats, box: Floats, periodic: NDArray[np.bool_], min_gap: float
) -> tuple[Floats, Floats]:
    """Where each centre may lie: its lower corner and the extent, (N, 3)."""
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
            "must leave room for a body and min_gap between the faces",
            "the box is too narrow",
            "Lower min_gap, or enlarge domain.size.",
            at=("min_gap",),
            value=min_gap,
        )
    return low, room


class _Tries:
    """The spheres placed so far, and which new ones keep clear of them."""

    def __init__(
        self, box: Floats, periodic: NDArray[np.bool_], min_gap: float, position: Floats, diameter: Floats
    ) -> None:
        self.box, self.periodic, self.min_gap = box, periodic, min_gap
        self.position, self.diameter = position, diameter

    def keep(self, draws: Floats, size: float, most: int) -> Floats:
        """Add the first `most` of some centres that are free, in their order, and return them."""
        from scipy.spatial import cKDTree

        free = draws
        images = np.where(self.periodic, self.box, 0.0)
        if len(self.position):
            tree = cKDTree(self.position, boxsize=images)
            hits = tree.query_ball_point(draws, 0.5 * (size + self.diameter.max()) + self.min_gap)
            i = np.repeat(np.arange(len(draws)), [len(hit) for hit in hits])
            j = np.concatenate([np.asarray(hit, dtype=np.int64) for hit in hits])
            reach = 0.5 * (size + self.diameter[j]) + self.min_gap
            blocked = i[self._distance(draws[i], self.position[j]) < reach]
            free = np.delete(draws, np.unique(blocked), axis=0)
        kept = np.empty((0, 3))
        for centre in free:  # few: those that may only hinder each other
            if len(kept) == most:
                break
            if not (self._distance(kept, centre) < size + self.min_gap).any():
                kept = np.vstack([kept, centre])
        self.position = np.vstack([self.position, kept])
        self.diameter = np.append(self.diameter, np.full(len(kept), size))
        return kept

    def _distance(self, a: Floats, b: Floats) -> Floats:
        delta = a - b
        delta -= np.where(self.periodic, self.box * np.round(delta / self.box), 0.0)
        distance: Floats = np.linalg.norm(delta, axis=1)
        return distance
