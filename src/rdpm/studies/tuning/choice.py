"""Which time step, and which contact steps: rules on plain tables."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from rdpm.studies.spread import Spread, number

__all__ = ["StepChoice", "Window", "choose_step", "choose_window", "differs"]

Row = Mapping[str, Any]

_ROUND_OFF = 1e-9


@dataclass(frozen=True)
class StepChoice:
    """A time step and why it was taken.

    Attributes
    ----------
    dt_s : float
    change : float or None, [-]
        Of the measure, to the finest step; None where it is the finest itself.
    is_converged : bool
        A finer step was tried, and this one and all finer ones agree with the finest.
    has_room : bool
        It is not above the longest that the overlap leaves room for.
    """

    dt_s: float
    change: float | None
    is_converged: bool
    has_room: bool


def choose_step(rows: Sequence[Row], tolerance: float, room: float = math.inf) -> StepChoice | None:
    """Take the longest time step that is stable, converged, and leaves room for contacts.

    Parameters
    ----------
    rows : sequence of mapping
        ``dt_s``; ``status``, "done" where the run came to its end; ``value`` of the measure, None where it has none.
    tolerance : float, [-]
        Relative change to the finest step that counts as none; > 0.
    room : float, [s]
        Longest step in which contacts of enough steps keep to the overlap limit.

    Returns
    -------
    StepChoice or None
        None where no run has a value.

    Examples
    --------
    >>> rows = [{"dt_s": dt, "status": "done", "value": 1.0 + dt} for dt in (8e-2, 4e-3, 2e-3, 1e-3)]
    >>> choose_step(rows, 0.01).dt_s, choose_step(rows, 0.01, room=3e-3).dt_s
    (0.004, 0.002)
    """
    changes = relative_changes(rows)
    if not changes:
        return None
    steps = sorted(changes, reverse=True)
    last = 0
    while any(changes[dt] > tolerance for dt in steps[last:]):
        last += 1
    agreeing = steps[last:]
    fitting = [dt for dt in agreeing if dt <= room * (1.0 + _ROUND_OFF)]
    dt = fitting[0] if fitting else steps[-1]
    is_finest = dt == steps[-1]
    return StepChoice(dt, None if is_finest else changes[dt], len(agreeing) > 1, bool(fitting))


def relative_changes(rows: Sequence[Row]) -> dict[float, float]:
    """Relative change of the measure to that of the finest step, by step; of the runs that have a value.

    Examples
    --------
    >>> relative_changes([{"dt_s": 2.0, "status": "done", "value": 1.5}, {"dt_s": 1.0, "status": "done", "value": 1.0},
    ...                   {"dt_s": 4.0, "status": "stopped", "value": None}])
    {2.0: 0.5, 1.0: 0.0}
    """
    values = {float(row["dt_s"]): number(row, "value") for row in rows if row["status"] == "done"}
    found = {dt: value for dt, value in values.items() if value is not None}
    if not found:
        return {}
    finest = found[min(found)]
    return {
        dt: 0.0 if value == finest else abs(value - finest) / abs(finest) if finest else math.inf
        for dt, value in found.items()
    }


@dataclass(frozen=True)
class Window:
    """Contact steps that keep to all rules.

    Attributes
    ----------
    members : tuple of float
        Of those that were tried, neighbours all; rising.
    chosen : float
        The one farthest from both ends: nearest to their geometric mean, the stiffer of two.
    reaches_lowest, reaches_highest : bool
        The range may go on beyond what was tried.
    """

    members: tuple[float, ...]
    chosen: float
    reaches_lowest: bool
    reaches_highest: bool

    def __str__(self) -> str:
        return f"{self.members[0]:g} to {self.members[-1]:g}"


def choose_window(
    rows: Sequence[Row], overlap_limit: float, work_tolerance: float, is_other: Callable[[Any, Any], bool]
) -> Window | None:
    """Find the widest range of contact steps in which every one keeps to the rules and the outcome is one.

    Parameters
    ----------
    rows : sequence of mapping
        ``contact_steps``; ``status``, "done" where the run came to its end; ``overlap_fraction``, largest of the run;
        ``work_fraction``, largest work of a contact on its pair over the energy it turned over; ``outcome``, None where
        it did not happen.
    overlap_limit, work_tolerance : float, [-]
    is_other : callable
        Whether two outcomes, of which either may be None, are told apart.

    Returns
    -------
    Window or None
        None where no two neighbours agree. Of two ranges of as many values the stiffer one.

    Examples
    --------
    >>> rows = [{"contact_steps": n, "status": "done", "overlap_fraction": 4e-4 * n, "work_fraction": -1.0,
    ...          "outcome": 2.7 if n < 12 else 2.9} for n in (4, 6, 8, 10, 12, 15)]
    >>> window = choose_window(rows, 0.005, 0.01, lambda a, b: abs(a - b) > 0.1)
    >>> window.members, window.chosen
    ((4, 6, 8, 10), 6)
    """
    table = sorted(rows, key=lambda row: float(row["contact_steps"]))
    best: list[Row] = []
    for first in range(len(table)):
        for end in range(first + 2, len(table) + 1):
            part = table[first:end]
            if len(part) > len(best) and _is_window(part, overlap_limit, work_tolerance, is_other):
                best = part
    if not best:
        return None
    members = tuple(row["contact_steps"] for row in best)
    middle = math.sqrt(members[0] * members[-1])
    chosen = min(members, key=lambda n: (round(abs(math.log(n / middle)), 9), n))
    return Window(members, chosen, best[0] is table[0], best[-1] is table[-1])


def keeps_overlap(row: Row, limit: float) -> bool:
    """Whether a run kept to the overlap limit.

    Examples
    --------
    >>> keeps_overlap({"overlap_fraction": 0.004}, 0.005), keeps_overlap({"overlap_fraction": None}, 0.005)
    (True, False)
    """
    overlap = number(row, "overlap_fraction")
    return overlap is not None and overlap <= limit


def makes_no_work(row: Row, tolerance: float) -> bool:
    """Whether no contact of a run did positive work beyond the tolerance.

    Examples
    --------
    >>> makes_no_work({"work_fraction": -0.7}, 0.01), makes_no_work({"work_fraction": 0.02}, 0.01)
    (True, False)
    """
    work = number(row, "work_fraction")
    return work is not None and work <= tolerance


def _is_window(
    rows: Sequence[Row], overlap_limit: float, work_tolerance: float, is_other: Callable[[Any, Any], bool]
) -> bool:
    keeps = all(
        row["status"] == "done" and keeps_overlap(row, overlap_limit) and makes_no_work(row, work_tolerance)
        for row in rows
    )
    outcomes = [number(row, "outcome") for row in rows]
    return keeps and not any(is_other(a, b) for n, a in enumerate(outcomes) for b in outcomes[:n])


def differs(spread: Spread | None, tolerance: float) -> Callable[[float | None, float | None], bool]:
    """Make the rule by which two outcomes are told apart.

    Parameters
    ----------
    spread : Spread, optional
        What numerics alone give the outcome; two runs differ when they are more than sqrt(2) spreads apart.
    tolerance : float, [-]
        Relative difference that never counts.

    Returns
    -------
    callable
        Of two outcomes; an event that happens in one run only tells the two apart.

    Examples
    --------
    >>> is_other = differs(Spread("tumble_start_s", 2.7, 0.1, 4), 0.01)
    >>> is_other(2.7, 2.83), is_other(2.7, 2.9), is_other(2.7, None), is_other(None, None)
    (False, True, True, False)
    """

    def is_other(a: float | None, b: float | None) -> bool:
        if a is None or b is None:
            return a is not b
        if abs(a - b) <= tolerance * max(abs(a), abs(b)):
            return False
        return spread is None or not math.isfinite(spread.half_width) or abs(spread.excess(a, b)) > 1.0

    return is_other
