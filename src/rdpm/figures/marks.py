"""What several charts of a run share: lines of bodies, phases, levels, gravity."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rdpm.figures.plane import Plane
from rdpm.figures.style import ACCENT, PALETTE
from rdpm.results.dkt import DktPhases

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["FEW", "body_lines", "gravity_arrow", "mark_level", "mark_phases"]

FEW = 7   # bodies drawn each in its colour and dash; more are light lines, their mean and spread
_DRAWN = 80   # light lines at most
_DASHES = ("-", (0, (4, 1.5)), (0, (6, 1.5, 1, 1.5)), (0, (1, 1)))
Floats = NDArray[np.float64]


def body_lines(
    axes: Axes, times: Floats, values: Floats, band: Literal["deviation", "quantiles"] = "deviation"
) -> None:
    """Draw one line a body, or the middle and spread of many.

    Parameters
    ----------
    axes : Axes
    times : ndarray, (T,), [s]
    values : ndarray, (T, N)
        Nan where a body has none.
    band : {"deviation", "quantiles"}
        Of many: mean with standard deviation, or median with the 10 % and 90 % quantiles where a spread is one-sided.
    """
    count = values.shape[1]
    if count <= FEW:
        for n in range(count):
            label = f"sphere {n}" if count > 1 else None
            axes.plot(times, values[:, n], label=label, color=PALETTE[n % len(PALETTE)], ls=_DASHES[n % len(_DASHES)])
        return
    for n in np.linspace(0, count - 1, min(count, _DRAWN)).astype(int):
        axes.plot(times, values[:, n], color=ACCENT, alpha=0.25, linewidth=0.4)
    kept = np.isfinite(values).any(axis=1)
    times, values = times[kept], values[kept]
    if band == "deviation":
        middle, spread = np.nanmean(values, axis=1), np.nanstd(values, axis=1)
        low, high, name = middle - spread, middle + spread, f"mean of {count}, ± standard deviation"
    else:
        low, middle, high = np.nanquantile(values, (0.1, 0.5, 0.9), axis=1)
        name = f"median of {count}, 10 % to 90 %"
    axes.fill_between(times, low, high, color=PALETTE[0], alpha=0.25, linewidth=0)
    axes.plot(times, middle, color=PALETTE[0], linewidth=1.8, label=name)


def mark_phases(axes: Axes, found: DktPhases | None) -> None:
    """Upright lines where the pair first kisses and tumbles, named at the top, away from each other."""
    if found is None:
        return
    for time, name, side in ((found.kiss_time_s, "kiss", "right"), (found.tumble_time_s, "tumble", "left")):
        if time is not None:
            axes.axvline(time, color=ACCENT, linestyle=(0, (3, 2)), linewidth=0.8)
            axes.annotate(
                f"{name} {time:.2f} s", (time, 1.0), xycoords=("data", "axes fraction"),
                xytext=(2 if side == "right" else -2, 2), textcoords="offset points", ha=side, va="bottom",
                fontsize=6.5, color="#444444",
            )


def mark_level(axes: Axes, level: float, name: str) -> None:
    """A level line with its name at the right end."""
    axes.axhline(level, color=ACCENT, linewidth=0.8, linestyle=(0, (3, 2)))
    axes.annotate(
        name, (1.0, level), xycoords=("axes fraction", "data"), xytext=(-2, 1.5), textcoords="offset points",
        ha="right", va="bottom", fontsize=6.5, color="#262626",
        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 0.6},
    )


def gravity_arrow(axes: Axes, gravity: ArrayLike, plane: Plane) -> None:
    """Draw the direction of gravity in a plane, in the upper left corner of the figure; nothing where it is not in it.

    Parameters
    ----------
    axes : Axes
        Of the figure.
    gravity : array_like, (3,), [m/s^2]
    plane : Plane
    """
    g = np.asarray(gravity, np.float64)
    across, up = g[plane.across], g[plane.up]
    size = float(np.hypot(across, up))
    if size == 0.0 or size < 1e-6 * float(np.linalg.norm(g)):
        return
    from matplotlib.transforms import ScaledTranslation

    figure: Any = axes.figure
    along, corner = 7.0 / 72.0 * np.array([across, up]) / size, np.array([0.14, -0.13])   # half its length [in]
    end, start, aside = (
        figure.transFigure + ScaledTranslation(float(x), float(y), figure.dpi_scale_trans)
        for x, y in (corner + along, corner - along, corner + np.array([0.09, 0.0]))
    )
    head = {"arrowstyle": "-|>", "color": "#262626", "lw": 1.0, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 7}
    top = (0.0, 1.0)
    arrow = axes.annotate("", xy=top, xycoords=end, xytext=top, textcoords=start, arrowprops=head)
    name = axes.annotate("g", xy=top, xycoords=aside, fontsize=7.5, style="italic", va="center", color="#262626")
    for part in (arrow, name):
        part.set_in_layout(False)
