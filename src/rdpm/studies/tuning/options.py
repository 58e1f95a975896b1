"""What a tuning may be told, and what it takes by itself."""

from __future__ import annotations

import math
from dataclasses import dataclass

from rdpm.config.case import Case
from rdpm.config.rule import suggestion
from rdpm.errors import CaseError
from rdpm.setup import plan
from rdpm.studies.measures import QUANTITIES

__all__ = ["CONTACT_STEPS", "QUICK_CONTACT_STEPS", "ROOM_STEPS", "SHIFTS", "TuneOptions", "step_candidates"]

#: Contact steps that are tried.
CONTACT_STEPS = (4.0, 6.0, 8.0, 10.0, 12.0, 15.0, 20.0)
QUICK_CONTACT_STEPS = (6.0, 10.0, 15.0)

#: Contact steps for which a time step must leave room below the overlap limit.
ROOM_STEPS = 8.0

#: Places in a cell from which one run is repeated [cells].
SHIFTS = [[0.25, 0.25, 0.25], [0.5, 0.5, 0.5], [0.75, 0.75, 0.75]]

_MANTISSAS = (8.0, 4.0, 2.0, 1.0)


@dataclass(frozen=True)
class TuneOptions:
    """How to tune.

    Attributes
    ----------
    measure, outcome : str
        Columns of `rdpm.studies.measures.QUANTITIES`, by which the time step and the contact steps are judged; "" for
        what fits the kind of the case.
    tolerance : float, [-]
        Relative change of `measure` to the finest step that counts as none; 0 < to 0.5.
    outcome_tolerance : float, optional, [-]
        Relative difference of `outcome` that counts as none. Left out, one run is repeated with other numerics, and
        what is within that spread or within `tolerance` counts as none.
    work_tolerance : float, [-]
        Work of a contact on its pair, over the energy it turned over, that counts as round-off.
    contact_steps : tuple of float
        At least two, 4 to 1000.
    time_steps : tuple of float, [s]
        To try; one alone is taken. Chosen by the flow's limit when empty.
    quick : bool
        Four cells a diameter, fewer values, no repetition.

    Raises
    ------
    CaseError

    Examples
    --------
    >>> TuneOptions(contact_steps=(12, 8)).contact_steps
    (8, 12)
    """

    measure: str = ""
    outcome: str = ""
    tolerance: float = 0.01
    outcome_tolerance: float | None = None
    work_tolerance: float = 0.01
    contact_steps: tuple[float, ...] = ()
    time_steps: tuple[float, ...] = ()
    quick: bool = False

    def __post_init__(self) -> None:
        for option, name in (("--measure", self.measure), ("--outcome", self.outcome)):
            if name and name not in QUANTITIES:
                raise CaseError(option, f'"{name[:60]}"', "must be a measure", cure=suggestion(name[:60], QUANTITIES))
        tolerances = (("--tolerance", self.tolerance), ("--outcome-tolerance", self.outcome_tolerance))
        for option, value in tolerances:
            if value is not None and not 0.0 < value <= 0.5:
                raise CaseError(option, f"{value:g}", "must be above 0 and at most 0.5", "it is a relative change",
                                'For one percent write 0.01, or "1 %".')  # fmt: skip
        steps = self.contact_steps or (QUICK_CONTACT_STEPS if self.quick else CONTACT_STEPS)
        for value in steps:
            if not 4.0 <= value <= 1000.0:
                raise CaseError("--contact-steps", f"{value:g}", "must lie between 4 and 1000",
                                "below, the fluid sees the rebound as a jump")  # fmt: skip
        if len(set(steps)) < 2:
            raise CaseError("--contact-steps", f"{steps[0]:g}", "must be at least two different values",
                            "a range has two ends", "Write for example --contact-steps 4,8,12.")  # fmt: skip
        for value in self.time_steps:
            if not (value > 0.0 and math.isfinite(value)):
                raise CaseError("--time-steps", f"{value:g} s", "must be above 0")
        object.__setattr__(self, "contact_steps", tuple(sorted(set(steps))))
        object.__setattr__(self, "time_steps", tuple(sorted(set(self.time_steps), reverse=True)))

    @property
    def of_outcome(self) -> float:
        """Relative difference of two outcomes that counts as none."""
        return self.tolerance if self.outcome_tolerance is None else self.outcome_tolerance


def step_candidates(case: Case, is_quick: bool = False) -> list[float]:
    """Time steps to try, from the longest that the flow can be thought to bear, each half of the one before.

    Parameters
    ----------
    case : Case
    is_quick : bool
        Four of them instead of five.

    Returns
    -------
    list of float, [s]
        The first lies below the step in which the flow crosses one cell (the case's own step doubled, in a dry one).

    Examples
    --------
    >>> from rdpm.config.load import load_case
    >>> step_candidates(load_case("dkt"))
    [0.01, 0.005, 0.0025, 0.00125, 0.000625]
    """
    if case.fluid is None:
        hardest = 2.0 * plan(case).step.dt
    else:
        automatic = case.model_copy(update={"time": case.time.model_copy(update={"step": "auto"})})
        hardest = plan(automatic).step.limits["advective"] / case.time.cfl
    longest = _rounded_down(min(hardest, case.time.end / 10.0))
    return [float(f"{longest / 2**n:.12g}") for n in range(4 if is_quick else 5)]


def _rounded_down(value: float) -> float:
    """The largest number of one digit 1, 2, 4 or 8 that is not above a value.

    Examples
    --------
    >>> _rounded_down(0.0131), _rounded_down(3.9)
    (0.01, 2.0)
    """
    power = 10.0 ** math.floor(math.log10(value) + 1e-12)
    return next(m for m in _MANTISSAS if m * power <= value * (1.0 + 1e-9)) * power
