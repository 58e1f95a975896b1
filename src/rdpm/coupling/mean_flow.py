"""Uniform forces on the fluid: a body force, a mean pressure gradient, or what holds the mean flow at zero."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

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

    def begin(self, dt: float, force_on_fluid: NDArray[np.float64]) -> tuple[float, float, float]:
        """Uniform force a unit mass for the coming step, [m/s^2].

        Parameters
        ----------
        dt : float, [s]
        force_on_fluid : ndarray, (3,), [N]
            Of all bodies, over the last step: it is balanced, and what it left of the mean flow.
        """
        total = self.given
        if self.is_zero_mean:
            total = total - force_on_fluid / self.fluid_mass - self.mean_velocity / dt
        return float(total[0]), float(total[1]), float(total[2])

    def end(self, dt: float, uniform: tuple[float, float, float], force_on_fluid: NDArray[np.float64]) -> None:
        """Follow the mean velocity: advection and diffusion keep it in a periodic box."""
        self.mean_velocity += dt * (np.array(uniform) + force_on_fluid / self.fluid_mass)
