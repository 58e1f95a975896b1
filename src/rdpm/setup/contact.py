"""The contacts of a case: the law of its model, the longest step it allows, the design of each kind of pair."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rdpm import design
from rdpm.config.case import Case
from rdpm.contacts import ContactLaw, SoftSphere
from rdpm.design.verdicts import LEAST_CONTACT_STEPS
from rdpm.setup.adaptive import adaptive_designs, adaptive_law, adaptive_limit
from rdpm.setup.extended import extended
from rdpm.setup.hard_sphere import hard_sphere
from rdpm.setup.hertz import hertz_designs, hertz_law, hertz_limit
from rdpm.setup.kinds import Kind
from rdpm.setup.repulsive import repulsive_designs, repulsive_law, repulsive_limit

__all__ = ["AUTO_OVERLAP", "PairKind", "contact_law", "contact_limit", "pairs"]

#: Dry overlap at the bodies' own speed, of the diameter, that an automatic step may lead to; wet kisses stay far below.
AUTO_OVERLAP = 0.025

Floats = NDArray[np.float64]
AnyDesign: TypeAlias = design.Design | design.AdaptiveDesign | design.HertzDesign | design.RepulsiveDesign


@dataclass(frozen=True)
class PairKind:
    """A kind of pair and the contact it will have.

    Parameters
    ----------
    kind : str
        "sphere-sphere" or "sphere-wall", with the groups where there are several.
    design : Design, AdaptiveDesign, HertzDesign or RepulsiveDesign
        The numbers, from the one module that computes them.
    """

    kind: str
    design: AnyDesign


@dataclass(frozen=True)
class _Model:
    """What a model makes of a case: its longest step, its law, its designs."""

    limit: Callable[[Case, list[Kind], float, float], float]
    """Kinds of pairs, impact speed in the worst case, spacing of the grid."""
    law: Callable[[Case, float, float, float], ContactLaw]
    """Time step, impact speed, spacing."""
    designs: Callable[[Case, list[Kind], float, float, float], Sequence[AnyDesign]]
    """Kinds of pairs, time step, impact speed, spacing."""


def contact_limit(case: Case, kinds: list[Kind], fall: float, h: float) -> float:
    """Longest time step the contacts allow.

    Parameters
    ----------
    case : Case
    kinds : list of Kind
    fall : float, [m/s]
        Impact speed in the worst case.
    h : float, [m]
        Mean spacing of the grid.

    Returns
    -------
    float, [s]
        inf without pairs, and at rest where the contact time follows the step.
    """
    return _MODELS[case.contact.model].limit(case, kinds, fall, h) if kinds else math.inf


def contact_law(case: Case, dt: float, fall: float, h: float) -> ContactLaw:
    """Make the law of a case's contacts.

    Parameters
    ----------
    case : Case
    dt : float, [s]
        Time step, of which contacts may be a multiple; not used where the stiffness is given.
    fall : float, [m/s]
        Impact speed in the worst case.
    h : float, [m]
        Mean spacing of the grid.

    Returns
    -------
    ContactLaw
    """
    return extended(case, _MODELS[case.contact.model].law(case, dt, fall, h))


def pairs(case: Case, kinds: list[Kind], dt: float, fall: float, h: float) -> list[PairKind]:
    """Design the contact of each kind of pair.

    Parameters
    ----------
    case : Case
    kinds : list of Kind
    dt : float, [s]
        Time step.
    fall : float, [m/s]
        Impact speed in the worst case; 0 where none is known.
    h : float, [m]
        Mean spacing of the grid.

    Returns
    -------
    list of PairKind
        Empty for hard spheres: nothing of their contact is designed.
    """
    designs = _MODELS[case.contact.model].designs(case, kinds, dt, fall, h) if kinds else []
    if not designs:
        return []
    return [PairKind(kind.name, one) for kind, one in zip(kinds, designs, strict=True)]


def _soft_sphere_limit(case: Case, kinds: list[Kind], fall: float) -> float:
    mass, diameter = _columns(kinds)
    contact = case.contact
    if contact.way != "contact-steps":
        law = _soft_sphere_law(case, math.nan)
        return float(law.resolved_time(mass, diameter).min()) / LEAST_CONTACT_STEPS
    if contact.adaptive_collision_time:
        return adaptive_limit(case, kinds, fall, AUTO_OVERLAP)
    if fall == 0.0:
        return math.inf
    # Contact time in which a dry impact at the bodies' own speed reaches the overlap allowed.
    e = max(float(contact.restitution or 1.0), 1e-3)
    longest = design.largest_contact_time(e, AUTO_OVERLAP * float(diameter.min()), fall, contact.ending)
    return float(longest) / float(contact.contact_steps or LEAST_CONTACT_STEPS)


def _tangential_ratio(case: Case) -> float:
    c = case.contact
    if c.tangential_ratio is None:
        return float(design.ratio_from_poisson(c.poisson_ratio or 0.0))
    return c.tangential_ratio


def _soft_sphere_law(case: Case, dt: float) -> SoftSphere:
    c, ratio = case.contact, _tangential_ratio(case)
    # What a way needs is there: the case was refused without it.
    given = {name: float(getattr(c, name) or 0.0) for name in ("restitution", "stiffness", "impact_speed")}
    surface = (c.ending, c.friction, ratio)
    if c.way == "contact-steps":
        return SoftSphere.from_contact_time(given["restitution"], float(c.contact_steps or 0.0) * dt, *surface)
    if c.way == "max-overlap":
        overlap = float(c.max_overlap or 0.0)
        return SoftSphere.from_overlap(overlap, given["impact_speed"], given["restitution"], *surface)
    if c.way == "stiffness-damping":
        return SoftSphere.from_stiffness(given["stiffness"], c.damping, None, *surface)
    return SoftSphere.from_stiffness(given["stiffness"], None, given["restitution"], *surface)


def _soft_sphere_designs(case: Case, kinds: list[Kind], dt: float, fall: float) -> Sequence[AnyDesign]:
    if case.contact.adaptive_collision_time:
        return adaptive_designs(case, kinds, dt, fall)
    law = _soft_sphere_law(case, dt)
    stiffness, damping = law.normal(*_columns(kinds))
    fluid: dict[str, Any] = {"fluid_density": case.fluid.density, "viscosity": case.fluid.mu} if case.fluid else {}
    return [
        design.soft_sphere(
            **kind.named,
            **fluid,
            stiffness=float(k_n),
            damping=float(eta_n),
            time_step=dt,
            ending=case.contact.ending,
            impact_speed=fall or None,
            overlap_limit=case.contact.overlap_warning,
            gravity=float(np.linalg.norm(case.domain.gravity)),
            tangential_ratio=law.tangential_ratio,
            friction=case.contact.friction,
        )
        for kind, k_n, eta_n in zip(kinds, stiffness, damping, strict=True)
    ]


def _columns(kinds: list[Kind]) -> tuple[Floats, Floats]:
    return np.array([kind.reduced_mass for kind in kinds]), np.array([kind.diameter for kind in kinds])


_MODELS = {
    "soft-sphere": _Model(
        lambda case, kinds, fall, h: _soft_sphere_limit(case, kinds, fall),
        lambda case, dt, fall, h: (
            adaptive_law(case, dt, fall, _tangential_ratio(case))
            if case.contact.adaptive_collision_time
            else _soft_sphere_law(case, dt)
        ),
        lambda case, kinds, dt, fall, h: _soft_sphere_designs(case, kinds, dt, fall),
    ),
    "hertz": _Model(
        lambda case, kinds, fall, h: hertz_limit(case, kinds, fall),
        lambda case, dt, fall, h: hertz_law(case, fall),
        lambda case, kinds, dt, fall, h: hertz_designs(case, kinds, dt, fall),
    ),
    "hard-sphere": _Model(
        lambda case, kinds, fall, h: math.inf, lambda case, dt, fall, h: hard_sphere(case),
        lambda case, kinds, dt, fall, h: [],
    ),
    "repulsive": _Model(
        lambda case, kinds, fall, h: repulsive_limit(case, kinds, h),
        lambda case, dt, fall, h: repulsive_law(case, h),
        lambda case, kinds, dt, fall, h: repulsive_designs(case, kinds, dt, fall, h),
    ),
}
