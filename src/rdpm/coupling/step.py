"""One step of the coupled system, in the order of the algorithm."""

from __future__ import annotations

import numpy as np

from rdpm.contacts import nearest_gaps
from rdpm.coupling.impacts import outer_iterations, set_by_contact
from rdpm.coupling.loads import keep_loads
from rdpm.coupling.system import System

__all__ = ["step"]


def step(system: System, dt: float, is_isolated: bool = False) -> None:
    """Advance the system by dt [s]; `is_isolated`: no two surfaces are near each other."""
    bodies, contacts, fluid, immersed, watch = (
        system.bodies, system.contacts, system.fluid, system.immersed, system.watch
    )  # fmt: skip
    system.prescription.hold(bodies, system.time, dt)
    before, load = bodies.velocities, system.load
    contact = contacts.advance(system.time, dt, load[:, :3], load[:, 3:], *system.inertia.T)
    # Positions are those of the new time; velocities are a dry prediction; impulses of contact are known.
    system.prescription.set(bodies, system.time + dt)
    impulse = np.concatenate([contact.impulse, contact.angular_impulse], axis=1)
    given = set_by_contact(system, contact, load, before, dt)
    watch.lap("contacts")

    if fluid is not None and system.mean_flow is not None:
        unretained = 0.0
        if immersed is not None:
            immersed.move(fluid, dt, contacts.close_pairs)
            # Markers, stencils and lagged forces have moved with the bodies; markers near other surfaces are reduced.
            unretained = immersed.spread_lagged_force(fluid, dt, is_isolated)
            # The lagged forces are a source of the prediction.
            watch.lap("bodies")
        uniform = system.mean_flow.begin(dt, system.force_on_fluid)
        fluid.predict(dt, uniform, time=system.time)
        if immersed is not None:
            immersed.remove_unretained_force(fluid, dt, unretained)
        # u, v, w are the new velocity but for the change of forcing and of pressure.
        watch.lap("momentum")
        for _ in range(outer_iterations(contact, load, dt, immersed)):
            if immersed is not None:
                immersed.impose_no_slip(fluid, dt, before, impulse, given)
                # The fluid at the markers moves with the bodies; Newton and Euler hold with that forcing.
                watch.lap("bodies")
            fluid.project(dt)
            # u is divergence-free and its halos are current.
            watch.lap("poisson")
        if immersed is not None:
            immersed.close(fluid, dt, before, impulse)
            # The interior momentum is that of the final velocity; the load of the next step is known.
            watch.lap("bodies")
        system.mean_flow.end(dt, uniform, system.force_on_fluid)

    keep_loads(bodies, contact, immersed, dt)
    system.last_contact = contact
    system.time += dt
    system.steps += 1
    system.prescription.release(bodies, system.time, dt, lambda: nearest_gaps(bodies, contacts.box)[0])
