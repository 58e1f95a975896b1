"""Impacts: how often a step forces and projects, and bodies that the fluid does not act on."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rdpm.contacts import ContactStep
from rdpm.coupling.system import System
from rdpm.particles.immersed import ImmersedBodies
from rdpm.particles.shared import SharedBodies

__all__ = ["outer_iterations", "set_by_contact"]

#: Of the contact impulse: what is left of it by the load and by lubrication. Below, the contact bears a load.
UNBALANCED = 0.5

#: Stokes number of the touch below which the fluid acts in a contact always: Biegert et al. 2017, section 5.1.
LEAST_STOKES_NUMBER = 5.0


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
    return 2 if _in_impact(contact, load, dt, immersed).any() else 1


def set_by_contact(
    system: System, contact: ContactStep, load: NDArray[np.float64], before: NDArray[np.float64], dt: float
) -> NDArray[np.bool_] | None:
    """Change the velocities of free bodies in an impact to what weight, contact and lubrication alone give.

    They have the inertia that contacts act on. A touch of a Stokes number below 5 is no impact here.
    None where the fluid acts on all bodies; else which those are, (N,).
    `before` are velocities and angular velocities at the beginning of the step, (N, 6).
    """
    if system.has_fluid_force_in_impact or system.immersed is None:
        return None
    bodies, inertia, fluid = system.bodies, system.inertia, system.fluid
    assert fluid is not None
    stokes = bodies.density * contact.impact_speed * bodies.diameter / (9.0 * fluid.density * fluid.kinematic_viscosity)
    which = _in_impact(contact, load, dt, system.immersed) & bodies.is_free & (stokes > LEAST_STOKES_NUMBER)
    linear = (contact.impulse + dt * system.weight) / inertia[:, :1]
    np.copyto(bodies.velocity, before[:, :3] + linear, where=which[:, None])
    np.copyto(bodies.angular_velocity, before[:, 3:] + contact.angular_impulse / inertia[:, 1:], where=which[:, None])
    return which


def _in_impact(
    contact: ContactStep, load: NDArray[np.float64], dt: float, immersed: ImmersedBodies | SharedBodies | None
) -> NDArray[np.bool_]:
    """Of each body, (N,)."""
    if immersed is None:
        return np.zeros(len(load), bool)
    by_contact = np.linalg.norm(contact.contact_impulse, axis=1)
    unbalanced = np.linalg.norm(contact.impulse + dt * load[:, :3], axis=1)
    threshold = immersed.calibration.impact_threshold * contact.impact_speed * immersed.inertia[:, 0]
    found: NDArray[np.bool_] = (by_contact > 0.0) & (unbalanced > UNBALANCED * by_contact) & (unbalanced > threshold)
    return found
