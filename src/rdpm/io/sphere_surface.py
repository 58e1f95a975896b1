"""A sphere as triangles, for programs that show surfaces."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

__all__ = ["sphere_surface", "surface_level"]

Floats = NDArray[np.float64]


@cache
def sphere_surface(level: int) -> tuple[Floats, NDArray[np.int64]]:
    """Unit sphere from an icosahedron whose triangles are split in four `level` times (shared arrays).

    Returns
    -------
    points : ndarray, (10 * 4**level + 2, 3), [-]
    triangles : ndarray, (20 * 4**level, 3), [-]
        Point numbers, seen counter-clockwise from outside.

    Examples
    --------
    >>> points, triangles = sphere_surface(1)
    >>> points.shape, triangles.shape
    ((42, 3), (80, 3))
    """
    golden = (1.0 + 5.0**0.5) / 2.0
    corners = [(-1.0, golden, 0.0), (1.0, golden, 0.0), (-1.0, -golden, 0.0), (1.0, -golden, 0.0)]
    points = np.array([(*p[s:], *p[:s]) for s in (0, 2, 1) for p in corners])
    points /= np.linalg.norm(points, axis=1)[:, None]
    i, j, k = (c.ravel() for c in np.meshgrid(*[np.arange(12)] * 3, indexing="ij"))
    edge = np.linalg.norm(points[:, None] - points[None], axis=2) < 1.1   # 1.05 to neighbours, 1.7 to others
    once = (i < j) & (i < k) & edge[i, j] & edge[j, k] & edge[i, k]
    i, j, k = i[once], j[once], k[once]
    outward = np.einsum("ij,ij->i", np.cross(points[j] - points[i], points[k] - points[i]), points[i]) > 0.0
    triangles = np.stack([i, j, k], axis=1)[outward]
    for _ in range(level):
        points, triangles = _split(points, triangles)
    return points, triangles


def _split(points: Floats, triangles: NDArray[np.int64]) -> tuple[Floats, NDArray[np.int64]]:
    edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    unique, where = np.unique(edges, axis=0, return_inverse=True)
    middle = points[unique].sum(axis=1)
    middle /= np.linalg.norm(middle, axis=1)[:, None]
    a, b, c = triangles.T
    ab, bc, ca = (where.reshape(-1, 3) + len(points)).T
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return np.concatenate([points, middle]), np.concatenate([np.stack(p, axis=1) for p in parts])


def surface_level(count: int) -> int:
    """How fine the surfaces of so many spheres are: a sphere has 10 * 4^level + 2 points.

    Examples
    --------
    >>> surface_level(2), surface_level(5000)
    (3, 0)
    """
    return 3 if count <= 20 else 2 if count <= 200 else 1 if count <= 2000 else 0
