"""The contacts of a case: its kinds of pairs, the law between them, and the longest step they allow."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rdpm import design
from rdpm.config.case import Case
from rdpm.contacts import ContactLaw, HardSphere, SoftSphere
from rdpm.design.verdicts import LEAST_CONTACT_STEPS

__all__ = [
    "AUTO_OVERLAP",
    "MOST_GROUPS",
    "REST_HEIGHT",
    "Kind",
    "PairKind",
    "contact_law",
    "contact_limit",
    "hard_sphere",
    "kinds_of_pairs",
    "pairs",
]

#: Dry overlap at the bodies' own speed, of the diameter, that an automatic step may lead to; wet kisses stay far below.
AUTO_OVERLAP = 0.025

#: Different bodies up to which every kind of pair is told apart.
MOST_GROUPS = 4

#: Rise of a rebound, over the smallest diameter, below which a pair is at rest where the case does not say.
REST_HEIGHT = 1e-5

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class PairKind:
    """A kind of pair and the contact it will have.

    Parameters
    ----------
    kind : str
        "sphere-sphere" or "sphere-wall", with the groups where there are several.
    design : Design
        The numbers, from the one module that computes them.
    """

    kind: str
    design: design.Design


@dataclass(frozen=True)
class Kind:
    """Two spheres, or a sphere and a wall.

    Parameters
    ----------
    name : str
    first : tuple of float, [m], [kg/m^3]
        Diameter and density.
    second : tuple of float, optional
        Of the other sphere; None for a wall.
    """

    name: str
    first: tuple[float, float]
    second: tuple[float, float] | None = None

    @property
    def reduced_mass(self) -> float:
        """The body's own mass against a wall [kg]."""
        own = float(design.sphere_mass(*self.first))
        return own if self.second is None else float(design.reduced_mass(own, design.sphere_mass(*self.second)))

    @property
    def diameter(self) -> float:
        """The smaller one [m]."""
        return self.first[0] if self.second is None else min(self.first[0], self.second[0])


def kinds_of_pairs(case: Case) -> list[Kind]:
    """List every kind of pair; of many different bodies only the lightest's and the heaviest's, between which all lie.

    Parameters
    ----------
    case : Case

    Returns
    -------
    list of Kind
        Empty without bodies, and where a lone body has no wall to meet.
    """
    bodies = case.expanded_bodies()
    if not len(bodies):
        return []
    rows, counts = np.unique(np.stack([bodies.diameter, bodies.density], axis=1), axis=0, return_counts=True)
    order = np.argsort(design.sphere_mass(rows[:, 0], rows[:, 1]), kind="stable")
    groups = [(float(rows[n, 0]), float(rows[n, 1])) for n in order]
    alone = {groups[n] for n, k in enumerate(order) if counts[k] < 2}
    is_many = len(groups) > MOST_GROUPS
    if is_many:
        groups, alone = [groups[0], groups[-1]], set()
    size = "" if len(groups) == 1 else " ({:.4g} mm, {:.4g} mm)"
    found: list[Kind] = []
    for a, one in enumerate(groups):
        partners = [one] if is_many else groups[a:]
        found.extend(
            Kind("sphere-sphere" + size.format(1e3 * one[0], 1e3 * other[0]), one, other)
            for other in partners
            if other != one or one not in alone
        )
        if any(kind != "periodic" for kind in case.domain.kinds):
            found.append(Kind("sphere-wall" + (f" ({1e3 * one[0]:.4g} mm)" if size else ""), one))
    return found


def contact_limit(case: Case, kinds: list[Kind], fall: float) -> float:
    """Longest time step the contacts allow.

    Parameters
    ----------
    case : Case
    kinds : list of Kind
    fall : float, [m/s]
        Impact speed in the worst case.

    Returns
    -------
    float, [s]
        inf without pairs, and at rest where the contact time follows the step.
    """
    if not kinds or case.contact.model == "hard-sphere":
        return math.inf
    mass, diameter = _columns(kinds)
    contact = case.contact
    if contact.way != "contact-steps":
        law = _soft_sphere(case, math.nan)
        return float(law.resolved_time(mass, diameter).min()) / LEAST_CONTACT_STEPS
    if fall == 0.0:
        return math.inf
    # Contact time in which a dry impact at the bodies' own speed reaches the overlap allowed.
    e = max(float(contact.restitution or 1.0), 1e-3)
    longest = design.largest_contact_time(e, AUTO_OVERLAP * float(diameter.min()), fall, contact.ending)
    return float(longest) / float(contact.contact_steps or LEAST_CONTACT_STEPS)


def contact_law(case: Case, dt: float) -> ContactLaw:
    """Make the law of a case's contacts.

    Parameters
    ----------
    case : Case
    dt : float, [s]
        Time step, of which contacts may be a multiple; not used where the stiffness is given.

    Returns
    -------
    ContactLaw
    """
    return hard_sphere(case) if case.contact.model == "hard-sphere" else _soft_sphere(case, dt)


def hard_sphere(case: Case) -> HardSphere:
    """Make the law of a case of hard spheres.

    Parameters
    ----------
    case : Case

    Returns
    -------
    HardSphere
    """
    c = case.contact
    rest = c.rest_speed
    if rest is None:
        smallest = float(case.expanded_bodies().diameter.min(initial=math.inf))
        gravity = float(np.linalg.norm(case.domain.gravity))
        rest = math.sqrt(2.0 * gravity * REST_HEIGHT * smallest) if math.isfinite(smallest) else 0.0
    return HardSphere(float(c.restitution or 0.0), c.friction, c.tangential_restitution, rest, c.most_events)


def _soft_sphere(case: Case, dt: float) -> SoftSphere:
    c = case.contact
    ratio = c.tangential_ratio
    if ratio is None:
        ratio = float(design.ratio_from_poisson(c.poisson_ratio or 0.0))
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


def pairs(case: Case, kinds: list[Kind], law: ContactLaw, dt: float, fall: float) -> list[PairKind]:
    """Design the contact of each kind of pair.

    Parameters
    ----------
    case : Case
    kinds : list of Kind
    law : ContactLaw
    dt : float, [s]
        Time step.
    fall : float, [m/s]
        Impact speed in the worst case; 0 where none is known.

    Returns
    -------
    list of PairKind
        Empty for hard spheres: nothing of their contact is designed.
    """
    if not kinds or not isinstance(law, SoftSphere):
        return []
    stiffness, damping = law.normal(*_columns(kinds))
    fluid = {"fluid_density": case.fluid.density, "viscosity": case.fluid.mu} if case.fluid else {}
    return [
        PairKind(
            kind.name,
            design.soft_sphere(
                diameter=kind.first[0],
                density=kind.first[1],
                diameter2=kind.second[0] if kind.second else None,
                density2=kind.second[1] if kind.second else None,
                wall=kind.second is None,
                stiffness=float(k_n),
                damping=float(eta_n),
                time_step=dt,
                ending=case.contact.ending,
                impact_speed=fall or None,
                overlap_limit=case.contact.overlap_warning,
                gravity=float(np.linalg.norm(case.domain.gravity)),
                tangential_ratio=law.tangential_ratio,
                friction=case.contact.friction,
                **fluid,
            ),
        )
        for kind, k_n, eta_n in zip(kinds, stiffness, damping, strict=True)
    ]


def _columns(kinds: list[Kind]) -> tuple[Floats, Floats]:
    return np.array([kind.reduced_mass for kind in kinds]), np.array([kind.diameter for kind in kinds])
