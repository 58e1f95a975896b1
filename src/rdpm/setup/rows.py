"""What a case implies, as lines for a reader."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from rdpm import design
from rdpm.config.case import Case
from rdpm.design import Design
from rdpm.design.report import Row
from rdpm.fluid.timestep import Choice
from rdpm.setup.contact import PairKind
from rdpm.setup.disk import FieldsDisk, size_text
from rdpm.setup.hard_sphere import hard_sphere
from rdpm.setup.kinds import Kind
from rdpm.setup.needs import MemoryNeeds
from rdpm.setup.scales import Scales

__all__ = ["EXPECTED_NS", "PlanRow", "cohesion_rows", "disk_rows", "hard_sphere_rows", "memory_rows", "sections"]

#: Nanoseconds a cell and step on one thread, for the estimate of a run's time.
EXPECTED_NS = 20.0

Verdict = Literal["", "ok", "warning"]

_LIMITS = {
    "advective": "the flow crosses time.cfl of a cell",
    "viscous": "diffusion is stable",
    "contact": "a contact keeps its least steps, a dry impact its overlap",
    "user": "as given",
    "output": "one step to the end",
}


@dataclass(frozen=True)
class PlanRow:
    """One line of what a case implies.

    Attributes
    ----------
    name, value, note : str
    verdict : {"", "ok", "warning"}
    severity : {"", "ok", "note", "fail"}
        Of a design's verdict; the note is then the whole of it, with value, sign, limit and condition.
    """

    name: str
    value: str
    verdict: Verdict = ""
    note: str = ""
    severity: str = ""


def sections(
    case: Case,
    cells: tuple[int, int, int] | None,
    spacing: tuple[float, ...] | None,
    step: Choice,
    pairs: list[PairKind],
    found: Scales,
    steps: int,
    markers: int,
) -> list[tuple[str, list[PlanRow]]]:
    """Group what was worked out: grid, flow, time, contact.

    Returns
    -------
    list of (title, list of PlanRow)
    """
    result = []
    if cells and spacing:
        result.append(("Grid", _grid(case, cells, spacing, markers)))
        result.append(("Flow", _flow(case, found)))
    result.append(("Time", _time(cells, step, steps)))
    result.extend((f"Contact, {pair.kind}", _contact(pair)) for pair in pairs)
    return result


def _row(name: str, value: str, ok: bool | None = None, note: str = "") -> PlanRow:
    return PlanRow(name, value, "" if ok is None else "ok" if ok else "warning", note)


def _grid(case: Case, cells: tuple[int, int, int], spacing: tuple[float, ...], markers: int) -> list[PlanRow]:
    rows = [
        _row("cells", f"{cells[0]} x {cells[1]} x {cells[2]} = {math.prod(cells) / 1e6:.3g} million"),
        _row("spacing", ", ".join(f"{1e3 * h:.4g}" for h in spacing) + " mm"),
    ]
    diameters = case.expanded_bodies().diameter
    if len(diameters):
        across = float(diameters.min()) / max(spacing)
        rows.append(
            _row(
                "cells a diameter",
                f"{across:.3g}",
                across >= 7.5,
                "below 8 the drag is several per cent off" if across < 7.5 else "",
            )
        )
        rows.append(_row("markers", f"{markers} on {len(diameters)} bodies"))
    return rows


def memory_rows(needs: MemoryNeeds, free: int) -> list[PlanRow]:
    """Memory of a run by process, of which so much is free [bytes], as lines for a reader."""
    rows = [
        _row("run", size_text(needs.process), True, f"{size_text(free)} are free"),
        _row("of it", f"solver {size_text(needs.solver)}, libraries {size_text(needs.libraries)}"),
    ]
    if needs.view:
        rows.append(_row("view of the bodies", size_text(needs.view), None, "a process of its own, after the run"))
    if needs.video:
        rows.append(_row("video", size_text(needs.video), None, "likewise"))
    if needs.at_once > needs.process:
        rows.append(_row("all at once", size_text(needs.at_once), None, "what a batch system must grant"))
    return rows


def disk_rows(disk: dict[str, tuple[int, int]], flow: FieldsDisk | None) -> list[PlanRow]:
    """Disk of a run by file, as lines for a reader."""
    sizes = {**disk, "all": (sum(least for least, _ in disk.values()), sum(most for _, most in disk.values()))}
    notes = {"fields.vtkhdf": f"{flow.count} pictures" if flow else "", "all": "without contacts.csv, a row a contact"}

    def said(least: int, most: int) -> str:
        return size_text(most) if least == most else f"{size_text(least)} to {size_text(most)}"

    return [_row(name, said(*size), None, notes.get(name, "")) for name, size in sizes.items()]


def _flow(case: Case, found: Scales) -> list[PlanRow]:
    fluid, bodies = case.fluid, case.expanded_bodies()
    assert fluid is not None
    rows = [_row("kinematic viscosity", f"{fluid.nu:.4g} m^2/s"), *_stream(case, fluid.nu)]
    if not len(bodies) or (case.domain.inflow is not None and all(motion == "fixed" for motion in bodies.motion)):
        return rows
    n = int(np.argmax(found.terminal)) if found.terminal.any() else 0
    d, ratio = float(bodies.diameter[n]), float(bodies.density[n] / fluid.density)
    g = float(np.linalg.norm(case.domain.gravity))
    speed = float(found.terminal[n]) or found.fall
    galileo = math.sqrt(abs(ratio - 1.0) * g * d**3) / fluid.nu
    reynolds = speed * d / fluid.nu
    rows += [
        _row(
            "density ratio",
            f"{ratio:.4g}",
            0.5 <= ratio <= 10.0,
            "" if 0.5 <= ratio <= 10.0 else "tested from 0.5 to 10",
        ),
        _row("Galileo number Ga", f"{galileo:.4g}"),
        _row(
            "terminal velocity",
            f"{float(found.terminal[n]):.4g} m/s",
            None,
            "of one sphere alone (Brown and Lawler's drag)",
        ),
        _row("Reynolds number Re", f"{reynolds:.4g}", None, "at that speed"),
        _row(
            "Stokes number St",
            f"{ratio * reynolds / 9.0:.4g}",
            None,
            "no rebound below about 10: lubrication absorbs it" if ratio * reynolds / 9.0 < 10.0 else "",
        ),
    ]
    return rows


def _stream(case: Case, nu: float) -> list[PlanRow]:
    """The inflow, and the Reynolds number of the smallest body in it or of the box's narrowest width."""
    inflow, axis = case.domain.inflow, case.domain.inflow_axis
    if inflow is None or axis is None:
        return []
    shape = inflow.profile if isinstance(inflow.profile, str) else "as given"
    ramp = f", rising for {inflow.start_up:.4g} s" if inflow.start_up else ""
    diameters = case.expanded_bodies().diameter
    width = min(length for n, length in enumerate(case.domain.size) if n != axis)
    across, of = (float(diameters.min()), "a diameter") if len(diameters) else (width, "the narrowest width")
    return [
        _row("inflow along " + "xyz"[axis], f"{inflow.velocity:.4g} m/s", None, f"mean; {shape}{ramp}"),
        _row("Reynolds number of the inflow", f"{abs(inflow.velocity) * across / nu:.4g}", None, f"with {of}"),
    ]


def _time(cells: tuple[int, int, int] | None, step: Choice, steps: int) -> list[PlanRow]:
    is_adaptive = step.longest is not None
    span = f" to {step.longest:.4g} s" if is_adaptive else " s"
    fallback = "adaptive; near a contact the shortest; its " if is_adaptive else ""
    rows = [
        _row(
            "time step", f"{step.dt:.4g}{span}", None, f"{fallback}limit: {step.limit} ({_LIMITS[step.limit]})"
        ),
        _row(
            "limits",
            ", ".join(
                f"{name} {value:.3g} s"
                for name, value in step.limits.items()
                if math.isfinite(value) and name != "output"
            ),
        ),
    ]
    if cells:
        most = "at most " if is_adaptive else ""
        way = "explicit" if step.is_explicit else f"stabilised, {most}{step.stages} stages"
        rows.append(_row("diffusion", way))
        wall = steps * math.prod(cells) * EXPECTED_NS * 1e-9
        rows.append(_row("steps", most + str(steps), None, f"{most}about {wall:.0f} s on one thread"))
    else:
        rows.append(_row("steps", str(steps)))
    return rows


def _contact(pair: PairKind) -> list[PlanRow]:
    d = pair.design
    if not isinstance(d, Design):
        return _listed(d.rows()) + _verdicts(d.verdicts)
    rows = [_row("stiffness k_n", f"{d.stiffness_N_m:.5g} N/m"), _row("damping eta_n", f"{d.damping_N_s_m:.4g} N s/m")]
    if d.restitution is not None:
        rows.append(_row("restitution e_n", f"{d.restitution:.4g}", None, "dry"))
    if d.contact_time_s is not None:
        steps = f", {d.contact_steps:.4g} steps" if d.contact_steps else ""
        rows.append(_row("contact time t_c", f"{d.contact_time_s:.4g} s{steps}"))
    return rows + _verdicts(d.verdicts)


def _listed(known: list[Row]) -> list[PlanRow]:
    return [
        _row(name, f"{value:.4g} {unit}".rstrip(), None, note) for name, value, unit, note in known if value is not None
    ]


def _verdicts(verdicts: tuple[design.Verdict, ...]) -> list[PlanRow]:
    told: dict[str, Verdict] = {"ok": "ok", "note": "", "fail": "warning"}
    rows = []
    for one in verdicts:
        value = "-" if one.value is None else f"{one.value:.4g}"
        rows.append(PlanRow(one.name, value, told[one.severity], one.text, one.severity))
    return rows


def hard_sphere_rows(case: Case, dt: float, fall: float) -> list[PlanRow]:
    """What a case implies of its hard spheres, as lines for a reader.

    Parameters
    ----------
    case : Case
    dt : float, [s]
        Time step.
    fall : float, [m/s]
        Impact speed in the worst case; 0 where none is known.

    Returns
    -------
    list of PlanRow
    """
    law = hard_sphere(case)
    rows = [
        PlanRow("restitution e_n", f"{law.restitution:.4g}", "", "dry"),
        PlanRow("rest speed", f"{law.rest_speed:.4g} m/s", "", "slower contacts do not rebound"),
        PlanRow("most events", str(law.most_events), "", "of a pair in a step, after which it rests"),
        PlanRow("time step", "not limited by contacts", "", "collisions are found inside it"),
    ]
    if fall > 0.0 and law.restitution > 0.0:
        diameter = float(case.expanded_bodies().diameter.min())
        error = design.finite_contact_error(design.COMPARED_STEPS * dt, law.restitution, diameter, fall)
        rows.append(
            PlanRow(
                f"a soft sphere of {design.COMPARED_STEPS:g} steps",
                f"{100.0 * error.time_ratio:.3g} % of d / v in contact",
                "",
                f"would overlap by {100.0 * error.overlap:.3g} % of d and lag by {100.0 * error.lag:.3g} % of d",
            )
        )
    return rows


def cohesion_rows(case: Case, kinds: list[Kind], pairs: list[PairKind], fall: float) -> list[PlanRow]:
    """What cohesion does to each kind of pair: its pull-off force, and the speed below which the pair sticks.

    Parameters
    ----------
    case : Case
        With cohesion.
    kinds : list of Kind
    pairs : list of PairKind
        Their designs.
    fall : float, [m/s]
        Impact speed in the worst case; 0 where none is known.

    Returns
    -------
    list of PlanRow
    """
    rows, well = [], float(case.contact.cohesion_range or 0.0)
    g = float(np.linalg.norm(case.domain.gravity))
    for kind, pair in zip(kinds, pairs, strict=True):
        force = float(design.pull_off_force(kind.reduced_radius, case.contact.cohesion))
        weight = g * kind.reduced_mass
        note = f"{force / weight:.3g} of the weight of the reduced mass" if weight > 0.0 else ""
        rows.append(PlanRow(f"pull-off force, {pair.kind}", f"{force:.4g} N", "", note))
        e = pair.design.restitution if isinstance(pair.design, (Design, design.HertzDesign)) else None
        if not e:
            continue
        speed = float(design.sticking_speed(kind.reduced_mass, force, well, e))
        sticks = fall > 0.0 and speed >= fall
        note = f"slower impacts do not part{f': also one at {fall:.3g} m/s, the fastest known' if sticks else ''}"
        rows.append(PlanRow(f"sticking speed, {pair.kind}", f"{speed:.4g} m/s", "warning" if sticks else "", note))
    return rows
