"""Velocity and pressure between the places where the staggered grid holds them, to second order."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rdpm.fluid.state import Fluid
from rdpm.grid import Grid

__all__ = ["PointSampler", "plane_parts", "plane_sum", "plane_values"]

Floats = NDArray[np.float64]


class PointSampler:
    """Interpolates the flow at points that stay where they are: trilinear, each component from its own faces.

    Beside a wall the velocity is that between the wall and the first cells, the pressure is extrapolated from the two
    cells next to it: both to second order in the spacing. Inside a body the velocity is that of its interior fluid.

    Parameters
    ----------
    grid : Grid
    points : ndarray, (M, 3), [m]
        In the box, its faces included.

    Examples
    --------
    >>> from rdpm.grid import Box
    >>> grid = Grid(Box((1.0, 1.0, 1.0)), (8, 8, 8))
    >>> fluid = Fluid(grid, 1.0, 1.0)
    >>> fluid.u[...] = grid.points("u")[2][:, None, None]      # u = z
    >>> velocity, pressure = PointSampler(grid, np.array([[0.3, 0.2, 0.71]])).values(fluid)
    >>> velocity.round(12).tolist(), pressure.tolist()
    ([[0.71, 0.0, 0.0]], [0.0])
    """

    def __init__(self, grid: Grid, points: Floats) -> None:
        self.points = np.asarray(points, np.float64).reshape(-1, 3)
        self._stencils = [_stencil(grid, self.points, location) for location in range(4)]

    def values(self, fluid: Fluid) -> tuple[Floats, Floats]:
        """Velocity (M, 3) [m/s] and pressure (M,) [Pa], without the hydrostatic part."""
        found = [
            (field.reshape(-1)[index] * weight).sum(axis=1)
            for field, (index, weight) in zip((*fluid.velocity, fluid.p), self._stencils, strict=True)
        ]
        if fluid.grid.slab is not None:  # each rank has what lies in its planes
            parts = fluid.ranks.rows(np.stack(found, axis=1), [len(self.points)] * fluid.ranks.size)
            found = [*parts.reshape(fluid.ranks.size, -1, 4).sum(axis=0).T]
        return np.stack(found[:3], axis=1), fluid.density * (found[3] - fluid.pressure_offset)


def _stencil(grid: Grid, points: Floats, location: int) -> tuple[NDArray[np.int64], Floats]:
    """Flat indices and weights of the eight values around each point, (M, 8); location 0 to 2: faces, 3: centres."""
    _, ny, nx = grid.shape
    index, weight = np.zeros((len(points), 1), np.int64), np.ones((len(points), 1))
    for axis, (cells, spacing, stride) in enumerate(zip(grid.cells, grid.spacing, (1, nx, nx * ny), strict=True)):
        at = points[:, axis] / spacing + (0.0 if axis == location else 0.5)
        if axis == location:
            low = np.clip(np.floor(at), 0, cells - 1)
        elif location < 3:
            low = np.clip(np.floor(at), 0, cells)  # halos hold what the walls do to the velocity
        elif grid.is_periodic[axis]:
            low = np.floor(at)
        else:
            low = np.clip(np.floor(at), 1, cells - 1)  # the pressure has no halo of its own
        part = at - low
        pair = np.stack([low, low + 1], axis=1).astype(np.int64)
        if location == 3 and grid.is_periodic[axis]:
            pair = (pair - 1) % cells + 1
        parts = np.stack([1.0 - part, part], axis=1)
        if axis == 2 and grid.slab is not None:
            is_own = (pair >= grid.slab.own.start) & (pair < grid.slab.own.stop)
            pair, parts = np.where(is_own, pair - grid.slab.first, 0), np.where(is_own, parts, 0.0)
        index = (index[:, :, None] + stride * pair[:, None, :]).reshape(len(points), -1)
        weight = (weight[:, :, None] * parts[:, None, :]).reshape(len(points), -1)
    return index, weight


def plane_values(fluid: Fluid, axis: int, position: float) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Velocity and pressure on a plane, at the centres of the cells in it.

    Parameters
    ----------
    fluid : Fluid
    axis : int
        Normal to the plane: 0, 1, 2 for x, y, z.
    position : float, [m]
        In the box. Values are linear between the two layers of cells next to it; within half a cell of a wall they are
        extrapolated.

    Returns
    -------
    velocity : ndarray, (nz, ny, nx, 3), [m/s]
        With 1 in place of the count along `axis`.
    pressure : ndarray, (nz, ny, nx), [Pa]
    """
    return plane_sum(fluid, plane_parts(fluid, axis, position))


def plane_parts(fluid: Fluid, axis: int, position: float) -> Floats:
    """What this rank adds to the values on a plane, to be summed over the first axis and the ranks, or put together.

    Parameters
    ----------
    fluid, axis, position
        As for `plane_values`.

    Returns
    -------
    ndarray, (parts, nz, ny, nx, 4)
        Velocity and pressure; nz of this rank's slab. Normal to z as many parts as it has of the two layers.
    """
    grid = fluid.grid
    cells, at = grid.cells[axis], position / grid.spacing[axis] + 0.5
    low = int(np.floor(at))
    if not grid.is_periodic[axis]:
        low = min(max(low, 1), cells - 1)
    part = at - low
    weighted = [((n - 1) % cells + 1, weight) for n, weight in ((low, 1.0 - part), (low + 1, part))]
    if axis == 2 and grid.slab is not None:
        weighted = [(n - grid.slab.first, weight) for n, weight in weighted]
        weighted = [(n, weight) for n, weight in weighted if 1 <= n <= grid.slab.planes]
    layers = [weight * _layer(fluid, axis, n) for n, weight in weighted]
    return np.stack(layers) if layers else np.empty((0, 1, grid.cells[1], grid.cells[0], 4))


def plane_sum(fluid: Fluid, parts: Floats) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Velocity and pressure as `plane_values` gives them, from all `plane_parts` of a plane."""
    total = parts.sum(axis=0)
    pressure = fluid.density * (total[..., 3] - fluid.pressure_offset)
    return total[..., :3].astype(np.float32), pressure.astype(np.float32)


def _layer(fluid: Fluid, axis: int, cell: int) -> Floats:
    """Velocity and pressure at the centres of one layer of cells, (..., 4)."""
    inner = [slice(1, -1)] * 3
    inner[2 - axis] = slice(cell, cell + 1)
    parts = []
    for component, field in enumerate(fluid.velocity):
        before = list(inner)
        own = inner[2 - component]
        before[2 - component] = slice(own.start - 1, own.stop - 1)
        parts.append(0.5 * (field[tuple(inner)] + field[tuple(before)]))
    return np.stack([*parts, fluid.p[tuple(inner)]], axis=-1)
