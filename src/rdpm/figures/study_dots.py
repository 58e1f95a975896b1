"""Runs told apart by name: one row a run, one panel a measure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rdpm.figures.style import PALETTE, drawing, save

__all__ = ["Column", "dot_chart"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Column:
    """A measure of each run, in two ways.

    Attributes
    ----------
    label : str
        With its unit.
    first, second : ndarray, (n,)
        nan where a run has none.
    spread : float
        Half width of a band about the first value that is there; 0 draws none.
    """

    label: str
    first: Floats
    second: Floats
    spread: float = 0.0


def dot_chart(
    path: str | Path, names: Sequence[str], columns: Sequence[Column], ways: tuple[str, str], title: str, caption: str
) -> Path:
    """Draw a row for each name and a panel for each column.

    Parameters
    ----------
    path : path
        Of the figure.
    names : sequence of str, (n,)
    columns : sequence of Column
    ways : (str, str)
        What `Column.first` and `Column.second` are.
    title, caption : str

    Returns
    -------
    pathlib.Path
    """
    rows = np.arange(len(names))
    with drawing(1.9 + 1.35 * len(columns), 1.6 + 0.32 * len(names)) as figure:
        panels = figure.subplots(1, len(columns), sharey=True, squeeze=False)[0]
        for axes, column in zip(panels, columns, strict=True):
            known = column.first[np.isfinite(column.first)]
            if column.spread > 0.0 and known.size:
                axes.axvspan(known[0] - column.spread, known[0] + column.spread, color=PALETTE[5], alpha=0.18, lw=0)
            looks = ((column.first, -0.12, PALETTE[0], "o"), (column.second, 0.12, PALETTE[1], "D"))
            for values, shift, color, marker in looks:
                axes.plot(values, rows + shift, ls="", marker=marker, ms=5, color=color)
            axes.set_xlabel(column.label, fontsize=8)
            axes.locator_params(axis="x", nbins=3)
            axes.tick_params(labelsize=7.5)
            axes.margins(x=0.15)
        panels[0].set_yticks(rows, list(names))
        panels[0].set_ylim(len(names) - 0.5, -0.5)
        figure.suptitle(title, x=0.01, ha="left", fontsize=9.5)
        from matplotlib.lines import Line2D

        handles = [
            Line2D([], [], ls="", marker=marker, color=color, label=way)
            for way, color, marker in zip(ways, PALETTE[:2], "oD", strict=True)
        ]
        figure.legend(handles=handles, loc="outside upper right", ncols=2)
        return save(figure, path, caption)
