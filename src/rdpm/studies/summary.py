"""What a run found, as ``summary.json`` holds it."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from rdpm.conventions import OVERLAP_WARNING
from rdpm.io.provenance import environment, peak_memory_bytes
from rdpm.io.tables import read_table
from rdpm.setup import Plan, Simulation
from rdpm.simulation.recorder import Recorder
from rdpm.studies.dkt import from_particles_table

__all__ = ["summarise"]


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
    case = simulation.case
    contact = _contact(simulation)
    summary: dict[str, Any] = {
        "title": case.title,
        **environment(),
        "status": status,
        **_grid_and_cost(simulation),
        "bodies": _bodies(simulation, recorder),
        "contact": contact,
        "contacts": dict(recorder.episodes),
    }
    if len(simulation.bodies) == 2:
        period = np.where(case.domain.is_periodic, case.domain.size, 0.0)
        first, second = (float(d) for d in simulation.bodies.diameter)
        phases = from_particles_table(
            read_table(folder / "particles.csv"),
            (first, second),
            case.domain.gravity,
            contact["contact_time_s"] or 0.0,
            period,
        )
        summary["dkt"] = asdict(phases)
    summary["warnings"] = _warnings(summary, simulation.plan)
    return summary


def _grid_and_cost(simulation: Simulation) -> dict[str, Any]:
    plan, fluid, bodies = simulation.plan, simulation.fluid, simulation.bodies
    cells = int(np.prod(plan.cells)) if plan.cells else 0
    wall, steps = simulation.wall_seconds, simulation.steps
    spacing = fluid.grid.spacing if fluid else None
    return {
        "cells": list(plan.cells) if plan.cells else None,
        "spacing_m": list(spacing) if spacing else None,
        "cells_per_diameter": float(bodies.diameter.min()) / max(spacing) if spacing and len(bodies) else None,
        "steps": steps,
        "time_s": simulation.time,
        "dt_s": _contact_step(simulation),
        "dt_shortest_s": simulation.shortest_dt or None,
        "dt_longest_s": simulation.longest_dt or None,
        "dt_limit": plan.step.limit,
        "diffusion": "explicit" if plan.step.is_explicit else "stabilised",
        "stages": plan.step.stages,
        "wall_s": wall,
        "ns_per_cell_step": 1e9 * wall / (cells * steps) if cells and steps else None,
        "parts_s": dict(simulation.system.watch.seconds),
        "threads": fluid.grid.threads if fluid else 1,
        "ranks": 1,
        "peak_memory_bytes": peak_memory_bytes(),
        "max_divergence": simulation.max_divergence if fluid else None,
    }


def _contact_step(simulation: Simulation) -> float:
    """The step, or the one that adaptive steps fall back to [s]."""
    return simulation.pace.contact_step if simulation.pace else simulation.dt


def _bodies(simulation: Simulation, recorder: Recorder) -> list[dict[str, Any]]:
    bodies = simulation.bodies
    return [
        {
            "id": n,
            "diameter_m": float(bodies.diameter[n]),
            "density_kg_m3": float(bodies.density[n]),
            "max_speed_m_s": float(recorder.max_speed[n]),
            "final_position_m": bodies.position[n].tolist(),
            "final_velocity_m_s": bodies.velocity[n].tolist(),
        }
        for n in range(len(bodies))
    ]


def _contact(simulation: Simulation) -> dict[str, Any]:
    asked = simulation.case.contact
    designs = [(pair.kind, pair.design) for pair in simulation.plan.pairs]
    times = [d.contact_time_s for _, d in designs if d.contact_time_s is not None]
    shortest = min(times) if times else None
    restitution = asked.restitution if asked.restitution is not None or not designs else designs[0][1].restitution
    return {
        "model": asked.model,
        "ending": asked.ending,
        "contact_time_s": shortest,
        "contact_steps": shortest / _contact_step(simulation) if shortest else None,
        "restitution": restitution,
        "friction": asked.friction,
        "lubrication": asked.lubrication,
        "pairs": [
            {
                "kind": kind,
                "reduced_mass_kg": d.reduced_mass_kg,
                "stiffness_N_m": d.stiffness_N_m,
                "damping_N_s_m": d.damping_N_s_m,
                "contact_time_s": d.contact_time_s,
                "restitution": d.restitution,
            }
            for kind, d in designs
        ],
    }


def _warnings(summary: dict[str, Any], plan: Plan) -> list[str]:
    """Where what happened lies outside what was designed."""
    warnings = []
    overlap = summary["contacts"]["max_overlap_fraction"]
    if overlap > OVERLAP_WARNING:
        warnings.append(
            f"the largest overlap was {100 * overlap:.3g} % of the diameter, above {100 * OVERLAP_WARNING:g} %: "
            "stiffen the contact (fewer contact_steps, or a shorter time.step)"
        )
    designed = max((pair.design.max_overlap_fraction or 0.0 for pair in plan.pairs), default=0.0)
    if 0.0 < designed < overlap:
        warnings.append(
            f"the largest overlap was {100 * overlap:.3g} % of the diameter; the design expected "
            f"{100 * designed:.3g} % at the bodies' own speed: several bodies pressed together, or an impact was faster"
        )
    return warnings
