"""Charts of the validation: measured points as marks, computed ones as lines."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from rdpm.figures.style import ACCENT, PALETTE, drawing, save

if TYPE_CHECKING:
    from rdpm.studies.validation.result import Chart

__all__ = ["draw"]


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
                axes.plot(curve.x, curve.y, color=next(colours), label=curve.label)
        axes.set(title=chart.title, xlabel=chart.x_label, ylabel=chart.y_label)
        if chart.log_x:
            axes.set_xscale("log")
        if chart.log_y:
            axes.set_yscale("log")
        if len(chart.curves) > 1:
            axes.legend()
        return save(figure, Path(folder) / f"validation_{chart.name}.png", chart.caption)
