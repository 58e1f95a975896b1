"""What a tuning reads from runs: the kind of the case, its contacts and their energy."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from rdpm import design
from rdpm.config.case import Case
from rdpm.results.run import Run
from rdpm.setup.kinds import Kind, kinds_of_pairs
from rdpm.studies.measures import MEASURES, QUANTITIES

__all__ = ["Probed", "columns", "dry_design", "first_kind", "probed", "work_fraction"]

#: Part of the time to the first contact at which the runs of N_c begin, and runs that need no contact end.
BEFORE_CONTACT = 0.93

#: Runs in which a kiss, or the last contact and the tumbling, counts go on by so much beyond the one seen first.
AFTER_KISS, AFTER_TUMBLE = 1.05, 1.1


@dataclass(frozen=True)
class Probed:
    """What one run showed of a case.

    Attributes
    ----------
    kind : {"kiss", "wall", "other"}
    measure, outcome : str
        Columns of `QUANTITIES` to find the time step and the contact steps by.
    contact_s : float
        First contact.
    measured_s, judged_s : float
        When `measure` is known; when `outcome` is and all contacts have ended.
    overlap_fraction : float
        Largest of the run, with contacts of `contact_time_s`.
    contact_time_s : float
    impact_speed_m_s : float or None
        Largest of all touches.
    """

    kind: str
    measure: str
    outcome: str
    contact_s: float
    measured_s: float
    judged_s: float
    overlap_fraction: float
    contact_time_s: float
    impact_speed_m_s: float | None


def columns(run: Run) -> dict[str, float | None]:
    """All measures of a run: the columns of `rdpm.studies.measures.QUANTITIES`."""
    found: dict[str, float | None] = dict.fromkeys(QUANTITIES)
    for group in MEASURES.values():
        found |= group(run)
    return found


def probed(run: Run) -> Probed | None:
    """Look at a run of a case.

    Parameters
    ----------
    run : Run

    Returns
    -------
    Probed or None
        None where nothing touched.

    Notes
    -----
    A pair that kisses is measured by its kiss time and judged by the start of tumbling (by the last angle where it does
    not tumble); a body that rebounds from a wall by the height of the rebound; anything else by the settling speed
    until shortly before the first contact, and by the mean one of the whole run. A run may end before the case does
    where the pair has tumbled and no contact came after.
    """
    rows = run.contacts
    if rows is None or not rows["start_s"].size:
        return None
    found = columns(run)
    n = int(np.argmin(rows["start_s"]))
    contact = float(rows["start_s"][n])
    end = float(run.summary.time_s or contact)
    kiss, tumble, judged = found["kiss_time_s"], found["tumble_start_s"], end
    if kiss is not None and rows["j"][n] >= 0:
        kind, measure, outcome, known = "kiss", "kiss_time_s", "final_angle_deg", min(end, AFTER_KISS * kiss)
        if tumble is not None:
            outcome = "tumble_start_s"
            judged = min(end, AFTER_TUMBLE * max(tumble, float(np.max(rows["start_s"] + rows["duration_s"]))))
    elif found["rebound_height_m"] is not None and rows["j"][n] < 0:
        kind, measure, outcome, known = "wall", "rebound_height_m", "rebound_height_m", end
    else:
        kind, measure, outcome = "other", "settling_speed_max_m_s", "settling_speed_mean_m_s"
        known = BEFORE_CONTACT * contact
    return Probed(
        kind, measure, outcome, contact, known, judged, float(found["max_overlap_fraction"] or 0.0),
        float(run.summary.contact.contact_time_s or 0.0), found["max_impact_speed_m_s"],
    )


def work_fraction(run: Run) -> float | None:
    r"""Largest work of a contact force on its pair, over the energy that the contact turned over.

    Parameters
    ----------
    run : Run

    Returns
    -------
    float or None, [-]
        Above 0 a contact made energy. The energy is that of the impact, :math:`m_{ij} v^2/2`, or that of the spring at
        the largest overlap where this is more, as in a contact in which a flow presses the bodies together. None
        without contacts.
    """
    rows = run.contacts
    pair = run.summary.contact.pairs[0] if run.summary.contact.pairs else None
    if rows is None or not rows["start_s"].size or pair is None or not pair.reduced_mass_kg:
        return None
    mass = np.array([design.sphere_mass(b.diameter_m or 0.0, b.density_kg_m3 or 0.0) for b in run.summary.bodies])
    i, j = rows["i"].astype(int), rows["j"].astype(int)
    own, other = mass[i], np.where(j >= 0, mass[np.maximum(j, 0)], np.inf)
    reduced = 1.0 / (1.0 / own + 1.0 / other)
    diameter = np.where(j >= 0, np.minimum(run.diameter[i], run.diameter[np.maximum(j, 0)]), run.diameter[i])
    # contacts of equal duration and restitution: stiffness is as the reduced mass
    stiffness = (pair.stiffness_N_m or 0.0) / pair.reduced_mass_kg * reduced
    impact = 0.5 * reduced * np.nan_to_num(rows["impact_speed_m_s"]) ** 2
    spring = 0.5 * stiffness * (rows["max_overlap_fraction"] * diameter) ** 2
    energy = np.maximum(impact, spring)
    met = energy > 0.0
    return float(np.max(rows["work_J"][met] / energy[met])) if met.any() else 0.0


def first_kind(case: Case, is_wall: bool) -> Kind:
    """The kind of pair whose contact is reported: the lightest of the kind that touches first."""
    kinds = kinds_of_pairs(case)
    wanted = "sphere-wall" if is_wall else "sphere-sphere"
    return next((kind for kind in kinds if kind.name.startswith(wanted)), kinds[0])


def dry_design(
    case: Case, kind: Kind, restitution: float, contact_steps: float, dt: float, speed: float | None
) -> design.Design:
    """What ``rdpm design`` gives for a contact at a speed that is known before any run.

    Parameters
    ----------
    case : Case
    kind : Kind
    restitution, contact_steps : float, [-]
    dt : float, [s]
    speed : float or None, [m/s]
        Of the impact; the terminal velocity of one sphere, in ``rdpm design``.
    """
    fluid: Mapping[str, Any] = {}
    if case.fluid is not None:
        fluid = {"fluid_density": case.fluid.density, "viscosity": case.fluid.mu}
    second = kind.second
    return design.soft_sphere(
        diameter=kind.first[0], density=kind.first[1], diameter2=second[0] if second else None,
        density2=second[1] if second else None, wall=second is None, restitution=restitution,
        contact_steps=contact_steps, time_step=dt, ending=case.contact.ending, impact_speed=speed or None,
        overlap_limit=case.contact.overlap_warning, gravity=float(np.linalg.norm(case.domain.gravity)), **fluid,
    )  # fmt: skip
