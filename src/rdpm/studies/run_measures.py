"""Measures of any run, from its summary and tables."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from rdpm.results.run import Run

__all__ = ["contact_totals", "dkt_phases", "extremes"]


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
    """Phases of a settling pair: the values of ``dkt`` in the run's ``summary.json``.

    Returns
    -------
    dict
        ``drafting_time_s``, ``kiss_time_s``, ``kiss_duration_s``, ``kisses``, ``tumble_time_s``, ``final_angle_deg``;
        None where a phase did not happen, or there is no pair.
    """
    names = ("drafting_time_s", "kiss_time_s", "kiss_duration_s", "kisses", "tumble_time_s", "final_angle_deg")
    return {name: getattr(run.summary.dkt, name, None) for name in names}


def extremes(run: Run) -> dict[str, Any]:
    """Greatest speed of any body, and the smallest gap of any body to another or to a wall.

    Returns
    -------
    dict
        ``max_speed_m_s``, ``min_gap_m``.
    """
    speeds = [body.max_speed_m_s for body in run.summary.bodies if body.max_speed_m_s is not None]
    gaps = run.tracks.gap if run.tracks is not None else np.zeros(0)
    finite = gaps[np.isfinite(gaps)]
    return {
        "max_speed_m_s": max(speeds, default=None),
        "min_gap_m": float(finite.min()) if finite.size else None,
    }
