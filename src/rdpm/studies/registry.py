"""What a study can measure, draw and claim, by the names that a study file uses.

A measure is a function of one run, from time zero on. It returns columns of the study's table: a flat dict from names
with units (``kiss_time_s``) to numbers, words or None, always with the same names. A drawing gets the whole study and
writes files into a folder. A claim judges the whole study. To add one, write the function and name it here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from rdpm.studies.run_measures import contact_totals, dkt_phases, end_state, extremes, rebound

if TYPE_CHECKING:
    from rdpm.results.run import Run
    from rdpm.studies.results import StudyResults

__all__ = ["CLAIMS", "DRAWINGS", "MEASURES", "Drawing", "Judgement", "Measure"]

#: One run -> columns of its row.
Measure = Callable[["Run"], Mapping[str, Any]]


@dataclass(frozen=True)
class Drawing:
    """A figure or video of a study.

    Parameters
    ----------
    draw : callable
        Gets the `StudyResults` and the folder to write to; returns the files it wrote.
    needs_fields : bool
        Whether the runs must keep their fields (``output.fields_every`` of the base case); otherwise they write none.
    """

    draw: Callable[[StudyResults, Path], list[Path]]
    needs_fields: bool = False


@dataclass(frozen=True)
class Judgement:
    """What became of a claim.

    Parameters
    ----------
    verdict : str
        "confirmed", "contradicted", "within the spread" or "conditional".
    reason : str
        A sentence with numbers.
    runs : tuple of str
        The runs that show it.
    numbers : mapping of str to float
        By names with units.
    """

    verdict: Literal["confirmed", "contradicted", "within the spread", "conditional"]
    reason: str
    runs: tuple[str, ...] = ()
    numbers: Mapping[str, float] = field(default_factory=dict)


MEASURES: dict[str, Measure] = {
    "contacts": contact_totals,
    "dkt": dkt_phases,
    "end": end_state,
    "extremes": extremes,
    "rebound": rebound,
}

DRAWINGS: dict[str, Drawing] = {}

#: Name -> function of the `StudyResults` and of the claim's options.
CLAIMS: dict[str, Callable[..., Judgement]] = {}
