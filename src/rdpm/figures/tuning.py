"""The chart of a tuning: convergence against the time step, and what contact steps do."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rdpm.figures.style import ACCENT, PALETTE, drawing, save

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["plot_tuning"]

_SHADE: Any = {"color": "#56B4E9", "alpha": 0.22, "linewidth": 0}


def plot_tuning(path: str | Path, tuning: Mapping[str, Any], names: Mapping[str, str]) -> Path:
    """Draw a tuning as PNG: the range of N_c is shaded.

    Parameters
    ----------
    path : path
    tuning : mapping
        Of ``tune.json``.
    names : mapping of str to str
        Labels of the columns that are the measure and the outcome.

    Returns
    -------
    pathlib.Path
        The file.
    """
    with drawing(9.0, 6.4) as figure:
        (convergence, overlap), (length, outcome) = figure.subplots(2, 2)
        _convergence(convergence, tuning)
        rows = tuning["contact_steps"]
        steps = _column(rows, "contact_steps")
        overlap.plot(steps, 100.0 * _column(rows, "overlap_fraction"), "o-", color=PALETTE[0], label="in the runs")
        dry = 100.0 * _column(rows, "dry_overlap_fraction")
        overlap.plot(steps, dry, "--", color=PALETTE[1], label="dry design")
        overlap.axhline(100.0 * tuning["overlap_limit_fraction"], color=ACCENT, linestyle=":", label="limit")
        overlap.set(ylabel="largest overlap [% d]", yscale="log")
        length.plot(steps, _column(rows, "contact_longest_time_s"), "o-", color=PALETTE[2], label="longest contact")
        length.plot(steps, _column(rows, "contact_time_s"), "--", color=PALETTE[1], label="$t_c$, dry")
        if np.isfinite(_column(rows, "gap_kiss_total_s")).any():
            length.plot(steps, _column(rows, "gap_kiss_total_s"), "s-", color=PALETTE[3], label="kisses by the gap")
        length.set(ylabel="duration [s]", yscale="log")
        _outcome(outcome, steps, tuning, names)
        for axes in (overlap, length, outcome):
            axes.set_xlabel("contact steps $N_c$")
            if tuning["window"]:
                axes.axvspan(min(tuning["window"]), max(tuning["window"]), **_SHADE, label="range of $N_c$")
            axes.legend()
        for axes in (convergence, overlap, length):
            _plain_ticks(axes)
        dt = 1e3 * tuning["time_step"]["dt_s"]
        caption = f"{tuning['case']}: runs at dt = {dt:.4g} ms, restitution {tuning['restitution']:.3g} (dry)."
        return save(figure, path, f"{caption} {tuning['verdict']}")


def _plain_ticks(axes: Axes) -> None:
    """Ticks of logarithmic axes at 1, 2 and 5 of each decade, as plain numbers."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    for axis in (axes.xaxis, axes.yaxis):
        if axis.get_scale() == "log":
            axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            axis.set_minor_formatter(NullFormatter())


def _column(rows: Sequence[Mapping[str, Any]], name: str) -> NDArray[np.float64]:
    return np.array([np.nan if row[name] is None else row[name] for row in rows], np.float64)


def _convergence(axes: Axes, tuning: Mapping[str, Any]) -> None:
    rows = [row for row in tuning["time_steps"] if row["value"] is not None]
    axes.set(xlabel="time step dt [ms]", ylabel=f"change of {tuning['measure']} [%]")
    if not rows:
        axes.text(0.5, 0.5, "the time step was given", transform=axes.transAxes, ha="center", color=ACCENT)
        return
    dt, value = 1e3 * _column(rows, "dt_s"), _column(rows, "value")
    finest = value[np.argmin(dt)]
    change = 100.0 * np.abs(value - finest) / (abs(finest) or 1.0)
    coarser = dt > dt.min()
    axes.plot(dt[coarser], change[coarser], "o-", color=PALETTE[0], label=f"to that at {dt.min():.4g} ms")
    axes.axhline(100.0 * tuning["tolerance"], color=ACCENT, linestyle=":", label="tolerance")
    axes.axvline(1e3 * tuning["time_step"]["dt_s"], color=PALETTE[6], linestyle="--", label="taken")
    lost = [1e3 * row["dt_s"] for row in tuning["time_steps"] if row["value"] is None]
    if lost:
        axes.plot(lost, np.full(len(lost), 100.0 * tuning["tolerance"]), "x", color="#262626", label="no result")
    axes.set_xscale("log")
    if (change[coarser] > 0.0).any():
        axes.set_yscale("log")
    axes.legend()


def _outcome(axes: Axes, steps: NDArray[np.float64], tuning: Mapping[str, Any], names: Mapping[str, str]) -> None:
    values = _column(tuning["contact_steps"], "outcome")
    name = tuning["outcome"]
    axes.plot(steps, values, "o-", color=PALETTE[0], label="in the runs")
    spread = tuning["outcome_spread"]
    if spread is not None and spread["center"] is not None:
        center, width = spread["center"], spread["half_width"]
        low, high = center - width, center + width
        if spread["scale"] == "log":
            low, high = center * np.exp(-width), center * np.exp(width)
        axes.axhspan(low, high, color=PALETTE[4], alpha=0.25, linewidth=0, label="spread of numerics")
    axes.set_ylabel(names.get(name, name))
