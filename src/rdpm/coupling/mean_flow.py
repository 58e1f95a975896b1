"""Uniform forces on the fluid: a body force, a mean pressure gradient, or what holds the mean flow at zero."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm.particles.rigid_motion import RigidMotion

__all__ = ["MeanFlow"]


class MeanFlow:
    """The uniform force a unit mass of fluid.

    Parameters
    ----------
    given : ndarray, (3,), [m/s^2]
        Body force, or minus the mean pressure gradient over the density.
    is_zero_mean : bool
        Hold the mean velocity of a fully periodic box at zero: the fluid then gets, as a mean pressure gradient,
        minus the force the bodies exert on it. Velocities are in the frame of zero volume flux.
    fluid_mass : float, [kg]
        Of the whole box.
    mean_velocity : ndarray, (3,), [m/s]
        At the start.
    """

    def __init__(
        self, given: NDArray[np.float64], is_zero_mean: bool, fluid_mass: float, mean_velocity: NDArray[np.float64]
    ) -> None:
        self.given, self.is_zero_mean, self.fluid_mass = given, is_zero_mean, fluid_mass
        self.mean_velocity = np.array(mean_velocity, float)

    def state(self) -> dict[str, NDArray[Any]]:
        """The mean velocity."""
        return {"mean_velocity": self.mean_velocity}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Take over what `state` gave."""
        np.copyto(self.mean_velocity, state["mean_velocity"])

    def force(self, dt: float, motion: RigidMotion | None) -> tuple[float, float, float]:
        """For the coming step, [m/s^2]: balances the force of the last step and what it left of the mean flow."""
        total = self.given
        if self.is_zero_mean:
            on_fluid = motion.given_force.sum(axis=0) if motion else np.zeros(3)
            total = total - on_fluid / self.fluid_mass - self.mean_velocity / dt
        return float(total[0]), float(total[1]), float(total[2])

    def advance(self, dt: float, force: tuple[float, float, float], motion: RigidMotion | None) -> None:
        """Follow the mean velocity: advection and diffusion keep it in a periodic box."""
        on_fluid = motion.given_force.sum(axis=0) if motion else np.zeros(3)
        self.mean_velocity += dt * (np.array(force) + on_fluid / self.fluid_mass)
