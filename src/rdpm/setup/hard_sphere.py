"""Hard spheres of a case: their law."""

from __future__ import annotations

import math

import numpy as np

from rdpm.config.case import Case
from rdpm.contacts import HardSphere

__all__ = ["REST_HEIGHT", "hard_sphere"]

#: Rise of a rebound, over the smallest diameter, below which a pair is at rest where the case does not say.
REST_HEIGHT = 1e-5


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
