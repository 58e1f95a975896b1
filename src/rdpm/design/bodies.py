"""Who meets whom, and how fast: the bodies of a contact as far as a user knows them."""

from __future__ import annotations

import math
from dataclasses import dataclass

from rdpm.design._checks import not_negative, positive
from rdpm.design.dimensionless import reduced_mass, sphere_mass, terminal_velocity
from rdpm.design.hertz import reduced_radius
from rdpm.design.overlap import submerged_weight
from rdpm.errors import CaseError

__all__ = ["Impact", "Pair", "read_impact", "read_pair"]


@dataclass(frozen=True)
class Pair:
    """The two bodies of a contact, as far as they are known (SI)."""

    mass: float | None
    diameter: float | None
    spheres: tuple[tuple[float, float], ...]
    """(diameter, density) of each sphere; empty where unknown."""
    radius: float | None
    """Reduced."""


def read_pair(
    mass: float | None,
    diameter: float | None,
    density: float | None,
    diameter2: float | None,
    density2: float | None,
    wall: bool,
) -> Pair:
    """Read the bodies; equal spheres unless a wall or a second sphere is named."""
    for name, value in (("mass", mass), ("diameter", diameter), ("density", density),
                        ("diameter2", diameter2), ("density2", density2)):  # fmt: skip
        if value is not None:
            positive(name, value)
    if diameter is None:
        if density is not None or diameter2 is not None or density2 is not None:
            raise CaseError("diameter", None, "must be given", "a density makes no mass", "Add diameter.")
        return Pair(mass, None, (), None)
    if wall and (diameter2 is not None or density2 is not None):
        raise CaseError("wall", True, "cannot go with diameter2 or density2", "", "Take one of them away.")
    if mass is not None and (density is not None or diameter2 is not None or density2 is not None):
        reason = "the mass follows from diameters and densities"
        raise CaseError(
            "mass", f"{mass:g}", "cannot go with a density or a second sphere", reason, "Drop it."
        )
    other = math.inf if wall else 0.5 * (diameter2 or diameter)
    radius = float(reduced_radius(0.5 * diameter, other))
    if mass is not None:
        density = (mass if wall else 2.0 * mass) / float(sphere_mass(diameter, 1.0))
        return Pair(mass, diameter, ((diameter, density),), radius)
    smaller = min(diameter, diameter2 or diameter)
    if density is None:
        return Pair(None, smaller, (), radius)
    spheres = [(diameter, density)]
    other_mass = math.inf
    if not wall:
        spheres.append((diameter2 or diameter, density2 or density))
        other_mass = float(sphere_mass(*spheres[1]))
    m = float(reduced_mass(sphere_mass(*spheres[0]), other_mass))
    return Pair(m, smaller, tuple(spheres), radius)


@dataclass(frozen=True)
class Impact:
    """How the bodies meet (SI, None where unknown)."""

    speed: float | None
    source: str | None
    terminal_velocity: float | None
    terminal_reynolds: float | None
    weight: float | None


def read_impact(
    pair: Pair, speed: float | None, fluid_density: float | None, viscosity: float | None, gravity: float
) -> Impact:
    """Take the impact speed given, else the terminal velocity of the faster sphere."""
    not_negative("gravity", gravity)
    for name, value in (("fluid_density", fluid_density), ("viscosity", viscosity), ("impact_speed", speed)):
        if value is not None:
            positive(name, value)
    if not pair.spheres:
        return Impact(speed, None if speed is None else "given", None, None, None)
    weight = max(float(submerged_weight(d, rho, fluid_density or 0.0, gravity)) for d, rho in pair.spheres)
    fall, re = None, None
    if fluid_density is not None and viscosity is not None:
        falls = [terminal_velocity(d, rho, fluid_density, viscosity, gravity) for d, rho in pair.spheres]
        fall, re = max((float(v), float(r)) for v, r in falls)
    source = None if speed is None else "given"
    if speed is None and fall:
        speed, source = fall, "terminal velocity (Brown, Lawler 2003)"
    return Impact(speed, source, fall, re, weight)
