"""What a design is: numbers, verdicts and advice, in SI units under the names of the JSON output."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Any, Literal, TypeAlias

from rdpm.design._checks import Ending
from rdpm.design.report import render
from rdpm.design.wording import said

__all__ = ["Advice", "Body", "Design", "Prediction", "Severity", "Tangential", "Verdict"]

Severity: TypeAlias = Literal["ok", "note", "fail"]
"""A limit is kept; something to know, which breaks none; a limit is broken."""


def _plain(value: Any) -> Any:
    """Give what JSON can hold: nan and infinity become null."""
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, tuple):
        return [_plain(v) for v in value]
    return value.to_dict() if isinstance(value, _Record) else value


class _Record:
    """A frozen dataclass that can be written as JSON."""

    def to_dict(self) -> dict[str, Any]:
        """Give a dict of plain types, null where undefined."""
        return {f.name: _plain(getattr(self, f.name)) for f in fields(self)}  # type: ignore[arg-type]


@dataclass(frozen=True)
class Verdict(_Record):
    """One limit: what was found, the bound, and why it matters.

    Examples
    --------
    >>> print(Verdict("contact_steps", 3.0, 4.0, False, "", "", "fail", "contact resolved by 3 steps < 4"))
    FAIL contact resolved by 3 steps < 4
    """

    name: str
    value: float | None
    limit: float
    ok: bool
    """No limit is broken: true for a note."""
    reason: str
    source: str
    severity: Severity
    text: str
    """Quantity, value, sign, limit and condition, without the severity; ``str`` gives both."""

    def __str__(self) -> str:
        return said(self.severity, self.text)


@dataclass(frozen=True)
class Body(_Record):
    """A sphere of the contact."""

    diameter_m: float
    density_kg_m3: float


@dataclass(frozen=True)
class Prediction(_Record):
    """Restitution one integrator produces without sub-steps, over the phase of the first step."""

    integrator: str
    mean: float
    least: float
    greatest: float


@dataclass(frozen=True)
class Tangential(_Record):
    """The tangential spring that goes with the normal one."""

    ratio: float
    stiffness_N_m: float  # noqa: N815
    damping_N_s_m: float  # noqa: N815
    restitution: float | None
    """Of an impact that sticks to its end [-]."""
    friction: float | None
    sliding_ratio: float | None
    """Tangential over normal approach speed from which an impact slides to its end [-]."""


@dataclass(frozen=True)
class Advice(_Record):
    """Which contact steps and time step keep to all limits."""

    shortest_contact_time_s: float | None
    longest_contact_time_s: float | None
    contact_steps_range: tuple[int, int] | None
    best_contact_steps: int | None
    largest_time_step_s: float | None
    """At the fewest contact steps allowed."""
    largest_time_step_at_contact_steps_s: float | None
    """At the contact steps of this design."""
    time_step_s: float | None
    """The one to take: of the spring given, or of the contact steps given; None where none keeps to all limits."""
    text: str


@dataclass(frozen=True)
class Design(_Record):
    """A designed contact. Attributes carry their unit; None where undefined or unknown.

    Examples
    --------
    >>> from rdpm.design import soft_sphere
    >>> d = soft_sphere(mass=1e-3, restitution=0.8, stiffness=1e2)
    >>> d.regime, round(d.damping_N_s_m, 5), d.to_dict()["contact_steps"]
    ('underdamped', 0.04703, None)
    """

    stiffness_N_m: float  # noqa: N815
    damping_N_s_m: float  # noqa: N815
    restitution: float | None
    contact_time_s: float | None
    contact_steps: float | None
    damping_ratio: float
    regime: str
    ending: Ending
    reduced_mass_kg: float
    diameter_m: float | None
    """Of the smaller sphere."""
    spheres: tuple[Body, ...]
    """One against a wall, else two; empty where a diameter or density is unknown."""
    is_wall: bool
    time_step_s: float | None
    impact_speed_m_s: float | None
    impact_speed_source: str | None
    max_overlap_m: float | None
    max_overlap_fraction: float | None
    static_overlap_fraction: float | None
    overlap_limit_fraction: float
    hertz_contact_time_s: float | None
    rayleigh_time_s: float | None
    terminal_velocity_m_s: float | None
    terminal_reynolds_number: float | None
    stokes_number: float | None
    wet_restitution: float | None
    tangential: Tangential
    predictions: tuple[Prediction, ...]
    verdicts: tuple[Verdict, ...]
    advice: Advice

    @property
    def ok(self) -> bool:
        """Whether no limit is broken; notes break none."""
        return all(v.ok for v in self.verdicts)

    def to_dict(self) -> dict[str, Any]:
        """Give the design as plain types under the names of the JSON output, null where undefined."""
        return super().to_dict()

    def __str__(self) -> str:
        return render(self.to_dict())
