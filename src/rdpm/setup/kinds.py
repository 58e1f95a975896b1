"""Kinds of pairs of a case: which spheres may meet, and walls."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from rdpm import design
from rdpm.config.case import Case

__all__ = ["MOST_GROUPS", "Kind", "kinds_of_pairs"]

#: Different bodies up to which every kind of pair is told apart.
MOST_GROUPS = 4


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
    def reduced_radius(self) -> float:
        """The body's own radius against a wall [m]."""
        other = math.inf if self.second is None else 0.5 * self.second[0]
        return float(design.reduced_radius(0.5 * self.first[0], other))

    @property
    def named(self) -> dict[str, Any]:
        """Diameters, densities and wall under the names of the design functions."""
        named = {"diameter": self.first[0], "density": self.first[1], "wall": self.second is None}
        return named | ({"diameter2": self.second[0], "density2": self.second[1]} if self.second else {})

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
        if case.walls or any(kind in ("wall", "free-slip") for kind in case.domain.kinds):
            found.append(Kind("sphere-wall" + (f" ({1e3 * one[0]:.4g} mm)" if size else ""), one))
    return found
