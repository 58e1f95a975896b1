"""Judging claims by a study's table and the spread of its quantities: rules, no eye."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from numbers import Real
from typing import Any, NamedTuple

from rdpm.studies.claims.alike import judge_alike, judge_approach
from rdpm.studies.claims.claim import (
    Alike,
    Approaches,
    Claim,
    Computed,
    Happens,
    Insensitive,
    Judgement,
    Limit,
    Trend,
    Verdict,
)
from rdpm.studies.measures import QUANTITIES
from rdpm.studies.spread import Spread, number

__all__ = ["judge", "judge_each"]

Rows = Sequence[Mapping[str, Any]]
Spreads = Mapping[str, Spread]


class _Point(NamedTuple):
    """Runs of one value of the parameter, averaged."""

    at: float
    value: float


def judge(claim: Claim, rows: Rows, spreads: Spreads) -> Judgement:
    """Judge a claim.

    Parameters
    ----------
    claim : Claim
    rows : sequence of mapping
        A study's table, one row a run: ``run`` (its name), parameters by the keys of the case in SI
        (``contact.stiffness``), and measures. Rows that lack a column of ``claim.where``, or hold another value, are
        passed over; runs of equal parameter are averaged.
    spreads : mapping of str to Spread
        By quantity; see `rdpm.studies.spread.spreads_of`.

    Returns
    -------
    Judgement

    Notes
    -----
    Two runs differ when they differ by more than sqrt(2) spreads. A trend is *confirmed* when some pair of runs differs
    in its direction and none against it, *contradicted* when it is the other way round, *within the spread* when no
    pair differs, *conditional* when both occur: the sentence then gives the range in which it holds. A limit is
    *confirmed* when each run keeps to it by more than a spread, *contradicted* when each that is off it breaks it,
    *conditional* when some keep to it and some break it, *within the spread* when none breaks it and some are too close
    to tell. Insensitivity is *confirmed* when no pair differs, in any of the quantities; runs are alike in the same
    way. For runs that come to a reference see `rdpm.studies.claims.alike.judge_approach`. What would be confirmed is
    *conditional* when the claim names a condition.

    Examples
    --------
    >>> claim = Claim("softer", "Softer springs overlap more.", "", Trend("max_overlap_fraction", "k", False), "")
    >>> rows = [{"run": "a", "k": 1.0, "max_overlap_fraction": 0.04}, {"run": "b", "k": 50.0,
    ...     "max_overlap_fraction": 0.002}]
    >>> spread = Spread("max_overlap_fraction", 0.002, 0.1, 4, "log")
    >>> judge(claim, rows, {"max_overlap_fraction": spread}).verdict
    'confirmed'
    """
    expected = claim.expected
    if isinstance(expected, Computed):
        return _finished(claim, expected.judgement())
    chosen = [row for row in rows if _matches(row, claim.where)]
    if isinstance(expected, Trend):
        found = _trend(expected, chosen, spreads)
    elif isinstance(expected, Limit):
        found = _limit(expected, chosen, spreads)
    elif isinstance(expected, Insensitive):
        found = _insensitive(expected, chosen, spreads)
    elif isinstance(expected, Alike):
        found = judge_alike(expected, chosen, spreads)
    elif isinstance(expected, Approaches):
        found = judge_approach(expected, chosen, spreads)
    else:
        found = _happens(expected, chosen, spreads)
    return _finished(claim, found)


def judge_each(claim: Claim, rows: Rows, spreads: Spreads, by: str) -> dict[Any, Judgement]:
    """Judge a claim for each value of a column by itself, such as two resolutions.

    Examples
    --------
    >>> claim = Claim("tumbles", "The pair tumbles.", "", Happens("tumble_start_s"), "")
    >>> rows = [{"run": "a", "cells": 8, "tumble_start_s": 2.7}, {"run": "b", "cells": 12, "tumble_start_s": None}]
    >>> {key: found.verdict for key, found in judge_each(claim, rows, {}, "cells").items()}
    {8: 'confirmed', 12: 'contradicted'}
    """
    values = sorted({row[by] for row in rows if row.get(by) is not None})
    return {value: judge(claim, [row for row in rows if row.get(by) == value], spreads) for value in values}


def _finished(claim: Claim, found: Judgement) -> Judgement:
    verdict, sentence = found.verdict, found.sentence
    if verdict == "confirmed" and claim.condition:
        verdict, sentence = "conditional", f"{sentence} It holds {claim.condition}."
    return replace(found, verdict=verdict, sentence=sentence, reason=found.reason or claim.reason)


def _matches(row: Mapping[str, Any], where: Mapping[str, Any]) -> bool:
    for name, wanted in where.items():
        value = row.get(name)
        if isinstance(wanted, float) and isinstance(value, Real):
            if not math.isclose(float(value), wanted, rel_tol=1e-9):
                return False
        elif value != wanted:
            return False
    return True


def _runs(rows: Rows) -> tuple[str, ...]:
    return tuple(str(row["run"]) for row in rows if "run" in row)


def _not_judged(text: str, rows: Rows) -> Judgement:
    return Judgement("not judged", text, runs=_runs(rows))


def _points(rows: Rows, along: str, quantity: str) -> list[_Point]:
    groups: dict[float, list[float]] = {}
    for row in rows:
        at, value = number(row, along), number(row, quantity)
        if at is not None and value is not None:
            groups.setdefault(at, []).append(value)
    return [_Point(at, sum(values) / len(values)) for at, values in sorted(groups.items())]


def _text(quantity: str, value: float) -> str:
    unit = QUANTITIES[quantity].unit if quantity in QUANTITIES else "-"
    return f"{value:.3g}" if unit == "-" else f"{value:.3g} {unit}"


def _series(quantity: str, along: str, points: Sequence[_Point]) -> str:
    values = ", ".join(_text(quantity, point.value) for point in points)
    return f"{quantity} is {values} at {along} = {', '.join(f'{point.at:g}' for point in points)}"


def _numbers(quantity: str, along: str, points: Sequence[_Point]) -> dict[str, float]:
    return {f"{quantity}@{along}={point.at:g}": point.value for point in points}


def _trend(expected: Trend, rows: Rows, spreads: Spreads) -> Judgement:
    quantity, along = expected.quantity, expected.along
    points, spread = _points(rows, along, quantity), spreads.get(quantity)
    if len(points) < 2:
        return _not_judged(f"{len(points)} runs have both {along} and {quantity}; two are needed.", rows)
    if spread is None:
        return _not_judged(f"The spread of {quantity} is not known.", rows)
    sign = 1.0 if expected.rises else -1.0

    def changes(part: Sequence[_Point]) -> list[float]:
        return [sign * spread.excess(one.value, other.value) for one, other in combinations(part, 2)]

    seen = changes(points)
    along_it, against = max(seen) > 1.0, min(seen) < -1.0
    verdict: Verdict = "within the spread"
    text = f"{_series(quantity, along, points)}; the spread is {spread.describe()}."
    absent = sum(number(row, quantity) is None for row in rows if number(row, along) is not None)
    if absent:
        text += f" {absent} runs have none."
    if along_it and against:
        parts = [points[a:b] for a, b in combinations(range(len(points) + 1), 2) if b - a >= 2]
        holds = [part for part in parts if min(changes(part)) >= -1.0]
        best = max(holds, key=lambda part: max(changes(part)), default=None)
        verdict = "conditional" if best is not None and max(changes(best)) > 1.0 else "contradicted"
        if verdict == "conditional" and best is not None:
            text += f" It holds from {best[0].at:g} to {best[-1].at:g} only."
    elif along_it or against:
        verdict = "confirmed" if along_it else "contradicted"
    return Judgement(verdict, text, runs=_runs(rows), numbers=_numbers(quantity, along, points))


def _limit(expected: Limit, rows: Rows, spreads: Spreads) -> Judgement:
    quantity, along, spread = expected.quantity, expected.along, spreads.get(expected.quantity)
    inside = [
        row for row in rows
        if along is None or ((at := number(row, along)) is not None and expected.low < at < expected.high)
    ]  # fmt: skip
    known = [(row, value) for row in inside if (value := number(row, quantity)) is not None]
    if not known:
        return _not_judged(f"No run has {quantity}.", inside)
    if spread is None:
        return _not_judged(f"The spread of {quantity} is not known.", inside)
    sign = 1.0 if expected.at_most else -1.0
    margins = [-sign * spread.beyond(expected.value, value) for _, value in known]
    keeps, breaks = [m > 1.0 for m in margins], [m < -1.0 for m in margins]
    verdict: Verdict = "within the spread"
    if any(breaks):
        verdict = "conditional" if any(keeps) else "contradicted"
    elif all(keeps):
        verdict = "confirmed"
    name = along or "run"
    values = ", ".join(f"{_text(quantity, value)} ({name} {_label(row.get(name))})" for row, value in known)
    bound = f"{'at most' if expected.at_most else 'at least'} {_text(quantity, expected.value)}"
    text = f"{quantity} must be {bound}: it is {values}; the spread is {spread.describe()}."
    if len(known) < len(inside):
        text += f" {len(inside) - len(known)} runs have none."
    numbers = {f"{quantity}@{name}={_label(row.get(name))}": value for row, value in known}
    return Judgement(verdict, text, runs=_runs(inside), numbers=numbers)


def _label(value: Any) -> str:
    return f"{float(value):.4g}" if isinstance(value, Real) else str(value)


def _insensitive(expected: Insensitive, rows: Rows, spreads: Spreads) -> Judgement:
    along = expected.along
    inside = [row for row in rows if (at := number(row, along)) is not None and expected.low <= at <= expected.high]
    texts: list[str] = []
    verdicts: list[Verdict] = []
    numbers: dict[str, float] = {}
    for quantity in expected.quantities:
        points, spread = _points(inside, along, quantity), spreads.get(quantity)
        if not points or spread is None:
            texts.append(f"{quantity} is not known" if not points else f"the spread of {quantity} is not known")
            continue
        numbers |= _numbers(quantity, along, points)
        absent = sum(number(row, quantity) is None for row in inside)
        changes = [abs(spread.excess(one.value, other.value)) for one, other in combinations(points, 2)]
        series = f"{_series(quantity, along, points)} (spread {spread.describe()})"
        if math.isinf(spread.half_width):
            verdicts.append("within the spread")
        elif absent or max(changes, default=0.0) > 1.0:
            verdicts.append("contradicted")
            series = f"it changes: {series}" + (f", none in {absent} runs" if absent else "")
        elif changes:
            verdicts.append("confirmed")
        else:
            texts.append(f"{quantity} is known at one value of {along}")
            continue
        texts.append(series)
    text = "; ".join(texts) + "."
    if not verdicts:
        return _not_judged(text, inside)
    if len(set(verdicts)) == 1:
        verdict = verdicts[0]
    else:
        verdict = "conditional" if "confirmed" in verdicts and "contradicted" in verdicts else _weaker(verdicts)
    return Judgement(verdict, text, runs=_runs(inside), numbers=numbers)


def _weaker(verdicts: Sequence[Verdict]) -> Verdict:
    """Of quantities of which numerics decide some: what the others say if it is a change, else no verdict on change."""
    return "contradicted" if "contradicted" in verdicts else "within the spread"


def _happens(expected: Happens, rows: Rows, spreads: Spreads) -> Judgement:
    quantity, spread = expected.quantity, spreads.get(expected.quantity)
    if not rows:
        return _not_judged("There is no such run.", rows)
    found = [value for row in rows if (value := number(row, quantity)) is not None]
    values = f": {', '.join(_text(quantity, value) for value in found)}" if found else ""
    text = f"{quantity} exists in {len(found)} of {len(rows)} runs{values}."
    verdict: Verdict = "contradicted" if not found else "confirmed" if len(found) == len(rows) else "conditional"
    if spread is not None and math.isinf(spread.half_width):
        verdict, text = "within the spread", f"{text} Numerics alone decide whether it happens."
    return Judgement(verdict, text, runs=_runs(rows), numbers={f"runs_with_{quantity}": float(len(found))})
