"""Published points that come with the package."""

from __future__ import annotations

import csv
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray

__all__ = ["crossing", "points"]

Floats = NDArray[np.float64]


def points(table: str, x: str, y: str, **where: str) -> tuple[Floats, Floats]:
    """Two columns of a table of published points.

    Parameters
    ----------
    table : str
        Name of the file without its ending; its first lines say where the points come from.
    x, y : str
        Columns.
    **where : str
        Only rows with these entries.

    Examples
    --------
    >>> gap, resistance = points("approach_stokes", "gap_over_a", "resistance", pair="wall")
    >>> float(resistance[gap == 0.1][0])
    11.4592
    """
    text = files("rdpm.studies.validation").joinpath("data", f"{table}.csv").read_text("utf-8")
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    rows = [row for row in csv.DictReader(lines) if all(row[key] == value for key, value in where.items())]
    return np.array([float(row[x]) for row in rows]), np.array([float(row[y]) for row in rows])


def crossing(x: Floats, y: Floats, level: float) -> float:
    """Where y first crosses a level, linear between points; nan where it does not.

    Examples
    --------
    >>> crossing(np.array([0.0, 1.0, 2.0]), np.array([3.0, 1.0, 0.0]), 2.0)
    0.5
    """
    sign = np.sign(y - level)
    at = np.flatnonzero(sign[1:] != sign[:-1])
    if not at.size:
        return float("nan")
    n = int(at[0])
    return float(x[n] + (level - y[n]) / (y[n + 1] - y[n]) * (x[n + 1] - x[n]))
