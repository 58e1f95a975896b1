"""Hertz contacts of a case: the law, the longest step, the design of each kind of pair."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from rdpm import design
from rdpm.config.case import Case
from rdpm.contacts import Hertz
from rdpm.design.verdicts import LEAST_CONTACT_STEPS
from rdpm.errors import CaseError
from rdpm.setup.kinds import Kind

__all__ = ["hertz_designs", "hertz_law", "hertz_limit", "impact_speed"]


def impact_speed(case: Case, fall: float) -> tuple[float, str]:
    """The impact speed in the worst case [m/s], and where it comes from."""
    if case.contact.impact_speed is not None:
        return float(case.contact.impact_speed), "as given"
    drop = 0.0
    if case.fluid is None:  # a free fall through the box, or until the end where it is periodic
        for g, length, kind in zip(case.domain.gravity, case.domain.size, case.domain.kinds, strict=True):
            drop += 2.0 * abs(g) * length if kind != "periodic" else (g * case.time.end) ** 2
    speed = math.hypot(fall, math.sqrt(drop))
    if speed == 0.0:
        raise CaseError(
            "contact.impact_speed", None, f'is missing for model = "{case.contact.model}"',
            "no body moves or falls, and such a contact depends on the speed of its impact", "Give it.",
        )  # fmt: skip
    return speed, "the bodies' own" if drop == 0.0 else "of a fall through the box"


def hertz_law(case: Case, fall: float) -> Hertz:
    """Make the law of a case.

    Parameters
    ----------
    case : Case
    fall : float, [m/s]
        Impact speed in the worst case, where the case names none.

    Returns
    -------
    Hertz

    Raises
    ------
    CaseError
        No speed is known.
    """
    c, speed = case.contact, impact_speed(case, fall)[0]
    # The material is there: the case was refused without it.
    material = (float(c.youngs_modulus or 0.0), float(c.poisson_ratio or 0.0), float(c.restitution or 0.0))
    return Hertz(*material, speed, c.ending, c.friction)


def hertz_limit(case: Case, kinds: list[Kind], fall: float) -> float:
    """Longest step that gives every contact at the impact speed its least steps [s]."""
    mass = np.array([kind.reduced_mass for kind in kinds])
    radius = np.array([kind.reduced_radius for kind in kinds])
    return float(hertz_law(case, fall).resolved_time(mass, radius).min()) / LEAST_CONTACT_STEPS


def hertz_designs(case: Case, kinds: list[Kind], dt: float, fall: float) -> list[design.HertzDesign]:
    """Design the contact of each kind of pair at the impact speed."""
    c, (speed, source) = case.contact, impact_speed(case, fall)
    fluid: dict[str, Any] = {"fluid_density": case.fluid.density, "viscosity": case.fluid.mu} if case.fluid else {}
    return [
        design.hertz_design(
            **kind.named, **fluid,
            youngs_modulus=float(c.youngs_modulus or 0.0),
            poisson_ratio=float(c.poisson_ratio or 0.0),
            restitution=float(c.restitution or 0.0),
            impact_speed=speed,
            impact_speed_source=source,
            time_step=dt,
            gravity=float(np.linalg.norm(case.domain.gravity)),
            overlap_limit=c.overlap_warning,
            ending=c.ending,
        )
        for kind in kinds
    ]  # fmt: skip
