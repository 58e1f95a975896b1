"""The immersed bodies: the one owner of markers, forcing, body equation and load."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm.fluid.state import Fluid
from rdpm.particles.calibration import CALIBRATION, Calibration
from rdpm.particles.markers import MarkerSet
from rdpm.particles.rigid_motion import RigidMotion
from rdpm.particles.state import Bodies
from rdpm.particles.walls import WallMarkers

__all__ = ["ImmersedBodies"]

Floats = NDArray[np.float64]
ClosePairs = Callable[[float], NDArray[np.int32]]


class ImmersedBodies:
    """Bodies that force no-slip upon a fluid, and move by what it does to them.

    A step calls, in this order, `move`, `spread_lagged_force`, `remove_unretained_force`, `impose_no_slip` (with a
    projection after each) and `close`.

    Parameters
    ----------
    bodies : Bodies
        Their velocities are changed by `impose_no_slip`.
    fluid : Fluid
        At the start of the run.
    gravity : ndarray, (3,), [m/s^2]
    calibration : Calibration
    has_variable_steps : bool
        Steps are of any length: what is of first order in it is removed from the lagged forcing.
    walls : WallMarkers, optional
        Of the walls within the box; made when left out.
    markers : MarkerSet, optional
        Made when left out; otherwise `begin` must follow, or a restored state.

    Attributes
    ----------
    markers : MarkerSet
    walls : WallMarkers
        Of the walls within the box.
    motion : RigidMotion
    load : ndarray, (N, 6), [N], [N m]
        Non-contact force and torque on each body, held over the sub-steps of the coming step.
    inertia : ndarray, (N, 2), [kg], [kg m^2]
        Mass and moment of inertia that contacts act on.
    slip : float, [m/s]
        Root mean square velocity change that the last forcing pass still made.
    pass_seconds : float, [s]
        Wall time spent in forcing passes so far.
    """

    def __init__(
        self,
        bodies: Bodies,
        fluid: Fluid,
        gravity: Floats,
        calibration: Calibration = CALIBRATION,
        has_variable_steps: bool = False,
        walls: WallMarkers | None = None,
        markers: MarkerSet | None = None,
    ) -> None:
        self.bodies, self.calibration, self.has_variable_steps = bodies, calibration, has_variable_steps
        self.markers = MarkerSet(bodies, fluid.grid, calibration) if markers is None else markers
        self.walls = WallMarkers(fluid.grid, calibration) if walls is None else walls
        self.motion = RigidMotion(bodies, fluid.density, self.markers.h, gravity, calibration)
        self.slip = self.pass_seconds = 0.0
        self.inertia, self.load = bodies.inertia, np.zeros((len(bodies), 6))
        if markers is None:
            self.markers.place(bodies.position, bodies.orientation)
            self.begin(fluid)

    def begin(self, fluid: Fluid) -> None:
        """Find what the first step begins with, the markers being placed."""
        bodies = self.bodies
        self.motion.interior = self.interior_momentum(fluid)
        self.inertia = self._contact_inertia()
        # In the first step weight less buoyancy moves body and added mass.
        accelerated = self.inertia[:, 0] / (bodies.mass + 0.5 * self.motion.fluid_mass)
        self.load[:, :3] = accelerated[:, None] * self.motion.weight

    @property
    def hydrodynamic_force(self) -> Floats:
        """Of the fluid on each body over the last step, without the hydrostatic part, (N, 3) [N]."""
        return self.motion.hydrodynamic_force

    @property
    def hydrodynamic_torque(self) -> Floats:
        """Likewise, (N, 3) [N m]."""
        return self.motion.hydrodynamic_torque

    @property
    def applied_force(self) -> Floats:
        """Of the bodies on the fluid over the last step, (N, 3) [N]."""
        return self.motion.applied_force

    @property
    def force_on_fluid(self) -> Floats:
        """Of bodies and walls together over the last step, (3,) [N]."""
        total: Floats = self.applied_force.sum(axis=0)
        return total + self.walls.force_on_fluid if len(self.walls) else total

    def interior_momentum(self, fluid: Fluid) -> Floats:
        """Momentum and angular momentum of the fluid inside each body, (N, 6) [kg m/s], [kg m^2/s]."""
        return self.motion.momentum(self.markers.interior_motion(fluid.velocity, self.bodies))

    def move(self, fluid: Fluid, dt: float, close_pairs: ClosePairs) -> None:
        """Move markers, stencils and lagged forces with the bodies; exclude markers near other surfaces.

        Parameters
        ----------
        fluid : Fluid
        dt : float, [s]
        close_pairs : callable
            Takes a gap [m], gives the pairs of surfaces nearer than that, (P, 2).
        """
        bodies, markers = self.bodies, self.markers
        markers.place(bodies.position, bodies.orientation)
        close = close_pairs(markers.exclusion_range)
        markers.exclude(bodies, close, self.retained_fraction(fluid, dt))
        if len(self.walls):
            self.walls.exclude(bodies, close, self.retained_fraction(fluid, dt))

    def spread_lagged_force(self, fluid: Fluid, dt: float, is_isolated: bool) -> float:
        """Spread the lagged forces into the fluid's tendency; returns the unretained part, a fraction of them.

        They are f_lag in eq. (3) of docs/theory/fluid.md.

        Variable steps remove what is of first order in dt. The part of a force that is not retained acts at the end of
        a step, where explicit diffusion meets it whole in the next one but diffusion by stages does not, and drag would
        depend on dt: there the whole force is a source, and the unretained part is removed after diffusion. A source
        acts in the middle of a step: away from other surfaces (`is_isolated`) it is placed where the body is then.
        """
        bodies, markers = self.bodies, self.markers
        unretained, factor = 0.0, -1.0 / fluid.weights(dt)[1]
        target = (fluid.tendency[0], fluid.tendency[1], fluid.tendency[2])
        if self.has_variable_steps and not fluid.is_explicit and fluid.last_dt > 0.0:
            unretained = 1.0 / self.retained_fraction(fluid, fluid.last_dt) - 1.0
        if self.has_variable_steps and is_isolated:
            markers.place(bodies.position - 0.5 * dt * bodies.velocity, bodies.orientation)
        markers.spread(target, markers.force, (1.0 + unretained) * factor)
        if len(self.walls):
            self.walls.begin(dt)
            self.walls.spread(target, (1.0 + unretained) * factor)
        if self.has_variable_steps and is_isolated:
            markers.place(bodies.position, bodies.orientation)
        return unretained

    def remove_unretained_force(self, fluid: Fluid, dt: float, unretained: float) -> None:
        """Change the predicted velocity: take back this fraction of the lagged forces' impulse."""
        if unretained:
            self.markers.spread(fluid.velocity, self.markers.force, -unretained * dt)
            if len(self.walls):
                self.walls.spread(fluid.velocity, -unretained * dt)

    def impose_no_slip(
        self, fluid: Fluid, dt: float, before: Floats, impulse: Floats, given: NDArray[np.bool_] | None = None
    ) -> None:
        """Change the fluid velocity to no-slip on the bodies, and the free bodies' velocities with it.

        Passes of eq. (6) of docs/theory/immersed_boundary.md, each after eq. (5) of docs/theory/rigid_motion.md. May be
        called again after a projection: it then adds what this took.

        Parameters
        ----------
        fluid : Fluid
        dt : float, [s]
        before : ndarray, (N, 6)
            Velocity and angular velocity at the beginning of the step.
        impulse : ndarray, (N, 6), [N s], [N m s]
            Of contacts and lubrication over the step.
        given : ndarray of bool, (N,), optional
            Free bodies that keep their velocities nevertheless: the fluid does not act on them.
        """
        bodies, markers, density = self.bodies, self.markers, fluid.density
        free = (bodies.is_free if given is None else bodies.is_free & ~given)[:, None]
        lagged, interior, layer = markers.before_forcing(fluid.velocity, bodies)
        lagged *= density * dt
        equation = self.motion.equation(dt, before, impulse, lagged, interior, layer)
        applied = np.zeros_like(lagged)
        began = perf_counter()
        for _ in range(self.calibration.forcing_passes):
            at_markers = density * markers.velocity_sums(fluid.velocity)
            solved = equation.solve(at_markers, applied)
            np.copyto(bodies.velocity, solved[:, :3], where=free)
            np.copyto(bodies.angular_velocity, solved[:, 3:], where=free)
            change, sums = markers.force_rigid(bodies, dt)
            applied += density * sums[:, :6]
            markers.spread(fluid.velocity, change, 1.0)
            if len(self.walls):
                self.walls.impose_no_slip(fluid.velocity, dt)
        self.pass_seconds += perf_counter() - began
        self.slip = float(np.sqrt(sums[:, 6].sum() / len(markers))) if len(markers) else 0.0
        self.motion.conclude(equation, applied, dt)
        if given is not None:
            self.motion.balance(given, before, impulse, dt)

    def close(self, fluid: Fluid, dt: float, before: Floats, impulse: Floats) -> None:
        """After the last projection: measure the interior, store the lagged forces, find the coming load.

        The load is eq. (12) of docs/theory/rigid_motion.md, the storing eq. (7) of docs/theory/immersed_boundary.md.
        `before` and `impulse` are those of `impose_no_slip`.
        """
        self.markers.store_force(self.bodies.orientation, self.retained_fraction(fluid, dt))
        if len(self.walls):
            self.walls.close(fluid.density, dt, self.retained_fraction(fluid, dt))
        self.motion.close(self.markers.interior_motion(fluid.velocity, self.bodies))
        change = self.bodies.velocities - before
        self.load = (np.repeat(self.inertia, 3, axis=1) * change - impulse) / dt
        self.inertia = self._contact_inertia()

    def state(self) -> dict[str, NDArray[Any]]:
        """All that the next step takes from the last one, beside the bodies and the fluid."""
        own = {"slip": np.array(self.slip), "load": self.load}
        return {**self.markers.state(), **self.motion.state(), **self.walls.state(), **own}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Take over what `state` gave; the bodies are restored before."""
        self.walls.restore(state)
        self.markers.restore(state)
        self.motion.restore(state)
        self.slip, self.load = float(state["slip"]), np.array(state["load"])
        self.markers.place(self.bodies.position, self.bodies.orientation)
        self.inertia = self._contact_inertia()

    def retained_fraction(self, fluid: Fluid, dt: float) -> float:
        """Of the lagged forcing, with which the next step begins."""
        return self.calibration.retained_fraction(fluid.kinematic_viscosity * dt / self.markers.h**2)

    def _contact_inertia(self) -> Floats:
        return self.motion.contact_inertia(*self.markers.layer_inertia())
