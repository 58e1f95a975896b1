"""One step of the coupled system, in the order of the algorithm."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rdpm.contacts import Contacts, ContactStep, nearest_gaps
from rdpm.coupling.mean_flow import MeanFlow
from rdpm.coupling.timing import Stopwatch
from rdpm.fluid import Fluid, stages_for
from rdpm.particles.markers import MarkerSet
from rdpm.particles.prescribed import Prescription
from rdpm.particles.rigid_motion import RigidMotion
from rdpm.particles.state import Bodies

__all__ = ["System", "step"]

Floats = NDArray[np.float64]

#: An impact is a contact that changes a velocity within a step by more than this share of the fastest body's speed.
IMPACT = 0.02


@dataclass
class System:
    """Everything one step changes; fluid, markers, motion and mean_flow are None in a dry case."""

    bodies: Bodies
    contacts: Contacts
    prescription: Prescription
    held: Floats  # (N, 6) force and torque other than contact, held over the sub-steps
    fluid: Fluid | None = None
    markers: MarkerSet | None = None
    motion: RigidMotion | None = None
    mean_flow: MeanFlow | None = None
    time: float = 0.0
    steps: int = 0
    is_adaptive: bool = False  # steps are of any length, and of second order where they can be
    is_alone: bool = False  # no two surfaces are close to each other
    last_contact: ContactStep | None = None
    watch: Stopwatch = field(default_factory=Stopwatch)


def _rounds(bodies: Bodies, contact: ContactStep) -> int:
    """Rounds of forcing and projection: two in an impact.

    Forced once, the fluid inside a body that is turned round in some steps follows two or three steps late, and takes
    from the rebound what it is then dragged along with.
    """
    change = np.linalg.norm(contact.contact_impulse, axis=1) / bodies.mass
    speed = np.linalg.norm(bodies.velocity, axis=1)
    return 2 if change.size and change.max() > IMPACT * speed.max() else 1


def step(system: System, dt: float) -> None:
    """Advance the system by dt [s]: bodies, velocity, pressure, contact history and time change together."""
    bodies, fluid, motion, markers = system.bodies, system.fluid, system.motion, system.markers
    system.prescription.hold(bodies, system.time, dt)
    before = np.concatenate([bodies.velocity, bodies.angular_velocity], axis=1)
    inertia = motion.contact_inertia if motion else (bodies.mass, bodies.moment_of_inertia)
    contact = system.contacts.advance(system.time, dt, system.held[:, :3], system.held[:, 3:], *inertia)
    # Positions are those of the new time; velocities are a dry prediction; contact impulses of the step are known.
    system.prescription.set(bodies, system.time + dt)
    system.watch.lap("contacts")

    spare = 0.0
    if fluid is not None:
        if markers is not None and motion is not None:
            markers.place(bodies)
            # Markers, their stencils and kept forces have moved with the bodies.
            markers.stand_back(bodies, system.contacts.close_pairs(markers.reach), motion.kept_share(dt))
            spare = _spread_kept(system, markers, motion, fluid, dt)
            # The kept forces are a source of the prediction.
            system.watch.lap("bodies")
        force = system.mean_flow.force(dt, motion) if system.mean_flow else (0.0, 0.0, 0.0)
        fluid.predict(dt, stages_for(dt, fluid.grid.spacing, fluid.viscosity), force)
        if spare and markers is not None:
            markers.spread(fluid.velocity, markers.force, -spare * dt)
        # u, v, w are the new velocity but for the change of forcing and of pressure.
        system.watch.lap("momentum")
        impulse = np.concatenate([contact.impulse, contact.angular_impulse], axis=1)
        for _ in range(_rounds(bodies, contact)):
            if motion is not None:
                motion.force(dt, before, impulse)
                # The fluid at the markers moves with the bodies, which obey Newton and Euler with that forcing.
                system.watch.lap("bodies")
            fluid.project(dt)
            # u is divergence-free and its halos are current.
            system.watch.lap("poisson")
        if motion is not None:
            motion.close(dt)
            # The inner fluid's momentum is that of the final velocity.
            after = np.concatenate([bodies.velocity, bodies.angular_velocity], axis=1)
            answer = np.repeat(np.stack(inertia, axis=1), 3, axis=1)
            system.held = (answer * (after - before) - impulse) / dt
            system.watch.lap("bodies")

    system.last_contact = contact
    system.time += dt
    system.steps += 1
    if system.mean_flow:
        system.mean_flow.advance(dt, force, motion)
    system.prescription.release(bodies, system.time, lambda: nearest_gaps(bodies, system.contacts.box)[0])


def _spread_kept(system: System, markers: MarkerSet, motion: RigidMotion, fluid: Fluid, dt: float) -> float:
    """Spread the kept forces into the tendency; the share of them to be taken from the prediction again.

    Adaptive steps remove what is of first order in dt. The part of a force that is not kept acts at the end of a step,
    where explicit diffusion meets it whole in the next one but diffusion by stages does not, and drag would depend on
    dt: there the whole force is a source, and what is not kept is taken back after diffusion. A source acts in the
    middle of a step, and so, away from other surfaces, it stands where the body is then.
    """
    spare, factor = 0.0, -1.0 / fluid.weights(dt)[1]
    target = (fluid.tendency[0], fluid.tendency[1], fluid.tendency[2])
    if system.is_adaptive and not fluid.is_explicit and fluid.last_dt > 0.0:
        spare = 1.0 / motion.kept_share(fluid.last_dt) - 1.0
    if not (system.is_adaptive and system.is_alone):
        markers.spread(target, markers.force, (1.0 + spare) * factor)
        return spare
    bodies = system.bodies
    after = bodies.position.copy()
    bodies.position -= 0.5 * dt * bodies.velocity
    markers.place(bodies)
    markers.spread(target, markers.force, (1.0 + spare) * factor)
    np.copyto(bodies.position, after)
    markers.place(bodies)
    return spare
