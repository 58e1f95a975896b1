"""The plane that pictures are drawn in."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rdpm.results.tracks import Tracks
from rdpm.surfaces import Surface

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["WALL_COLOUR", "Plane", "draw_walls", "viewing_plane"]

WALL_COLOUR = "#b8b8b8"


@dataclass(frozen=True)
class Plane:
    """A vertical plane to look at: numbers of its axes, and where it lies.

    Attributes
    ----------
    across, up, normal : int
        0, 1, 2 for x, y, z: drawn to the right, drawn upwards, out of the picture.
    position : float, [m]
        Along the normal.
    walls : tuple of rdpm.surfaces.Plane or Cylinder
        That the plane cuts.
    """

    across: int
    up: int
    normal: int
    position: float
    walls: tuple[Surface, ...] = field(default=(), repr=False)

    def beyond_walls(self, across: ArrayLike, up: ArrayLike) -> NDArray[np.float64]:
        """How far points of the plane lie beyond the walls.

        Parameters
        ----------
        across, up : array_like, (A,) and (U,), [m]
            Coordinates of a grid of points.

        Returns
        -------
        ndarray, (U, A), [m]
            Negative where bodies may be; -inf without walls.
        """
        u, v = np.meshgrid(across, up)
        points = np.full((u.size, 3), self.position)
        points[:, self.across], points[:, self.up] = u.ravel(), v.ravel()
        beyond = np.full(u.size, -np.inf)
        for wall in self.walls:
            beyond = np.maximum(beyond, -wall.distance(points)[0])
        return beyond.reshape(u.shape)


def draw_walls(axes: Axes, plane: Plane, box: ArrayLike, factor: float) -> None:
    """Hatch what is beyond the walls, into axes whose unit is 1/factor m.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    plane : Plane
    box : array_like, (3,), [m]
    factor : float
    """
    if not plane.walls:
        return
    size = np.asarray(box, np.float64)
    across, up = (np.linspace(0.0, size[axis], 401) for axis in (plane.across, plane.up))
    beyond = plane.beyond_walls(across, up)
    if beyond.max() > 0.0:
        axes.contourf(factor * across, factor * up, beyond, levels=[0.0, beyond.max()], colors=[WALL_COLOUR], zorder=1.5)
        axes.contour(factor * across, factor * up, beyond, levels=[0.0], colors=["#444444"], linewidths=0.8, zorder=1.6)


def viewing_plane(
    tracks: Tracks | None, box: ArrayLike, gravity: ArrayLike, walls: tuple[Surface, ...] = ()
) -> Plane:
    """The vertical plane through the bodies in which they move most.

    Parameters
    ----------
    tracks : Tracks or None
        None without bodies: the plane through the middle of the box.
    box : array_like, (3,), [m]
    gravity : array_like, (3,), [m/s^2]
        Its largest component is vertical; z without gravity.
    walls : tuple of rdpm.surfaces.Plane or Cylinder
        Within the box.

    Examples
    --------
    >>> viewing_plane(None, (1.0, 2.0, 3.0), (0.0, 0.0, -9.81))
    Plane(across=0, up=2, normal=1, position=1.0)
    """
    size, g = np.asarray(box, np.float64), np.abs(np.asarray(gravity, np.float64))
    up = int(np.argmax(g)) if g.any() else 2
    first, second = (n for n in range(3) if n != up)
    if tracks is None or tracks.count == 0 or tracks.count > 8:
        return Plane(first, up, second, float(0.5 * size[second]), walls)
    spread = np.ptp(tracks.position, axis=(0, 1))
    across, normal = (second, first) if spread[second] > 1.5 * spread[first] else (first, second)
    return Plane(across, up, normal, float(np.mean(tracks.position[..., normal]) % size[normal]), walls)
