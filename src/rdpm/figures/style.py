"""One look for every figure: size, colours, units, and a caption that says what was run."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from rdpm.io.files import replacing
from rdpm.results.summary import Summary

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["ACCENT", "FLOW_MAP", "PALETTE", "case_text", "drawing", "length_unit", "save"]

# Okabe and Ito (2008): colours told apart with any kind of colour vision. First those that a body keeps
# in charts and video alike, where the flow behind it is blue.
PALETTE = ("#D55E00", "#262626", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#0072B2")
ACCENT = "#7a7a7a"
FLOW_MAP = "YlGnBu"

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
}


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
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    together = re.sub(r"(?<=\d) (?=[a-zA-Z])| (?==)|(?<==) |(?<=Pa) ", "\N{NO-BREAK SPACE}", caption)
    lines = textwrap.wrap(together, int(figure.get_figwidth() * 16))
    figure.supxlabel("\n".join(lines), fontsize=7.5, color="#555555", x=0.01, ha="left")
    with replacing(path) as temporary:
        figure.savefig(temporary, format=path.suffix[1:])
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
