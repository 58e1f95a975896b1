"""How often a step forces and projects."""

from __future__ import annotations

import numpy as np

from rdpm.contacts import ContactStep
from rdpm.particles.immersed import ImmersedBodies
from rdpm.particles.state import Bodies

__all__ = ["outer_iterations"]


def outer_iterations(bodies: Bodies, contact: ContactStep, immersed: ImmersedBodies | None) -> int:
    """Forcings and projections of a step: two in an impact.

    Forced once, the interior fluid of a body that contact reverses within some steps follows two or three steps late,
    and drags on the rebound. An impact is a contact that changes a velocity within the step by more than
    `Calibration.impact_threshold` of the fastest body's speed.
    """
    if immersed is None:
        return 1
    change = np.linalg.norm(contact.contact_impulse, axis=1) / bodies.mass
    speed = np.linalg.norm(bodies.velocity, axis=1)
    return 2 if change.size and change.max() > immersed.calibration.impact_threshold * speed.max() else 1
