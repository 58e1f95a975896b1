"""Paths of the bodies in two vertical views, to scale."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rdpm.figures.flow import periodic_copies
from rdpm.figures.marks import FEW, gravity_arrow
from rdpm.figures.plane import Plane, circular_mean, draw_walls
from rdpm.figures.style import ACCENT, PALETTE, column_figure, length_unit
from rdpm.results.tracks import Tracks

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["trajectory_chart", "wrapped"]

Floats = NDArray[np.float64]
_ROOM = 2.7   # inches for both views
_MOMENTS = 5   # times at which few bodies are drawn; of many the first and the last


def trajectory_chart(
    tracks: Tracks, diameter: ArrayLike, box: ArrayLike, period: ArrayLike, plane: Plane, gravity: ArrayLike
) -> Figure:
    """Paths in the viewing plane and across it, with the bodies to scale at a few times, the latest the strongest.

    Along periodic directions the bodies are drawn where they are in the box.

    Parameters
    ----------
    tracks : Tracks
    diameter : array_like, (N,), [m]
    box : array_like, (3,), [m]
    period : array_like, (3,), [m]
        Length of the box along periodic directions, 0 along others.
    plane : Plane
    gravity : array_like, (3,), [m/s^2]
        Drawn as an arrow.

    Returns
    -------
    matplotlib.figure.Figure
    """
    from matplotlib.ticker import MaxNLocator

    size = np.asarray(box, np.float64)
    factor, unit = length_unit(size)
    box, repeat = factor * size, factor * np.asarray(period, np.float64)
    d = factor * np.asarray(diameter, np.float64)
    position = factor * tracks.position
    at = circular_mean(tracks.position[..., plane.across], float(np.asarray(period)[plane.across]))
    views = (plane, Plane(plane.normal, plane.up, plane.across, at, plane.walls))
    widths = [box[view.across] for view in views]
    low, high = _seen(position[..., plane.up], 0.5 * d.max(), box[plane.up], repeat[plane.up])
    tall = float(np.clip(_ROOM * (high - low) / sum(widths), 1.0, 4.2))
    with column_figure("Paths, seen from two sides", tall + 1.25) as figure:
        pair = figure.subplots(1, 2, sharey=True, width_ratios=widths)
        for axes, view in zip(pair, views, strict=True):
            draw_walls(axes, view, size, factor)
            _view(axes, position, d, box, repeat, view)
            axes.set(xlim=(0.0, box[view.across]), ylim=(low, high), xlabel=f"{'xyz'[view.across]} [{unit}]")
            axes.set_aspect("equal", anchor="N")
            axes.xaxis.set_major_locator(MaxNLocator(max(2, min(5, round(6 * box[view.across] / sum(widths))))))
        pair[0].set_ylabel(f"{'xyz'[plane.up]} [{unit}]")
        gravity_arrow(pair[0], gravity, plane)
    return figure


def _seen(heights: Floats, radius: float, height: float, period: float) -> tuple[float, float]:
    """The part of the box that the bodies pass, with some room; all of it where it is periodic."""
    if period > 0.0:
        return 0.0, height
    room = radius + 0.04 * height
    return max(0.0, float(heights.min()) - room), min(height, float(heights.max()) + room)


def wrapped(path: Floats, period: Floats) -> Floats:
    """A path moved into the box along periodic directions, broken by nan where it crosses a face: (T + breaks, 2).

    Examples
    --------
    >>> wrapped(np.array([[0.9, 0.5], [1.2, 0.5]]), np.array([1.0, 0.0])).round(3).tolist()
    [[0.9, 0.5], [nan, nan], [0.2, 0.5]]
    """
    image = np.floor(path / np.where(period > 0.0, period, np.inf))
    breaks = 1 + np.flatnonzero((np.diff(image, axis=0) != 0.0).any(axis=1))
    return np.insert(path - period * image, breaks, np.nan, axis=0)


def _inside(points: Floats, period: Floats) -> Floats:
    return points - period * np.floor(points / np.where(period > 0.0, period, np.inf))


def _view(axes: Axes, position: Floats, diameter: Floats, box: Floats, period: Floats, view: Plane) -> None:
    from matplotlib.collections import EllipseCollection

    axis = [view.across, view.up]
    count = position.shape[1]
    is_few = count <= FEW
    for n in range(count):
        look: Any = {"color": PALETTE[n], "lw": 1.0} if is_few else {"color": ACCENT, "lw": 0.3}
        axes.plot(*wrapped(position[:, n][:, axis], period[axis]).T, **look)
    if 1 < count <= FEW:   # each is numbered where it ends
        for n, (x, y) in enumerate(_inside(position[-1][:, axis], period[axis])):
            axes.text(x, y, str(n), color="white", fontsize=6.5, weight="bold", ha="center", va="center", zorder=6)
    moments = np.unique(np.linspace(0, len(position) - 1, _MOMENTS if is_few else 2).astype(int))
    for number, moment in enumerate(moments):
        strength = (0.2, 0.75)[number] if not is_few else 0.2 + 0.6 * (number + 1) / len(moments)
        colours = [PALETTE[n] if is_few else PALETTE[6 if number == 0 else 0] for n in range(count)]
        for copy in periodic_copies(position[moment][:, axis], period[axis]):
            axes.add_collection(
                EllipseCollection(
                    diameter, diameter, np.zeros(count), units="xy", offset_transform=axes.transData, offsets=copy,
                    facecolors=colours, edgecolors="white", linewidths=0.3, alpha=strength,
                )
            )
