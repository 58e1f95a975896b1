"""State of the bodies: one array an attribute, one row a body."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["FREE", "LOADS", "PRESCRIBED", "Bodies"]

FREE = 0

#: Forces [N] and torques [N m] of the last step on each body, by what exerts them.
LOADS = (
    "hydrodynamic_force", "lubrication_force", "collision_force",
    "hydrodynamic_torque", "lubrication_torque", "collision_torque",
)  # fmt: skip
_CHANGING = ("position", "velocity", "angular_velocity", "orientation", "crossings", "motion", *LOADS)
PRESCRIBED = 1  # velocity given as a function of time; a fixed body is one at rest

Floats = NDArray[np.float64]


@dataclass
class Bodies:
    """Spheres in a box; ids are the row numbers.

    Parameters
    ----------
    diameter : ndarray, (N,), [m]
        > 0.
    density : ndarray, (N,), [kg/m^3]
        > 0.
    position : ndarray, (N, 3), [m]
        Centres x, y, z; along a periodic direction wrapped into the box.
    velocity, angular_velocity : ndarray, (N, 3), [m/s], [rad/s]
        Zero when left out.
    motion : ndarray of int32, (N,)
        FREE or PRESCRIBED.

    Attributes
    ----------
    mass : ndarray, (N,), [kg]
    moment_of_inertia : ndarray, (N,), [kg m^2]
        Of a homogeneous sphere, 0.4 m a^2.
    orientation : ndarray, (N, 4), [-]
        Unit quaternion w, x, y, z that rotates body axes into box axes.
    crossings : ndarray of int64, (N, 3)
        Times a body left through the upper (+) or lower (-) face of a periodic direction:
        the unwrapped position is ``position + crossings * box_size``.
    hydrodynamic_force, hydrodynamic_torque : ndarray, (N, 3), [N], [N m]
        Of the fluid, over the last step, without the hydrostatic part; without the lubrication that the grid does not
        resolve.
    lubrication_force, lubrication_torque : ndarray, (N, 3), [N], [N m]
        Of that lubrication, mean over the sub-steps of the last step.
    collision_force, collision_torque : ndarray, (N, 3), [N], [N m]
        Of the contact model, likewise.
    """

    diameter: Floats
    density: Floats
    position: Floats
    velocity: Floats = field(default=None)  # type: ignore[arg-type]
    angular_velocity: Floats = field(default=None)  # type: ignore[arg-type]
    motion: NDArray[np.int32] = field(default=None)  # type: ignore[arg-type]
    orientation: Floats = field(init=False)
    crossings: NDArray[np.int64] = field(init=False)
    mass: Floats = field(init=False)
    moment_of_inertia: Floats = field(init=False)
    hydrodynamic_force: Floats = field(init=False)
    hydrodynamic_torque: Floats = field(init=False)
    lubrication_force: Floats = field(init=False)
    lubrication_torque: Floats = field(init=False)
    collision_force: Floats = field(init=False)
    collision_torque: Floats = field(init=False)

    def __post_init__(self) -> None:
        self.diameter = np.ascontiguousarray(self.diameter, dtype=np.float64)
        n = self.diameter.size
        self.density = np.ascontiguousarray(self.density, dtype=np.float64)
        self.position = np.array(self.position, dtype=np.float64).reshape(n, 3)
        for name in ("velocity", "angular_velocity"):
            given = getattr(self, name)
            setattr(self, name, np.zeros((n, 3)) if given is None else np.array(given, float).reshape(n, 3))
        self.motion = np.zeros(n, np.int32) if self.motion is None else np.array(self.motion, np.int32)
        self.orientation = np.tile([1.0, 0.0, 0.0, 0.0], (n, 1))
        self.crossings = np.zeros((n, 3), np.int64)
        self.mass = self.density * np.pi / 6.0 * self.diameter**3
        self.moment_of_inertia = 0.1 * self.mass * self.diameter**2
        for name in LOADS:
            setattr(self, name, np.zeros((n, 3)))

    def __len__(self) -> int:
        return int(self.diameter.size)

    def state(self) -> dict[str, NDArray[Any]]:
        """All that changes from step to step, as views."""
        return {name: getattr(self, name) for name in _CHANGING}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Change the bodies to what `state` gave."""
        for name in _CHANGING:
            np.copyto(getattr(self, name), state[name])

    def turn_at_random(self, members: NDArray[np.int64], seed: int) -> None:
        """Change the orientation of some bodies to random ones, evenly over all rotations.

        Parameters
        ----------
        members : ndarray of int, (K,)
        seed : int
        """
        quaternion = np.random.default_rng(seed).standard_normal((len(members), 4))
        self.orientation[members] = quaternion / np.linalg.norm(quaternion, axis=1, keepdims=True)

    @property
    def velocities(self) -> Floats:
        """Velocity and angular velocity side by side, (N, 6), a copy."""
        return np.concatenate([self.velocity, self.angular_velocity], axis=1)

    @property
    def inertia(self) -> Floats:
        """Mass [kg] and moment of inertia [kg m^2], (N, 2), a copy."""
        return np.stack([self.mass, self.moment_of_inertia], axis=1)

    @property
    def contact_force(self) -> Floats:
        """Of contact model and lubrication together in the last step, (N, 3) [N], a copy."""
        return self.collision_force + self.lubrication_force

    @property
    def contact_torque(self) -> Floats:
        """Of contact model and lubrication together in the last step, (N, 3) [N m], a copy."""
        return self.collision_torque + self.lubrication_torque

    @property
    def is_free(self) -> NDArray[np.bool_]:
        """Bodies that move under forces: (N,)."""
        is_free: NDArray[np.bool_] = self.motion == FREE
        return is_free
