"""What acted on each body in a step, by what exerted it."""

from __future__ import annotations

import numpy as np

from rdpm.contacts import ContactStep
from rdpm.particles.immersed import ImmersedBodies
from rdpm.particles.shared import SharedBodies
from rdpm.particles.state import Bodies

__all__ = ["keep_loads"]


def keep_loads(bodies: Bodies, contact: ContactStep, immersed: ImmersedBodies | SharedBodies | None, dt: float) -> None:
    r"""Change the loads of the bodies to those of the step just done.

    For a free body :math:`m\,\Delta U = \delta t\,(F_{hydrodynamic} + F_{lubrication} + F_{collision} + B)` holds to
    round-off, with weight less buoyancy B; likewise its angular velocity.

    Parameters
    ----------
    bodies : Bodies
    contact : ContactStep
    immersed : ImmersedBodies, SharedBodies or None
        None in a dry case.
    dt : float, [s]
    """
    if immersed is not None:
        np.copyto(bodies.hydrodynamic_force, immersed.hydrodynamic_force)
        np.copyto(bodies.hydrodynamic_torque, immersed.hydrodynamic_torque)
    np.divide(contact.lubrication_impulse, dt, out=bodies.lubrication_force)
    np.divide(contact.contact_impulse, dt, out=bodies.collision_force)
    np.divide(contact.lubrication_angular_impulse, dt, out=bodies.lubrication_torque)
    np.divide(contact.contact_angular_impulse, dt, out=bodies.collision_torque)
