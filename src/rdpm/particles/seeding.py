"""Points spread evenly over a sphere, without a preferred direction."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

__all__ = ["marker_arms", "marker_count", "sphere_points"]

#: Mirror images in the three coordinate planes times the cyclic exchange of the axes.
SYMMETRY = 24


def marker_count(radius: float, spacing: float) -> int:
    """Markers of a sphere, about one a cell face of its surface.

    Parameters
    ----------
    radius, spacing : float, [m]
        Of the sphere, and of the grid.

    Returns
    -------
    int
        pi/3 (12 (a/h)^2 + 1), to the nearest multiple of 24 [1]_.

    References
    ----------
    .. [1] Uhlmann, J. Comput. Phys. 209 (2005) 448-476, section 4.2.

    Examples
    --------
    >>> marker_count(4.0, 1.0)
    192
    """
    even = math.pi / 3.0 * (12.0 * (radius / spacing) ** 2 + 1.0)
    return SYMMETRY * max(1, round(even / SYMMETRY))


@lru_cache(maxsize=1024)  # bodies of many sizes: each count is relaxed once
def _points(count: int) -> NDArray[np.float64]:
    """Repel points of one patch from all their images until they are even."""
    patch = count // SYMMETRY
    # A spiral over the sphere; those that fall into the patch x, y, z > 0, z the largest, start the relaxation.
    n = np.arange(8 * count) + 0.5
    height, azimuth = 1.0 - 2.0 * n / n.size, math.pi * (1.0 + math.sqrt(5.0)) * n
    ring = np.sqrt(1.0 - height**2)
    spiral = np.stack([ring * np.cos(azimuth), ring * np.sin(azimuth), height], axis=1)
    inside = spiral[(spiral[:, 0] > 0) & (spiral[:, 1] > 0) & (spiral[:, 2] >= spiral[:, :2].max(axis=1))]
    points = inside[np.linspace(0, len(inside) - 1, patch).round().astype(int)]
    distance = math.sqrt(4.0 * math.pi / count)
    for sweep in range(300):
        images = _images(points)
        apart = points[:, None, :] - images[None, :, :]
        square = np.einsum("ijk,ijk->ij", apart, apart)
        square[square < 1e-20] = np.inf  # a point and itself
        push = np.einsum("ijk,ij->ik", apart, square**-2.0) * distance**4
        push -= np.einsum("ik,ik->i", push, points)[:, None] * points
        size = np.linalg.norm(push, axis=1, keepdims=True)
        points = points + push / np.maximum(size, 1.0) * distance * 0.1 * (1.0 - sweep / 300)
        points /= np.linalg.norm(points, axis=1, keepdims=True)
    result = _images(points)
    # Neighbours in the list are neighbours on the grid: rings by height, round each ring.
    ring_of = np.floor((result[:, 2] + 1.0) / distance)
    result = result[np.lexsort((np.arctan2(result[:, 1], result[:, 0]), ring_of))]
    result.setflags(write=False)
    return result


def _images(points: NDArray[np.float64]) -> NDArray[np.float64]:
    signs = np.array([[x, y, z] for x in (1, -1) for y in (1, -1) for z in (1, -1)], float)
    cyclic = np.concatenate([np.roll(points, shift, axis=1) for shift in range(3)])
    images: NDArray[np.float64] = (signs[:, None, :] * cyclic[None, :, :]).reshape(-1, 3)
    return images


def sphere_points(count: int) -> NDArray[np.float64]:
    """Even points on the unit sphere, symmetric under reflection and exchange of the axes.

    Parameters
    ----------
    count : int
        A multiple of 24.

    Returns
    -------
    ndarray, (count, 3), [-]
        Unit vectors, read-only. Their sum is zero and their second moment isotropic: a sphere that starts
        on a symmetry line of the flow is not pushed off it by its own markers.

    Examples
    --------
    >>> points = sphere_points(48)
    >>> points.shape, bool(abs(points.sum()) < 1e-12)
    ((48, 3), True)
    """
    if count < SYMMETRY or count % SYMMETRY:
        raise ValueError(f"count = {count}: must be a positive multiple of {SYMMETRY}")
    return _points(count)


def marker_arms(diameter: NDArray[np.float64], spacing: float, retraction: float) -> list[NDArray[np.float64]]:
    """From each body's centre to its markers, in its axes.

    Parameters
    ----------
    diameter : ndarray, (N,), [m]
    spacing : float, [m]
        Mean spacing of the grid.
    retraction : float, [cells]
        Depth of the markers below the surface.

    Returns
    -------
    list of ndarray, (markers, 3), [m]

    Examples
    --------
    >>> [arms.shape for arms in marker_arms(np.array([8.0]), 1.0, 0.3)]
    [(192, 3)]
    """
    radius = 0.5 * diameter
    return [sphere_points(marker_count(a, spacing)) * (a - retraction * spacing) for a in radius]
