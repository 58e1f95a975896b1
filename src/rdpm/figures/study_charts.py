"""Charts that compare runs: curves in stacked panels, paths side by side, kisses on a time line."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rdpm.figures.style import ACCENT, PALETTE, drawing, length_unit, save
from rdpm.io.files import replacing

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Bars", "Curve", "PairPath", "Panel", "bar_chart", "chart", "colours", "path_chart", "shrink"]

Floats = NDArray[np.float64]
MOST_INSIDE = 8   # names in a legend that still leave room for the curves
_FEW = 4   # values up to which colours need no order


@dataclass(frozen=True)
class Curve:
    """One curve of a panel.

    Attributes
    ----------
    label : str
        "" for none.
    x, y : array_like, (n,)
    color : str
    look : {"line", "dashed", "points", "both"}
    spread : float or tuple of array_like, optional
        Half widths of the error bars.
    """

    label: str
    x: ArrayLike
    y: ArrayLike
    color: str
    look: Literal["line", "dashed", "points", "both"] = "line"
    spread: Any = None


@dataclass(frozen=True)
class Panel:
    """Curves over one another.

    Attributes
    ----------
    y_label : str
        With its unit.
    curves : sequence of Curve
    log : bool
    limits : tuple of (float, str)
        Horizontal lines and what they are.
    """

    y_label: str
    curves: Sequence[Curve]
    log: bool = False
    limits: tuple[tuple[float, str], ...] = ()


@dataclass(frozen=True)
class PairPath:
    """Where a pair went, in the plane of view.

    Attributes
    ----------
    label : str
    upper, lower : ndarray, (T, 2), [m]
        Across and up; of the sphere that began above, and below.
    at : sequence of int
        Rows at which the spheres are drawn.
    """

    label: str
    upper: Floats
    lower: Floats
    at: Sequence[int]


@dataclass(frozen=True)
class Bars:
    """Spells of one run on a time line.

    Attributes
    ----------
    label : str
    gap, contact : sequence of (float, float), [s]
        Start and length.
    marks : mapping of str to float
        Instants by name.
    """

    label: str
    gap: Sequence[tuple[float, float]]
    contact: Sequence[tuple[float, float]]
    marks: dict[str, float] = field(default_factory=dict)


def colours(count: int) -> list[str]:
    """Colours of so many values in order: told apart with any colour vision, from dark to light when many.

    Examples
    --------
    >>> colours(2)
    ['#D55E00', '#262626']
    """
    if count <= _FEW:
        return list(PALETTE[:count])
    from matplotlib import colormaps
    from matplotlib.colors import to_hex

    return [to_hex(colour) for colour in colormaps["viridis"](np.linspace(0.0, 0.88, count))]


def chart(
    path: str | Path,
    panels: Sequence[Panel],
    x_label: str,
    title: str,
    caption: str,
    *,
    log_x: bool = False,
    ticks: ArrayLike | None = None,
    band: tuple[float, float, str] | None = None,
    height: float | None = None,
    to_scale: bool = False,
) -> Path:
    """Draw panels over one x axis.

    Parameters
    ----------
    path : path
        Of the figure.
    panels : sequence of Panel
    x_label, title, caption : str
        The label with its unit; the caption says what was run.
    log_x : bool
    ticks : array_like, optional
        Values of x that were run.
    band : (float, float, str), optional
        Range of x that is shaded, and what it is.
    height : float, optional, [inches]
    to_scale : bool
        One unit of x is as long as one of y.

    Returns
    -------
    pathlib.Path
    """
    tall = height or (3.7 if len(panels) == 1 else 0.9 + 1.9 * len(panels))
    with drawing(6.7, tall) as figure:
        stack = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        for axes, panel in zip(stack, panels, strict=True):
            _draw_panel(axes, panel)
            if band is not None:
                label = band[2] if axes is stack[0] else None
                axes.axvspan(band[0], band[1], color="#56B4E9", alpha=0.15, lw=0, label=label)
        if to_scale:
            stack[0].set_aspect("equal")
        stack[0].set_title(title, loc="left")
        stack[-1].set_xlabel(x_label)
        if log_x:
            stack[-1].set_xscale("log")
        if ticks is not None:
            values = np.unique(np.asarray(ticks, np.float64))
            stack[-1].set_xticks(values, _tick_labels(values))
            stack[-1].minorticks_off()
        for axes in stack:
            names = axes.get_legend_handles_labels()[1]
            if len(names) > MOST_INSIDE:
                axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
            elif names:
                axes.legend(loc="best" if len(panels) > 1 else "upper left", bbox_to_anchor=None if len(panels) > 1
                            else (1.0, 1.0))  # fmt: skip
        figure.align_ylabels()
        return save(figure, path, caption)


def _tick_labels(values: Floats) -> list[str]:
    """Values as text; long ones with two digits, where these tell them apart.

    Examples
    --------
    >>> _tick_labels(np.array([4.0, 8.0, 12.5])), _tick_labels(np.array([0.001521, 0.003042]))
    (['4', '8', '12.5'], ['0.0015', '0.003'])
    """
    whole, short = [f"{value:g}" for value in values], [f"{value:.2g}" for value in values]
    return short if max(map(len, whole)) > 6 and len(set(short)) == len(values) else whole


def _draw_panel(axes: Axes, panel: Panel) -> None:
    looks: dict[str, dict[str, Any]] = {
        "line": {}, "dashed": {"ls": (0, (4, 2)), "lw": 1.2}, "points": {"ls": "", "marker": "o", "ms": 5},
        "both": {"marker": "o", "ms": 5, "lw": 1.0},
    }  # fmt: skip
    for curve in panel.curves:
        look = looks[curve.look] | {"color": curve.color, "label": curve.label or None}
        if curve.spread is None:
            axes.plot(np.asarray(curve.x), np.asarray(curve.y), **look)
        else:
            axes.errorbar(
                np.asarray(curve.x), np.asarray(curve.y), yerr=curve.spread, capsize=3, elinewidth=1.0, **look
            )
    for value, name in panel.limits:
        axes.axhline(value, color=ACCENT, lw=1.0, ls=":", label=name or None)
    axes.set_ylabel(panel.y_label)
    if panel.log:
        axes.set_yscale("log")


def path_chart(
    path: str | Path, pairs: Sequence[PairPath], diameter: float, axes_names: tuple[str, str], title: str, caption: str
) -> Path:
    """Paths of pairs side by side and to scale, with the spheres at a few times.

    Parameters
    ----------
    path : path
        Of the figure.
    pairs : sequence of PairPath
    diameter : float, [m]
    axes_names : (str, str)
        Of the directions across and up.
    title, caption : str

    Returns
    -------
    pathlib.Path
    """
    from matplotlib.patches import Circle

    points = np.concatenate([np.concatenate([pair.upper, pair.lower]) for pair in pairs])
    factor, unit = length_unit(points)
    low, high = factor * (points.min(axis=0) - 0.8 * diameter), factor * (points.max(axis=0) + 0.8 * diameter)
    high[0] = max(high[0], low[0] + 0.12 * (high[1] - low[1]))
    with drawing(6.7, 5.6) as figure:
        row = figure.subplots(1, len(pairs), sharex=True, sharey=True, squeeze=False)[0]
        for axes, pair in zip(row, pairs, strict=True):
            for centre, color, name in ((pair.upper, PALETTE[0], "upper"), (pair.lower, PALETTE[1], "lower")):
                axes.plot(*(factor * centre.T), color=color, lw=1.0, label=f"{name} sphere at the start")
                for n in pair.at:
                    axes.add_patch(Circle(
                        tuple(factor * centre[n]), 0.5 * factor * diameter, facecolor=color, alpha=0.45, edgecolor=color
                    ))  # fmt: skip
            axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
            label = pair.label if "$" in pair.label else "\n".join(wrap(pair.label, max(8, 60 // len(pairs))))
            axes.set_title(label, fontsize=8.5)
            axes.set_xlabel(f"{axes_names[0]} [{unit}]")
        row[0].set_ylabel(f"{axes_names[1]} [{unit}]")
        figure.suptitle(title, x=0.01, ha="left", fontsize=9.5)
        handles, labels = row[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside right upper")
        return save(figure, path, caption)


def bar_chart(path: str | Path, rows: Sequence[Bars], title: str, caption: str) -> Path:
    """Kisses of each run as bars on a time line, by both definitions.

    Parameters
    ----------
    path : path
        Of the figure.
    rows : sequence of Bars
    title, caption : str

    Returns
    -------
    pathlib.Path
    """
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    markers = ("v", "D", "s")
    names = list(dict.fromkeys(name for row in rows for name in row.marks))
    with drawing(6.7, 1.5 + 0.42 * len(rows)) as figure:
        axes = figure.add_subplot(xlabel="time [s]")
        for n, row in enumerate(rows):
            axes.broken_barh(list(row.gap), (n - 0.36, 0.36), facecolors=PALETTE[5], edgecolors="white", lw=0.5)
            axes.broken_barh(list(row.contact), (n, 0.36), facecolors=PALETTE[0], edgecolors="white", lw=0.5)
            for name, time in row.marks.items():
                axes.plot(time, n, marker=markers[names.index(name) % 3], color=PALETTE[1], ms=6, ls="")
        axes.set_yticks(range(len(rows)), [row.label for row in rows])
        axes.set_ylim(len(rows) - 0.4, -0.6)
        axes.grid(visible=False, axis="y")
        axes.set_title(title, loc="left")
        handles: list[Any] = [
            Patch(color=PALETTE[5], label="gap at most 2 % d"), Patch(color=PALETTE[0], label="mechanical contact"),
            *(
                Line2D([], [], marker=markers[n % 3], color=PALETTE[1], ls="", label=name)
                for n, name in enumerate(names)
            ),
        ]  # fmt: skip
        figure.legend(handles=handles, loc="outside upper right", ncols=len(handles))
        return save(figure, path, caption)


def shrink(path: Path) -> None:
    """Bring a PNG file to 128 colours, a third of its size; any other file stays.

    Parameters
    ----------
    path : Path
    """
    if path.suffix != ".png":
        return
    from PIL import Image

    with Image.open(path) as image:
        small = image.convert("RGB").quantize(128)
    with replacing(path) as temporary:
        small.save(temporary, format="PNG", optimize=True)
