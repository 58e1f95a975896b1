"""What a tuning chose, held against a run of twice the resolution."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from rdpm.config.case import Case
from rdpm.errors import CaseError
from rdpm.results.run import Run
from rdpm.studies.spread import number
from rdpm.studies.tuning.choice import keeps_overlap, makes_no_work
from rdpm.studies.tuning.reading import columns, work_fraction

__all__ = ["COMPARED", "FINER", "Confirmation", "finer", "measured"]

#: Cells a diameter, over those of the tuning.
FINER = 2

#: The run goes on by so much beyond what was needed of the coarse one: on a finer grid things happen a little later.
LONGER = 1.15

#: What is compared, beside the measure and the outcome: column -> factor and unit of the printed table.
COMPARED = {
    "overlap_fraction": (100.0, "% d"), "work_fraction": (1.0, "-"), "max_impact_speed_m_s": (1e3, "mm/s"),
    "contact_total_time_s": (1.0, "s"), "kiss_time_s": (1.0, "s"), "gap_kiss_total_s": (1.0, "s"),
}  # fmt: skip


@dataclass(frozen=True)
class Confirmation:
    """The chosen contact at two resolutions.

    Attributes
    ----------
    cells_per_diameter : (float, float)
        Of the tuning, and of this run.
    dt_s : (float, float)
    status, reason : str
        Of the finer run.
    rows : tuple of dict
        One a compared number: ``quantity, coarse, fine, change``; the change over the coarse one.
    keeps_overlap, makes_no_work, same_event : bool
        Whether the finer run keeps the overlap limit, no contact of it makes energy, and the outcome exists there as it
        does in the coarse one.
    outcome : str
    is_other : bool
        Whether the outcomes are told apart by the rule that compares N_c.
    """

    cells_per_diameter: tuple[float, float]
    dt_s: tuple[float, float]
    status: str
    reason: str
    rows: tuple[dict[str, Any], ...]
    keeps_overlap: bool
    makes_no_work: bool
    same_event: bool
    outcome: str
    is_other: bool

    @property
    def holds(self) -> bool:
        """Whether the choice keeps its rules on the finer grid."""
        return self.status == "done" and self.keeps_overlap and self.makes_no_work and self.same_event

    def sentence(self) -> str:
        """What the finer run says."""
        n = self.cells_per_diameter[1]
        if self.status != "done":
            return f"Not confirmed: the run at {n:g} cells a diameter was not done ({self.reason})."
        broken = [
            text for is_kept, text in (
                (self.keeps_overlap, "the overlap is above its limit"),
                (self.makes_no_work, "a contact makes energy"),
                (self.same_event, f"{self.outcome} is not there in both"),
            ) if not is_kept
        ]  # fmt: skip
        if broken:
            return f"Not confirmed at {n:g} cells a diameter: {', '.join(broken)}."
        change = next((row["change"] for row in self.rows if row["quantity"] == self.outcome), None)
        moved = "" if change is None else f" by {100.0 * abs(change):.2g} %"
        grid = (
            f"The grid moves {self.outcome}{moved}, more than N_c does."
            if self.is_other else f"{self.outcome} differs{moved}, no more than numerics alone."
        )  # fmt: skip
        return (
            f"Confirmed at {n:g} cells a diameter with the same stiffness and damping: the overlap keeps its limit and "
            f"no contact makes energy. {grid}"
        )


def finer(case: Case, contact_steps: float, dt: float, end: float) -> list[dict[str, Any]]:
    """Changes that make the finer run, of which the first that the plan takes is meant.

    Parameters
    ----------
    case : Case
    contact_steps, dt, end : float
        Of the chosen contact.

    Returns
    -------
    list of dict
        With steps of a half and a quarter: a finer grid bears shorter ones. The contact lasts as long in time.

    Raises
    ------
    CaseError
        The case is dry.

    Examples
    --------
    >>> from rdpm.config.load import load_case
    >>> finer(load_case("dkt"), 8.0, 2e-3, 3.0)[0]
    {'resolution.cells_per_diameter': 16.0, 'time.step': 0.001, 'time.end': 3.45, 'contact.contact_steps': 16.0}
    """
    grid = case.resolution
    if grid is None:
        raise CaseError("--confirm", None, "must have a case with a fluid", "a dry one has no grid to refine",
                        "Leave it out.")  # fmt: skip
    if grid.cells_per_diameter is not None:
        same: dict[str, Any] = {"resolution.cells_per_diameter": FINER * grid.cells_per_diameter}
    else:
        same = {"resolution.cells": [FINER * n for n in grid.cells or ()]}
    until = min(case.time.end, float(f"{LONGER * end:.6g}"))
    return [
        same | {"time.step": dt / part, "time.end": until, "contact.contact_steps": contact_steps * part}
        for part in (2, 4)
    ]


def measured(
    coarse: Mapping[str, Any],
    run: Run | None,
    names: tuple[str, str],
    status: tuple[str, str],
    limits: tuple[float, float],
    is_other: Callable[[Any, Any], bool],
    cells: tuple[float, float],
    dt: tuple[float, float],
) -> Confirmation:
    """Compare the chosen row of a tuning with the finer run.

    Parameters
    ----------
    coarse : mapping
        The row.
    run : Run, optional
        None where it was not done.
    names : (str, str)
        Of the measure and the outcome.
    status : (str, str)
        Of the finer run, and the reason.
    limits : (float, float)
        Of the overlap and of the work.
    is_other : callable
        As `rdpm.studies.tuning.choice.differs` makes it.
    cells, dt : (float, float)
        Coarse and fine.
    """
    measure, outcome = names
    fine: dict[str, Any] = {}
    if run is not None:
        values = columns(run)
        fine = dict(values) | {
            "overlap_fraction": values["max_overlap_fraction"],
            "work_fraction": work_fraction(run),
        }
    rows = []
    for name in dict.fromkeys((*COMPARED, measure, outcome)):
        a = number(coarse, "outcome" if name == outcome else name)
        b = number(fine, name)
        change = None if a is None or b is None or a == 0.0 else b / a - 1.0
        rows.append({"quantity": name, "coarse": a, "fine": b, "change": change})
    both = next(row for row in rows if row["quantity"] == outcome)
    return Confirmation(
        cells, dt, *status, tuple(row for row in rows if row["coarse"] is not None or row["fine"] is not None),
        keeps_overlap(fine, limits[0]), makes_no_work(fine, limits[1]),
        (both["coarse"] is None) == (both["fine"] is None), outcome, bool(is_other(both["coarse"], both["fine"])),
    )  # fmt: skip
