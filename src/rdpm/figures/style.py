"""One look for every figure: size, colours, units, and a caption that says what was run."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from rdpm.io.files import replacing
from rdpm.results.summary import Summary

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = [
    "ACCENT", "COLUMN", "FLOW_MAP", "OWN", "PALETTE", "case_text", "column_chart", "column_figure", "drawing",
    "length_unit", "prefixed", "save",
]  # fmt: skip

# Okabe and Ito (2008): colours told apart with any kind of colour vision. First those that a body keeps
# in charts and video alike, where the flow behind it is blue.
PALETTE = ("#D55E00", "#262626", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#0072B2")
ACCENT = "#7a7a7a"
FLOW_MAP = "YlGnBu"

COLUMN = 85.0 / 25.4   # width of a journal's column [in]
OWN = "this design"   # the user's own; last in a legend

_STYLE: Any = {
    "axes.prop_cycle": f"cycler(color={list(PALETTE)})",
    "font.family": "DejaVu Sans",
    "font.size": 9,
    "axes.titlesize": 9.5,
    "axes.labelsize": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#e3e3e3",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "lines.linewidth": 1.6,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "figure.dpi": 130,
    "pdf.fonttype": 42,
}
# Of text in print at the width of a column [pt].
_SMALL: Any = {
    "font.size": 7.5, "axes.labelsize": 8, "axes.titlesize": 7.5, "xtick.labelsize": 7, "ytick.labelsize": 7,
    "legend.fontsize": 7, "lines.linewidth": 1.2, "legend.handlelength": 2.2, "axes.linewidth": 0.6,
    "figure.dpi": 300,
}  # fmt: skip


@contextmanager
def drawing(width: float = 7.0, height: float = 4.2) -> Iterator[Figure]:
    """Give an empty figure of width and height in inches, under the common style.

    Examples
    --------
    >>> with drawing(4, 3) as figure:
    ...     axes = figure.add_subplot()
    >>> len(figure.axes)
    1
    """
    import matplotlib
    from matplotlib.figure import Figure

    # Figures are made without pyplot: no window system, no global list of them.
    with matplotlib.rc_context(_STYLE):
        yield Figure(figsize=(width, height), layout="constrained")


@contextmanager
def column_figure(title: str, height: float = 3.0) -> Iterator[Figure]:
    """Give an empty figure a column wide (85 mm) with its title; ticks are thinned on leaving.

    Examples
    --------
    >>> with column_figure("flow") as figure:
    ...     axes = figure.add_subplot()
    >>> round(figure.get_figwidth() * 25.4)
    85
    """
    import matplotlib
    from matplotlib.figure import Figure

    with matplotlib.rc_context(_STYLE | _SMALL):
        figure = Figure(figsize=(COLUMN, height), layout="constrained")
        figure.suptitle(title, fontsize=8.5)
        yield figure
        is_low = height < 1.4 * len(figure.axes)
        for axes in figure.axes:
            _thin_ticks(axes.xaxis)
            _thin_ticks(axes.yaxis, is_low)


@contextmanager
def column_chart(title: str, height: float = 3.3) -> Iterator[Figure]:
    """Give a figure as `column_figure`; the legend of all its axes is set below on leaving.

    Examples
    --------
    >>> with column_chart("stiffness") as figure:
    ...     axes = figure.add_subplot()
    >>> round(figure.get_figwidth() * 25.4)
    85
    """
    from matplotlib.transforms import ScaledTranslation

    with column_figure(title, height) as figure:
        yield figure
        # one entry a name; the user's own design last
        named = {t: h for axes in figure.axes for h, t in zip(*axes.get_legend_handles_labels(), strict=True)}
        names = sorted(named, key=lambda name: name == OWN)
        if names:
            lowest = figure.axes[-1]
            below = lowest.transAxes + ScaledTranslation(0.0, -32.0 / 72.0, figure.dpi_scale_trans)
            lowest.legend(
                [named[n] for n in names], names, loc="upper center", bbox_to_anchor=(0.5, 0.0), bbox_transform=below,
                borderaxespad=0.0, ncols=_columns(names), columnspacing=1.2,
            )  # fmt: skip


def _columns(names: Sequence[str]) -> int:
    """Give the columns in which a legend fits 85 mm; what stands between dollars is shorter than written.

    Examples
    --------
    >>> _columns(["$N_c$ = 4", "$N_c$ = 8", "critical"]), _columns(["no more: overlap 0.5 % d", "allowed"])
    (3, 2)
    """
    longest = max(len(re.sub(r"[$\\\\{}_^]|delta", "", name)) for name in names)
    most = 1 if longest > 24 else 2 if longest > 13 else 3
    return min(most, len(names))


def _thin_ticks(axis: Any, is_short: bool = False) -> None:
    """Give an axis ticks that are apart: of a logarithmic one decades, or 1, 2 and 5 of each where there is room."""
    from matplotlib.ticker import AutoLocator, FuncFormatter, LogLocator, MaxNLocator, NullFormatter

    if axis.get_scale() == "log":
        low, high = sorted(axis.get_view_interval())
        if np.log10(high / low) < (1.0 if is_short else 2.5):
            axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            axis.set_major_formatter(FuncFormatter(lambda value, _: _tick_text(value)))
        axis.set_minor_formatter(NullFormatter())
    elif type(axis.get_major_locator()) is AutoLocator:
        axis.set_major_locator(MaxNLocator(nbins=4 if is_short else 5, steps=[1, 2, 2.5, 5, 10]))


def _tick_text(value: float) -> str:
    """Say a tick of 1, 2 or 5 times a power of ten.

    Examples
    --------
    >>> _tick_text(0.05), _tick_text(2e-5)
    ('0.05', '$2\\\\cdot10^{-5}$')
    """
    if 1e-3 <= value < 1e5:
        return f"{value:g}"
    digits, power = f"{value:.0e}".split("e")
    return rf"$10^{{{int(power)}}}$" if digits == "1" else rf"${digits}\cdot10^{{{int(power)}}}$"


def save(figure: Figure, path: str | Path, caption: str) -> Path:
    """Write a figure with its caption below, whole or not at all.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
    path : path
        Ends in ``.png``, ``.pdf`` or ``.svg``; its folder is made.
    caption : str
        What was run.

    Returns
    -------
    pathlib.Path
        The file.

    Raises
    ------
    OutputError
        The file cannot be written.
    """
    import matplotlib

    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    together = re.sub(r"(?<=\d) (?=[a-zA-Z])| (?==)|(?<==) |(?<=Pa) ", "\N{NO-BREAK SPACE}", caption)
    is_column = figure.get_figwidth() < 1.01 * COLUMN
    size, letters = (6.5, 18.0) if is_column else (7.5, 16.0)
    lines = textwrap.wrap(together, int(figure.get_figwidth() * letters))
    figure.supxlabel("\n".join(lines), fontsize=size, color="#444444", x=0.01, ha="left")
    undated: Any = {".pdf": {"CreationDate": None}, ".svg": {"Date": None}}.get(path.suffix)   # equal runs, equal files
    with replacing(path) as temporary, matplotlib.rc_context(_STYLE):
        figure.savefig(temporary, format=path.suffix[1:], metadata=undated)
    return path


def length_unit(values: ArrayLike) -> tuple[float, str]:
    """Factor and name of the unit of length in which the largest of `values` [m] reads well.

    Examples
    --------
    >>> length_unit([0.5]), length_unit([0.004])
    ((100.0, 'cm'), (1000.0, 'mm'))
    """
    finite = np.abs(np.asarray(values, np.float64))
    largest = float(np.max(finite[np.isfinite(finite)], initial=0.0))
    if largest >= 1.0:
        return 1.0, "m"
    return (100.0, "cm") if largest >= 0.02 else (1000.0, "mm")


def prefixed(values: ArrayLike, unit: str) -> tuple[float, str]:
    """Factor and prefixed unit in which the largest of `values` reads well.

    Examples
    --------
    >>> prefixed([3e-5], "J"), prefixed([0.0], "J"), prefixed([2.0], "J")
    ((1000000.0, 'µJ'), (1.0, 'J'), (1.0, 'J'))
    """
    finite = np.abs(np.asarray(values, np.float64))
    largest = float(np.max(finite[np.isfinite(finite)], initial=0.0))
    for size, prefix in ((1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n")):
        if largest >= size:
            return round(1.0 / size, 12), prefix + unit
    return 1.0, unit


def case_text(title: str, case: dict[str, Any], summary: Summary, diameter: ArrayLike) -> str:
    """One sentence that says what was run.

    Examples
    --------
    >>> case_text("One sphere", {"fluid": {"density": 962.0, "viscosity": 0.113}}, Summary(dt_s=2e-3), [0.015])
    'One sphere: sphere of 15 mm in 962 kg/m³, 0.113 Pa s; dt = 2 ms'
    """
    parts = []
    d = np.asarray(diameter, np.float64)
    if d.size:
        sizes = f"{1e3 * d.min():.4g}" + ("" if np.ptp(d) < 1e-9 * d.max() else f" to {1e3 * d.max():.4g}")
        parts.append(f"{'sphere' if d.size == 1 else f'{d.size} spheres'} of {sizes} mm")
    densities = {b["density"] for b in case.get("bodies", []) if isinstance(b.get("density"), (int, float))}
    if len(densities) == 1 and parts:
        parts[0] += f", {densities.pop():.6g} kg/m³"
    fluid = case.get("fluid")
    if fluid and isinstance(fluid.get("density"), (int, float)):
        viscosity = ""
        if isinstance(fluid.get("viscosity"), (int, float)):
            viscosity = f", {fluid['viscosity']:.4g} Pa s"
        elif isinstance(fluid.get("kinematic_viscosity"), (int, float)):
            viscosity = f", {fluid['kinematic_viscosity']:.4g} m²/s"
        parts.append(f"in {fluid['density']:.6g} kg/m³{viscosity}")
    numerics = []
    if summary.cells_per_diameter:
        numerics.append(f"{summary.cells_per_diameter:.3g} cells a diameter")
    if summary.dt_s:
        numerics.append(f"dt = {1e3 * summary.dt_s:.4g} ms")
    text = " ".join(parts) + ("; " + ", ".join(numerics) if numerics else "")
    return ": ".join(part for part in (title, text) if part)
