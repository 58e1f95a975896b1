"""Inflow and outflow: normal velocities on the two open ends, for the coming projection."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rdpm.grid import Grid
from rdpm.grid.inflow import Inflow
from rdpm.parallel.ranks import ALONE, Ranks

__all__ = ["OpenEnds"]

Field = NDArray[np.float64]
Velocity = tuple[Field, Field, Field]


class OpenEnds:
    """What passes through the two faces across the stream: section 1 of docs/theory/inflow.md.

    Parameters
    ----------
    grid : Grid
        Of a box with an inflow.
    inflow : Inflow
    ranks : Ranks
        That share the box, where the grid is of a slab.

    Notes
    -----
    It holds no state: all that the next step needs is in the velocity.
    """

    def __init__(self, grid: Grid, inflow: Inflow, ranks: Ranks = ALONE) -> None:
        self.inflow, self._ranks = inflow, ranks
        x, y, z = (kind == "wall" for kind in grid.boundary)
        self._shape = inflow.shape(grid.cells, (x, y, z))
        self._spacing = grid.spacing[inflow.axis]
        n = grid.cells_here[inflow.axis]
        is_up = inflow.velocity > 0.0
        self._entry, self._exit, self._before_exit = (0, n, n - 1) if is_up else (n, 0, 1)
        # A slab has a part of both ends, or across z at most one of them.
        self._is_entry_here = self._is_exit_here = True
        self._faces_of_an_end, self._is_shared = self._shape.size, False
        if grid.slab is not None and inflow.axis == 2:
            ends = grid.slab.lower is None, grid.slab.upper is None
            self._is_entry_here, self._is_exit_here = ends if is_up else ends[::-1]
        elif grid.slab is not None:
            self._shape = self._shape[grid.slab.first : grid.slab.first + grid.slab.planes]
            self._is_shared = True

    def begin(self, velocity: Velocity) -> None:
        """Change the velocity on both ends: inflow of time 0, outflow as it is but with as much volume."""
        self.set(velocity, self._entering(0.0), self._balanced(self._faces(velocity, self._exit), 0.0))

    def coming(self, velocity: Velocity, time: float, dt: float) -> tuple[Field, Field]:
        """Normal velocities at the end of a step from `time` to `time + dt`, from the velocity before it.

        The outflow is convected with the mean velocity, eq. (3) of docs/theory/inflow.md, one cell a step at most; then
        one number is added so that as much leaves as enters, eq. (4).

        Parameters
        ----------
        velocity : tuple of three ndarray, (nz+2, ny+2, nx+2), [m/s]
        time, dt : float, [s]

        Returns
        -------
        entering, leaving : ndarray, (n_second, n_first), [m/s]
        """
        last, before = self._faces(velocity, self._exit), self._faces(velocity, self._before_exit)
        crossed = min(abs(self.inflow.speed_at(time + 0.5 * dt)) * dt / self._spacing, 1.0)
        return self._entering(time + dt), self._balanced(last - crossed * (last - before), time + dt)

    def set(self, velocity: Velocity, entering: Field, leaving: Field) -> None:
        """Change the velocity: normal components on both ends."""
        if self._is_entry_here:
            self._faces(velocity, self._entry)[...] = entering
        if self._is_exit_here:
            self._faces(velocity, self._exit)[...] = leaving

    def _faces(self, velocity: Velocity, at: int) -> Field:
        inner: list[slice | int] = [slice(1, -1)] * 3
        inner[2 - self.inflow.axis] = at
        return velocity[self.inflow.axis][tuple(inner)]

    def _entering(self, time: float) -> Field:
        return self.inflow.speed_at(time) * self._shape

    def _balanced(self, leaving: Field, time: float) -> Field:
        mean = float(leaving.mean())
        if self._is_shared:
            mean = float(self._ranks.table([float(leaving.sum())]).sum()) / self._faces_of_an_end
        result: Field = leaving + (self.inflow.speed_at(time) - mean)
        return result
