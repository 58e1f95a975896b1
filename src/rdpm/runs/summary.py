"""Making the summary of a run from its simulation."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from rdpm.contacts import HardSphere
from rdpm.design import Design
from rdpm.io.provenance import environment, peak_memory_bytes
from rdpm.io.tables import read_table
from rdpm.results.dkt import DktPhases, from_particles_table
from rdpm.results.run_folder import RunFolder
from rdpm.results.summary import BodySummary, ContactDesign, ContactTotals, DesignQuantity, PairDesign, Summary
from rdpm.results.warnings import RunWarning, each_once
from rdpm.runs.recorder import Recorder
from rdpm.runs.warnings import happened
from rdpm.setup import Simulation
from rdpm.setup.contact import AnyDesign

__all__ = ["contact_design", "summarise"]


def summarise(
    simulation: Simulation, recorder: Recorder, folder: RunFolder, status: str, warnings: Iterable[RunWarning] = ()
) -> Summary:
    """Collect what a run found.

    Parameters
    ----------
    simulation : Simulation
    recorder : Recorder
        Closed.
    folder : RunFolder
        Where its tables are.
    status : str
        "done", "interrupted", or the guard that stopped it.
    warnings : iterable of RunWarning
        Told so far; what then happened is added.

    Returns
    -------
    Summary
    """
    contact, contacts = contact_design(simulation), ContactTotals(**recorder.episodes)
    found = each_once((*warnings, *happened(contacts, simulation.plan)))
    return Summary(
        title=simulation.case.title,
        **environment(),
        status=status,
        **_grid_and_cost(simulation),
        bodies=_bodies(simulation, recorder),
        contact=contact,
        contacts=contacts,
        dkt=_phases(simulation, folder, contact.contact_time_s or 0.0),
        warnings=tuple(map(str, found)),
        warning_details=found,
    )


def _phases(simulation: Simulation, folder: RunFolder, contact_time: float) -> DktPhases | None:
    """Of a pair."""
    if len(simulation.bodies) != 2:
        return None
    domain = simulation.case.domain
    period = np.where(domain.is_periodic, domain.size, 0.0)
    first, second = (float(d) for d in simulation.bodies.diameter)
    table = read_table(folder.table("particles"))
    return from_particles_table(table, (first, second), domain.gravity, contact_time, period)


def _grid_and_cost(simulation: Simulation) -> dict[str, Any]:
    plan, fluid, bodies = simulation.plan, simulation.fluid, simulation.bodies
    cells = int(np.prod(plan.cells)) if plan.cells else 0
    wall, steps = simulation.wall_seconds, simulation.steps
    spacing = fluid.grid.spacing if fluid else None
    return {
        "cells": tuple(plan.cells) if plan.cells else None,
        "spacing_m": tuple(spacing) if spacing else None,
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
        "ranks": simulation.system.ranks.size,
        "peak_memory_bytes": peak_memory_bytes(),
        "max_divergence": simulation.max_divergence if fluid else None,
    }


def _contact_step(simulation: Simulation) -> float:
    """The step, or the one that adaptive steps fall back to [s]."""
    return simulation.step_control.contact_step if simulation.step_control else simulation.dt


def _bodies(simulation: Simulation, recorder: Recorder) -> tuple[BodySummary, ...]:
    bodies = simulation.bodies
    return tuple(
        BodySummary(
            id=n,
            diameter_m=float(bodies.diameter[n]),
            density_kg_m3=float(bodies.density[n]),
            max_speed_m_s=float(recorder.max_speed[n]),
            final_position_m=tuple(bodies.position[n].tolist()),
            final_velocity_m_s=tuple(bodies.velocity[n].tolist()),
        )
        for n in range(len(bodies))
    )


def contact_design(simulation: Simulation) -> ContactDesign:
    """What the contacts of a simulation were designed to be."""
    given = simulation.case.contact
    designs = [(pair.kind, pair.design) for pair in simulation.plan.pairs]
    times = [d.contact_time_s for _, d in designs if d.contact_time_s is not None]
    shortest = min(times) if times else None
    restitution = given.restitution if given.restitution is not None or not designs else designs[0][1].restitution
    return ContactDesign(
        model=given.model,
        ending=given.ending if given.model in ("soft-sphere", "hertz") else None,
        contact_time_s=shortest,
        contact_steps=shortest / _contact_step(simulation) if shortest else None,
        restitution=restitution,
        friction=given.friction if given.model != "repulsive" else None,
        lubrication=given.lubrication,
        overlap_warning=given.overlap_warning,
        rest_speed_m_s=simulation.plan.law.rest_speed if isinstance(simulation.plan.law, HardSphere) else None,
        pairs=tuple(_pair_design(kind, design) for kind, design in designs),
    )


def _pair_design(kind: str, d: AnyDesign) -> PairDesign:
    rows = [] if isinstance(d, Design) else d.rows()
    return PairDesign(
        kind=kind,
        reduced_mass_kg=d.reduced_mass_kg,
        stiffness_N_m=d.stiffness_N_m,
        damping_N_s_m=d.damping_N_s_m,
        contact_time_s=d.contact_time_s,
        restitution=d.restitution,
        max_overlap_fraction=d.max_overlap_fraction,
        impact_speed_m_s=d.impact_speed_m_s,
        diameter_m=d.diameter_m,
        quantities=tuple(DesignQuantity(name, value, unit) for name, value, unit, _ in rows if value is not None),
        verdicts=tuple(map(str, d.verdicts)),
    )
