"""How often a step forces and projects."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rdpm.contacts import ContactStep
from rdpm.particles.immersed import ImmersedBodies
from rdpm.particles.shared import SharedBodies

__all__ = ["outer_iterations"]

#: Of the contact impulse: what is left of it by the load and by lubrication. Below, the contact bears a load.
UNBALANCED = 0.5


def outer_iterations(
    contact: ContactStep, load: NDArray[np.float64], dt: float, immersed: ImmersedBodies | SharedBodies | None
) -> int:
    """Forcings and projections of a step: two in an impact.

    Forced once, the interior fluid of a body that contact reverses within some steps follows two or three steps late,
    and drags on the rebound. An impact is a contact that no load balances and that changes the body's velocity within
    the step by more than `Calibration.impact_threshold` of the speed at which that contact began. Whatever bears a
    weight, or moves elsewhere, is none, in any frame.

    Parameters
    ----------
    contact : ContactStep
    load : ndarray, (N, 6), [N], [N m]
        That the step began with.
    dt : float, [s]
    immersed : ImmersedBodies, SharedBodies or None
    """
    if immersed is None:
        return 1
    by_contact = np.linalg.norm(contact.contact_impulse, axis=1)
    unbalanced = np.linalg.norm(contact.impulse + dt * load[:, :3], axis=1)
    threshold = immersed.calibration.impact_threshold * contact.impact_speed * immersed.inertia[:, 0]
    is_impact = (by_contact > 0.0) & (unbalanced > UNBALANCED * by_contact) & (unbalanced > threshold)
    return 2 if is_impact.any() else 1
