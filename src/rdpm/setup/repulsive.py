"""Repulsive force of a case: the law, the longest step, the design of each kind of pair."""

from __future__ import annotations

from typing import Any

import numpy as np

from rdpm import design
from rdpm.config.case import Case
from rdpm.contacts import Repulsive
from rdpm.design.verdicts import LEAST_CONTACT_STEPS
from rdpm.setup.kinds import Kind

__all__ = ["RANGE_IN_CELLS", "repulsive_designs", "repulsive_law", "repulsive_limit"]

#: Range of the force where none is given, in cells of the grid.
RANGE_IN_CELLS = 2.0


def repulsive_law(case: Case, h: float) -> Repulsive:
    """Make the law of a case.

    Parameters
    ----------
    case : Case
    h : float, [m]
        Mean spacing of the grid; the range is two of it where the case gives none.

    Returns
    -------
    Repulsive
    """
    c = case.contact
    # A dry case was refused without a range, any without a stiffness.
    return Repulsive(float(c.repulsion_stiffness or 0.0), c.repulsion_range or RANGE_IN_CELLS * h)


def repulsive_limit(case: Case, kinds: list[Kind], h: float) -> float:
    """Longest step that gives the force of every kind of pair its least steps [s]."""
    law, mass = repulsive_law(case, h), np.array([kind.reduced_mass for kind in kinds])
    return float(np.min(design.repulsion_time(mass, law.stiffness, law.range))) / LEAST_CONTACT_STEPS


def repulsive_designs(
    case: Case, kinds: list[Kind], dt: float, fall: float, h: float
) -> list[design.RepulsiveDesign]:
    """Design the force for each kind of pair."""
    law = repulsive_law(case, h)
    fluid: dict[str, Any] = {"fluid_density": case.fluid.density, "viscosity": case.fluid.mu} if case.fluid else {}
    return [
        design.repulsive_design(
            **kind.named, **fluid,
            range=law.range,
            stiffness=law.stiffness,
            impact_speed=fall or None,
            time_step=dt,
            gravity=float(np.linalg.norm(case.domain.gravity)),
        )
        for kind in kinds
    ]  # fmt: skip
