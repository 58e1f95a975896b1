"""Lagrangian markers: where they are, what volume each stands for, and the force each keeps."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm import _core
from rdpm.grid import Grid
from rdpm.particles.seeding import marker_count, sphere_points
from rdpm.particles.state import Bodies

__all__ = ["RETRACTION", "MarkerSet"]

#: Markers sit this many cells inside the surface, because the regularised delta spreads their force outwards;
#: fitted on the drag of dilute simple-cubic arrays.
RETRACTION = 0.39

Floats = NDArray[np.float64]


class MarkerSet:
    """The markers of all bodies, body after body.

    Parameters
    ----------
    bodies : Bodies
    grid : Grid
    retraction : float, [cells]
        Depth of the markers below the surface.

    Attributes
    ----------
    first : ndarray of int32, (N + 1,)
        Markers ``first[b]`` to ``first[b + 1]`` belong to body b.
    arm : ndarray, (M, 3), [m]
        From the centre, in box axes.
    volume : ndarray, (M,), [m^3]
        Of the fluid layer, one cell thick, that a marker stands for; less where it lies in another body or a wall.
    force : ndarray, (M, 3), [m/s^2]
        Kept from step to step and turned with the body: the force a unit mass that holds no-slip there.
    """

    def __init__(self, bodies: Bodies, grid: Grid, retraction: float = RETRACTION) -> None:
        self.grid = grid
        h = float(np.cbrt(np.prod(grid.spacing)))
        radius = 0.5 * bodies.diameter
        counts = [marker_count(a, h) for a in radius]
        self.first = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
        depth = radius - retraction * h
        self._body_arm = (
            np.concatenate([sphere_points(n) * r for n, r in zip(counts, depth, strict=True)])
            if len(bodies)
            else np.zeros((0, 3))
        )
        layer = 4.0 / 3.0 * np.pi * ((depth + 0.5 * h) ** 3 - (depth - 0.5 * h) ** 3)
        self.full_volume = np.repeat(layer / np.array(counts, float), counts) if len(bodies) else np.zeros(0)
        self.volume = self.full_volume.copy()
        self.body = np.repeat(np.arange(len(bodies)), counts)
        size = (len(self), 3)
        self.arm, self.position, self.force = np.zeros(size), np.zeros(size), np.zeros(size)
        self._body_force = np.zeros(size)
        self.fluid_velocity, self._change = np.zeros(size), np.zeros(size)
        self._layer_arm_square = depth**2
        self._stencils = _core.Markers(grid.core, self.first)

    def __len__(self) -> int:
        return int(self.first[-1])

    def state(self) -> dict[str, NDArray[Any]]:
        """The kept forces in the bodies' axes, and the volumes as the last step left them; views."""
        return {"force": self._body_force, "volume": self.volume}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Take over what `state` gave; call `place` once the bodies are restored."""
        np.copyto(self._body_force, state["force"])
        np.copyto(self.volume, state["volume"])

    def place(self, bodies: Bodies) -> None:
        """Move the markers, their stencils and their kept forces to where the bodies are now."""
        threads, q = self.grid.threads, bodies.orientation
        _core.turn_vectors(self.first, q, bodies.position, self._body_arm, False, False, threads, self.arm)
        _core.turn_vectors(self.first, q, bodies.position, self._body_arm, False, True, threads, self.position)
        _core.turn_vectors(self.first, q, bodies.position, self._body_force, False, False, threads, self.force)
        self._stencils.place(self.grid.core, self.position)

    def keep_force(self, bodies: Bodies) -> None:
        """Store the present forces in the bodies' axes, for the next step."""
        _core.turn_vectors(
            self.first,
            bodies.orientation,
            bodies.position,
            self.force,
            True,
            False,
            self.grid.threads,
            self._body_force,
        )

    def interpolate(self, velocity: tuple[Floats, Floats, Floats]) -> Floats:
        """Velocity of the fluid at the markers, (M, 3) [m/s]; the array is used again by the next call."""
        self._stencils.interpolate(self.grid.core, *velocity, self.fluid_velocity)
        return self.fluid_velocity

    def spread(self, target: tuple[Floats, Floats, Floats], values: Floats, factor: float) -> None:
        """Add factor * values, (M, 3), to a staggered field: the adjoint of `interpolate`."""
        self._stencils.spread(self.grid.core, *target, values, self.volume, factor)

    def sums(self, values: Floats) -> Floats:
        """Of each body, (N, 6): sum of volume * value, and of arm x (volume * value)."""
        out = np.empty((self.first.size - 1, 6))
        _core.sum_over_markers(self.first, self.arm, self.volume, values, self.grid.threads, out)
        return out

    def force_rigid(self, bodies: Bodies, dt: float) -> Floats:
        """Change `force` so that the fluid at the markers moves rigidly; returns its velocity change (M, 3)."""
        _core.rigid_change(
            self.first,
            self.arm,
            bodies.velocity,
            bodies.angular_velocity,
            self.fluid_velocity,
            1.0 / dt,
            self.grid.threads,
            self._change,
            self.force,
        )
        return self._change

    def layer_inertia(self) -> tuple[Floats, Floats]:
        """Of each body's marker layer: volume (N,) [m^3] and its moment 2/3 sum volume r^2 (N,) [m^5]."""
        volume = np.add.reduceat(self.volume, self.first[:-1]) if len(self) else np.zeros(0)
        return volume, 2.0 / 3.0 * volume * self._layer_arm_square

    def cover(self, bodies: Bodies, pairs: NDArray[np.integer], has_wall: tuple[bool, bool, bool]) -> None:
        """Take volume from markers inside another body or beyond a wall, down to none one cell deep.

        Parameters
        ----------
        bodies : Bodies
        pairs : ndarray of int, (P, 2)
            Bodies that overlap; a negative second id is a wall.
        has_wall : tuple of bool, (3,)
            Directions whose sides are solid.

        Notes
        -----
        Two surfaces cannot both be held where they overlap; the deeper a marker, the less it forces.
        """
        np.copyto(self.volume, self.full_volume)
        h = float(np.cbrt(np.prod(self.grid.spacing)))
        size = np.array(self.grid.size)
        for i, j in pairs:
            for one, other in ((i, j), (j, i)):
                if one < 0:
                    continue
                mine = slice(self.first[one], self.first[one + 1])
                if other >= 0:
                    away = self.position[mine] - bodies.position[other]
                    away -= np.where(self.grid.is_periodic, np.round(away / size) * size, 0.0)
                    depth = 0.5 * bodies.diameter[other] - np.linalg.norm(away, axis=1)
                else:
                    direction, side = divmod(-other - 1, 2)
                    if not has_wall[direction]:
                        continue
                    x = self.position[mine, direction]
                    depth = x - size[direction] if side else -x
                self.volume[mine] *= np.clip(1.0 - depth / h, 0.0, 1.0)
