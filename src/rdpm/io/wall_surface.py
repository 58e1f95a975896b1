"""Walls within the box as triangles, for ParaView."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rdpm.io.appending import reserve
from rdpm.io.files import replacing
from rdpm.surfaces import Cylinder, Surface

__all__ = ["wall_surface", "write_walls"]

Floats = NDArray[np.float64]
Triangles = NDArray[np.int64]

_AROUND = 96  # lines of a cylinder


def wall_surface(wall: Surface, box: ArrayLike) -> tuple[Floats, Triangles]:
    """The part of a wall that is within the box.

    Parameters
    ----------
    wall : Plane or Cylinder
    box : array_like, (3,), [m]

    Returns
    -------
    points : ndarray, (P, 3), [m]
    triangles : ndarray, (T, 3)
        Point numbers.

    Examples
    --------
    >>> from rdpm.surfaces import Plane
    >>> points, triangles = wall_surface(Plane((0.5, 0.5, 0.5), (0.0, 0.0, 1.0)), (1.0, 1.0, 1.0))
    >>> points.shape, triangles.shape
    ((4, 3), (2, 3))
    """
    size = np.asarray(box, np.float64)
    return _cylinder(wall, size) if isinstance(wall, Cylinder) else _plane(wall.point, np.asarray(wall.row[2]), size)


def _plane(point: ArrayLike, normal: Floats, size: Floats) -> tuple[Floats, Triangles]:
    """The polygon of the points where the edges of the box meet the plane."""
    corners = size * np.array([[i >> d & 1 for d in range(3)] for i in range(8)])
    height = (corners - np.asarray(point)) @ normal
    near = 1e-12 * size.max()
    edges = [(i, j) for i in range(8) for j in (i ^ 1, i ^ 2, i ^ 4) if i < j]
    found = [corners[n] for n in range(8) if abs(height[n]) <= near]
    found += [
        corners[i] + height[i] / (height[i] - height[j]) * (corners[j] - corners[i])
        for i, j in edges
        if min(height[i], height[j]) < -near and max(height[i], height[j]) > near
    ]
    if len(found) < 3:
        return np.empty((0, 3)), np.empty((0, 3), np.int64)
    points = np.array(found)
    middle = points.mean(axis=0)
    first, second = _across(normal)
    order = np.argsort(np.arctan2((points - middle) @ second, (points - middle) @ first))
    fan = np.arange(1, len(points) - 1)
    return points[order], np.stack([np.zeros_like(fan), fan, fan + 1], axis=1)


def _cylinder(wall: Cylinder, size: Floats) -> tuple[Floats, Triangles]:
    """Lines along the axis, each as far as it is within the box, and the strips between neighbours."""
    axis = np.asarray(wall.row[2])
    first, second = _across(axis)
    angle = 2.0 * np.pi * np.arange(_AROUND) / _AROUND
    start = np.asarray(wall.point) + wall.radius * (np.cos(angle)[:, None] * first + np.sin(angle)[:, None] * second)
    with np.errstate(divide="ignore", invalid="ignore"):
        to = np.sort(np.stack([(0.0 - start) / axis, (size - start) / axis]), axis=0)
    level = np.abs(axis) < 1e-12
    within = ((start >= 0.0) & (start <= size)) | ~level
    low = np.where(level, -np.inf, to[0]).max(axis=1)
    high = np.where(level, np.inf, to[1]).min(axis=1)
    drawn = within.all(axis=1) & (high > low)
    low, high = np.where(drawn, low, 0.0), np.where(drawn, high, 0.0)
    points = np.concatenate([start + low[:, None] * axis, start + high[:, None] * axis])
    n = np.arange(_AROUND)
    after = (n + 1) % _AROUND
    pair = drawn & drawn[after]
    n, after = n[pair], after[pair]
    strips = np.stack([n, after, after + _AROUND]), np.stack([n, after + _AROUND, n + _AROUND])
    return points, np.concatenate(strips, axis=1).T.copy()


def _across(axis: Floats) -> tuple[Floats, Floats]:
    """Two unit vectors at right angles to a third and to each other."""
    first = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    first /= np.linalg.norm(first)
    return first, np.cross(axis, first)


def write_walls(path: str | Path, walls: Sequence[Surface], box: ArrayLike) -> None:
    """Write the walls as one VTKHDF file without time steps; the number of each wall is a cell value.

    Parameters
    ----------
    path : path
        Ends in ``.vtkhdf``; replaced.
    walls : sequence of Plane or Cylinder
    box : array_like, (3,), [m]

    Raises
    ------
    OutputError
        The file cannot be written.
    """
    import h5py

    shapes = [wall_surface(wall, box) for wall in walls]
    first = np.cumsum([0, *(len(points) for points, _ in shapes)])
    points = np.concatenate([points for points, _ in shapes])
    cells = np.concatenate([triangles + at for (_, triangles), at in zip(shapes, first, strict=False)])
    number = np.repeat(np.arange(len(shapes)), [len(triangles) for _, triangles in shapes])
    with replacing(Path(path)) as temporary:
        reserve(temporary)
        with h5py.File(temporary, "w") as file:
            root = file.create_group("VTKHDF", track_order=True)
            root.attrs["Version"] = (2, 2)
            root.attrs["Type"] = np.bytes_("PolyData")
            root.create_dataset("NumberOfPoints", data=np.array([len(points)]))
            root.create_dataset("Points", data=points)
            for name, used in (("Vertices", 0), ("Lines", 0), ("Polygons", len(cells)), ("Strips", 0)):
                group = root.create_group(name)
                group.create_dataset("NumberOfCells", data=np.array([used]))
                group.create_dataset("NumberOfConnectivityIds", data=np.array([3 * used]))
                group.create_dataset("Offsets", data=3 * np.arange(used + 1))
                group.create_dataset("Connectivity", data=cells[:used].ravel())
            root.create_group("CellData").create_dataset("wall", data=number)
