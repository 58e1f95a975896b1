"""The flow in a vertical plane through the bodies, at a few times."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rdpm.figures.plane import Plane, draw_walls
from rdpm.figures.style import FLOW_MAP, drawing, length_unit, save
from rdpm.io.vtkhdf import field_grid, field_times, read_plane
from rdpm.results.tracks import Tracks

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Slices", "body_positions", "load_slices", "periodic_copies", "plot_flow"]

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


def plot_flow(
    path: str | Path,
    slices: Slices,
    tracks: Tracks | None,
    diameter: ArrayLike,
    box: ArrayLike,
    period: ArrayLike,
    plane: Plane,
    caption: str,
    at: ArrayLike | None = None,
) -> Path:
    """Speed (colour), velocity in the plane (arrows) and the bodies it cuts, at a few times, as PNG.

    Parameters
    ----------
    path : path
    slices : Slices
    tracks : Tracks or None
        Bodies to draw.
    diameter : array_like, (N,), [m]
    box : array_like, (3,), [m]
    period : array_like, (3,), [m]
        Length of the box along periodic directions, 0 along others.
    plane : Plane
    caption : str
        What was run.
    at : array_like, optional, [s]
        Times; the nearest stored ones are drawn. Evenly spread when left out.

    Returns
    -------
    pathlib.Path
    """
    size, repeat = np.asarray(box, np.float64), np.asarray(period, np.float64)
    factor, unit = length_unit(size)
    width, height = factor * size[plane.across], factor * size[plane.up]
    follows = tracks is not None and 0 < tracks.count <= 8 and repeat[plane.up] == 0.0
    window = min(height, 2.0 * width) if follows else height   # of a tall tank the part around the bodies
    steps = _steps(slices.times, at, int(np.clip(round(2.2 * window / width), 2, 5)))
    tall = float(np.clip(1.7 * window / width, 2.6, 5.2))
    speed_factor, speed_unit = length_unit(slices.top_speed)
    with drawing(max(3.4, len(steps) * (tall * width / window + 0.2) + 1.5), tall + 0.9) as figure:
        all_axes = figure.subplots(1, len(steps), sharey=not follows, squeeze=False)[0]
        for axes, step in zip(all_axes, steps, strict=True):
            image = _slice(axes, slices, step, width, height, speed_factor)
            draw_walls(axes, plane, size, factor)
            if tracks is not None:
                centres = factor * body_positions(tracks, slices.times[step])
                d = factor * np.asarray(diameter, np.float64)
                _discs(axes, centres, d, factor * repeat, plane, factor * plane.position)
                if follows:
                    middle = np.clip(centres[:, plane.up].mean(), 0.5 * window, height - 0.5 * window)
                    axes.set_ylim(middle - 0.5 * window, middle + 0.5 * window)
            axes.set_title(f"t = {slices.times[step]:.3g} s")
            axes.set_xlabel(f"{'xyz'[plane.across]} [{unit}]")
        all_axes[0].set_ylabel(f"{'xyz'[plane.up]} [{unit}]")
        label = f"speed of the fluid [{speed_unit}/s]"
        figure.colorbar(image, ax=list(all_axes), label=label, aspect=30, pad=0.02, shrink=0.85, extend="max")
        where = f"Plane {'xyz'[plane.normal]} = {factor * plane.position:.3g} {unit}."
        return save(figure, path, f"{caption}. {where}")


def _steps(times: Floats, at: ArrayLike | None, panels: int) -> NDArray[np.int64]:
    """Numbers of the stored steps nearest to the requested times."""
    wanted = np.linspace(times[-1] / panels, times[-1], panels) if at is None else np.asarray(at, np.float64)
    return np.unique([int(np.argmin(np.abs(times - time))) for time in wanted])


def _slice(axes: Axes, slices: Slices, step: int, width: float, height: float, factor: float) -> Any:
    top = factor * max(slices.top_speed, 1e-12)
    image = axes.imshow(
        factor * slices.speed[step], origin="lower", extent=(0.0, width, 0.0, height), cmap=FLOW_MAP,
        vmin=0.0, vmax=top, interpolation="bilinear", aspect="equal",
    )
    rows, columns = slices.speed[step].shape
    every = max(1, round(columns / 14))
    i, k = np.arange(every // 2, columns, every), np.arange(every // 2, rows, every)
    u, w = (factor * part[step][np.ix_(k, i)] for part in (slices.across, slices.up))
    seen = np.hypot(u, w) > 0.03 * top   # arrows shorter than that are dots
    x, z = np.meshgrid((i + 0.5) * width / columns, (k + 0.5) * height / rows)
    axes.quiver(
        x[seen], z[seen], u[seen], w[seen], angles="xy", scale_units="xy",
        scale=top / (2.0 * every * width / columns), color="#333333", width=0.007, headwidth=4, alpha=0.8,
    )
    axes.grid(visible=False)
    axes.set(xlim=(0.0, width), ylim=(0.0, height))
    return image


def _discs(axes: Axes, centres: Floats, diameter: Floats, period: Floats, plane: Plane, depth: float) -> None:
    """The circles in which the plane cuts the spheres, periodic images included."""
    from matplotlib.collections import EllipseCollection

    axis = [plane.across, plane.up]
    offset = centres[:, plane.normal] - depth
    if period[plane.normal] > 0.0:
        offset -= period[plane.normal] * np.rint(offset / period[plane.normal])
    cut = 2.0 * np.sqrt(np.maximum(0.25 * diameter**2 - offset**2, 0.0))
    for copy in periodic_copies(centres[:, axis], period[axis]):
        axes.add_collection(
            EllipseCollection(
                cut, cut, np.zeros(len(cut)), units="xy", offsets=copy, offset_transform=axes.transData,
                facecolors="#E69F00", edgecolors="#5a3d00", linewidths=0.6,
            )
        )


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
