"""A case from its first step to its tables and summary."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from rdpm.config.case import Case
from rdpm.config.write import case_to_toml
from rdpm.errors import RdpmError
from rdpm.io.files import replacing
from rdpm.io.provenance import environment, peak_memory_bytes, write_json
from rdpm.io.tables import read_table
from rdpm.setup import Plan, Simulation
from rdpm.simulation.recorder import Recorder
from rdpm.studies.dkt import from_particles_table

__all__ = ["Reporter", "run_case", "summarise"]


class Reporter(Protocol):
    """Who is told how a run goes."""

    def start(self, plan: Plan) -> None:
        """Before the first step."""

    def update(self, step: int, time: float, end: float, message: str = "") -> None:
        """After each step."""

    def note(self, text: str) -> None:
        """A warning."""

    def finish(self, summary: dict[str, Any]) -> None:
        """At the end."""


def run_case(case: Case, folder: Path, *, threads: int | None = None, reporter: Reporter | None = None) -> dict[str, Any]:
    """Run a case to its end; write its tables, fields and summary into a folder.

    Parameters
    ----------
    case : Case
    folder : Path
        Exists and is empty.
    threads : int, optional
    reporter : Reporter, optional

    Returns
    -------
    dict
        What ``summary.json`` holds.

    Raises
    ------
    RdpmError
        A guard stopped the run, or the disk is full; what was written stays, and the summary says so.
    """
    simulation = Simulation(case, threads)
    with replacing(folder / "case.toml") as temporary:
        temporary.write_text(case_to_toml(case), encoding="utf-8")
    log = _Log(folder / "run.log", reporter)
    if reporter:
        reporter.start(simulation.plan)
    for warning in simulation.plan.warnings:
        log.note(f"warning: {warning}", is_shown=False)
    recorder = Recorder(simulation, folder, float(case.output.table_every or 0.0), float(case.output.fields_every or 0.0))
    status = "failed"
    try:
        simulation.run(case.time.end, reporter.update if reporter else False)
        status = "done"
    except RdpmError as error:
        status = getattr(error, "guard", "failed")
        log.note(str(error), is_shown=False)
        raise
    except KeyboardInterrupt:
        status = "interrupted"
        raise
    finally:
        recorder.close()
        summary = summarise(simulation, recorder, folder, status)
        write_json(folder / "summary.json", summary)
    for warning in summary["warnings"]:
        log.note(f"warning: {warning}")
    if reporter:
        reporter.finish(summary)
    return summary


class _Log:
    """Lines of run.log, and the same to the reporter."""

    def __init__(self, path: Path, reporter: Reporter | None) -> None:
        self._path, self._reporter = path, reporter
        path.write_text("", encoding="utf-8")

    def note(self, text: str, is_shown: bool = True) -> None:
        with self._path.open("a", encoding="utf-8") as file:
            file.write(text + "\n")
        if self._reporter and is_shown:
            self._reporter.note(text)


def summarise(simulation: Simulation, recorder: Recorder, folder: Path, status: str) -> dict[str, Any]:
    """Collect what a run found.

    Parameters
    ----------
    simulation : Simulation
    recorder : Recorder
        Closed.
    folder : Path
        Where its tables are.
    status : str
        "done", "interrupted", or the guard that stopped it.

    Returns
    -------
    dict
    """
    plan, case, fluid, bodies = simulation.plan, simulation.case, simulation.fluid, simulation.bodies
    cells = int(np.prod(plan.cells)) if plan.cells else 0
    wall, steps = simulation.wall_seconds, simulation.steps
    spacing = fluid.grid.spacing if fluid else None
    pairs = [{"kind": pair.kind, "reduced_mass_kg": pair.design.reduced_mass_kg,
              "stiffness_N_m": pair.design.stiffness_N_m, "damping_N_s_m": pair.design.damping_N_s_m,
              "contact_time_s": pair.design.contact_time_s, "restitution": pair.design.restitution}
             for pair in plan.pairs]
    times = [pair["contact_time_s"] for pair in pairs if pair["contact_time_s"] is not None]
    shortest = min(times) if times else None
    summary: dict[str, Any] = {
        "title": case.title, **environment(), "status": status,
        "cells": list(plan.cells) if plan.cells else None, "spacing_m": list(spacing) if spacing else None,
        "cells_per_diameter": float(bodies.diameter.min() / max(spacing)) if spacing and len(bodies) else None,
        "steps": steps, "time_s": simulation.time, "dt_s": simulation.dt, "dt_limit": plan.step.limit,
        "diffusion": "explicit" if plan.step.is_explicit else "stabilised", "stages": plan.step.stages,
        "wall_s": wall, "ns_per_cell_step": 1e9 * wall / (cells * steps) if cells and steps else None,
        "parts_s": dict(simulation.system.watch.seconds),
        "threads": fluid.grid.threads if fluid else 1, "ranks": 1, "peak_memory_bytes": peak_memory_bytes(),
        "max_divergence": simulation.max_divergence if fluid else None,
        "bodies": [{"id": n, "diameter_m": float(bodies.diameter[n]), "density_kg_m3": float(bodies.density[n]),
                    "max_speed_m_s": float(recorder.max_speed[n]), "final_position_m": bodies.position[n].tolist(),
                    "final_velocity_m_s": bodies.velocity[n].tolist()} for n in range(len(bodies))],
        "contact": {"model": case.contact.model, "ending": case.contact.ending, "contact_time_s": shortest,
                    "contact_steps": shortest / simulation.dt if shortest else None,
                    "restitution": case.contact.restitution if case.contact.restitution is not None
                    else (pairs[0]["restitution"] if pairs else None), "friction": case.contact.friction,
                    "lubrication": case.contact.lubrication, "pairs": pairs},
        "contacts": dict(recorder.episodes),
    }
    if len(bodies) == 2:
        table = read_table(folder / "particles.csv")
        gravity = case.domain.gravity
        period = np.where(case.domain.is_periodic, case.domain.size, 0.0)
        phases = from_particles_table(table, (float(bodies.diameter[0]), float(bodies.diameter[1])), gravity,
                                      shortest or 0.0, period)
        summary["dkt"] = asdict(phases)
    summary["warnings"] = _warnings(summary, plan)
    return summary


def _warnings(summary: dict[str, Any], plan: Plan) -> list[str]:
    """Where what happened lies outside what was designed."""
    warnings = []
    overlap = summary["contacts"]["max_overlap_fraction"]
    if overlap > 0.005:
        warnings.append(f"the largest overlap was {100 * overlap:.3g} % of the diameter, above 0.5 %: "
                        "stiffen the contact (fewer contact_steps, a shorter time.step)")
    return warnings
