"""The plane that pictures are drawn in."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from rdpm.results.tracks import Tracks

__all__ = ["Plane", "viewing_plane"]


@dataclass(frozen=True)
class Plane:
    """A vertical plane to look at: numbers of its axes, and where it lies.

    Attributes
    ----------
    across, up, normal : int
        0, 1, 2 for x, y, z: drawn to the right, drawn upwards, out of the picture.
    position : float, [m]
        Along the normal.
    """

    across: int
    up: int
    normal: int
    position: float


def viewing_plane(tracks: Tracks | None, box: ArrayLike, gravity: ArrayLike) -> Plane:
    """The vertical plane through the bodies in which they move most.

    Parameters
    ----------
    tracks : Tracks or None
        None without bodies: the plane through the middle of the box.
    box : array_like, (3,), [m]
    gravity : array_like, (3,), [m/s^2]
        Its largest component is vertical; z without gravity.

    Examples
    --------
    >>> viewing_plane(None, (1.0, 2.0, 3.0), (0.0, 0.0, -9.81))
    Plane(across=0, up=2, normal=1, position=1.0)
    """
    size, g = np.asarray(box, np.float64), np.abs(np.asarray(gravity, np.float64))
    up = int(np.argmax(g)) if g.any() else 2
    first, second = (n for n in range(3) if n != up)
    if tracks is None or tracks.count == 0 or tracks.count > 8:
        return Plane(first, up, second, float(0.5 * size[second]))
    spread = np.ptp(tracks.position, axis=(0, 1))
    across, normal = (second, first) if spread[second] > 1.5 * spread[first] else (first, second)
    return Plane(across, up, normal, float(np.mean(tracks.position[..., normal]) % size[normal]))
