"""Spells: when a quantity that was sampled lay below a level."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["crossing", "merged", "spells_below"]

Floats = NDArray[np.float64]


def crossing(t: Floats, level: Floats, n: int) -> float:
    """Time between rows n and n + 1 where the level is zero.

    Examples
    --------
    >>> crossing(np.array([0.0, 1.0]), np.array([1.0, -3.0]), 0)
    0.25
    """
    return float(t[n] + (t[n + 1] - t[n]) * level[n] / (level[n] - level[n + 1]))


def spells_below(t: Floats, level: Floats, release: float = 0.0) -> list[tuple[float, float]]:
    """Spells that begin where the level is not positive and last until it has risen above ``release``.

    Parameters
    ----------
    t : ndarray, (T,)
        Increasing.
    level : ndarray, (T,)
        Linear between the rows.
    release : float
        Hysteresis, >= 0: an excursion that stays at or below it does not end a spell.

    Returns
    -------
    list of (start, end)
        Where the level crosses zero for the first and the last time; an end of the record where it does not.

    Examples
    --------
    >>> t, level = np.arange(6.0), np.array([1.0, -1.0, 0.5, -1.0, 3.0, 3.0])
    >>> spells_below(t, level)
    [(0.5, 1.6666666666666665), (2.3333333333333335, 3.25)]
    >>> spells_below(t, level, 1.0)
    [(0.5, 3.25)]
    """
    rows = np.arange(t.size)
    low = level <= 0.0
    high = ~(level <= release)   # a level that is not a number is not below
    decided = np.maximum.accumulate(np.where(low | high, rows, -1))   # in between: as before
    inside = np.concatenate([[False], (decided >= 0) & low[decided], [False]])
    starts = np.flatnonzero(inside[1:] & ~inside[:-1])
    ends = np.flatnonzero(inside[:-1] & ~inside[1:])
    last_low = np.maximum.accumulate(np.where(low, rows, -1))[ends - 1]
    return [
        (
            float(t[0]) if start == 0 else crossing(t, level, start - 1),
            float(t[-1]) if last == t.size - 1 else crossing(t, level, last),
        )
        for start, last in zip(starts.tolist(), last_low.tolist(), strict=True)
    ]


def merged(spells: list[tuple[float, float]], shortest: float) -> list[tuple[float, float]]:
    """Join spells between which less than the shortest pause lies.

    Examples
    --------
    >>> merged([(0.0, 1.0), (1.1, 2.0), (3.0, 4.0)], 0.5)
    [(0.0, 2.0), (3.0, 4.0)]
    """
    joined: list[tuple[float, float]] = []
    for start, end in spells:
        if joined and start - joined[-1][1] < shortest:
            joined[-1] = (joined[-1][0], end)
        else:
            joined.append((start, end))
    return joined
