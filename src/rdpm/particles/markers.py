"""Lagrangian markers: where they are, what volume each stands for, and the lagged force of each."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm import _core
from rdpm.conventions import FIRST_WALL
from rdpm.grid import Grid
from rdpm.particles.calibration import CALIBRATION, Calibration
from rdpm.particles.seeding import marker_arms
from rdpm.particles.state import Bodies
from rdpm.particles.walls import left_to_marker

__all__ = ["MarkerSet", "layer_matrices", "means"]

Floats = NDArray[np.float64]


class MarkerSet:
    """The markers of all bodies, body after body.

    Parameters
    ----------
    bodies : Bodies
    grid : Grid
    calibration : Calibration
        Depth of the markers below the surface, and how they are excluded near other surfaces.
    chosen : ndarray of bool, optional
        Of all markers of the bodies, those that are here; every one when left out.

    Attributes
    ----------
    first : ndarray of int32, (N + 1,)
        Markers ``first[b]`` to ``first[b + 1]`` belong to body b.
    arm : ndarray, (M, 3), [m]
        From the centre, in box axes.
    volume : ndarray, (M,), [m^3]
        Of the fluid layer, one cell thick, that a marker stands for; reduced close to another surface.
    h : float, [m]
        Mean spacing of the grid.
    force : ndarray, (M, 3), [m/s^2]
        Lagged from step to step and turned with the body: the force a unit mass that holds no-slip there.
    """

    def __init__(
        self,
        bodies: Bodies,
        grid: Grid,
        calibration: Calibration = CALIBRATION,
        chosen: NDArray[np.bool_] | None = None,
    ) -> None:
        self.grid, self.calibration = grid, calibration
        self.h = h = float(np.cbrt(np.prod(grid.spacing)))
        arms = marker_arms(bodies.diameter, h, calibration.marker_retraction)
        counts = np.array([len(each) for each in arms], np.int64)
        depth = 0.5 * bodies.diameter - calibration.marker_retraction * h
        self._body_arm = np.concatenate([*arms, np.zeros((0, 3))])
        layer = 4.0 / 3.0 * np.pi * ((depth + 0.5 * h) ** 3 - (depth - 0.5 * h) ** 3)
        self.body = np.repeat(np.arange(len(bodies)), counts)
        if chosen is not None:
            self._body_arm, self.body = self._body_arm[chosen], self.body[chosen]
        here = np.bincount(self.body, minlength=len(bodies))
        self.first = np.concatenate([[0], np.cumsum(here)]).astype(np.int32)
        self.full_volume = (layer / counts)[self.body]
        self.volume = self.full_volume.copy()
        # One allocation: many markers then lie in large pages.
        self.arm, self.position, self.force, self._body_force, self._velocity = np.zeros((5, len(self), 3))
        self._layer_arm_square = depth**2
        self._stencils = _core.Markers(grid.core, self.first)

    def __len__(self) -> int:
        return int(self.first[-1])

    @property
    def exclusion_range(self) -> float:
        """Gap [m] beyond which no marker is excluded."""
        return self.calibration.exclusion_far * self.h

    def state(self) -> dict[str, NDArray[Any]]:
        """The lagged forces in the bodies' axes, and the volumes as the last step left them; views."""
        return {"force": self._body_force, "volume": self.volume}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Take over what `state` gave; call `place` once the bodies are restored."""
        np.copyto(self._body_force, state["force"])
        np.copyto(self.volume, state["volume"])

    def place(self, position: Floats, orientation: Floats) -> None:
        """Move the markers, their stencils and their lagged forces.

        Parameters
        ----------
        position : ndarray, (N, 3), [m]
            Of the bodies' centres.
        orientation : ndarray, (N, 4), [-]
            Unit quaternions.
        """
        _core.move_markers(
            self.first, orientation, position, self._body_arm, self._body_force, self.grid.threads,
            self.arm, self.position, self.force,
        )  # fmt: skip
        self._stencils.place(self.grid.core, self.position)

    def store_force(self, orientation: Floats, retained: float) -> None:
        """Relax the forces to this fraction, and store them in the bodies' axes for the next step."""
        _core.store_forces(self.first, orientation, retained, self.grid.threads, self.force, self._body_force)

    def interpolate(self, velocity: tuple[Floats, Floats, Floats]) -> Floats:
        """Velocity of the fluid at the markers, (M, 3) [m/s]; the array is used again by the next call."""
        self._stencils.interpolate(self.grid.core, *velocity, self._velocity)
        return self._velocity

    def velocity_sums(self, velocity: tuple[Floats, Floats, Floats]) -> Floats:
        """`sums` of the fluid's velocity at the markers, which is then interpolated for `force_rigid`."""
        return self.sums(self.interpolate(velocity))

    def spread(self, target: tuple[Floats, Floats, Floats], values: Floats, factor: float) -> None:
        """Add factor * values, (M, 3), to a staggered field: the adjoint of `interpolate`."""
        self._stencils.spread(self.grid.core, *target, values, self.volume, factor)

    def interior_motion(self, velocity: tuple[Floats, Floats, Floats], bodies: Bodies) -> Floats:
        """Mean velocity and angular velocity of the fluid inside each body, (N, 6) [m/s], [rad/s]."""
        return means(self._inner_sums(velocity, bodies))

    def before_forcing(self, velocity: tuple[Floats, Floats, Floats], bodies: Bodies) -> tuple[Floats, Floats, Floats]:
        """`sums` of the lagged force, `interior_motion` and `layer_matrix`: what a step's equations are made of."""
        return self.sums(self.force), self.interior_motion(velocity, bodies), self.layer_matrix()

    def sums(self, values: Floats) -> Floats:
        """Of each body, (N, 6): sum of volume * value, and of arm x (volume * value)."""
        out = np.empty((self.first.size - 1, 6))
        _core.sum_over_markers(self.first, self.arm, self.volume, values, self.grid.threads, out)
        return out

    def force_rigid(self, bodies: Bodies, dt: float) -> tuple[Floats, Floats]:
        """Change `force` so that the fluid at the markers, as last interpolated, moves rigidly.

        Parameters
        ----------
        bodies : Bodies
        dt : float, [s]

        Returns
        -------
        change : ndarray, (M, 3), [m/s]
            Of the fluid's velocity at the markers; the array that `interpolate` gave.
        sums : ndarray, (N, 7)
            `sums` of the change, and the sum of its square [m^2/s^2].
        """
        out = np.empty((self.first.size - 1, 7))
        _core.rigid_change(
            self.first, self.arm, self.volume, bodies.velocity, bodies.angular_velocity, 1.0 / dt, self.grid.threads,
            self._velocity, self.force, out,
        )  # fmt: skip
        return self._velocity, out

    def layer_inertia(self) -> tuple[Floats, Floats]:
        """Of each body's marker layer: volume (N,) [m^3] and its moment 2/3 sum volume r^2 (N,) [m^5]."""
        volume = np.add.reduceat(self.volume, self.first[:-1]) if len(self) else np.zeros(0)
        return volume, 2.0 / 3.0 * volume * self._layer_arm_square

    def layer_matrix(self) -> Floats:
        """Of each body, (N, 6, 6): its velocity and angular velocity to the `sums` of the rigid motion at its markers.

        Markers excluded on one side leave first moments: translation and rotation are coupled.
        """
        moments = np.empty((self.first.size - 1, 10))
        _core.marker_moments(self.first, self.arm, self.volume, self.grid.threads, moments)
        return layer_matrices(moments)

    def exclude(self, bodies: Bodies, close: NDArray[np.int32], least: float) -> None:
        """Reduce the volume of markers that are close to another surface.

        Parameters
        ----------
        bodies : Bodies
        close : ndarray of int32, (P, 2)
            Pairs of bodies whose surfaces are close; a negative second id is a wall.
        least : float, [-]
            Fraction left to markers within `exclusion_near` cells of the other surface; all from `exclusion_far` cells
            on; inside it, down to none one cell deep.

        Notes
        -----
        The grid cannot hold two surfaces whose deltas overlap. Bodies beyond those of the markers have none here, but
        others are excluded near them.
        """
        grid, c, h = self.grid, self.calibration, self.h
        others = len(bodies) - (self.first.size - 1)
        first = np.concatenate([self.first, np.repeat(self.first[-1:], others)]) if others else self.first
        solid = [kind == "wall" for kind in grid.boundary]
        within = close[:, 1] <= FIRST_WALL
        bodies_and_faces = close if not within.any() else close[~within]
        _core.exclude_markers(
            grid.size, grid.is_periodic, solid, (c.exclusion_near * h, c.exclusion_far * h, least, h), bodies_and_faces,
            first, self.position, bodies.position, 0.5 * bodies.diameter, self.full_volume, grid.threads,
            self.volume,
        )  # fmt: skip
        for n, wall in enumerate(grid.box.walls):
            near = np.zeros(len(bodies), np.bool_)
            near[close[close[:, 1] == FIRST_WALL - n, 0]] = True
            at = np.flatnonzero(near[self.body])
            distance = wall.distance(self.position[at], grid.box.period)[0]
            left = self.full_volume[at] * left_to_marker(distance / h, c, least)
            self.volume[at] = np.minimum(self.volume[at], left)

    def _inner_sums(self, velocity: tuple[Floats, Floats, Floats], bodies: Bodies) -> Floats:
        """Over the fluid inside each body, (N, 12): of its motion and of the weights."""
        sums = np.empty((len(bodies), 12))
        self._stencils.inner_sums(self.grid.core, *velocity, bodies.position, 0.5 * bodies.diameter, sums)
        return sums


def means(inner_sums: Floats) -> Floats:
    """Mean velocity and angular velocity, (N, 6), of the fluid of these sums."""
    motion, weight = (inner_sums.reshape(-1, 2, 2, 3)[:, :, n].reshape(-1, 6) for n in range(2))
    return np.divide(motion, weight, out=np.zeros_like(motion), where=weight > 0.0)


def layer_matrices(moments: Floats) -> Floats:
    """`MarkerSet.layer_matrix` of these moments."""
    volume, (x, y, z) = moments[:, 0], moments[:, 1:4].T
    xx, yy, zz, xy, yz, zx = moments[:, 4:].T
    zero = np.zeros_like(x)
    cross = np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]])
    matrix = np.zeros((6, 6, len(moments)))
    matrix[range(3), range(3)] = volume
    matrix[3:, :3], matrix[:3, 3:] = cross, -cross
    matrix[3:, 3:] = [[yy + zz, -xy, -zx], [-xy, zz + xx, -yz], [-zx, -yz, xx + yy]]
    return matrix.transpose(2, 0, 1)
