r"""Newton-Euler for bodies in fluid, implicit in the impulse that the markers give the fluid.

Equation numbers are those of docs/theory/rigid_motion.md.

The markers give the fluid an impulse G; the body gets its reaction and what the fluid in its interior gained:

.. math:: m_p (U' - U) = \Delta P_{in} - G + J + \delta t\, B,

with contact impulse J and weight less buoyancy B. G is linear in the new velocity, G = G_old + m_L (U' - u), with
m_L the fluid of the marker layer and u its velocity. A fraction beta of that impulse is found in the interior after
the projection, the rest in the layer's outer half and in the added mass outside, so
:math:`\Delta P_{in}` is what was measured on the grid before forcing plus beta (G - G_old). Then

.. math:: (m_p + (1 - \beta) m_L) U' = m_p U + (1 - \beta) m_L u + \ldots

has only positive terms on the left at any density ratio, and a contact accelerates the body and the fluid it entrains
within the same step. What beta misses of the interior momentum, the interior residual, is measured after projection and
enters the next step, so that momentum is conserved over time.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm.particles.calibration import Calibration
from rdpm.particles.state import Bodies

__all__ = ["BodyEquation", "RigidMotion"]

Floats = NDArray[np.float64]

_STATE = ("interior", "residual", "hydrodynamic_force", "hydrodynamic_torque", "applied_force")


@dataclass(frozen=True)
class BodyEquation:
    """The linear equation of each body's new velocity within one step.

    Parameters
    ----------
    inverse : ndarray, (N, 6, 6)
        Of body and entrained layer together.
    known : ndarray, (N, 6), [N s], [N m s]
        What does not depend on the new velocity.
    outer : ndarray, (N, 6), [-]
        One less the interior fraction.
    predicted : ndarray, (N, 6)
        Interior momentum before the forcing.
    lagged : ndarray, (N, 6)
        Impulse of the lagged forcing, which the prediction holds.
    """

    inverse: Floats
    known: Floats
    outer: Floats
    predicted: Floats
    lagged: Floats

    def solve(self, at_markers: Floats, applied: Floats) -> Floats:
        """New velocity and angular velocity, (N, 6), from the layer's momentum and what was applied so far: eq. (5)."""
        solved: Floats = np.einsum("nij,nj->ni", self.inverse, self.known + self.outer * (at_markers - applied))
        return solved


class RigidMotion:
    """The bodies' equations of motion in a fluid, and what one step hands to the next.

    Parameters
    ----------
    bodies : Bodies
    fluid_density : float, [kg/m^3]
    spacing : float, [m]
        Mean spacing of the grid.
    gravity : ndarray, (3,), [m/s^2]
    calibration : Calibration

    Attributes
    ----------
    interior : ndarray, (N, 6), [kg m/s], [kg m^2/s]
        Momentum and angular momentum of the interior fluid after the last projection.
    residual : ndarray, (N, 6)
        Interior momentum that the last step's fractions did not predict.
    hydrodynamic_force, hydrodynamic_torque : ndarray, (N, 3), [N], [N m]
        Of the last step on each body, without the hydrostatic part.
    applied_force : ndarray, (N, 3), [N]
        Of the bodies on the fluid, over the last step.
    weight : ndarray, (N, 3), [N]
        Less buoyancy.
    """

    def __init__(
        self, bodies: Bodies, fluid_density: float, spacing: float, gravity: Floats, calibration: Calibration
    ) -> None:
        self.bodies, self.density, self.calibration = bodies, fluid_density, calibration
        n = len(bodies)
        # In the order of the bodies' mass, so that a neutrally buoyant body has no weight at all.
        self.fluid_mass = fluid_density * np.pi / 6.0 * bodies.diameter**3
        self.fluid_moment = 0.1 * self.fluid_mass * bodies.diameter**2
        self.weight = (bodies.mass - self.fluid_mass)[:, None] * gravity
        self.interior, self.residual, self._expected = np.zeros((3, n, 6))
        self.hydrodynamic_force, self.hydrodynamic_torque, self.applied_force = np.zeros((3, n, 3))
        cells = bodies.diameter / spacing
        c = calibration
        linear, rotation, predicted = (
            a + b / cells for a, b in (c.interior_fraction, c.interior_fraction_rotation, c.interior_fraction_predicted)
        )
        self._fraction = np.repeat(np.stack([linear, rotation], axis=1), 3, axis=1)
        self._pressure_fraction = (predicted - linear)[:, None]
        self._inertia = np.repeat(bodies.inertia, 3, axis=1)

    def contact_inertia(self, layer_volume: Floats, layer_moment: Floats) -> Floats:
        """Inertia that contacts act on, (N, 2), eq. (11): the body's, and part of the entrained fluid's.

        A stiff lubrication force stops the body within the step; the fluid then gives back velocity and holds the body
        a step later. That exchange alternates and grows where inertia * (2 R_0 - R_1) > 4/3, with R_0 and R_1 the
        velocity one and some steps after a unit impulse: R_1 is 0.3 to 0.6 of R_0 beside a wall. So only
        `contact_fluid_fraction` of the fluid counts. The passes are taken as a geometric series, each finding half of
        the slip before it.

        Parameters
        ----------
        layer_volume, layer_moment : ndarray, (N,), [m^3], [m^5]
            Of the marker layer.
        """
        c = self.calibration
        entrained = c.contact_fluid_fraction * self.density * (2.0 - 2.0 * 0.5**c.forcing_passes)
        linear = self.bodies.mass + (1.0 - self._fraction[:, 0]) * entrained * layer_volume
        rotation = self.bodies.moment_of_inertia + (1.0 - self._fraction[:, 3]) * entrained * layer_moment
        return np.stack([linear, rotation], axis=1)

    def equation(
        self, dt: float, before: Floats, impulse: Floats, lagged: Floats, interior_motion: Floats, layer_matrix: Floats
    ) -> BodyEquation:
        """Set up a step's equation (5).

        Parameters
        ----------
        dt : float, [s]
        before : ndarray, (N, 6)
            Velocity and angular velocity at the beginning of the step.
        impulse : ndarray, (N, 6), [N s], [N m s]
            Of contacts and lubrication over the step.
        lagged : ndarray, (N, 6), [N s], [N m s]
            Of the lagged forcing on the fluid.
        interior_motion : ndarray, (N, 6), [m/s], [rad/s]
            Of the predicted fluid.
        layer_matrix : ndarray, (N, 6, 6)
            Of `MarkerSet.layer_matrix`.
        """
        outer = 1.0 - self._fraction
        inertia = outer[:, :, None] * self.density * layer_matrix
        inertia[:, range(6), range(6)] += self._inertia
        predicted = self.momentum(interior_motion)
        # The old pressure is that of the whole last force, of which a fraction is retained: eq. (7).
        predicted[:, :3] += self._pressure_fraction * (dt * self.applied_force - lagged[:, :3])
        known = self._inertia * before + (predicted - self.interior + self.residual) - lagged + impulse
        known[:, :3] += dt * self.weight
        inverse = np.asarray(np.linalg.inv(inertia), np.float64)
        return BodyEquation(inverse, known, outer, predicted, lagged)

    def conclude(self, equation: BodyEquation, applied: Floats, dt: float) -> None:
        """Forces that follow from what was applied, (N, 6), in a step of `dt`: eqs. (1) and (4)."""
        self._expected = equation.predicted + self._fraction * applied
        on_body = (self._expected - self.interior + self.residual - equation.lagged - applied) / dt
        self.hydrodynamic_force, self.hydrodynamic_torque = on_body[:, :3], on_body[:, 3:]
        self.applied_force = (equation.lagged + applied)[:, :3] / dt

    def balance(self, given: NDArray[np.bool_], before: Floats, impulse: Floats, dt: float) -> None:
        """Have the forces on bodies of a given velocity be what the motion leaves beside weight and `impulse`, (N, 6).

        Contacts act on more inertia than the body's: these are the forces of the fluid that moves with it.
        """
        left = (self._inertia * (self.bodies.velocities - before) - impulse) / dt
        np.copyto(self.hydrodynamic_force, left[:, :3] - self.weight, where=given[:, None])
        np.copyto(self.hydrodynamic_torque, left[:, 3:], where=given[:, None])

    def close(self, interior_motion: Floats) -> None:
        """After projection: what the interior fluid really gained, and the residual (6)."""
        self.interior = self.momentum(interior_motion)
        self.residual = self.interior - self._expected

    def momentum(self, interior_motion: Floats) -> Floats:
        """Momentum and angular momentum, (N, 6), of interior fluid of this mean motion."""
        out = interior_motion.copy()
        out[:, :3] *= self.fluid_mass[:, None]
        out[:, 3:] *= self.fluid_moment[:, None]
        return out

    def state(self) -> dict[str, NDArray[Any]]:
        """What the next step, and the tables, take from the last one."""
        return {name: np.asarray(getattr(self, name)) for name in _STATE}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Take over what `state` gave."""
        for name in _STATE:
            setattr(self, name, np.array(state[name]))
