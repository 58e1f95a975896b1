"""Random sequential placement of spheres in a box."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rdpm.config.cells import LARGER, Placed
from rdpm.config.overlaps import wrapped
from rdpm.config.rule import RuleError
from rdpm.surfaces import Surface

__all__ = ["place_at_random"]

Floats = NDArray[np.float64]

_SATURATED = 0.38  # equal spheres placed at random jam at 0.384 of the volume [1]
_TRIES = 20_000  # failed tries in a row after which there is hardly a hole left
_BLOCK = 2048
_ALIKE = 1.0 / LARGER  # sizes down to this share of the largest left are placed side by side, all others later


def place_at_random(
    diameter: Floats,
    box: Floats,
    periodic: NDArray[np.bool_],
    min_gap: float,
    seed: int,
    obstacles: tuple[Floats, Floats],
    walls: tuple[Surface, ...] = (),
) -> Floats:
    """Place spheres at random, the largest first (sizes within an eighth side by side), none touching.

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
    walls : tuple of Plane or Cylinder
        Within the box.

    Returns
    -------
    ndarray, (N, 3), [m]
        Centres.

    Raises
    ------
    RuleError
        They do not fit, or no hole was found for one of them.

    Notes
    -----
    Time and memory grow as N, whatever the sizes: 1e5 spheres of different sizes take some seconds.

    References
    ----------
    .. [1] Torquato, Random Heterogeneous Materials (2002), Sec. 3.4: random sequential addition.
    """
    low, room = _room(diameter, box, periodic, min_gap)
    placed = Placed(box, periodic, min_gap, diameter, obstacles)
    rng = np.random.default_rng(seed)
    position = np.empty((len(diameter), 3))
    order = np.argsort(-diameter, kind="stable")
    done = 0
    while done < len(order):
        alike = done + int(np.count_nonzero(diameter[order[done:]] >= _ALIKE * diameter[order[done]]))
        waiting, ahead, failed, block = order[:0], done, 0, 64
        while done < alike:
            # Each draw is for one of the sizes that wait, in turn, and goes to any body of that size.
            taken = order[ahead : min(ahead + block - len(waiting), alike)]
            waiting, ahead = np.concatenate([waiting, taken]), ahead + len(taken)
            turn = np.resize(waiting, block)
            draws = wrapped(low[turn] + rng.random((block, 3)) * room[turn], box, periodic)
            free = placed.is_free(draws, diameter[turn])
            for wall in walls:
                distance = wall.distance(draws, np.where(periodic, box, 0.0))[0]
                free &= distance >= 0.5 * diameter[turn] + min_gap
            kept, bodies = _settle(draws[free], diameter[turn[free]], waiting, diameter, placed)
            position[bodies] = kept
            placed.add(kept, diameter[bodies])
            waiting = waiting[~np.isin(waiting, bodies)]
            done += len(bodies)
            failed = 0 if len(bodies) else failed + block
            if failed >= _TRIES:
                raise RuleError(
                    f"must fit the box: {done} of {len(diameter)} bodies were placed, "
                    f"then {failed} tries in a row failed",
                    "hardly a hole is left",
                    "Ask for fewer bodies or a smaller min_gap, or use a lattice.",
                )
            block = min(_BLOCK, 2 * block)
    return position


def _settle(
    draws: Floats, sizes: Floats, waiting: NDArray[np.int64], diameter: Floats, placed: Placed
) -> tuple[Floats, NDArray[np.int64]]:
    """Of centres that are free, those that do not hinder an earlier one, (M, 3), and the body each is for, (M,)."""
    left: dict[float, list[int]] = {}
    for body in waiting[::-1].tolist():
        left.setdefault(diameter[body], []).append(body)
    earlier: dict[int, list[int]] = {}
    for i, j in placed.meeting(draws, sizes).tolist():
        earlier.setdefault(j, []).append(i)
    bodies: dict[int, int] = {}
    for n, size in enumerate(sizes):
        mine = left[size]
        if mine and not any(other in bodies for other in earlier.get(n, ())):
            bodies[n] = mine.pop()
    return draws[list(bodies)], np.array(list(bodies.values()), dtype=np.int64)


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
