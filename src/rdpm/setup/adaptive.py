"""Adaptive collision time model of a case: the law, the longest step, the design of each kind of pair."""

from __future__ import annotations

from typing import Any

import numpy as np

from rdpm import design
from rdpm.config.case import Case
from rdpm.contacts import AdaptiveCollisionTime
from rdpm.setup.hertz import impact_speed
from rdpm.setup.kinds import Kind

__all__ = ["LEAST_SPEED", "adaptive_designs", "adaptive_law", "adaptive_limit"]

#: Of the impact speed in the worst case: slower touches have the stiffness of such an impact.
LEAST_SPEED = 1e-3


def adaptive_law(case: Case, dt: float, fall: float, tangential_ratio: float) -> AdaptiveCollisionTime:
    """Make the law of a case.

    Parameters
    ----------
    case : Case
    dt : float, [s]
        Time step.
    fall : float, [m/s]
        Impact speed in the worst case.
    tangential_ratio : float, [-]

    Returns
    -------
    AdaptiveCollisionTime
    """
    c = case.contact
    time, least = float(c.contact_steps or 0.0) * dt, LEAST_SPEED * impact_speed(case, fall)[0]
    return AdaptiveCollisionTime(float(c.restitution or 0.0), time, least, c.ending, c.friction, tangential_ratio)


def adaptive_limit(case: Case, kinds: list[Kind], fall: float, overlap: float) -> float:
    """Longest step with which an impact at the bodies' own speed stays within this overlap of the diameter [s]."""
    c, smallest = case.contact, min(kind.diameter for kind in kinds)
    e, speed = float(c.restitution or 0.0), impact_speed(case, fall)[0]
    deepest = design.adaptive_overlap(e, c.ending) / design.adaptive_collision(e, c.ending)[1]
    return overlap * smallest / (deepest * speed) / float(c.contact_steps or 1.0)


def adaptive_designs(case: Case, kinds: list[Kind], dt: float, fall: float) -> list[design.AdaptiveDesign]:
    """Design the contact of each kind of pair at the impact speed in the worst case."""
    c, speed = case.contact, impact_speed(case, fall)[0]
    fluid: dict[str, Any] = {"fluid_density": case.fluid.density, "viscosity": case.fluid.mu} if case.fluid else {}
    return [
        design.adaptive_design(
            **kind.named, **fluid,
            restitution=float(c.restitution or 0.0),
            contact_time=float(c.contact_steps or 0.0) * dt,
            impact_speed=speed,
            least_speed=LEAST_SPEED * speed,
            time_step=dt,
            gravity=float(np.linalg.norm(case.domain.gravity)),
            overlap_limit=c.overlap_warning,
            ending=c.ending,
        )
        for kind in kinds
    ]  # fmt: skip
