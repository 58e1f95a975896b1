"""Immersed bodies where several ranks share the box: each rank works on the bodies at its slab."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm.fluid.state import Fluid
from rdpm.parallel.gather import rows_on_root
from rdpm.particles.calibration import CALIBRATION, Calibration
from rdpm.particles.immersed import ClosePairs, ImmersedBodies
from rdpm.particles.sharing import Sharing
from rdpm.particles.slab_markers import SlabMarkers
from rdpm.particles.state import Bodies
from rdpm.particles.walls import WallMarkers

__all__ = ["ROW_COLUMNS", "SharedBodies"]

Floats = NDArray[np.float64]

#: Rows of each body that all ranks know after a step, and their columns.
_MOTION = {"interior": 6, "residual": 6, "hydrodynamic_force": 3, "hydrodynamic_torque": 3, "applied_force": 3}
_ROWS = {"load": 6, "inertia": 2, **_MOTION}

#: Numbers in such a row: velocity, angular velocity, square of the slip, and the above.
ROW_COLUMNS = 7 + sum(_ROWS.values())


class SharedBodies:
    """As `ImmersedBodies` to a step, of all bodies on every rank.

    A rank works on the bodies that touch its planes, and has those markers of them that do. What ranks interpolate at
    markers that they have in common, and their sums over a body's markers, are added up, in the order of ranks, so that
    all holders of a body compute the same. Its rows are then those of its owner, the rank that has its centre.

    Parameters
    ----------
    bodies, fluid, gravity, calibration, has_variable_steps
        As for `ImmersedBodies`; the fluid is that of a slab.

    Attributes
    ----------
    part : ImmersedBodies
        Of the bodies here.
    walls : WallMarkers
        Of the walls within the box, those at this slab.
    load, inertia, hydrodynamic_force, hydrodynamic_torque, applied_force : ndarray, (N, ...)
        As those of `ImmersedBodies`.
    slip : float, [m/s]
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
    ) -> None:
        self.bodies, self.calibration = bodies, calibration
        self._fluid, self._gravity, self._is_variable = fluid, gravity, has_variable_steps
        self._ranks = fluid.ranks
        self.slip = self.pass_seconds = 0.0
        self._sharing = Sharing(fluid.grid, fluid.ranks, bodies, calibration)
        self.walls = WallMarkers(fluid.grid, calibration, fluid.ranks)
        self.part = self._made()
        self.markers.place_all(self.part.bodies)
        self.part.begin(fluid)
        self.load, self.inertia = np.zeros((len(bodies), 6)), np.zeros((len(bodies), 2))
        self.interior, self.residual = np.zeros((2, len(bodies), 6))
        self.hydrodynamic_force, self.hydrodynamic_torque, self.applied_force = np.zeros((3, len(bodies), 3))
        self._exchange_rows()

    @property
    def markers(self) -> SlabMarkers:
        """Those at this slab."""
        assert isinstance(self.part.markers, SlabMarkers)
        return self.part.markers

    @property
    def force_on_fluid(self) -> Floats:
        """Of all bodies and walls over the last step, (3,) [N]."""
        total: Floats = self.applied_force.sum(axis=0)
        return total + self.walls.force_on_fluid if len(self.walls) else total

    @property
    def here(self) -> NDArray[np.int64]:
        """Ids of the bodies that this rank works on, rising."""
        return self._sharing.here

    def move(self, fluid: Fluid, dt: float, close_pairs: ClosePairs) -> None:
        """See `ImmersedBodies.move`; bodies that came near this slab are taken over first."""
        self._follow(dt)
        bodies, local, here, markers = self.bodies, self.part.bodies, self.here, self.markers
        for name in ("position", "orientation", "velocity", "angular_velocity", "motion"):
            np.copyto(getattr(local, name), getattr(bodies, name)[here])
        markers.place(local.position, local.orientation)
        close, least = close_pairs(markers.exclusion_range), self.part.retained_fraction(fluid, dt)
        known, pairs = self._surroundings(close)
        around = Bodies(bodies.diameter[known], bodies.density[known], bodies.position[known])
        markers.exclude(around, pairs, least)
        if len(self.walls):
            self.walls.exclude(bodies, close, least)

    def spread_lagged_force(self, fluid: Fluid, dt: float, is_isolated: bool) -> float:
        """See `ImmersedBodies.spread_lagged_force`."""
        return self.part.spread_lagged_force(fluid, dt, is_isolated)

    def remove_unretained_force(self, fluid: Fluid, dt: float, unretained: float) -> None:
        """See `ImmersedBodies.remove_unretained_force`."""
        self.part.remove_unretained_force(fluid, dt, unretained)

    def impose_no_slip(
        self, fluid: Fluid, dt: float, before: Floats, impulse: Floats, given: NDArray[np.bool_] | None = None
    ) -> None:
        """See `ImmersedBodies.impose_no_slip`; the velocities of all bodies are known after `close`."""
        here = self.here
        self.part.impose_no_slip(fluid, dt, before[here], impulse[here], None if given is None else given[here])
        self.pass_seconds += self.part.pass_seconds
        self.part.pass_seconds = 0.0

    def close(self, fluid: Fluid, dt: float, before: Floats, impulse: Floats) -> None:
        """See `ImmersedBodies.close`; afterwards the rows of all bodies are known here."""
        self.part.close(fluid, dt, before[self.here], impulse[self.here])
        self._exchange_rows()

    def state(self) -> dict[str, NDArray[Any]]:
        """As `ImmersedBodies.state`, whole on the root alone: what the markers have is empty on other ranks."""
        markers, ids = self.markers, self._sharing.ids
        of_part = markers.state()
        rows = np.concatenate([ids[:, None], of_part["force"], of_part["volume"][:, None]], axis=1)
        gathered = rows_on_root(self._ranks, rows[markers.is_own])
        whole = np.empty((self._sharing.markers if self._ranks.rank == 0 else 0, 4))
        whole[gathered[:, 0].astype(np.int64)] = gathered[:, 1:]
        of_markers = {"force": whole[:, :3], "volume": whole[:, 3]}
        of_bodies = {name: getattr(self, name) for name in _MOTION}
        return {**of_markers, **of_bodies, **self.walls.state(), "slip": np.array(self.slip), "load": self.load}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Take over what `state` gave on the root; the bodies are restored before."""
        self.load = np.array(state["load"])
        for name in _MOTION:
            setattr(self, name, np.array(state[name]))
        self._sharing.hold(self.bodies, 0.0)
        self._sharing.renew(self.bodies)
        self.part = self._made()
        ids, markers = self._sharing.ids, self.markers
        markers.restore({"force": state["force"][ids], "volume": state["volume"][ids]})
        markers.place_all(self.part.bodies)
        self._give_rows()
        self.part.inertia = self.part.motion.contact_inertia(*markers.layer_inertia())
        self.walls.restore(state)
        self._exchange_rows()
        self.slip = float(state["slip"])

    def _made(self) -> ImmersedBodies:
        bodies, here = self.bodies, self.here
        local = Bodies(
            bodies.diameter[here], bodies.density[here], bodies.position[here], bodies.velocity[here],
            bodies.angular_velocity[here], bodies.motion[here],
        )  # fmt: skip
        np.copyto(local.orientation, bodies.orientation[here])
        markers = SlabMarkers(local, self._fluid.grid, self.calibration, self._ranks, self._sharing)
        return ImmersedBodies(
            local, self._fluid, self._gravity, self.calibration, self._is_variable, self.walls, markers
        )  # fmt: skip

    def _follow(self, dt: float) -> None:
        """Take over bodies and markers that now touch this slab, with their lagged forces, and let go of others."""
        sharing = self._sharing
        if not sharing.hold(self.bodies, dt):
            return
        force = sharing.renew(self.bodies, self.markers.state()["force"])
        self.part = self._made()
        np.copyto(self.markers.state()["force"], force)
        self._give_rows()
        self.part.inertia = self.inertia[self.here]

    def _give_rows(self) -> None:
        """Give the bodies here their rows."""
        part = self.part
        part.load = self.load[self.here]
        for name in _MOTION:
            setattr(part.motion, name, getattr(self, name)[self.here])

    def _surroundings(self, pairs: NDArray[np.int32]) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
        """Ids of the bodies here, then of others close to them; and the pairs, in numbers of these."""
        number = np.full(len(self.bodies) + 6, -1, np.int64)
        number[self.here] = np.arange(len(self.here))
        i, j = pairs.astype(np.int64).T
        is_body = j >= 0
        near = (number[i] >= 0) | (is_body & (number[np.where(is_body, j, 0)] >= 0))
        i, j, is_body = i[near], j[near], is_body[near]
        others = np.setdiff1d(np.concatenate([i, j[is_body]]), self.here)
        number[others] = len(self.here) + np.arange(len(others))
        known = np.concatenate([self.here, others])
        found = np.stack([number[i], np.where(is_body, number[np.where(is_body, j, 0)], j)], axis=1)
        return known, np.ascontiguousarray(found, np.int32)

    def _exchange_rows(self) -> None:
        """Give every rank the rows of all bodies, each from its owner."""
        part, local, sharing = self.part, self.part.bodies, self._sharing
        mine = np.concatenate(
            [
                local.velocity, local.angular_velocity, self.markers.slip_square[:, None], part.load, part.inertia,
                *(getattr(part.motion, name) for name in _MOTION),
            ],
            axis=1,
        )  # fmt: skip
        table = np.empty((len(self.bodies), mine.shape[1]))
        table[sharing.order] = self._ranks.rows(mine[sharing.is_own], sharing.counts)
        at = np.cumsum([0, 3, 3, 1, *_ROWS.values()])
        columns = dict(zip(("velocity", "angular_velocity", "slip", *_ROWS), pairwise(at), strict=True))
        for name in ("velocity", "angular_velocity"):
            np.copyto(getattr(self.bodies, name), table[:, slice(*columns[name])])
        markers = sharing.markers
        self.slip = float(np.sqrt(table[:, columns["slip"][0]].sum() / markers)) if markers else 0.0
        for name in _ROWS:
            setattr(self, name, np.ascontiguousarray(table[:, slice(*columns[name])]))
        # All holders of a body go on from the same rows.
        part.inertia = self.inertia[self.here]
        self._give_rows()
