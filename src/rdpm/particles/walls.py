"""Markers on the walls within the box: the fluid does not slip there."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm import _core
from rdpm.conventions import FIRST_WALL
from rdpm.grid import Grid
from rdpm.parallel.gather import rows_on_root
from rdpm.parallel.ranks import ALONE, Ranks
from rdpm.particles.calibration import CALIBRATION, Calibration
from rdpm.particles.sharing import Common, Cuts, add_up
from rdpm.particles.state import Bodies
from rdpm.surfaces import Cylinder, Plane, Surface

__all__ = ["WallMarkers", "left_to_marker", "wall_points"]

Floats = NDArray[np.float64]

#: Markers that are worked on together.
_BLOCK = 256

#: From a marker to where its delta ends [cells]: beyond, the fluid behind a wall is held at the wall's velocity in a
#: layer of the next number of cells, and at rest still deeper.
_DELTA_REACH, _MOVING_LAYER = 1.5, 2.0


def wall_points(wall: Surface, size: Floats, spacing: float, depth: float) -> tuple[Floats, float]:
    """Points spread evenly over the part of a wall that is within the box, about one a cell face.

    Parameters
    ----------
    wall : Plane or Cylinder
    size : ndarray, (3,), [m]
        Of the box.
    spacing : float, [m]
        Edge of a cell.
    depth : float, [m]
        Of the points behind the wall.

    Returns
    -------
    points : ndarray, (M, 3), [m]
    area : float, [m^2]
        That each stands for.
    """
    axis, middle = np.asarray(wall.row[2]), 0.5 * size
    first = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    first /= np.linalg.norm(first)
    second = np.cross(axis, first)
    reach = 0.5 * float(np.linalg.norm(size)) + spacing
    if isinstance(wall, Plane):
        # From the point nearest to the middle of the box, in rows.
        foot = middle - ((middle - wall.point) @ axis) * axis - depth * axis
        at = spacing * (np.arange(-int(reach / spacing) - 1, int(reach / spacing) + 2) + 0.5)
        u, v = (c.ravel() for c in np.meshgrid(at, at))
        points, area = foot + u[:, None] * first + v[:, None] * second, spacing**2
    else:
        radius = wall.radius + (depth if wall.side == "inside" else -depth)
        foot = np.asarray(wall.point) + ((middle - wall.point) @ axis) * axis
        around = max(3, round(2.0 * np.pi * radius / spacing))
        along = spacing * (np.arange(-int(reach / spacing) - 1, int(reach / spacing) + 2) + 0.5)
        # Each ring is turned by half a step against the last.
        s, n = (c.ravel() for c in np.meshgrid(along, np.arange(around), indexing="ij"))
        ring = np.repeat(np.arange(len(along)), around)
        angle = 2.0 * np.pi * (n + 0.5 * (ring % 2)) / around
        points = foot + s[:, None] * axis + radius * (np.cos(angle)[:, None] * first + np.sin(angle)[:, None] * second)
        area = 2.0 * np.pi * wall.radius / around * spacing
    within = ((points > 0.0) & (points < size)).all(axis=1)
    return points[within], area


def left_to_marker(distance: Floats, calibration: Calibration, least: float) -> Floats:
    """Fraction of its volume left to a marker so far from another surface, as `exclude_markers` of the kernels has it.

    Parameters
    ----------
    distance : ndarray, (M,), [cells]
        Negative inside it.
    calibration : Calibration
    least : float, [-]
        Up to `exclusion_near`.

    Returns
    -------
    ndarray, (M,), [-]
    """
    near, far = calibration.exclusion_near, calibration.exclusion_far
    outside = np.clip((distance - near) / (far - near), 0.0, 1.0)
    result: Floats = (least + (1.0 - least) * outside) * np.clip(1.0 + distance, 0.0, 1.0)
    return result


class WallMarkers:
    """The markers of all walls within the box; they do not move.

    Of several ranks each has those at its slab, and does its own planes' part; its length is that of all.

    Parameters
    ----------
    grid : Grid
    calibration : Calibration
        Depth of the markers behind the surface, and how they are excluded near bodies.
    ranks : Ranks
        That share the box, where the grid is of a slab.

    Attributes
    ----------
    position : ndarray, (M, 3), [m]
    velocity : ndarray, (M, 3), [m/s]
        Of the wall there.
    volume : ndarray, (M,), [m^3]
        Of the fluid layer, one cell thick, that a marker stands for; reduced close to a body.
    force : ndarray, (M, 3), [m/s^2]
        Lagged from step to step: the force a unit mass that holds no-slip there.
    force_on_fluid : ndarray, (3,), [N]
        Over the last step.
    """

    def __init__(self, grid: Grid, calibration: Calibration = CALIBRATION, ranks: Ranks = ALONE) -> None:
        self.grid, self.calibration, self._ranks = grid, calibration, ranks
        self.h = h = float(np.cbrt(np.prod(grid.spacing)))
        size = np.array(grid.box.size)
        found = [wall_points(wall, size, h, calibration.marker_retraction * h) for wall in grid.box.walls]
        self.position = np.concatenate([np.empty((0, 3)), *(points for points, _ in found)])
        moves = (_velocity(wall, points) for wall, (points, _) in zip(grid.box.walls, found, strict=True))
        self.velocity = np.concatenate([np.empty((0, 3)), *moves])
        full = np.concatenate([np.empty(0), *(np.full(len(points), area * h) for points, area in found)])
        order = np.argsort(self.position[:, 2], kind="stable")  # from bottom to top
        self._count = len(order)
        self._here = self._own = np.arange(self._count)
        self._common: Common | None = None
        if grid.slab is not None:
            self._here, self._own, self._common = _shared(grid, ranks, self.position[order, 2])
        order = order[self._here]
        self.position, self.velocity = self.position[order].copy(), self.velocity[order].copy()
        self._full_volume = full[order]
        self.volume = self._full_volume.copy()
        self.force, self._at_markers = np.zeros((2, len(order), 3))
        self._impulse, self.force_on_fluid = np.zeros((2, 3))  # the impulse over the density
        self._cell = float(np.prod(grid.spacing))
        first = np.append(np.arange(0, len(order), _BLOCK), len(order)).astype(np.int32)
        self._stencils = _core.Markers(grid.core, first)
        self._stencils.place(grid.core, self.position)
        self._behind = [_faces_behind(grid, n, (calibration.marker_retraction + _DELTA_REACH) * h) for n in range(3)]
        self._tree: Any = None

    def __len__(self) -> int:
        return self._count

    def spread(self, target: tuple[Floats, Floats, Floats], factor: float) -> None:
        """Add factor * force to a staggered field."""
        self._stencils.spread(self.grid.core, *target, self.force, self.volume, factor)

    def impose_no_slip(self, velocity: tuple[Floats, Floats, Floats], dt: float) -> None:
        """Change the fluid's velocity to that of the walls, in one pass of direct forcing, and the forces with it.

        Behind the markers' deltas the fluid moves with the wall, and is at rest deeper: a flow there would act on
        the markers.
        """
        self._stencils.interpolate(self.grid.core, *velocity, self._at_markers)
        if self._common is not None:
            add_up(self._ranks, (self._common, self._at_markers))
        change = self.velocity - self._at_markers
        self._stencils.spread(self.grid.core, *velocity, change, self.volume, 1.0)
        self.force += change / dt
        self._impulse += self._summed(change)
        for n, (q, (at, wanted)) in enumerate(zip(velocity, self._behind, strict=True)):
            flat = q.reshape(-1)
            self._impulse[n] += self._cell * float((wanted - flat[at]).sum())
            flat[at] = wanted

    def begin(self, dt: float) -> None:
        """Start a step's sum of impulses with that of the lagged forces."""
        self._impulse = dt * self._summed(self.force)

    def close(self, density: float, dt: float, retained: float) -> None:
        """Conclude the force on the fluid; relax the lagged forces to this fraction for the next step."""
        impulse = self._impulse if self._ranks.size == 1 else self._ranks.table(self._impulse.tolist()).sum(axis=0)
        self.force_on_fluid = density / dt * impulse
        self.force *= retained

    def _summed(self, values: Floats) -> Floats:
        """Sum of volume * value over the markers that this rank alone counts."""
        if self._common is None:
            return np.asarray(self.volume @ values)
        return np.asarray(self.volume[self._own] @ values[self._own])

    def exclude(self, bodies: Bodies, close: NDArray[np.int32], least: float) -> None:
        """Reduce the volume of markers close to a body, as :meth:`rdpm.particles.markers.MarkerSet.exclude` does.

        Parameters
        ----------
        bodies : Bodies
        close : ndarray of int32, (P, 2)
            Pairs of surfaces that are close.
        least : float, [-]
            Fraction left to the nearest ones.
        """
        np.copyto(self.volume, self._full_volume)
        near = np.unique(close[close[:, 1] <= FIRST_WALL, 0])
        if not len(near):
            return
        if self._tree is None:
            from scipy.spatial import cKDTree

            self._tree = cKDTree(self.position)
        c, h = self.calibration, self.h
        for body in near:
            radius = 0.5 * bodies.diameter[body]
            at = self._tree.query_ball_point(bodies.position[body], radius + c.exclusion_far * h)
            distance = np.linalg.norm(self.position[at] - bodies.position[body], axis=1) - radius
            share = left_to_marker(distance / h, c, least)
            self.volume[at] = np.minimum(self.volume[at], share * self._full_volume[at])

    def state(self) -> dict[str, NDArray[Any]]:
        """What the next step takes from the last one, of all walls on the root alone; nothing without walls."""
        if not len(self):
            return {}
        force, volume = self.force, self.volume
        if self._ranks.size > 1:  # from bottom to top, as the ranks are
            force = rows_on_root(self._ranks, force[self._own])
            volume = rows_on_root(self._ranks, volume[self._own][:, None])[:, 0]
        return {"wall_force": force, "wall_volume": volume, "wall_force_on_fluid": self.force_on_fluid}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Take over what `state` gave."""
        if len(self):
            np.copyto(self.force, state["wall_force"][self._here])
            np.copyto(self.volume, state["wall_volume"][self._here])
            np.copyto(self.force_on_fluid, state["wall_force_on_fluid"])


def _shared(grid: Grid, ranks: Ranks, z: Floats) -> tuple[NDArray[np.int64], NDArray[np.int64], Common]:
    """Of markers at these heights, which this rank works on, which of those are its own, and what it shares of them."""
    assert grid.slab is not None
    cuts = Cuts.of(grid, ranks)
    holders = cuts.touched(z)
    here = np.flatnonzero(holders[ranks.rank])
    held = holders[:, here]
    rows = {rank: np.flatnonzero(both) for rank, both in enumerate(held) if rank != ranks.rank and both.any()}
    return here, np.flatnonzero(cuts.owner(z[here]) == ranks.rank), Common(ranks.rank, rows)


def _velocity(wall: Surface, points: Floats) -> Floats:
    velocity = np.tile(np.array(wall.velocity, np.float64), (len(points), 1))
    if isinstance(wall, Cylinder):
        velocity += np.cross(np.asarray(wall.row[4]), points - np.asarray(wall.point))
    return velocity


def _faces_behind(grid: Grid, component: int, depth: float) -> tuple[NDArray[np.int64], Floats]:
    """Places in the field of one component that are deeper than this behind a wall, and the wall's velocity there."""
    counts, spacing, box = np.array(grid.cells), np.array(grid.spacing), grid.box
    offset = np.where(np.arange(3) == component, 0.0, 0.5)
    last = counts + 1 - ((np.arange(3) == component) & ~np.array(grid.is_periodic))  # faces on the box's own walls
    x, y, z = (np.arange(1, last[n]) for n in range(3))
    if not box.walls:
        return np.zeros(0, np.int64), np.zeros(0)
    j, i = (c.reshape(-1) for c in np.meshgrid(y, x, indexing="ij"))
    found, values = [], []
    below, planes = (grid.slab.first, grid.slab.planes) if grid.slab is not None else (0, counts[2])
    for k in z[(z > below) & (z <= below + planes)]:  # plane by plane: a whole field of points takes much memory
        points = (np.stack([i, j, np.full_like(i, k)], axis=1) - offset) * spacing
        deepest, value = np.full(len(points), np.inf), np.zeros(len(points))
        for wall in box.walls:
            distance = wall.distance(points, box.period)[0]
            nearer = distance < np.minimum(deepest, -depth)
            deepest[nearer] = distance[nearer]
            moving = distance[nearer] > -depth - _MOVING_LAYER * float(spacing.max())
            value[nearer] = np.where(moving, _velocity(wall, points[nearer])[:, component], 0.0)
        behind = np.isfinite(deepest)
        found.append((((k - below) * (counts[1] + 2) + j) * (counts[0] + 2) + i)[behind])
        values.append(value[behind])
    return np.concatenate(found).astype(np.int64), np.concatenate(values)
