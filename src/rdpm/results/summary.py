"""What a run found: the contents of ``summary.json`` with names and types."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from rdpm.errors import CaseError
from rdpm.io.provenance import read_json, write_json
from rdpm.results.dkt import DktPhases
from rdpm.results.warnings import RunWarning

__all__ = [
    "BodySummary",
    "ContactDesign",
    "ContactTotals",
    "DesignQuantity",
    "PairDesign",
    "Summary",
    "read_summary",
    "write_summary",
]


@dataclass(frozen=True)
class BodySummary:
    """One body; what is not known, or was not finite when a guard stopped the run, is None.

    Attributes
    ----------
    id : int
        From 0, in the order of the case.
    diameter_m, density_kg_m3, max_speed_m_s : float
    final_position_m, final_velocity_m_s : tuple of float, (3,)
    """

    id: int
    diameter_m: float | None = None
    density_kg_m3: float | None = None
    max_speed_m_s: float | None = None
    final_position_m: tuple[float | None, ...] = ()
    final_velocity_m_s: tuple[float | None, ...] = ()


@dataclass(frozen=True)
class DesignQuantity:
    """A number of a design: ``name``, ``value`` and its ``unit``."""

    name: str
    value: float
    unit: str = ""


@dataclass(frozen=True)
class PairDesign:
    """Contact parameters of one kind of pair.

    Attributes
    ----------
    kind : str
        "sphere-sphere" or "sphere-wall".
    reduced_mass_kg, stiffness_N_m, damping_N_s_m, contact_time_s, restitution : float
    max_overlap_fraction : float, [-]
        Of the smaller diameter, that a dry impact at the bodies' own speed would reach.
    impact_speed_m_s, diameter_m : float
        That speed; the smaller diameter.
    quantities : tuple of DesignQuantity
        What else was designed, of models other than the soft sphere.
    verdicts : tuple of str
        "ok", "note" or "FAIL", quantity, value, sign, limit, condition.
    """

    kind: str
    reduced_mass_kg: float | None = None
    stiffness_N_m: float | None = None  # noqa: N815 (unit)
    damping_N_s_m: float | None = None  # noqa: N815 (unit)
    contact_time_s: float | None = None
    restitution: float | None = None
    max_overlap_fraction: float | None = None
    impact_speed_m_s: float | None = None
    diameter_m: float | None = None
    quantities: tuple[DesignQuantity, ...] = ()
    verdicts: tuple[str, ...] = ()


@dataclass(frozen=True)
class ContactDesign:
    """The contact law and what was designed.

    Attributes
    ----------
    model, ending : str
    contact_time_s : float
        Shortest of all pairs.
    contact_steps : float
        The same in steps of the fluid.
    restitution, friction : float, [-]
    lubrication : bool
    pairs : tuple of PairDesign
    overlap_warning : float, [-]
        Overlap that the case allows without a warning.
    rest_speed_m_s : float
        Of hard spheres: slower contacts do not rebound.
    """

    model: str | None = None
    ending: str | None = None
    contact_time_s: float | None = None
    contact_steps: float | None = None
    restitution: float | None = None
    friction: float | None = None
    lubrication: bool | None = None
    pairs: tuple[PairDesign, ...] = ()
    overlap_warning: float | None = None
    rest_speed_m_s: float | None = None

    @property
    def contact_times(self) -> dict[str, float]:
        """Longest contact time of each kind, "sphere-sphere" and "sphere-wall" [s]."""
        times: dict[str, float] = {}
        for pair in self.pairs:
            kind = pair.kind.split(" ")[0]
            if pair.contact_time_s is not None:
                times[kind] = max(times.get(kind, 0.0), pair.contact_time_s)
        return times


@dataclass(frozen=True)
class ContactTotals:
    """The contacts that happened.

    Attributes
    ----------
    count : int
    max_overlap_fraction : float, [-]
        Of the smaller diameter.
    total_time_s : float
    pressed : int
        Of them, those in which the bodies were pressed together; see `rdpm.results.contacts.is_pressed`.
    came_to_rest, capped : int
        Hard spheres: contacts slower than the rest speed, or beyond the most events of a pair in a step; and of these
        the latter.
    outside : int
        Contacts that left the range that the design promises.
    outside_reasons : mapping of str to int
        What left it, and why; see `rdpm.results.contacts.outside_range`.
    """

    count: int = 0
    max_overlap_fraction: float | None = 0.0
    total_time_s: float | None = 0.0
    pressed: int = 0
    came_to_rest: int = 0
    capped: int = 0
    outside: int = 0
    outside_reasons: Mapping[str, int] = field(default_factory=dict)


@dataclass(frozen=True)
class Summary:
    """What a run found, under the names that it has in ``summary.json``.

    What does not apply (the grid of a dry case, the phases of anything but a pair), or is missing in a file of another
    version, is None or empty.

    Attributes
    ----------
    title, status : str
        Status: "done", "interrupted", or the guard that stopped the run.
    rdpm_version, simd, python, numpy, platform, cpu, date_utc : str
    threads, ranks : int
    cells : tuple of int, (3,)
    spacing_m : tuple of float, (3,)
    cells_per_diameter : float
    steps : int
    time_s, dt_s, dt_shortest_s, dt_longest_s : float
        Adaptive: `dt_s` is the contact step.
    dt_limit, diffusion : str
    stages : int
    wall_s, ns_per_cell_step : float
    parts_s : mapping of str to float
    peak_memory_bytes : int
    max_divergence : float, [1/s]
    bodies : tuple of BodySummary
    contact : ContactDesign
    contacts : ContactTotals
    dkt : DktPhases
    warnings : tuple of str
        What the run was warned of, before it started and at its end; each once.
    warning_details : tuple of RunWarning
        The same, taken apart.

    Examples
    --------
    >>> summary = Summary.from_dict({"status": "done", "steps": 3, "of_a_later_version": 1})
    >>> summary.status, summary.steps, summary.cells, summary.contacts.count
    ('done', 3, None, 0)
    >>> Summary.from_dict(summary.to_dict()) == summary
    True
    """

    title: str | None = None
    rdpm_version: str | None = None
    simd: str | None = None
    python: str | None = None
    numpy: str | None = None
    platform: str | None = None
    cpu: str | None = None
    threads: int | None = None
    date_utc: str | None = None
    status: str | None = None
    cells: tuple[int, int, int] | None = None
    spacing_m: tuple[float, float, float] | None = None
    cells_per_diameter: float | None = None
    steps: int | None = None
    time_s: float | None = None
    dt_s: float | None = None
    dt_shortest_s: float | None = None
    dt_longest_s: float | None = None
    dt_limit: str | None = None
    diffusion: str | None = None
    stages: int | None = None
    wall_s: float | None = None
    ns_per_cell_step: float | None = None
    parts_s: Mapping[str, float] = field(default_factory=dict)
    ranks: int | None = None
    peak_memory_bytes: int | None = None
    max_divergence: float | None = None
    bodies: tuple[BodySummary, ...] = ()
    contact: ContactDesign = field(default_factory=ContactDesign)
    contacts: ContactTotals = field(default_factory=ContactTotals)
    dkt: DktPhases | None = None
    warnings: tuple[str, ...] = ()
    warning_details: tuple[RunWarning, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """The same as plain dicts; without ``dkt`` where there is no pair."""
        content = asdict(self)
        if self.dkt is None:
            del content["dkt"]
        return content

    @classmethod
    def from_dict(cls, content: Mapping[str, Any], place: str = "summary") -> Summary:
        """Read what `to_dict` gave, or what ``summary.json`` holds; unknown keys are passed over.

        Parameters
        ----------
        content : mapping
        place : str
            Named in the message.

        Raises
        ------
        CaseError
            A key holds something of another kind.
        """
        known = {key: value for key, value in content.items() if value is not None}
        try:
            return _adapter().validate_python(known)
        except ValidationError as error:
            first = error.errors()[0]
            key = ".".join(str(part) for part in first["loc"])
            raise CaseError(f"{place}: {key}", repr(first["input"]), "must be that of a run", first["msg"]) from None


@cache
def _adapter() -> TypeAdapter[Summary]:
    return TypeAdapter(Summary)


def read_summary(path: str | Path) -> Summary:
    """Read a ``summary.json``.

    Parameters
    ----------
    path : path

    Returns
    -------
    Summary

    Raises
    ------
    CaseError
        The file is missing or broken.
    """
    return Summary.from_dict(read_json(path), str(path))


def write_summary(path: str | Path, summary: Summary) -> None:
    """Write a ``summary.json``, whole or not at all.

    Parameters
    ----------
    path : path
    summary : Summary

    Raises
    ------
    OutputError
        The file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp()) / "summary.json"
    >>> write_summary(path, Summary(status="done", cells=(4, 4, 8)))
    >>> read_summary(path).cells
    (4, 4, 8)
    """
    write_json(path, summary.to_dict())
