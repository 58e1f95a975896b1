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

__all__ = ["WALL_COLOUR", "Plane", "circular_mean", "draw_walls", "viewing_plane"]

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
        levels = [0.0, beyond.max()]
        axes.contourf(factor * across, factor * up, beyond, levels=levels, colors=[WALL_COLOUR], zorder=1.5)
        axes.contour(factor * across, factor * up, beyond, levels=[0.0], colors=["#444444"], linewidths=0.8, zorder=1.6)


def viewing_plane(
    tracks: Tracks | None, box: ArrayLike, gravity: ArrayLike, period: ArrayLike | None = None,
    walls: tuple[Surface, ...] = (),
) -> Plane:
    """The vertical plane through the bodies in which they move most.

    Parameters
    ----------
    tracks : Tracks or None
        None without bodies: the plane through the middle of the box.
    box : array_like, (3,), [m]
    gravity : array_like, (3,), [m/s^2]
        Its largest component is vertical; z without gravity.
    period : array_like, (3,), optional, [m]
        Length of the box along periodic directions, 0 along others.
    walls : tuple of rdpm.surfaces.Plane or Cylinder
        Within the box.

    Examples
    --------
    >>> viewing_plane(None, (1.0, 2.0, 3.0), (0.0, 0.0, -9.81))
    Plane(across=0, up=2, normal=1, position=1.0)
    """
    size, g = np.asarray(box, np.float64), np.abs(np.asarray(gravity, np.float64))
    repeat = np.zeros(3) if period is None else np.asarray(period, np.float64)
    up = int(np.argmax(g)) if g.any() else 2
    first, second = (n for n in range(3) if n != up)
    if tracks is None or tracks.count == 0 or tracks.count > 8:
        return Plane(first, up, second, float(0.5 * size[second]), walls)
    # Each body's image nearest to the others at the start; its way is without jumps.
    start = tracks.position[0]
    middle = np.array([circular_mean(start[:, n], repeat[n]) for n in range(3)])
    images = repeat * np.rint((start - middle) / np.where(repeat > 0.0, repeat, np.inf))
    position = tracks.position - images
    spread = np.ptp(position, axis=(0, 1))
    across, normal = (second, first) if spread[second] > 1.5 * spread[first] else (first, second)
    at = circular_mean(position[..., normal], repeat[normal])
    return Plane(across, up, normal, float(np.clip(at, 0.0, size[normal])), walls)


def circular_mean(values: ArrayLike, period: float) -> float:
    """Mean of positions along a periodic direction, in the box: across its seam as well; the common mean without one.

    Parameters
    ----------
    values : array_like, [m]
    period : float, [m]
        0: not periodic.

    Examples
    --------
    >>> round(circular_mean([0.95, 0.15], 1.0), 6), circular_mean([0.25, 0.75], 0.0)
    (0.05, 0.5)
    """
    v = np.asarray(values, np.float64)
    if period <= 0.0:
        return float(v.mean())
    turned = np.exp(2j * np.pi * v / period).mean()
    return float(np.angle(turned) / (2.0 * np.pi) * period % period)
