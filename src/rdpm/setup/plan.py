"""What a case implies: grid, time step, contact, memory, time; a case that cannot run is refused here."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from rdpm import design
from rdpm.config.case import Case
from rdpm.contacts import SoftSphere
from rdpm.errors import CaseError
from rdpm.fluid.timestep import Choice, advective_limit, choose_step
from rdpm.grid.grid import choose_cells
from rdpm.particles.seeding import marker_count
from rdpm.setup.scales import Scales, available_memory, memory_needed, scales
from rdpm.simulation.pace import Pace

__all__ = ["PairKind", "Plan", "PlanRow", "plan"]

#: Least steps in a contact: below, a rebound is not resolved.
LEAST_CONTACT_STEPS = 4

#: Dry overlap at the bodies' own speed, of the diameter, that an automatic step may lead to; wet kisses stay far below.
AUTO_OVERLAP = 0.025

#: Different bodies up to which every kind of pair is told apart.
MOST_GROUPS = 4

#: What a measured flow may cross over what `time.cfl` gives an estimated one: an automatic step at its advective limit
#: reaches as much, as the estimate knows no corners (case dkt: 0.59 of a cell for 0.5).
MEASURED = 1.2

#: Nanoseconds a cell and step on one thread, for the estimate of a run's time.
EXPECTED_NS = 20.0

Verdict = Literal["", "ok", "warning"]
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class PlanRow:
    """One line of what a case implies."""

    name: str
    value: str
    verdict: Verdict = ""
    note: str = ""


@dataclass(frozen=True)
class PairKind:
    """A kind of pair and the contact it will have.

    Parameters
    ----------
    kind : str
        "sphere-sphere" or "sphere-wall", with the groups where there are several.
    design : Design
        The numbers, from the one module that computes them.
    """

    kind: str
    design: design.Design


@dataclass(frozen=True)
class Plan:
    """All that follows from a case before the first step.

    Attributes
    ----------
    cells : tuple of int or None
    step : Choice
    law : SoftSphere
    pairs : list of PairKind
    scales : Scales
    memory : int, [bytes]
    steps : int
        The most, where steps are adaptive.
    sections : list of (str, list of PlanRow)
        The same for a reader.
    warnings : list of str
    """

    case: Case
    cells: tuple[int, int, int] | None
    step: Choice
    law: SoftSphere
    pairs: list[PairKind]
    scales: Scales
    memory: int
    steps: int
    sections: list[tuple[str, list[PlanRow]]]

    @property
    def pace(self) -> Pace | None:
        """How adaptive steps are chosen; None where all are equal."""
        if self.step.longest is None:
            return None
        return Pace(self.step.dt, self.step.longest, MEASURED * self.case.time.cfl, self.case.time.end)

    @property
    def warnings(self) -> list[str]:
        """Rows with a warning, as sentences."""
        return [
            f"{row.name} = {row.value}: {row.note}"
            for _, rows in self.sections
            for row in rows
            if row.verdict == "warning"
        ]

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers for machines."""
        return {
            "cells": list(self.cells) if self.cells else None,
            "dt_s": self.step.dt,
            "dt_longest_s": self.step.longest,
            "dt_limit": self.step.limit,
            "dt_limits_s": {k: v if math.isfinite(v) else None for k, v in self.step.limits.items()},
            "diffusion": "explicit" if self.step.is_explicit else "stabilised",
            "stages": self.step.stages,
            "steps": self.steps,
            "memory_bytes": self.memory,
            "terminal_velocity_m_s": float(self.scales.terminal.max(initial=0.0)),
            "pairs": [{"kind": p.kind, **p.design.to_dict()} for p in self.pairs],
            "sections": {title: [vars(row) for row in rows] for title, rows in self.sections},
        }


def plan(case: Case) -> Plan:
    """Work out what a case implies.

    Parameters
    ----------
    case : Case

    Returns
    -------
    Plan

    Raises
    ------
    CaseError
        The grid does not fit the memory, or the time step asked is above its limit.

    Examples
    --------
    >>> from rdpm.config.load import load_case
    >>> plan(load_case("dkt")).cells
    (54, 54, 270)
    """
    found = scales(case)
    cells = _cells(case)
    spacing = tuple(length / n for length, n in zip(case.domain.size, cells, strict=True)) if cells else None
    step = _time_step(case, spacing, found)
    law = _law(case, step.dt)
    bodies = case.expanded_bodies()
    h = float(np.cbrt(np.prod(spacing))) if spacing else math.inf
    markers = sum(marker_count(0.5 * d, h) for d in bodies.diameter) if cells else 0
    memory = memory_needed(cells, step.is_explicit, markers) if cells else 0
    _check_memory(case, cells, memory)
    pairs = _pairs(case, law, step.dt, found)
    steps = max(1, math.ceil(case.time.end / step.dt - 1e-6))
    from rdpm.setup.rows import sections  # the wording, beside the numbers

    return Plan(
        case,
        cells,
        step,
        law,
        pairs,
        found,
        memory,
        steps,
        sections(case, cells, spacing, step, pairs, found, memory, steps, markers),
    )


def _cells(case: Case) -> tuple[int, int, int] | None:
    if case.fluid is None or case.resolution is None:
        return None
    if case.resolution.cells is not None:
        return case.resolution.cells
    h = float(case.expanded_bodies().diameter.min()) / float(case.resolution.cells_per_diameter or 0.0)
    x, y, z = (choose_cells(length, h) for length in case.domain.size)
    return x, y, z


def _time_step(case: Case, spacing: tuple[float, ...] | None, found: Scales) -> Choice:
    contact = _contact_limit(case, found)
    asked = case.time.step
    if spacing is None or case.fluid is None:
        if isinstance(asked, str) or asked > contact:
            # As promised of a stiffness given literally: a step is lowered, and the reason is said.
            dt, limit = contact, "contact"
        else:
            dt, limit = asked, "user"
        return Choice(_to_end(case.time.end, dt) if asked == "auto" else dt, limit, True, 0, {"contact": contact})
    x, y, z = spacing
    h = (x, y, z)
    limits = {"advective": advective_limit(h, found.speed, case.time.cfl), "contact": contact, "output": case.time.end}
    if isinstance(asked, str):
        choice = choose_step(h, case.fluid.nu, case.time.diffusion, limits)
        dt = case.time.contact_step or _to_end(case.time.end, choice.dt)
        choice = replace(choice, dt=dt)
        return choice if asked == "auto" else _adaptive(case, h, choice, limits)
    literal = case.contact.stiffness is not None or case.contact.max_overlap is not None
    dt, limit = (contact, "contact") if literal and asked > contact else (asked, "user")
    # A step that is asked for may use the whole cell that time.cfl keeps a share of.
    hardest = advective_limit(h, found.speed, 1.0)
    limits = {"user": dt, "advective": hardest}
    if dt > hardest * (1.0 + 1e-9):
        raise CaseError(
            "time.step",
            f"{dt:g} s",
            f"must be at most {hardest:.3g} s",
            "the flow would cross more than a cell in a step",
            'Lower it, or use "auto".',
        )
    choice = choose_step(h, case.fluid.nu, case.time.diffusion, limits)
    if choice.dt < dt * (1.0 - 1e-9) and case.time.diffusion == "auto":
        choice = choose_step(h, case.fluid.nu, "stabilised", limits)
    if choice.dt < dt * (1.0 - 1e-9):
        raise CaseError(
            "time.step",
            f"{dt:g} s",
            f"must be at most {choice.dt:.3g} s",
            f"the limit of {'explicit' if choice.is_explicit else 'stabilised'} diffusion on this grid",
            'Lower it, or set time.diffusion = "auto".' if case.time.diffusion == "explicit" else "Lower it.",
        )
    return Choice(dt, limit, choice.is_explicit, choice.stages, choice.limits)


def _adaptive(
    case: Case, spacing: tuple[float, float, float], contact: Choice, limits: dict[str, float]
) -> Choice:
    """Steps from that of `contact` to the longest that all limits but the contact's allow; diffusion is made for it."""
    assert case.fluid is not None
    others = {name: limit for name, limit in limits.items() if name != "contact"}
    wide = choose_step(spacing, case.fluid.nu, case.time.diffusion, others)
    limits = contact.limits | {"viscous": wide.limits["viscous"]}
    return Choice(contact.dt, contact.limit, wide.is_explicit, wide.stages, limits, max(wide.dt, contact.dt))


def _to_end(end: float, dt: float) -> float:
    """The longest step not above dt of which a whole number ends at the end."""
    return end / math.ceil(end / dt - 1e-9)


@dataclass(frozen=True)
class _Kind:
    """Two spheres, or a sphere and a wall."""

    name: str
    first: tuple[float, float]  # diameter [m], density [kg/m^3]
    second: tuple[float, float] | None = None  # None: a wall

    @property
    def reduced_mass(self) -> float:
        own = float(design.sphere_mass(*self.first))
        return own if self.second is None else float(design.reduced_mass(own, design.sphere_mass(*self.second)))

    @property
    def diameter(self) -> float:
        return self.first[0] if self.second is None else min(self.first[0], self.second[0])


def _kinds(case: Case) -> list[_Kind]:
    """Every kind of pair; of many different bodies only the lightest's and the heaviest's, between which all lie."""
    bodies = case.expanded_bodies()
    if not len(bodies):
        return []
    rows, counts = np.unique(np.stack([bodies.diameter, bodies.density], axis=1), axis=0, return_counts=True)
    order = np.argsort(design.sphere_mass(rows[:, 0], rows[:, 1]), kind="stable")
    groups = [(float(rows[n, 0]), float(rows[n, 1])) for n in order]
    alone = {groups[n] for n, k in enumerate(order) if counts[k] < 2}
    is_many = len(groups) > MOST_GROUPS
    if is_many:
        groups, alone = [groups[0], groups[-1]], set()
    size = "" if len(groups) == 1 else " ({:.4g} mm, {:.4g} mm)"
    found: list[_Kind] = []
    for a, one in enumerate(groups):
        partners = [one] if is_many else groups[a:]
        found.extend(
            _Kind("sphere-sphere" + size.format(1e3 * one[0], 1e3 * other[0]), one, other)
            for other in partners
            if other != one or one not in alone
        )
        if any(kind != "periodic" for kind in case.domain.kinds):
            found.append(_Kind("sphere-wall" + (f" ({1e3 * one[0]:.4g} mm)" if size else ""), one))
    return found


def _columns(kinds: list[_Kind]) -> tuple[Floats, Floats]:
    return np.array([kind.reduced_mass for kind in kinds]), np.array([kind.diameter for kind in kinds])


def _contact_limit(case: Case, found: Scales) -> float:
    """Longest step the contacts allow [s]; inf without pairs."""
    kinds = _kinds(case)
    if not kinds:
        return math.inf
    mass, diameter = _columns(kinds)
    contact = case.contact
    if contact.way != "contact-steps":
        law = _law(case, math.nan)
        return float(law.resolved_time(mass, diameter).min()) / LEAST_CONTACT_STEPS
    if found.fall == 0.0:
        return math.inf
    # Contact time in which a dry impact at the bodies' own speed reaches the overlap allowed.
    e = max(float(contact.restitution or 1.0), 1e-3)
    longest = design.largest_contact_time(e, AUTO_OVERLAP * float(diameter.min()), found.fall, contact.ending)
    return float(longest) / float(contact.contact_steps or LEAST_CONTACT_STEPS)


def _law(case: Case, dt: float) -> SoftSphere:
    c = case.contact
    ratio = c.tangential_ratio
    if ratio is None:
        ratio = float(design.ratio_from_poisson(c.poisson_ratio)) if c.poisson_ratio is not None else 2.0 / 7.0
    # What a way needs is there: the case was refused without it.
    given = {name: float(getattr(c, name) or 0.0) for name in ("restitution", "stiffness", "impact_speed")}
    surface = (c.ending, c.friction, ratio)
    if c.way == "contact-steps":
        return SoftSphere.from_contact_time(given["restitution"], float(c.contact_steps or 0.0) * dt, *surface)
    if c.way == "max-overlap":
        overlap = float(c.max_overlap or 0.0)
        return SoftSphere.from_overlap(overlap, given["impact_speed"], given["restitution"], *surface)
    if c.way == "stiffness-damping":
        return SoftSphere.from_stiffness(given["stiffness"], c.damping, None, *surface)
    return SoftSphere.from_stiffness(given["stiffness"], None, given["restitution"], *surface)


def _pairs(case: Case, law: SoftSphere, dt: float, found: Scales) -> list[PairKind]:
    kinds = _kinds(case)
    if not kinds:
        return []
    stiffness, damping = law.normal(*_columns(kinds))
    fluid = {"fluid_density": case.fluid.density, "viscosity": case.fluid.mu} if case.fluid else {}
    return [
        PairKind(
            kind.name,
            design.soft_sphere(
                diameter=kind.first[0],
                density=kind.first[1],
                diameter2=kind.second[0] if kind.second else None,
                density2=kind.second[1] if kind.second else None,
                wall=kind.second is None,
                stiffness=float(k_n),
                damping=float(eta_n),
                time_step=dt,
                ending=case.contact.ending,
                impact_speed=found.fall or None,
                gravity=float(np.linalg.norm(case.domain.gravity)),
                tangential_ratio=law.tangential_ratio,
                friction=case.contact.friction,
                **fluid,
            ),
        )
        for kind, k_n, eta_n in zip(kinds, stiffness, damping, strict=True)
    ]


def _check_memory(case: Case, cells: tuple[int, int, int] | None, memory: int) -> None:
    available = available_memory()
    if cells and memory > 0.9 * available:
        place = "resolution.cells" if case.resolution and case.resolution.cells else "resolution.cells_per_diameter"
        value = (
            list(cells)
            if case.resolution and case.resolution.cells
            else (case.resolution.cells_per_diameter if case.resolution else None)
        )
        raise CaseError(
            place,
            value,
            f"must lead to a grid of at most {0.9 * available / 1e9:.3g} GB",
            f"{cells[0]} x {cells[1]} x {cells[2]} cells need {memory / 1e9:.3g} GB",
            "Lower it, or shorten the box.",
        )
