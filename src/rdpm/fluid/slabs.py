"""The projection on a slab: the Poisson solve of the whole box, of which each rank has some planes."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from rdpm import _core
from rdpm.grid import Grid
from rdpm.parallel.halo import Halo
from rdpm.parallel.ranks import Ranks

__all__ = ["SlabProjection"]

Field = NDArray[np.float64]


class SlabProjection:
    """What `_core.Projection` is for a whole box.

    Parameters
    ----------
    grid : Grid
        Of a slab.
    ranks : Ranks
    halo : Halo

    Attributes
    ----------
    offset : float, [m^2/s^2]
        Of the pressure to that of one rank, whose mean over one plane does not change.

    Notes
    -----
    Each rank solves along z up to the values below and above its slab; these are found mode by mode from two numbers a
    mode of every slab, the modes shared evenly.
    """

    def __init__(self, grid: Grid, ranks: Ranks, halo: Halo) -> None:
        self._grid, self._ranks, self._halo = grid, ranks, halo
        nx, ny, nz = grid.cells
        self._solver = _core.Projection(grid.core)
        self._planes = [int(n) for n in ranks.table([grid.cells_here[2]])[:, 0]]
        self._first = [nx * ny * rank // ranks.size for rank in range(ranks.size + 1)]
        mine = self._first[ranks.rank + 1] - self._first[ranks.rank]
        self._interfaces = _core.Interfaces(grid.core, self._planes, self._first[ranks.rank], mine)
        self._below, self._above = np.zeros((2, ny, nx))
        self._sent = np.empty(2 * nx * ny)
        self._shared = np.empty((ranks.size, 2, mine))
        # The plane whose mean pressure increment is zero on one rank.
        assert grid.slab is not None
        middle = (nz if grid.is_periodic[2] else nz // 2 + 1) - grid.slab.first
        self._middle = middle if 1 <= middle <= grid.slab.planes else None
        self.offset = 0.0

    @property
    def bytes(self) -> int:
        """Memory of the solver."""
        own = self._below.nbytes + self._above.nbytes + self._sent.nbytes + self._shared.nbytes
        return int(self._solver.bytes) + int(self._interfaces.bytes) + own

    def project(
        self, velocity: tuple[Field, Field, Field], p: Field, increment: Field, dt: float, rotational: float
    ) -> tuple[float, float]:
        """Change the velocity to be divergence-free, its halos current, and the pressure; cfl rate and square sum."""
        core, (u, v, w) = self._grid.core, velocity
        self._halo.exchange(up=[w])
        self._solver.inwards(core, u, v, w, increment, dt, self._below, self._above)
        self._solve_interfaces()
        self._solver.outwards(core, u, v, w, p, increment, dt, rotational, self._below, self._above)
        self._halo.exchange(down=[increment])
        self._solver.finish(core, u, v, w, p, increment, dt)
        self._halo.exchange(up=[u, v, w], down=[u, v, w, p])
        cfl_rate, square_sum = self._solver.measures(core, u, v, w)
        middle = 0.0 if self._middle is None else float(increment[self._middle, 1:-1, 1:-1].mean())
        table = self._ranks.table([cfl_rate, square_sum, middle])
        self.offset += float(table[:, 2].sum())
        # Not a number anywhere must not be lost.
        return float(np.max(table[:, 0])), float(table[:, 1].sum())

    def _solve_interfaces(self) -> None:
        """From p and q of each slab to the values below and above it."""
        first, sent = self._first, self._sent
        below, above = self._below.reshape(-1), self._above.reshape(-1)
        counts = [2 * (last - begin) for begin, last in pairwise(first)]
        mine = [2 * self._shared.shape[2]] * self._ranks.size
        for begin, last in pairwise(first):
            sent[2 * begin : begin + last] = below[begin:last]
            sent[begin + last : 2 * last] = above[begin:last]
        self._ranks.all_to_all(sent, counts, self._shared.reshape(-1), mine)
        self._interfaces.solve(self._shared, self._grid.threads)
        self._ranks.all_to_all(self._shared.reshape(-1), mine, sent, counts)
        for begin, last in pairwise(first):
            below[begin:last] = sent[2 * begin : begin + last]
            above[begin:last] = sent[begin + last : 2 * last]
