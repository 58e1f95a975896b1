"""Measures of any run, from its summary and tables."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from rdpm.results.run import Run

__all__ = ["contact_totals", "dkt_phases", "end_state", "extremes", "rebound"]


def contact_totals(run: Run) -> dict[str, Any]:
    """Number, length and depth of the mechanical contacts, and the first one's speeds.

    Returns
    -------
    dict
        ``contacts``, ``contact_total_time_s``, ``max_overlap_fraction`` [-]; of the first contact
        ``first_impact_speed_m_s``, ``first_rebound_speed_m_s``, ``first_restitution`` [-], ``first_stokes_number``
        [-], ``first_contact_duration_s``: None where there was none.
    """
    totals = run.summary.contacts
    found: dict[str, Any] = {
        "contacts": totals.count,
        "contact_total_time_s": totals.total_time_s,
        "max_overlap_fraction": totals.max_overlap_fraction,
    }
    first = None
    if run.contacts is not None:
        first = int(np.argmin(run.contacts["start_s"]))
    for column, name in (
        ("first_impact_speed_m_s", "impact_speed_m_s"),
        ("first_rebound_speed_m_s", "rebound_speed_m_s"),
        ("first_restitution", "restitution"),
        ("first_stokes_number", "stokes_number"),
        ("first_contact_duration_s", "duration_s"),
    ):
        value = float(run.contacts[name][first]) if run.contacts is not None and first is not None else None
        found[column] = value if value is not None and np.isfinite(value) else None
    return found


def dkt_phases(run: Run) -> dict[str, Any]:
    """Phases of a settling pair, as in ``dkt`` of a run's ``summary.json``; with the common start, if there is one.

    Returns
    -------
    dict
        ``drafting_time_s``, ``kiss_time_s``, ``kiss_duration_s``, ``kisses``, ``tumble_time_s``, ``final_angle_deg``;
        None where a phase did not happen, or there is no pair.
    """
    names = ("drafting_time_s", "kiss_time_s", "kiss_duration_s", "kisses", "tumble_time_s", "final_angle_deg")
    return {name: getattr(run.phases, name, None) for name in names}


def extremes(run: Run) -> dict[str, Any]:
    """Greatest speed of any body, and the smallest gap of any body to another or to a wall.

    Returns
    -------
    dict
        ``max_speed_m_s``, ``min_gap_m``.
    """
    speeds = [body.max_speed_m_s for body in run.summary.bodies if body.max_speed_m_s is not None]
    if run.tracks is not None and run.tracks.times.size:  # before a common checkpoint, at the times of the table
        speeds.append(float(np.linalg.norm(run.tracks.velocity, axis=-1).max()))
    gaps = run.tracks.gap if run.tracks is not None else np.zeros(0)
    finite = gaps[np.isfinite(gaps)]
    return {
        "max_speed_m_s": max(speeds, default=None),
        "min_gap_m": float(finite.min()) if finite.size else None,
    }


def end_state(run: Run) -> dict[str, Any]:
    """Where the run ended.

    Returns
    -------
    dict
        ``end_gap_m``, the smallest of any body; ``end_speed_m_s``, the greatest; ``end_height_m``, the lowest centre.
    """
    tracks = run.tracks
    if tracks is None or not tracks.times.size:
        return {"end_gap_m": None, "end_speed_m_s": None, "end_height_m": None}
    gaps = tracks.gap[-1][np.isfinite(tracks.gap[-1])]
    return {
        "end_gap_m": float(gaps.min()) if gaps.size else None,
        "end_speed_m_s": float(np.linalg.norm(tracks.velocity[-1], axis=-1).max()),
        "end_height_m": float(tracks.position[-1, :, 2].min()),
    }


def rebound(run: Run) -> dict[str, Any]:
    """Rebound of a single body that falls along z onto a wall.

    Returns
    -------
    dict
        ``approach_speed_m_s``, the greatest downwards; ``rebound_speed_m_s``, the greatest upwards after that, 0 where
        it did not rise; ``wet_restitution`` [-], their ratio; ``approach_stokes_number`` [-], with the body's density,
        None in a dry case.
    """
    names = ("approach_speed_m_s", "rebound_speed_m_s", "wet_restitution", "approach_stokes_number")
    tracks = run.tracks
    if tracks is None or tracks.count != 1 or not tracks.times.size:
        return dict.fromkeys(names)
    speed = tracks.velocity[:, 0, 2]
    lowest = int(np.argmin(speed))
    approach, back = -float(speed[lowest]), max(0.0, float(speed[lowest:].max()))
    if approach <= 0.0:
        return dict.fromkeys(names)
    fluid, density = run.case.get("fluid"), run.summary.bodies[0].density_kg_m3
    stokes = None
    if fluid is not None and density is not None:
        viscosity = fluid.get("viscosity") or fluid["kinematic_viscosity"] * fluid["density"]
        stokes = density * float(run.diameter[0]) * approach / (9.0 * viscosity)
    return dict(zip(names, (approach, back, back / approach, stokes), strict=True))
