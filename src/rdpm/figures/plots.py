"""Charts of the motion: settling velocity, trajectory, gap, line of centres, contacts, budgets."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rdpm.conventions import OVERLAP_WARNING
from rdpm.figures.plane import Plane, draw_walls
from rdpm.figures.style import ACCENT, PALETTE, drawing, length_unit, save
from rdpm.results.dkt import KISS_GAP, TUMBLE_ANGLE, DktPhases, line_of_centres, pair_gap
from rdpm.results.tracks import Tracks

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["plot_angle", "plot_contacts", "plot_gap", "plot_history", "plot_trajectory", "plot_velocity"]

FEW = 8         # bodies drawn each in its colour; more are light lines, their mean and spread
_DRAWN = 80     # light lines at most
Floats = NDArray[np.float64]


def _lines(axes: Axes, times: Floats, values: Floats, name: str = "sphere") -> None:
    """One line a body, or mean and spread of many: values are (T, N)."""
    count = values.shape[1]
    if count <= FEW:
        for n in range(count):
            axes.plot(times, values[:, n], label=f"{name} {n}" if count > 1 else None, color=PALETTE[n % 7])
        return
    for n in np.linspace(0, count - 1, min(count, _DRAWN)).astype(int):
        axes.plot(times, values[:, n], color=ACCENT, alpha=0.25, linewidth=0.6)
    mean, spread = values.mean(axis=1), values.std(axis=1)
    axes.fill_between(times, mean - spread, mean + spread, color=PALETTE[0], alpha=0.25, linewidth=0)
    axes.plot(times, mean, color=PALETTE[0], linewidth=2.2, label=f"mean of {count}, ± standard deviation")


def _mark_phases(axes: Axes, found: DktPhases | None) -> None:
    """Upright lines where the pair first kisses and tumbles, named at the top."""
    if found is None:
        return
    for time, name in ((found.kiss_time_s, "kiss"), (found.tumble_time_s, "tumble")):
        if time is not None:
            axes.axvline(time, color=ACCENT, linestyle=(0, (3, 2)), linewidth=0.9)
            axes.annotate(
                f"{name} {time:.2f} s", (time, 1.0), xycoords=("data", "axes fraction"), xytext=(0, 2),
                textcoords="offset points", ha="center", va="bottom", fontsize=8, color="#444444",
            )


def _mark_level(axes: Axes, level: float, name: str) -> None:
    """A level line with its name at the right end."""
    axes.axhline(level, color=ACCENT, linewidth=0.9)
    axes.annotate(
        name, (1.0, level), xycoords=("axes fraction", "data"), xytext=(-2, 2), textcoords="offset points",
        ha="right", va="bottom", fontsize=8, color="#444444",
    )


def _legend(axes: Axes) -> None:
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="best")


def plot_velocity(
    path: str | Path, tracks: Tracks, gravity: ArrayLike, caption: str, phases: DktPhases | None = None
) -> Path:
    """Settling velocity (along gravity; along -z without) of each body against time, as PNG.

    Parameters
    ----------
    path : path
    tracks : Tracks
    gravity : array_like, (3,), [m/s^2]
    caption : str
        What was run.
    phases : DktPhases, optional
        Marked when given.

    Returns
    -------
    pathlib.Path
    """
    g = np.asarray(gravity, np.float64)
    down = g / np.linalg.norm(g) if g.any() else np.array([0.0, 0.0, -1.0])
    values = tracks.velocity @ down
    factor, unit = length_unit(values)
    with drawing() as figure:
        axes = figure.add_subplot(xlabel="time [s]", ylabel=f"settling velocity [{unit}/s]")
        _lines(axes, tracks.times, factor * values)
        _mark_phases(axes, phases)
        _legend(axes)
        return save(figure, path, caption)


def plot_trajectory(
    path: str | Path, tracks: Tracks, diameter: ArrayLike, box: ArrayLike, plane: Plane, caption: str
) -> Path:
    """Paths in the viewing plane with bodies to scale, and each coordinate against time, as PNG.

    Parameters
    ----------
    path : path
    tracks : Tracks
    diameter : array_like, (N,), [m]
    box : array_like, (3,), [m]
    plane : Plane
    caption : str
        What was run.

    Returns
    -------
    pathlib.Path
    """
    size = np.asarray(box, np.float64)
    width = float(np.clip(4.8 * size[plane.across] / size[plane.up], 1.6, 4.5))
    factor, unit = length_unit(size)
    with drawing(4.0 + width, 5.6) as figure:
        grid = figure.add_gridspec(3, 2, width_ratios=[width, 4.0])
        d = factor * np.asarray(diameter, np.float64)
        map_axes = figure.add_subplot(grid[:, 0])
        draw_walls(map_axes, plane, size, factor)
        _paths(map_axes, factor * tracks.position, d, factor * size, plane, unit)
        panels = [figure.add_subplot(grid[n, 1]) for n in range(3)]
        for n, axes in enumerate(panels):
            axes.sharex(panels[-1])
            axes.tick_params(labelbottom=n == 2)
            _lines(axes, tracks.times, factor * tracks.position[..., n])
            axes.set_ylabel(f"{'xyz'[n]} [{unit}]")
            span = np.ptp(tracks.position[..., n])
            if span < 1e-3 * size[n]:   # noise is not blown up to a motion
                middle = factor * float(tracks.position[..., n].mean())
                axes.set_ylim(middle - 0.01 * factor * size[n], middle + 0.01 * factor * size[n])
        panels[-1].set_xlabel("time [s]")
        if tracks.count > 1:
            _legend(panels[-1])
        return save(figure, path, caption)


def _paths(axes: Axes, position: Floats, diameter: Floats, box: Floats, plane: Plane, unit: str) -> None:
    from matplotlib.collections import EllipseCollection
    from matplotlib.patches import Rectangle

    across, up = position[..., plane.across], position[..., plane.up]
    count = position.shape[1]
    axes.add_patch(Rectangle((0, 0), box[plane.across], box[plane.up], fill=False, edgecolor="#999999"))
    moments = np.unique(np.linspace(0, len(position) - 1, 6 if count <= FEW else 2).astype(int))
    for n in range(count):
        colour = PALETTE[n % 7] if count <= FEW else ACCENT
        axes.plot(across[:, n], up[:, n], color=colour, linewidth=1.2 if count <= FEW else 0.5, alpha=0.8)
    for number, moment in enumerate(moments):
        strength = 0.25 + 0.6 * (number + 1) / len(moments)
        colours = [PALETTE[n % 7] if count <= FEW else PALETTE[number] for n in range(count)]
        axes.add_collection(
            EllipseCollection(
                diameter, diameter, np.zeros(count), units="xy", offset_transform=axes.transData,
                offsets=np.stack([across[moment], up[moment]], axis=1),
                facecolors=colours, edgecolors="white", linewidths=0.5, alpha=strength,
            )
        )
    axes.set_aspect("equal")
    radius = 0.5 * diameter.max()
    margin = 0.01 * box.max()
    for values, axis, limit in ((across, plane.across, axes.set_xlim), (up, plane.up, axes.set_ylim)):
        limit(min(0.0, values.min() - radius) - margin, max(box[axis], values.max() + radius) + margin)
    axes.set(xlabel=f"{'xyz'[plane.across]} [{unit}]", ylabel=f"{'xyz'[plane.up]} [{unit}]")


def plot_gap(
    path: str | Path,
    tracks: Tracks,
    diameter: ArrayLike,
    caption: str,
    phases: DktPhases | None = None,
    period: ArrayLike | None = None,
) -> Path:
    """Gap in % of the smaller diameter against time, with the 2 % line of a kiss, as PNG.

    Of a pair the gap between the two; else of each body the smallest to any body or wall.

    Parameters
    ----------
    path : path
    tracks : Tracks
    diameter : array_like, (N,), [m]
    caption : str
        What was run.
    phases : DktPhases, optional
        Marked when given.
    period : array_like, (3,), optional, [m]
        Length of the box along periodic directions, 0 along others.

    Returns
    -------
    pathlib.Path
    """
    d = np.asarray(diameter, np.float64)
    is_pair = tracks.count == 2
    if is_pair:
        between = pair_gap(tracks.position[:, 0], tracks.position[:, 1], d[0], d[1], period)
        percent = 100.0 * between[:, None] / d.min()
    else:
        percent = 100.0 * tracks.gap / d.min()
    with drawing() as figure:
        what = "gap between the spheres" if is_pair else "smallest gap to a body or wall"
        axes = figure.add_subplot(xlabel="time [s]", ylabel=f"{what} [% d]")
        if is_pair:
            axes.plot(tracks.times, percent[:, 0])
        else:
            _lines(axes, tracks.times, percent)
        # Both a gap of some diameters and the last hundredth of one must be seen: linear inside +-2 %.
        axes.set_yscale("symlog", linthresh=100.0 * KISS_GAP, linscale=1.0)
        _mark_level(axes, 100.0 * KISS_GAP, "kiss: 2 %")
        deepest = min(-1.0, 1.2 * float(np.nanmin(percent, initial=0.0)))
        axes.axhspan(deepest, 0.0, color=PALETTE[0], alpha=0.08)
        axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
        _mark_phases(axes, phases)
        _legend(axes)
        return save(figure, path, caption + ". Shaded: overlap.")


def plot_angle(
    path: str | Path,
    tracks: Tracks,
    gravity: ArrayLike,
    caption: str,
    phases: DktPhases | None = None,
    period: ArrayLike | None = None,
) -> Path:
    """Angle of a pair's line of centres from gravity against time, as PNG.

    Parameters
    ----------
    path : path
    tracks : Tracks
        Of two bodies.
    gravity : array_like, (3,), [m/s^2]
        Not zero.
    caption : str
        What was run.
    phases : DktPhases, optional
        Marked when given.
    period : array_like, (3,), optional, [m]
        Length of the box along periodic directions, 0 along others.

    Returns
    -------
    pathlib.Path
    """
    angle = line_of_centres(tracks.position[:, 0], tracks.position[:, 1], gravity, period)
    with drawing(height=3.6) as figure:
        axes = figure.add_subplot(xlabel="time [s]", ylabel="line of centres from gravity [°]")
        axes.plot(tracks.times, angle)
        _mark_level(axes, TUMBLE_ANGLE, "tumbling: 45°")
        axes.set_yticks([0, 45, 90] if angle.max() <= 95.0 else [0, 45, 90, 135, 180])
        axes.set_ylim(0, 95 if angle.max() <= 95.0 else 185)
        _mark_phases(axes, phases)
        return save(figure, path, caption)


def plot_contacts(
    path: str | Path, contacts: Mapping[str, NDArray[Any]], target_restitution: float | None, caption: str
) -> Path:
    """Overlap of each contact against time, and achieved restitution against Stokes number, as PNG.

    Without a fluid the restitution is drawn against the impact speed.

    Parameters
    ----------
    path : path
    contacts : mapping of ndarray
        Columns of ``contacts.csv``.
    target_restitution : float or None, [-]
        Drawn as a line.
    caption : str
        What was run.

    Returns
    -------
    pathlib.Path
    """
    has_fluid = bool(np.isfinite(contacts["stokes_number"]).any())
    where = contacts["stokes_number"] if has_fluid else contacts["impact_speed_m_s"]
    with drawing(height=3.6) as figure:
        left, right = figure.subplots(1, 2)
        for n, kind in enumerate(np.unique(contacts["kind"])):
            rows = contacts["kind"] == kind
            overlap = 100.0 * contacts["max_overlap_fraction"][rows]
            left.vlines(contacts["start_s"][rows], 0.0, overlap, color=PALETTE[n], alpha=0.5, linewidth=1.0)
            dots: dict[str, Any] = {"marker": "o", "linestyle": "", "markersize": 4, "color": PALETTE[n]}
            left.plot(contacts["start_s"][rows], overlap, label=str(kind), **dots)
            right.plot(where[rows], contacts["restitution"][rows], **dots)
        _mark_level(left, 100.0 * OVERLAP_WARNING, f"{100.0 * OVERLAP_WARNING:g} %")
        left.set(xlabel="start of the contact [s]", ylabel="largest overlap [% d]")
        left.set_ylim(bottom=0.0)
        _legend(left)
        if target_restitution is not None:
            _mark_level(right, target_restitution, "target (dry)")
        right.set(xlabel="Stokes number at impact" if has_fluid else "impact speed [m/s]")
        right.set(ylabel="achieved restitution", ylim=(-0.03, 1.05))
        return save(figure, path, caption)


def plot_history(path: str | Path, history: Mapping[str, NDArray[Any]], caption: str) -> Path:
    """Energies, CFL number, divergence and slip against time: whether the numbers can be trusted, as PNG.

    Parameters
    ----------
    path : path
    history : mapping of ndarray
        Columns of ``history.csv``.
    caption : str
        What was run.

    Returns
    -------
    pathlib.Path
    """
    times = history["time_s"]
    panels = (
        ("kinetic energy [J]", (("kinetic_energy_fluid_J", "fluid"), ("kinetic_energy_bodies_J", "bodies"))),
        ("CFL number", (("cfl", ""),)),
        ("largest divergence [1/s]", (("divergence", ""),)),
        ("fraction", (("slip", "slip / fastest body"), ("max_overlap_fraction", "overlap / diameter"))),
    )
    with drawing(height=4.6) as figure:
        for axes, (label, columns) in zip(figure.subplots(2, 2, sharex=True).flat, panels, strict=True):
            for column, name in columns:
                if np.isfinite(history[column]).any():
                    axes.plot(times, history[column], label=name or None)
            axes.set_ylabel(label)
            axes.set_ylim(bottom=0.0)
            _legend(axes)
        for axes in figure.axes[-2:]:
            axes.set_xlabel("time [s]")
        return save(figure, path, caption)
