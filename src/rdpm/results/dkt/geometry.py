"""A pair of spheres: gap, line of centres, and paths through periodic boundaries."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["continued", "line_of_centres", "pair_gap", "separation", "speed"]

Floats = NDArray[np.float64]


def pair_gap(
    position_0: ArrayLike,
    position_1: ArrayLike,
    diameter_0: float,
    diameter_1: float,
    period: ArrayLike | None = None,
) -> Floats:
    """Gap between the surfaces of two spheres, negative where they overlap: (T,), [m].

    Examples
    --------
    >>> pair_gap([[0, 0, 0]], [[0, 0, 2]], 1.0, 0.5).tolist()
    [1.25]
    """
    line = separation(np.asarray(position_0, np.float64), np.asarray(position_1, np.float64), period)
    return np.asarray(np.linalg.norm(line, axis=1) - 0.5 * (diameter_0 + diameter_1))


def line_of_centres(
    position_0: ArrayLike, position_1: ArrayLike, gravity: ArrayLike, period: ArrayLike | None = None
) -> Floats:
    """Angle of a pair from gravity: 0 with the first above or below, 180 with places changed: (T,), [deg].

    Examples
    --------
    >>> line_of_centres([[0, 0, 0]] * 3, [[0, 0, 1], [1, 0, 0], [0, 0, -1]], (0, 0, -9.81)).tolist()
    [0.0, 90.0, 180.0]
    """
    line = separation(np.asarray(position_0, np.float64), np.asarray(position_1, np.float64), period)
    up = -np.asarray(gravity, np.float64)
    along = line @ up / np.linalg.norm(up)
    across = np.sqrt(np.maximum(np.einsum("ij,ij->i", line, line) - along**2, 0.0))
    return np.asarray(np.degrees(np.arctan2(across, along if along[0] >= 0.0 else -along)))


def separation(first: Floats, second: Floats, period: ArrayLike | None) -> Floats:
    """From the first sphere to the nearest image of the second: (T, 3), [m].

    Examples
    --------
    >>> separation(np.array([[0.1, 0, 0]]), np.array([[0.9, 0, 0]]), (1.0, 0, 0)).round(3).tolist()
    [[-0.2, 0.0, 0.0]]
    """
    difference = second - first
    if period is not None:
        length = np.asarray(period, np.float64)
        difference -= length * np.rint(difference / np.where(length > 0.0, length, np.inf))
    return difference


def continued(position: Floats, period: ArrayLike | None) -> Floats:
    """Path from the first position on, without the jumps through periodic boundaries: (T, 3), [m].

    Examples
    --------
    >>> continued(np.array([[0.9, 0, 0], [0.1, 0, 0]]), (1.0, 0, 0)).round(3).tolist()
    [[0.0, 0.0, 0.0], [0.2, 0.0, 0.0]]
    """
    moved = separation(position[:-1], position[1:], period)
    return np.concatenate([np.zeros((1, 3)), np.cumsum(moved, axis=0)])


def speed(t: Floats, position: Floats, period: ArrayLike | None) -> Floats:
    """Speed along a path by central differences: (T,), [m/s].

    Examples
    --------
    >>> speed(np.array([0.0, 1.0, 2.0]), np.array([[0.0, 0, 0], [2, 0, 0], [4, 0, 0]]), None).tolist()
    [2.0, 2.0, 2.0]
    """
    return np.asarray(np.linalg.norm(np.gradient(continued(position, period), t, axis=0), axis=1))
