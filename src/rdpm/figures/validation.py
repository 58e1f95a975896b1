"""Charts of the validation: measured points as rings, computed ones as lines."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rdpm.figures.style import ACCENT, PALETTE, drawing, save

__all__ = ["Chart", "Curve", "draw"]

Floats = NDArray[np.float64]

#: Of so many points or fewer each is marked on its line.
FEW_POINTS = 12


@dataclass(frozen=True)
class Curve:
    """Points of a chart: a line, or marks where they were measured."""

    label: str
    x: Floats
    y: Floats
    is_measured: bool = False


@dataclass(frozen=True)
class Chart:
    """Curves to be drawn together.

    Parameters
    ----------
    name : str
        Of the file.
    title, x_label, y_label, caption : str
        Labels with units; the caption says what was run.
    log_x, log_y : bool
    """

    name: str
    title: str
    x_label: str
    y_label: str
    caption: str
    curves: list[Curve] = field(default_factory=list)
    log_x: bool = False
    log_y: bool = False


def draw(chart: Chart, folder: str | Path) -> Path:
    """Draw one chart as ``validation_NAME.png``.

    Parameters
    ----------
    chart : Chart
        Curves with labels.
    folder : path
        Made when missing.

    Returns
    -------
    pathlib.Path
        The file.

    Raises
    ------
    OutputError
        The file cannot be written.
    """
    with drawing(5.6, 3.6) as figure:
        axes = figure.add_subplot()
        colours = iter(PALETTE * 2)
        for curve in chart.curves:
            if curve.is_measured:
                axes.plot(curve.x, curve.y, "o", markersize=3.5, color=ACCENT, label=curve.label, fillstyle="none")
            else:
                marker = "." if len(curve.x) <= FEW_POINTS else ""  # where the line was computed
                axes.plot(curve.x, curve.y, marker=marker, color=next(colours), label=curve.label)
        axes.set(title=chart.title, xlabel=chart.x_label, ylabel=chart.y_label)
        if chart.log_x:
            axes.set_xscale("log")
        if chart.log_y:
            axes.set_yscale("log")
        if len(chart.curves) > 1:
            axes.legend()
        return save(figure, Path(folder) / f"validation_{chart.name}.png", chart.caption)
