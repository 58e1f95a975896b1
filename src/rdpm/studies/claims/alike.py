"""Claims that hold runs against each other: all alike, or one family that comes to another run."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Any

from rdpm.studies.claims.claim import Alike, Approaches, Judgement, Verdict
from rdpm.studies.spread import Spread, number

__all__ = ["judge_alike", "judge_approach"]

Row = Mapping[str, Any]
Spreads = Mapping[str, Spread]


def judge_alike(expected: Alike, rows: Sequence[Row], spreads: Spreads) -> Judgement:
    """Judge whether no two runs differ: by more than the spread, or in whether an event happens.

    Examples
    --------
    >>> rows = [{"run": "soft", "tumble_start_s": 2.7}, {"run": "hard", "tumble_start_s": 2.71}]
    >>> spread = Spread("tumble_start_s", 2.7, 0.1, 4)
    >>> judge_alike(Alike(("tumble_start_s",)), rows, {"tumble_start_s": spread}).verdict
    'confirmed'
    """
    names = tuple(str(row["run"]) for row in rows)
    texts: list[str] = []
    verdicts: list[Verdict] = []
    numbers: dict[str, float] = {}
    for quantity in expected.quantities:
        spread = spreads.get(quantity)
        known = [(str(row["run"]), value) for row in rows if (value := number(row, quantity)) is not None]
        if len(rows) < 2 or not known or spread is None:
            texts.append(f"{quantity} is not known" if not known else f"the spread of {quantity} is not known")
            continue
        numbers |= {f"{quantity}@{run}": value for run, value in known}
        values = ", ".join(f"{value:.3g} ({run})" for run, value in known)
        absent = [name for name in names if name not in dict(known)]
        if absent:
            values += f"; none in {', '.join(absent)}"
        texts.append(f"{quantity} is {values}; the spread is {spread.describe()}")
        apart = max((abs(spread.excess(a, b)) for (_, a), (_, b) in combinations(known, 2)), default=0.0)
        verdicts.append(
            "within the spread" if math.isinf(spread.half_width)
            else "contradicted" if absent or apart > 1.0 else "confirmed"
        )  # fmt: skip
    return Judgement(_together(verdicts), f"{'. '.join(texts)}.", runs=names, numbers=numbers)


def judge_approach(expected: Approaches, rows: Sequence[Row], spreads: Spreads) -> Judgement:
    """Judge whether runs come to a reference run as a parameter falls.

    Notes
    -----
    *Confirmed* when the run of the smallest parameter does not differ from the reference and some other does, *within
    the spread* when none does, *contradicted* when the smallest differs by no less than the largest, *conditional* when
    it differs by less.

    Examples
    --------
    >>> rows = [{"run": "hard", "model": "hard", "e": 0.8}, {"run": "4", "steps": 4, "e": 0.79},
    ...         {"run": "32", "steps": 32, "e": 0.6}]
    >>> expected = Approaches(("e",), "steps", {"model": "hard"})
    >>> judge_approach(expected, rows, {"e": Spread("e", 0.8, 0.05, 4)}).verdict
    'confirmed'
    """
    texts: list[str] = []
    verdicts: list[Verdict] = []
    numbers: dict[str, float] = {}
    used: list[Row] = []
    reference = [row for row in rows if all(row.get(key) == value for key, value in expected.reference.items())]
    swept = sorted(
        (row for row in rows if row not in reference and number(row, expected.along) is not None),
        key=lambda row: float(row[expected.along]),
    )
    for quantity in expected.quantities:
        spread = spreads.get(quantity)
        goal = next((value for row in reference if (value := number(row, quantity)) is not None), None)
        points = [(float(row[expected.along]), value) for row in swept if (value := number(row, quantity)) is not None]
        if goal is None or spread is None or len(points) < 2:
            texts.append(f"{quantity} is not known" if spread else f"the spread of {quantity} is not known")
            continue
        numbers |= {f"{quantity}@{expected.along}={at:g}": value for at, value in points} | {quantity: goal}
        used = [*reference, *swept]
        series = ", ".join(f"{value:.3g}" for _, value in points)
        at = ", ".join(f"{at:g}" for at, _ in points)
        texts.append(
            f"{quantity} is {series} at {expected.along} = {at}, and {goal:.3g} in {reference[0]['run']}; the spread "
            f"is {spread.describe()}"
        )
        verdicts.append(_approach([abs(spread.excess(goal, value)) for _, value in points], spread))
    return Judgement(
        _together(verdicts), f"{'. '.join(texts)}.", runs=tuple(str(row["run"]) for row in used), numbers=numbers
    )


def _approach(apart: list[float], spread: Spread) -> Verdict:
    """By the distances to the reference, from the smallest parameter to the largest."""
    if math.isinf(spread.half_width) or max(apart) <= 1.0:
        return "within the spread"
    if apart[0] <= 1.0:
        return "confirmed"
    return "conditional" if apart[0] < apart[-1] else "contradicted"


def _together(verdicts: Sequence[Verdict]) -> Verdict:
    """One verdict of several quantities: what all say; of what decides, a mixture is conditional."""
    if not verdicts:
        return "not judged"
    decided = {verdict for verdict in verdicts if verdict != "within the spread"}
    if not decided:
        return "within the spread"
    return decided.pop() if len(decided) == 1 else "conditional"
