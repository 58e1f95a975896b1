"""What a case implies: grid, time step, contact, memory, time; a case that cannot run is refused here."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from rdpm.config.case import Case
from rdpm.contacts import ContactLaw
from rdpm.errors import CaseError
from rdpm.fluid.timestep import Choice
from rdpm.grid.grid import choose_cells
from rdpm.parallel.launcher import launched, launched_here
from rdpm.particles.seeding import marker_count
from rdpm.setup.contact import PairKind, contact_law, contact_limit, pairs
from rdpm.setup.disk import fields_disk, run_disk
from rdpm.setup.inflow import check_ends
from rdpm.setup.kinds import kinds_of_pairs
from rdpm.setup.needs import MemoryNeeds, memory_needs
from rdpm.setup.plausible import implausible
from rdpm.setup.rows import PlanRow, cohesion_rows, disk_rows, hard_sphere_rows, memory_rows, sections
from rdpm.setup.scales import Scales, available_memory, memory_needed, scales
from rdpm.setup.time_step import time_step
from rdpm.setup.walls import check_room_behind
from rdpm.simulation.step_control import StepControl

__all__ = ["PairKind", "Plan", "PlanRow", "plan"]

#: What a measured flow may cross over what `time.cfl` gives an estimated one: an automatic step at its advective limit
#: reaches as much, as the estimate knows no corners (case dkt: 0.59 of a cell for 0.5).
MEASURED = 1.2


@dataclass(frozen=True)
class Plan:
    """All that follows from a case before the first step.

    Attributes
    ----------
    cells : tuple of int or None
    step : Choice
    law : ContactLaw
    pairs : list of PairKind
    scales : Scales
    memory : int, [bytes]
        Of fields, solver and markers; `needs` says all that a run takes.
    steps : int
        The most, where steps are adaptive.
    sections : list of (str, list of PlanRow)
        The same for a reader.
    warnings : list of str
    """

    case: Case
    cells: tuple[int, int, int] | None
    step: Choice
    law: ContactLaw
    pairs: list[PairKind]
    scales: Scales
    memory: int
    steps: int
    sections: list[tuple[str, list[PlanRow]]]

    @cached_property
    def needs(self) -> MemoryNeeds:
        """Memory by process."""
        return memory_needs(self.case, self.cells, self.memory)

    @cached_property
    def disk(self) -> dict[str, tuple[int, int]]:
        """Disk by file, at least and at most [bytes]."""
        return run_disk(self.case, self.cells, self.steps)

    @property
    def step_control(self) -> StepControl | None:
        """How adaptive steps are chosen; None where all are equal."""
        if self.step.longest is None:
            return None
        return StepControl(self.step.dt, self.step.longest, MEASURED * self.case.time.cfl, self.case.time.end)

    @property
    def warnings(self) -> list[str]:
        """Rows with a warning, as sentences."""
        return [
            row.note if row.severity else f"{row.name} = {row.value}: {row.note}"
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
            "memory_bytes": self.needs.process,
            "memory": self.needs.to_dict(),
            "disk_bytes": sum(most for _, most in self.disk.values()),
            "disk": {name: {"least": least, "most": most} for name, (least, most) in self.disk.items()},
            "terminal_velocity_m_s": float(self.scales.terminal.max(initial=0.0)),
            "pairs": [{"kind": p.kind, **p.design.to_dict()} for p in self.pairs],
            "sections": {title: [vars(row) for row in rows] for title, rows in self.sections},
        }


def plan(case: Case, contact_step: float | None = None, machines: float | None = None) -> Plan:
    """Work out what a case implies.

    Parameters
    ----------
    case : Case
    contact_step : float, optional, [s]
        Step with which a run began that automatic steps now continue; chosen when left out.
    machines : float, optional
        Like this one, that share the memory of the flow; those of the launcher when left out.

    Returns
    -------
    Plan

    Raises
    ------
    CaseError
        The grid does not fit the memory, or the time step asked for is above its limit.

    Examples
    --------
    >>> from rdpm.config.load import load_case
    >>> plan(load_case("dkt")).cells
    (54, 54, 270)
    """
    found = scales(case)
    cells = _cells(case)
    spacing = _spacing(case, cells) if cells else None
    check_ends(case, spacing)
    h = float(np.cbrt(np.prod(spacing))) if spacing else math.inf
    check_room_behind(case, h)
    kinds = kinds_of_pairs(case)
    limit = contact_limit(case, kinds, found.fall, h)
    step = time_step(case, spacing, found.speed, limit, contact_step)
    law = contact_law(case, step.dt, found.fall, h)
    markers = sum(marker_count(0.5 * d, h) for d in case.expanded_bodies().diameter) if cells else 0
    memory = memory_needed(cells, step.is_explicit, markers) if cells else 0
    ranks = launched()[0]
    _check_memory(case, cells, round(memory / (machines or ranks / min(ranks, launched_here()))))
    designed = pairs(case, kinds, step.dt, found.fall, h)
    steps = max(1, math.ceil(case.time.end / step.dt - 1e-6))
    rows = sections(case, cells, spacing, step, designed, found, steps, markers)
    if case.contact.model == "hard-sphere" and kinds:
        rows.append(("Contact, hard spheres", hard_sphere_rows(case, step.dt, found.fall)))
    if case.contact.cohesion > 0.0 and kinds:
        rows.append(("Contact, cohesion", cohesion_rows(case, kinds, designed, found.fall)))
    made = Plan(case, cells, step, law, designed, found, memory, steps, rows)
    rows.append(("Memory", memory_rows(made.needs, available_memory())))
    rows.append(("Disk", disk_rows(made.disk, fields_disk(case, cells, steps))))
    if doubts := implausible(case, cells, steps):
        rows.append(("Values hardly meant", doubts))
    return made


def _cells(case: Case) -> tuple[int, int, int] | None:
    if case.fluid is None or case.resolution is None:
        return None
    if case.resolution.cells is not None:
        return case.resolution.cells
    h = float(case.expanded_bodies().diameter.min()) / float(case.resolution.cells_per_diameter or 0.0)
    x, y, z = (choose_cells(length, h) for length in case.domain.size)
    return x, y, z


def _spacing(case: Case, cells: tuple[int, int, int]) -> tuple[float, float, float]:
    x, y, z = (length / n for length, n in zip(case.domain.size, cells, strict=True))
    return x, y, z


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
            f"{cells[0]} x {cells[1]} x {cells[2]} cells need {memory / 1e9:.3g} GB here",
            "Lower it, or shorten the box.",
        )
