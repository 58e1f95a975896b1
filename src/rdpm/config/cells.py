"""Spheres in a box, in cells by size: which new ones keep clear of those that are there."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

__all__ = ["LARGER", "Placed"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Most that a sphere tried may be larger than one that was added.
LARGER = 1.125

_NONE = -1


class Placed:
    """Spheres placed so far.

    Parameters
    ----------
    box : ndarray, (3,), [m]
    periodic : ndarray of bool, (3,)
    min_gap : float, [m]
        Distance between surfaces that is kept clear.
    diameter : ndarray, (N,), [m]
        Of all spheres that are still to be added.
    obstacles : tuple of ndarray (M, 3) and (M,), [m]
        Centres and diameters of spheres already there.

    Examples
    --------
    >>> box, walls = np.ones(3), np.zeros(3, bool)
    >>> placed = Placed(box, walls, 0.0, np.full(2, 0.1), (np.empty((0, 3)), np.empty(0)))
    >>> placed.add(np.array([[0.5, 0.5, 0.5]]), np.array([0.1]))
    >>> placed.is_free(np.array([[0.55, 0.5, 0.5], [0.61, 0.5, 0.5]]), np.full(2, 0.1))
    array([False,  True])
    """

    def __init__(
        self,
        box: Floats,
        periodic: NDArray[np.bool_],
        min_gap: float,
        diameter: Floats,
        obstacles: tuple[Floats, Floats],
    ) -> None:
        self._box, self._periodic, self._min_gap = box, periodic, min_gap
        total = len(diameter) + len(obstacles[1])
        self._position, self._diameter = np.empty((total, 3)), np.empty(total)
        self._next = np.full(total, _NONE)  # of the same cell
        self._count = 0
        # An obstacle may be smaller than what is tried beside it: its cells must hold the larger of both.
        self._obstacles = self._levels_of(obstacles[1], float(diameter.max(initial=0.0)))
        self._added = self._levels_of(diameter, 0.0)
        self._put(self._obstacles, *obstacles)

    def _levels_of(self, diameter: Floats, least: float) -> dict[int, _Level]:
        """Cells for each octave of sizes, for spheres at least so large [m] to be tried beside them."""
        octaves, counts = np.unique(_octave(diameter), return_counts=True)
        levels = {}
        for octave, count in zip(octaves, counts, strict=True):
            reach = max(0.5 * (1.0 + LARGER) * float(np.exp2(octave)), least) + self._min_gap
            levels[int(octave)] = _Level(self._box, self._periodic, reach, int(count))
        return levels

    def add(self, position: Floats, diameter: Floats) -> None:
        """Add spheres, (M, 3) and (M,), [m]."""
        self._put(self._added, position, diameter)

    def _put(self, levels: dict[int, _Level], position: Floats, diameter: Floats) -> None:
        ids = np.arange(self._count, self._count + len(diameter))
        self._count += len(diameter)
        self._position[ids], self._diameter[ids] = position, diameter
        octave = _octave(diameter)
        for one in np.unique(octave):
            levels[int(one)].add(ids[octave == one], position[octave == one], self._next)

    def is_free(self, position: Floats, diameter: Floats) -> NDArray[np.bool_]:
        """Tell which of some spheres, (M, 3) and (M,), [m], keep clear of all there.

        None is over `LARGER` times one that was added.
        """
        free = np.ones(len(diameter), dtype=bool)
        for level in (*self._obstacles.values(), *self._added.values()):
            tried, there = level.candidates(position)
            while tried.size:
                hit = self._meets(position[tried], diameter[tried], self._position[there], self._diameter[there])
                free[tried[hit]] = False
                there = self._next[there]
                more = (there != _NONE) & free[tried]
                tried, there = tried[more], there[more]
        return free

    def meeting(self, position: Floats, diameter: Floats) -> Ints:
        """Pairs i < j, (P, 2), of some spheres, (M, 3) and (M,), [m], that do not keep clear of each other."""
        from scipy.spatial import cKDTree

        if len(diameter) < 2:
            return np.empty((0, 2), dtype=np.int64)
        tree = cKDTree(position, boxsize=np.where(self._periodic, self._box, 0.0))
        reach = (float(diameter.max()) + self._min_gap) * (1.0 + 1e-9)  # the exact rule follows
        pairs: Ints = tree.query_pairs(reach, output_type="ndarray")
        i, j = pairs[:, 0], pairs[:, 1]
        return pairs[self._meets(position[i], diameter[i], position[j], diameter[j])]

    def _meets(self, position: Floats, diameter: Floats, others: Floats, sizes: Floats) -> NDArray[np.bool_]:
        """Whether spheres come nearer to others, pair by pair, than the gap that is kept."""
        delta = position - others
        delta -= np.where(self._periodic, self._box * np.round(delta / self._box), 0.0)
        near: NDArray[np.bool_] = np.linalg.norm(delta, axis=1) < 0.5 * (diameter + sizes) + self._min_gap
        return near


class _Level:
    """Cells of the spheres of one octave of sizes, each the head of a chain of ids.

    Their edges are at least `reach` [m], the largest distance at which such a sphere meets one tried: 27 cells hold
    all it can meet.
    """

    def __init__(self, box: Floats, periodic: NDArray[np.bool_], reach: float, count: int) -> None:
        shape = np.clip(np.floor(box / reach), 1, 1 << 20).astype(np.int64)
        while np.prod(shape) > 8 * count + 64:  # no more cells than a few for each sphere
            shape = np.maximum(1, shape // 2)
        self._shape, self._periodic, self._scale = shape, periodic, shape / box
        self._head = np.full(int(np.prod(shape)), _NONE)
        few = {1: (0,), 2: (0, 1)}  # where neighbours on both sides would be the same cell
        around = [few.get(n if wraps else 3, (-1, 0, 1)) for n, wraps in zip(shape.tolist(), periodic, strict=True)]
        self._offsets = np.array(list(itertools.product(*around)))

    def add(self, ids: Ints, position: Floats, following: Ints) -> None:
        """Put spheres into their cells. Changes `following`, the next of each in its cell."""
        cell = self._flat(self._cell(position))
        order = np.argsort(cell, kind="stable")
        ids, cell = ids[order], cell[order]
        is_last = np.append(cell[1:] != cell[:-1], True)
        following[ids[:-1]] = ids[1:]
        following[ids[is_last]] = self._head[cell[is_last]]
        is_first = np.append(True, is_last[:-1])
        self._head[cell[is_first]] = ids[is_first]

    def candidates(self, position: Floats) -> tuple[Ints, Ints]:
        """Pairs of a point and the first sphere of a cell around it."""
        cell = self._cell(position)[:, None, :] + self._offsets
        inside = np.where(self._periodic, True, (cell >= 0) & (cell < self._shape)).all(axis=2)
        tried, _ = np.nonzero(inside)
        there = self._head[self._flat(cell[inside] % self._shape)]
        return tried[there != _NONE], there[there != _NONE]

    def _cell(self, position: Floats) -> Ints:
        return np.clip((position * self._scale).astype(np.int64), 0, self._shape - 1)

    def _flat(self, cell: Ints) -> Ints:
        flat: Ints = (cell[..., 2] * self._shape[1] + cell[..., 1]) * self._shape[0] + cell[..., 0]
        return flat


def _octave(diameter: Floats) -> Ints:
    """Exponent of the least power of two that is not below."""
    return np.ceil(np.log2(diameter)).astype(np.int64)
