"""A claim judged by what a study left: its table, the cases of its runs, and the spread of those that were repeated."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Protocol

from rdpm.results.run_folder import RunFolder
from rdpm.studies.claims.claim import Alike, Approaches, Claim, Computed, Insensitive, Judgement, Limit, Trend
from rdpm.studies.claims.judging import judge, judge_each
from rdpm.studies.spread import Spread, number, spread_of

__all__ = ["case_columns", "judge_study", "parameters_of", "quantities_of", "widest_spreads"]


RESOLUTION = "resolution.cells_per_diameter"
NOT_JUDGED = "not judged"


class _Results(Protocol):
    @property
    def table(self) -> Any:
        """A DataFrame: ``study, run, spread_of, status``, parameters that differ, measures."""

    def run_folder(self, name: str, study: str = "") -> Path:
        """The folder of a run."""


def judge_study(claim: Claim, results: _Results) -> Judgement:
    """Judge a claim by a study.

    Parameters
    ----------
    claim : Claim
    results : StudyResults
        Its ``table`` and ``run_folder`` are used.

    Returns
    -------
    Judgement

    Notes
    -----
    Only runs that are done count. A parameter without a value in a run's row is read from the run's ``case.toml``: the
    study, or this part of it, does not vary it. Repetitions (``spread_of``) give the spread and are not judged
    themselves. Resolutions are not mixed: the verdict is that of the one with most runs, the sentence adds those of the
    others.
    """
    if isinstance(claim.expected, Computed):
        return judge(claim, (), {})
    rows = [row for row in results.table.to_dict("records") if row.get("status", "done") == "done"]
    spreads = widest_spreads(rows, quantities_of(claim))
    own: list[dict[str, Any]] = []
    keys = (*parameters_of(claim), RESOLUTION)
    for row in rows:
        if _text(row.get("spread_of")):
            continue
        files = RunFolder(results.run_folder(str(row["run"]), _text(row.get("study"))))
        case = tomllib.loads(files.case.read_text(encoding="utf-8")) if files.case.is_file() else {}
        own.append(row | case_columns(case, [key for key in keys if _is_missing(row.get(key))]))
    resolutions = [row[RESOLUTION] for row in own if number(row, RESOLUTION) is not None]
    if not resolutions:
        return judge(claim, own, spreads)
    found = judge_each(claim, own, spreads, RESOLUTION)
    most = max(found, key=lambda value: (found[value].verdict != NOT_JUDGED, resolutions.count(value)))
    others = [f"At {n:g}: {one.verdict}." for n, one in found.items() if n != most and one.verdict != NOT_JUDGED]
    text = " ".join([found[most].sentence, *([f"This is at {most:g} cells a diameter."] if others else []), *others])
    return replace(found[most], sentence=text)


def quantities_of(claim: Claim) -> tuple[str, ...]:
    """Measured columns that a claim is about.

    Examples
    --------
    >>> quantities_of(Claim("a", "", "", Trend("kisses", "contact.stiffness", True), ""))
    ('kisses',)
    """
    expected = claim.expected
    if isinstance(expected, Computed):
        return ()
    return expected.quantities if isinstance(expected, Insensitive | Alike | Approaches) else (expected.quantity,)


def parameters_of(claim: Claim) -> tuple[str, ...]:
    """Keys of the case that a claim is about.

    Examples
    --------
    >>> parameters_of(Claim("a", "", "", Trend("kisses", "contact.stiffness", True), "", {"fluid.viscosity": 0.1}))
    ('contact.stiffness', 'fluid.viscosity')
    """
    expected = claim.expected
    along = expected.along if isinstance(expected, Trend | Limit | Insensitive | Approaches) else None
    reference = expected.reference if isinstance(expected, Approaches) else ()
    return (*([along] if along else []), *reference, *claim.where)


def case_columns(case: Mapping[str, Any], keys: Iterable[str]) -> dict[str, Any]:
    """Values of a resolved case by their dotted keys; None where it has none.

    Examples
    --------
    >>> case_columns({"fluid": {"viscosity": 0.113}}, ["fluid.viscosity", "contact.damping"])
    {'fluid.viscosity': 0.113, 'contact.damping': None}
    """
    found = {}
    for key in keys:
        value: Any = case
        for part in key.split("."):
            value = value.get(part) if isinstance(value, Mapping) else None
        found[key] = value
    return found


def widest_spreads(rows: Iterable[Mapping[str, Any]], quantities: Iterable[str]) -> dict[str, Spread]:
    """Spread of each quantity over every run that was repeated, of which the widest is taken.

    Parameters
    ----------
    rows : iterable of mapping
        With ``run`` and ``spread_of``: the name of the run that a row repeats, else empty.
    quantities : iterable of str

    Returns
    -------
    dict of Spread
        Empty where no run was repeated.

    Examples
    --------
    >>> rows = [{"run": "a", "kisses": 1}, {"run": "b", "spread_of": "a", "kisses": 2}]
    >>> round(widest_spreads(rows, ["kisses"])["kisses"].half_width, 2)
    1.41
    """
    listed = list(rows)
    repeated = {(_text(row.get("study")), _text(row.get("spread_of"))) for row in listed if _text(row.get("spread_of"))}
    groups = [
        [
            row for row in listed
            if _text(row.get("study")) == study and name in (row.get("run"), row.get("spread_of"))
        ]
        for study, name in sorted(repeated)
    ]  # fmt: skip
    groups = [group for group in groups if len(group) >= 2]
    if not groups:
        return {}
    return {
        quantity: max((spread_of(group, quantity) for group in groups), key=lambda spread: spread.half_width)
        for quantity in quantities
    }


def _is_missing(value: Any) -> bool:
    return value is None or value != value   # NaN, where other parts of a study vary the key


def _text(value: Any) -> str:
    """A word of the table; empty where it is missing."""
    return value if isinstance(value, str) else ""
