"""The flow in a vertical plane through the bodies, at a few times."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rdpm.figures.marks import gravity_arrow
from rdpm.figures.plane import Plane, draw_walls
from rdpm.figures.style import COLUMN, FLOW_MAP, column_figure, length_unit
from rdpm.io.vtkhdf import field_grid, field_times, read_plane
from rdpm.results.tracks import Tracks

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["Slices", "body_positions", "flow_chart", "load_slices", "nearest", "periodic_copies"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Slices:
    """Velocity in the cells that a plane cuts, at each stored time.

    Attributes
    ----------
    times : ndarray, (S,), [s]
    across, up, speed : ndarray of float32, (S, n_up, n_across), [m/s]
        Components in the plane, and the magnitude of all three.
    """

    times: Floats
    across: NDArray[np.float32]
    up: NDArray[np.float32]
    speed: NDArray[np.float32]

    @property
    def top_speed(self) -> float:
        """The colour scale's upper end, [m/s]: exceeded in one cell of a thousand at the busiest time."""
        return max((float(np.quantile(one, 0.999)) for one in self.speed), default=0.0)


def load_slices(path: str | Path, plane: Plane) -> Slices:
    """Read a plane of every stored step of ``fields.vtkhdf``.

    Parameters
    ----------
    path : path
    plane : Plane

    Returns
    -------
    Slices

    Raises
    ------
    CaseError
        The file is missing or no VTKHDF file.
    """
    times = field_times(path)
    cells, _ = field_grid(path)
    shape = (len(times), cells[plane.up], cells[plane.across])
    across, up, speed = (np.empty(shape, np.float32) for _ in range(3))
    for step in range(len(times)):
        layer = read_plane(path, step, "xyz"[plane.normal], plane.position)
        if plane.up < plane.across:   # rows of the file follow the later axis
            layer = layer.transpose(1, 0, 2)
        across[step], up[step] = layer[..., plane.across], layer[..., plane.up]
        speed[step] = np.linalg.norm(layer, axis=-1)
    return Slices(times, across, up, speed)


def body_positions(tracks: Tracks, time: float) -> Floats:
    """Centres of the bodies at a time between the rows of the table: (N, 3), [m]."""
    after = int(np.clip(np.searchsorted(tracks.times, time), 1, max(1, len(tracks.times) - 1)))
    if len(tracks.times) == 1:
        return np.asarray(tracks.position[0])
    start, end = tracks.times[after - 1], tracks.times[after]
    part = float(np.clip((time - start) / (end - start), 0.0, 1.0))
    return np.asarray((1.0 - part) * tracks.position[after - 1] + part * tracks.position[after])


def flow_chart(
    slices: Slices,
    tracks: Tracks | None,
    diameter: ArrayLike,
    box: ArrayLike,
    period: ArrayLike,
    plane: Plane,
    gravity: ArrayLike,
    at: ArrayLike | None = None,
) -> Figure:
    """Speed (colour), velocity in the plane (arrows) and the bodies at it, at a few times.

    Bodies that the plane cuts are filled where it cuts them, and outlined to their full size; those within half a
    diameter of it are outlined alone.

    Parameters
    ----------
    slices : Slices
    tracks : Tracks or None
        Bodies to draw.
    diameter : array_like, (N,), [m]
    box : array_like, (3,), [m]
    period : array_like, (3,), [m]
        Length of the box along periodic directions, 0 along others.
    plane : Plane
    gravity : array_like, (3,), [m/s^2]
        Drawn as an arrow.
    at : array_like, optional, [s]
        Times; the nearest stored ones are drawn. Evenly spread when left out.

    Returns
    -------
    matplotlib.figure.Figure
    """
    size, repeat = np.asarray(box, np.float64), np.asarray(period, np.float64)
    factor, unit = length_unit(size)
    width, height = factor * size[plane.across], factor * size[plane.up]
    follows = tracks is not None and 0 < tracks.count <= 8 and repeat[plane.up] == 0.0
    window = min(height, 2.0 * width) if follows else height   # of a tall tank the part around the bodies
    across = 2 if window < 1.3 * width else 3
    steps = _steps(slices.times, at, across if window > 1.3 * width else 2 * across)
    down = -(-len(steps) // across)
    room = (COLUMN - 0.5 - (0.3 if follows else 0.1) * (across - 1)) / across   # width of a panel [in]
    tall = min(room * window / width, 3.6)
    speed_factor, speed_unit = length_unit(slices.top_speed)
    with column_figure("Flow", down * (tall + 0.25) + 1.45) as figure:
        grid = figure.add_gridspec(down + 1, across, height_ratios=[*[tall] * down, 0.08])
        panels = [figure.add_subplot(grid[divmod(n, across)]) for n in range(len(steps))]
        for axes, step in zip(panels, steps, strict=True):
            image, arrows = _slice(axes, slices, step, width, height, speed_factor)
            draw_walls(axes, plane, size, factor)
            if tracks is not None:
                centres = factor * body_positions(tracks, slices.times[step])
                d = factor * np.asarray(diameter, np.float64)
                _spheres(axes, centres, d, factor * repeat, plane, factor * plane.position)
                if follows:
                    middle = np.clip(centres[:, plane.up].mean(), 0.5 * window, height - 0.5 * window)
                    axes.set_ylim(middle - 0.5 * window, middle + 0.5 * window)
            axes.set_title(f"{slices.times[step]:.3g} s", pad=2)
        _name_axes(panels, across, plane, unit, follows)
        gravity_arrow(panels[0], gravity, plane)
        label = f"speed of the fluid [{speed_unit}/s]"
        figure.colorbar(image, cax=figure.add_subplot(grid[-1, :]), orientation="horizontal", label=label, extend="max")
        told, line = _round_speed(speed_factor * slices.top_speed), 1.0 - 0.09 / figure.get_figheight()
        panels[0].quiverkey(
            arrows, 0.93, line, told, f"{told:g} {speed_unit}/s", labelpos="W", coordinates="figure", labelsep=0.05
        )
    return figure


def _round_speed(top: float) -> float:
    """1, 2 or 5 times a power of ten, at most the top.

    Examples
    --------
    >>> _round_speed(8.7), _round_speed(0.013)
    (5.0, 0.01)
    """
    power = 10.0 ** np.floor(np.log10(max(top, 1e-12)))
    return float(next(n * power for n in (5.0, 2.0, 1.0) if n * power <= top * (1.0 + 1e-9) or n == 1.0))


def _name_axes(panels: list[Axes], across: int, plane: Plane, unit: str, follows: bool) -> None:
    """Labels at the outer panels; numbers at the left of each where the panels show different heights."""
    from matplotlib.ticker import MaxNLocator

    for n, axes in enumerate(panels):
        axes.xaxis.set_major_locator(MaxNLocator(2 if across > 2 else 4))
        axes.yaxis.set_major_locator(MaxNLocator(5))
        if n % across == 0:
            axes.set_ylabel(f"{'xyz'[plane.up]} [{unit}]")
        elif not follows:
            axes.tick_params(labelleft=False)
        if n + across >= len(panels):
            axes.set_xlabel(f"{'xyz'[plane.across]} [{unit}]")
        else:
            axes.tick_params(labelbottom=False)


def _steps(times: Floats, at: ArrayLike | None, panels: int) -> NDArray[np.int64]:
    """Numbers of the stored steps nearest to the requested times."""
    wanted = np.linspace(times[-1] / panels, times[-1], panels) if at is None else np.asarray(at, np.float64)
    return np.unique([int(np.argmin(np.abs(times - time))) for time in wanted])


def _slice(axes: Axes, slices: Slices, step: int, width: float, height: float, factor: float) -> tuple[Any, Any]:
    """Draw one time: the image of the speed, and the arrows."""
    top = factor * max(slices.top_speed, 1e-12)
    image = axes.imshow(
        factor * slices.speed[step], origin="lower", extent=(0.0, width, 0.0, height), cmap=FLOW_MAP,
        vmin=0.0, vmax=top, interpolation="bilinear", aspect="equal",
    )
    rows, columns = slices.speed[step].shape
    every = max(1, round(columns / 12))
    i, k = np.arange(every // 2, columns, every), np.arange(every // 2, rows, every)
    u, w = (factor * part[step][np.ix_(k, i)] for part in (slices.across, slices.up))
    seen = np.hypot(u, w) > 0.03 * top   # arrows shorter than that are dots
    x, z = np.meshgrid((i + 0.5) * width / columns, (k + 0.5) * height / rows)
    arrows = axes.quiver(
        x[seen], z[seen], u[seen], w[seen], angles="xy", scale_units="xy",
        scale=top / (2.2 * every * width / columns), color="#262626", width=0.012, headwidth=3.5, headlength=4,
        headaxislength=3.5, alpha=0.85,
    )
    axes.grid(visible=False)
    axes.set(xlim=(0.0, width), ylim=(0.0, height))
    return image, arrows


def _spheres(axes: Axes, centres: Floats, diameter: Floats, period: Floats, plane: Plane, depth: float) -> None:
    """The spheres whose surface is within half a diameter of the plane, periodic images included."""
    from matplotlib.collections import EllipseCollection

    axis = [plane.across, plane.up]
    offset = np.abs(nearest(centres[:, plane.normal] - depth, period[plane.normal]))
    near = offset <= diameter
    cut = 2.0 * np.sqrt(np.maximum(0.25 * diameter**2 - offset**2, 0.0))
    is_cut = cut > 0.0
    for copy in periodic_copies(centres[:, axis], period[axis]):
        filled: Any = {"facecolors": "#E69F00", "edgecolors": "#5a3d00", "linewidths": 0.5}
        outline: Any = {"facecolors": "none", "edgecolors": "#5a3d00", "linewidths": 0.4}
        beside = (near & ~is_cut, diameter, outline | {"linestyles": ":"})
        shapes = (beside, (is_cut, diameter, outline), (is_cut, cut, filled))
        for kept, widths, look in shapes:
            axes.add_collection(
                EllipseCollection(
                    widths[kept], widths[kept], np.zeros(int(kept.sum())), units="xy", offsets=copy[kept],
                    offset_transform=axes.transData, **look,
                )
            )


def nearest(distance: Floats, period: float) -> Floats:
    """Distances to the nearest image along a direction of this period; as they are where it is 0.

    Examples
    --------
    >>> nearest(np.array([0.9, -0.4]), 1.0).round(6).tolist()
    [-0.1, -0.4]
    """
    return distance - period * np.rint(distance / period) if period > 0.0 else distance


def periodic_copies(points: Floats, period: Floats) -> list[Floats]:
    """Points moved into the box, and the same beside each of its periodic boundaries.

    Parameters
    ----------
    points : ndarray, (N, 2), [m]
    period : ndarray, (2,), [m]
        Length of the box along periodic directions, 0 along others.

    Examples
    --------
    >>> [copy.tolist() for copy in periodic_copies(np.array([[5.0, 2.0]]), np.array([4.0, 0.0]))]
    [[[-3.0, 2.0]], [[1.0, 2.0]], [[5.0, 2.0]]]
    """
    inside = points - period * np.floor(points / np.where(period > 0.0, period, np.inf))
    shifts = [[0.0] if length == 0.0 else [-length, 0.0, length] for length in period]
    return [inside + np.array([a, b]) for a in shifts[0] for b in shifts[1]]
