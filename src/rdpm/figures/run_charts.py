"""Charts of a run against time: velocity, positions, gap, line of centres, budgets."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rdpm.figures.marks import FEW, body_lines, mark_level, mark_phases
from rdpm.figures.style import PALETTE, column_chart, length_unit, prefixed
from rdpm.results.dkt import KISS_GAP, TUMBLE_ANGLE, DktPhases, line_of_centres, pair_gap
from rdpm.results.tracks import Tracks

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["angle_chart", "gap_chart", "history_chart", "positions_chart", "velocity_chart"]


def velocity_chart(tracks: Tracks, gravity: ArrayLike, phases: DktPhases | None = None) -> Figure:
    """Settling velocity (along gravity; along -z without) of each body against time.

    Parameters
    ----------
    tracks : Tracks
    gravity : array_like, (3,), [m/s^2]
    phases : DktPhases, optional
        Marked when given.

    Returns
    -------
    matplotlib.figure.Figure
    """
    g = np.asarray(gravity, np.float64)
    down = g / np.linalg.norm(g) if g.any() else np.array([0.0, 0.0, -1.0])
    values = tracks.velocity @ down
    factor, unit = length_unit(values)
    with column_chart("Settling velocity" if g.any() else "Velocity along -z", 2.8) as figure:
        axes = figure.add_subplot(xlabel="time [s]", ylabel=f"velocity [{unit}/s]")
        body_lines(axes, tracks.times, factor * values)
        mark_phases(axes, phases)
    return figure


def positions_chart(tracks: Tracks, box: ArrayLike, period: ArrayLike) -> Figure:
    """Coordinates against time; of many bodies along periodic directions how far they went.

    Along periodic directions positions are continued beyond the box: a mean over them has a meaning only as that of the
    way since the start.

    Parameters
    ----------
    tracks : Tracks
    box : array_like, (3,), [m]
    period : array_like, (3,), [m]
        Length of the box along periodic directions, 0 along others.

    Returns
    -------
    matplotlib.figure.Figure
    """
    size, repeat = np.asarray(box, np.float64), np.asarray(period, np.float64)
    is_way = (repeat > 0.0) & (tracks.count > FEW)
    shown = tracks.position - np.where(is_way, tracks.position[:1], 0.0)
    factor, unit = length_unit(size)
    with column_chart("Way from the start" if is_way.all() else "Positions", 4.6) as figure:
        panels = figure.subplots(3, 1, sharex=True)
        for n, axes in enumerate(panels):
            body_lines(axes, tracks.times, factor * shown[..., n])
            axes.set_ylabel(f"{'xyz'[n]}{' - start' if is_way[n] else ''} [{unit}]")
            if np.ptp(shown[..., n]) < 1e-3 * size[n]:   # noise is not blown up to a motion
                middle = factor * float(shown[0, :, n].mean())
                axes.set_ylim(middle - 0.01 * factor * size[n], middle + 0.01 * factor * size[n])
                axes.ticklabel_format(useOffset=False)
        panels[-1].set_xlabel("time [s]")
        figure.align_ylabels()
    return figure


def gap_chart(
    tracks: Tracks, diameter: ArrayLike, phases: DktPhases | None = None, period: ArrayLike | None = None
) -> Figure:
    """Gap in % of the smaller diameter against time, with the 2 % line of a kiss; linear below it.

    Of a pair the gap between the two; else of each body the smallest to any body or wall.

    Parameters
    ----------
    tracks : Tracks
    diameter : array_like, (N,), [m]
    phases : DktPhases, optional
        Marked when given.
    period : array_like, (3,), optional, [m]
        Length of the box along periodic directions, 0 along others.

    Returns
    -------
    matplotlib.figure.Figure
    """
    d = np.asarray(diameter, np.float64)
    is_pair = tracks.count == 2
    if is_pair:
        percent = 100.0 * pair_gap(tracks.position[:, 0], tracks.position[:, 1], d[0], d[1], period)[:, None] / d.min()
    else:
        percent = 100.0 * tracks.gap / d.min()
    title = "Gap between the spheres" if is_pair else "Smallest gap to a body or wall"
    with column_chart(title, 3.0) as figure:
        axes = figure.add_subplot(xlabel="time [s]", ylabel="gap [% d]")
        if is_pair:
            axes.plot(tracks.times, percent[:, 0])
        else:
            body_lines(axes, tracks.times, percent, "quantiles")
        # Both a gap of some diameters and the last hundredth of one must be seen: linear inside +-2 %.
        axes.set_yscale("symlog", linthresh=100.0 * KISS_GAP, linscale=1.0)
        mark_level(axes, 100.0 * KISS_GAP, "kiss: 2 % d")
        deepest = min(-1.0, 1.2 * float(np.nanmin(percent, initial=0.0)))
        axes.axhspan(deepest, 0.0, color=PALETTE[0], alpha=0.12, linewidth=0, label="overlap")
        largest = float(np.nanmax(percent, initial=0.0))
        ticks = [value for value in (-20.0, -10.0, -5.0, -2.0, -1.0) if value >= deepest][-2:]
        ticks += [0.0, 1.0, 2.0, *(value for value in (10.0, 100.0, 1000.0, 10000.0) if value <= 1.5 * largest)]
        axes.set_ylim(deepest, max(3.0, 1.3 * largest))
        axes.set_yticks(ticks, [f"{value:g}" for value in ticks])
        axes.minorticks_off()
        mark_phases(axes, phases)
    return figure


def angle_chart(
    tracks: Tracks, gravity: ArrayLike, phases: DktPhases | None = None, period: ArrayLike | None = None
) -> Figure:
    """Angle of a pair's line of centres from gravity against time.

    Parameters
    ----------
    tracks : Tracks
        Of two bodies.
    gravity : array_like, (3,), [m/s^2]
        Not zero.
    phases : DktPhases, optional
        Marked when given.
    period : array_like, (3,), optional, [m]
        Length of the box along periodic directions, 0 along others.

    Returns
    -------
    matplotlib.figure.Figure
    """
    angle = line_of_centres(tracks.position[:, 0], tracks.position[:, 1], gravity, period)
    with column_chart("Line of centres", 2.6) as figure:
        axes = figure.add_subplot(xlabel="time [s]", ylabel="angle from gravity [°]")
        axes.plot(tracks.times, angle)
        mark_level(axes, TUMBLE_ANGLE, "tumbling: 45°")
        axes.set_yticks([0, 45, 90] if angle.max() <= 95.0 else [0, 45, 90, 135, 180])
        axes.set_ylim(0, 95 if angle.max() <= 95.0 else 185)
        mark_phases(axes, phases)
    return figure


def history_chart(history: Mapping[str, NDArray[Any]], tracks: Tracks | None = None) -> Figure:
    """Energies, CFL number, divergence and slip against time: whether the numbers can be trusted.

    Parameters
    ----------
    history : mapping of ndarray
        Columns of ``history.csv``.
    tracks : Tracks, optional
        The slip is then over the fastest speed of the run, instead of that of the moment, which may be nothing.

    Returns
    -------
    matplotlib.figure.Figure
    """
    times = history["time_s"]
    energies = (("kinetic_energy_fluid_J", "energy of the fluid"), ("kinetic_energy_bodies_J", "of the bodies"))
    factor, unit = prefixed([np.nanmax(history[name], initial=0.0) for name, _ in energies], "J")
    overlap = history["max_overlap_fraction"]
    panels: list[tuple[str, list[tuple[NDArray[Any], str]]]] = [
        (f"energy [{unit}]", [(factor * history[name], label) for name, label in energies]),
        ("CFL number", [(history["cfl"], "")]),
        ("div. [1/s]", [(history["divergence"], "")]),
        ("fraction", [(_slip(history, tracks), "slip / fastest body"), (overlap, "overlap / d")]),
    ]
    used = [(label, [c for c in curves if (np.nan_to_num(c[0]) > 0.0).any()]) for label, curves in panels]
    used = [(label, curves) for label, curves in used if curves] or panels[:1]
    with column_chart("Health of the run", 1.0 + 1.05 * len(used)) as figure:
        stack = figure.subplots(len(used), 1, sharex=True, squeeze=False)[:, 0]
        colours = iter(PALETTE)
        for axes, (label, curves) in zip(stack, used, strict=True):
            for n, (values, name) in enumerate(curves):
                style = {"color": next(colours), "label": name} if name else {"color": PALETTE[6]}
                axes.plot(times, values, ls=("-", "--")[n % 2], **style)
            axes.set_ylabel(label)
            if label.startswith("div"):
                axes.set_yscale("log")
            else:
                axes.set_ylim(bottom=0.0)
        stack[-1].set_xlabel("time [s]")
        figure.align_ylabels()
    return figure


def _slip(history: Mapping[str, NDArray[Any]], tracks: Tracks | None) -> NDArray[np.float64]:
    """Slip of the markers over the fastest speed of the run: at rest a share of nothing would fill the chart."""
    slip = np.asarray(history["slip"], np.float64)
    if tracks is None or not len(tracks.times):
        return slip
    speed = np.linalg.norm(tracks.velocity, axis=2).max(axis=1, initial=0.0)
    fastest = float(speed.max(initial=0.0))
    if fastest == 0.0:
        return slip
    return np.asarray(slip * np.interp(history["time_s"], tracks.times, speed) / fastest)
