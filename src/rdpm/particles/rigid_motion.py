r"""Newton-Euler for bodies in fluid, implicit in what the markers force upon the fluid.

The markers hand the fluid an impulse G; the body gets its reaction and what the fluid inside the body gained:

.. math:: m_p (U' - U) = \Delta P_{in} - G + J + \delta t\, B,

with contact impulse J and weight less buoyancy B. G is linear in the new velocity, G = G_old + m_L (U' - u), with
m_L the fluid of the marker layer and u its velocity. A part beta of that impulse is found in the fluid inside once
the pressure has answered, the rest in the layer's outer half and in the added mass outside, so
:math:`\Delta P_{in}` is what was measured on the grid before forcing plus beta (G - G_old). Then

.. math:: (m_p + (1 - \beta) m_L) U' = m_p U + (1 - \beta) m_L u + \ldots

has only positive terms on the left at any density ratio, and a contact accelerates the body and the fluid it takes
along within the same step. What beta misses of the inner momentum is measured after projection and enters the next
step, so that momentum is conserved over time.
"""

from __future__ import annotations

from collections.abc import Mapping
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm.fluid.state import Fluid
from rdpm.particles.markers import MarkerSet
from rdpm.particles.state import Bodies

__all__ = ["INNER_SHARE", "INNER_SHARE_SPIN", "KEPT_FROM", "RigidMotion"]

#: beta for translation, share of an impulse on the markers that is found inside one projection later: limit for many
#: cells a diameter and what one over the cells a diameter takes from it. Measured from 6 to 24 within 0.003
#: (docs/theory/rigid_motion.md). The motion stays stable while beta is less than about 0.1 too high.
INNER_SHARE = (0.471, -0.336)

#: The same for rotation, where no pressure answers.
INNER_SHARE_SPIN = (0.71, -1.07)

#: The same for translation before the projection.
SPREAD_SHARE = (0.702, -0.50)

#: Share of the fluid's part in the inertia that contacts and films are resolved with. A stiff film stops the body
#: within the step; the fluid then gives back velocity and holds the body a step later. That exchange changes sign and
#: grows where inertia * (2 R_0 - R_1) > 4/3, with R_0 and R_1 the velocity one and some steps after a unit impulse:
#: R_1 is 0.3 to 0.6 of R_0 beside a wall. The whole is too much for light bodies; 0.2 to 0.4 was calm everywhere.
CONTACT_SHARE = 0.3

#: Viscous number nu dt / h^2 at which half of a marker's force is kept for the next step; see `RigidMotion.kept_share`.
KEPT_FROM = 0.04

Floats = NDArray[np.float64]

_KEPT = ("inner", "missed", "hydrodynamic_force", "hydrodynamic_torque", "given_force")


class RigidMotion:
    """Solves the bodies' new velocities together with the forcing.

    Parameters
    ----------
    bodies : Bodies
    fluid : Fluid
    markers : MarkerSet
    gravity : ndarray, (3,), [m/s^2]
    passes : int
        Forcing passes a step.

    Attributes
    ----------
    hydrodynamic_force, hydrodynamic_torque : ndarray, (N, 3), [N], [N m]
        Of the last step on each body, without the hydrostatic part.
    slip : float, [m/s]
        Root mean square velocity change that the last forcing pass still made.
    pass_seconds : float, [s]
        Wall time spent in forcing passes so far.
    """

    def __init__(self, bodies: Bodies, fluid: Fluid, markers: MarkerSet, gravity: Floats, passes: int) -> None:
        self.bodies, self.fluid, self.markers, self.passes = bodies, fluid, markers, passes
        n = len(bodies)
        # In the order of the bodies' mass, so that a neutrally buoyant body has no weight at all.
        self.fluid_mass = fluid.density * np.pi / 6.0 * bodies.diameter**3
        self.fluid_moment = 0.1 * self.fluid_mass * bodies.diameter**2
        self.weight = (bodies.mass - self.fluid_mass)[:, None] * gravity
        self.inner = np.zeros((n, 6))  # momentum and spin of the inner fluid after the last projection
        self.missed = np.zeros((n, 6))  # inner momentum that beta did not foresee in the last step
        self.hydrodynamic_force, self.hydrodynamic_torque = np.zeros((n, 3)), np.zeros((n, 3))
        self.given_force = np.zeros((n, 3))  # on the fluid, over the last step
        self.slip = self.pass_seconds = 0.0
        cells = bodies.diameter / markers.h
        inner, spin, spread = (a + b / cells for a, b in (INNER_SHARE, INNER_SHARE_SPIN, SPREAD_SHARE))
        self._share = np.repeat(np.stack([inner, spin], axis=1), 3, axis=1)
        self._pressure_share = (spread - inner)[:, None]
        self._inertia = np.repeat(np.stack([bodies.mass, bodies.moment_of_inertia], axis=1), 3, axis=1)

    @property
    def contact_inertia(self) -> tuple[Floats, Floats]:
        """Mass and moment (N,), (N,) that contacts are resolved with: the body's, and a share of the fluid taken along.

        The passes are taken as a geometric series, each finding half of the slip before it.
        """
        volume, moment = self.markers.layer_inertia()
        taken = CONTACT_SHARE * self.fluid.density * (2.0 - 2.0 * 0.5**self.passes)
        return (
            self.bodies.mass + (1.0 - self._share[:, 0]) * taken * volume,
            self.bodies.moment_of_inertia + (1.0 - self._share[:, 3]) * taken * moment,
        )

    def kept_share(self, dt: float) -> float:
        """Share x / (x + `KEPT_FROM`) of the markers' forces that the next step begins with, x = nu dt / h^2.

        What is kept makes the drag independent of dt where viscosity takes the forced layer away within a step, x ~ 1.
        It also remembers: where two surfaces are so close that the grid cannot hold both, or a contact turns a body
        round, a force kept whole goes on long after its cause. With this share the memory is 1 + x / KEPT_FROM steps,
        and the slip that the rest leaves behind is at most of order KEPT_FROM h / delta of the speed, whatever dt.
        """
        x = self.fluid.viscosity * dt / self.markers.h**2
        return x / (x + KEPT_FROM)

    def inner_momentum(self) -> Floats:
        """Momentum and angular momentum of the fluid inside each body, (N, 6) [kg m/s], [kg m^2/s]."""
        out = self.markers.inner_motion(self.fluid.velocity, self.bodies)
        out[:, :3] *= self.fluid_mass[:, None]
        out[:, 3:] *= self.fluid_moment[:, None]
        return out

    def state(self) -> dict[str, NDArray[Any]]:
        """What the next step, and the tables, take from the last one."""
        return {name: np.asarray(getattr(self, name)) for name in _KEPT} | {"slip": np.array(self.slip)}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Take over what `state` gave."""
        for name in _KEPT:
            setattr(self, name, np.array(state[name]))
        self.slip = float(state["slip"])

    def begin(self) -> None:
        """Measure the inner fluid at the start of a run."""
        self.inner = self.inner_momentum()

    def force(self, dt: float, old: Floats, impulse: Floats) -> None:
        """Change the fluid velocity to no-slip on the bodies, and the free bodies' velocities with it.

        May be called again after a projection: it then adds what this took.

        Parameters
        ----------
        dt : float, [s]
        old : ndarray, (N, 6)
            Velocity and angular velocity at the beginning of the step.
        impulse : ndarray, (N, 6), [N s], [N m s]
            Of contacts and lubrication over the step.
        """
        bodies, markers, density = self.bodies, self.markers, self.fluid.density
        free = bodies.is_free[:, None]
        outer = 1.0 - self._share
        inertia = outer[:, :, None] * density * markers.layer_matrix()
        inertia[:, range(6), range(6)] += self._inertia
        answer = np.linalg.inv(inertia)
        given = density * dt * markers.sums(markers.force)  # impulse of the kept forces, already in the prediction
        predicted = self.inner_momentum()
        # The pressure has answered the whole of the last force, of which a share is kept.
        predicted[:, :3] += self._pressure_share * (dt * self.given_force - given[:, :3])
        known = self._inertia * old + (predicted - self.inner + self.missed) - given + impulse
        known[:, :3] += dt * self.weight
        total = np.zeros_like(given)
        began = perf_counter()
        for _ in range(self.passes):
            at_markers = density * markers.sums(markers.interpolate(self.fluid.velocity))
            solved = np.einsum("nij,nj->ni", answer, known + outer * (at_markers - total))
            np.copyto(bodies.velocity, solved[:, :3], where=free)
            np.copyto(bodies.angular_velocity, solved[:, 3:], where=free)
            change, sums = markers.force_rigid(bodies, dt)
            total += density * sums[:, :6]
            markers.spread(self.fluid.velocity, change, 1.0)
        self.pass_seconds += perf_counter() - began
        self.slip = float(np.sqrt(sums[:, 6].sum() / len(markers))) if len(markers) else 0.0
        self._foreseen = predicted + self._share * total
        fluid_on_body = (self._foreseen - self.inner + self.missed - given - total) / dt
        self.hydrodynamic_force, self.hydrodynamic_torque = fluid_on_body[:, :3], fluid_on_body[:, 3:]
        self.given_force = (given + total)[:, :3] / dt

    def close(self, dt: float) -> None:
        """After projection: what the inner fluid really gained, and what the markers keep."""
        self.markers.keep_force(self.bodies, self.kept_share(dt))
        self.inner = self.inner_momentum()
        self.missed = self.inner - self._foreseen
