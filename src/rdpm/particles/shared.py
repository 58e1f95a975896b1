"""Immersed bodies where several ranks share the box: each rank works on the bodies at its slab."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm.fluid.state import Fluid
from rdpm.parallel.gather import rows_on_root
from rdpm.particles.calibration import CALIBRATION, Calibration
from rdpm.particles.immersed import ClosePairs, ImmersedBodies
from rdpm.particles.markers import MarkerSet
from rdpm.particles.seeding import marker_count
from rdpm.particles.sharing import Sharing
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

    A rank holds the markers of the bodies that touch its planes. Each marker is interpolated and spread in the planes
    of every rank that holds its body; what they interpolate is added up, in the order of ranks, so that all holders of
    a body compute the same. Its rows are then those of its owner, the rank that has its centre.

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
        h = float(np.cbrt(np.prod(fluid.grid.spacing)))
        self._markers = np.array([marker_count(0.5 * d, h) for d in bodies.diameter], np.int64)
        self._sharing = Sharing(fluid.grid, fluid.ranks, bodies.diameter)
        self._sharing.hold(bodies, 0.0)
        self.walls = WallMarkers(fluid.grid, calibration, fluid.ranks)
        self.part = self._made()
        self._attach()
        self.part.motion.interior = self.part.interior_momentum(fluid)
        self.load, self.inertia = np.zeros((len(bodies), 6)), np.zeros((len(bodies), 2))
        self.interior, self.residual = np.zeros((2, len(bodies), 6))
        self.hydrodynamic_force, self.hydrodynamic_torque, self.applied_force = np.zeros((3, len(bodies), 3))
        self._exchange_rows()

    @property
    def markers(self) -> MarkerSet:
        """Of the bodies here."""
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
        bodies, local, here = self.bodies, self.part.bodies, self.here
        for name in ("position", "orientation", "velocity", "angular_velocity", "motion"):
            np.copyto(getattr(local, name), getattr(bodies, name)[here])
        markers = self.part.markers
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
        markers = self.part.markers
        own = self._sharing.own_rows(markers.first)
        order = self._order_of_markers()
        of_markers = {}
        for name, values in markers.state().items():
            gathered = rows_on_root(self._ranks, values.reshape(len(markers), math.prod(values.shape[1:]))[own])
            whole = np.empty((len(order) if self._ranks.rank == 0 else 0, gathered.shape[1]))
            whole[order[: len(whole)]] = gathered
            of_markers[name] = whole.reshape(-1, *values.shape[1:])
        rows = {name: getattr(self, name) for name in _MOTION}
        return {**of_markers, **rows, **self.walls.state(), "slip": np.array(self.slip), "load": self.load}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Take over what `state` gave on the root; the bodies are restored before."""
        self.slip = float(state["slip"])
        self.load = np.array(state["load"])
        for name in _MOTION:
            setattr(self, name, np.array(state[name]))
        self._sharing.hold(self.bodies, 0.0)
        self.part = self._made()
        first = np.concatenate([[0], np.cumsum(self._markers)])
        rows = _ranges(first[self.here], self._markers[self.here])
        of_part = {name: getattr(self, name)[self.here] for name in (*_MOTION, "load")}
        self.part.restore_markers(
            {"force": state["force"][rows], "volume": state["volume"][rows], "slip": state["slip"]} | of_part
        )
        self.walls.restore(state)
        self._attach()
        self._exchange_rows()

    def _made(self) -> ImmersedBodies:
        bodies, here = self.bodies, self.here
        local = Bodies(
            bodies.diameter[here], bodies.density[here], bodies.position[here], bodies.velocity[here],
            bodies.angular_velocity[here], bodies.motion[here],
        )  # fmt: skip
        np.copyto(local.orientation, bodies.orientation[here])
        return ImmersedBodies(local, self._fluid, self._gravity, self.calibration, self._is_variable, self.walls)

    def _attach(self) -> None:
        """Have the part's sums completed by the other holders."""
        self._sharing.index(self.part.markers.first)
        self.part.markers.complete = self._sharing.complete

    def _follow(self, dt: float) -> None:
        """Take over bodies that now touch this slab, with their lagged forces, and let go of others."""
        before, old = self.here, self.part
        arrivals = self._sharing.hold(self.bodies, dt)
        forces = old.markers.state()["force"]
        gained = self._sharing.bring(arrivals, forces, before, old.markers.first, self._markers)
        if np.array_equal(before, self.here):
            self._sharing.index(old.markers.first)
            return
        self.part = self._made()
        first = self.part.markers.first
        force, volume = np.zeros((len(self.part.markers), 3)), self.part.markers.full_volume.copy()
        stays = np.isin(before, self.here)
        kept = np.searchsorted(self.here, before[stays])
        counts = self._markers[before[stays]]
        new_rows, old_rows = _ranges(first[kept], counts), _ranges(old.markers.first[:-1][stays], counts)
        force[new_rows], volume[new_rows] = forces[old_rows], old.markers.volume[old_rows]
        for ids, values in gained:
            force[_ranges(first[np.searchsorted(self.here, ids)], self._markers[ids])] = values
        rows = {name: getattr(self, name)[self.here] for name in (*_MOTION, "load")}
        self.part.restore_markers({"force": force, "volume": volume, "slip": np.array(0.0)} | rows)
        self.part.inertia = self.inertia[self.here]
        self._attach()

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
                local.velocity, local.angular_velocity, part.slip_square[:, None], part.load, part.inertia,
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
        markers = int(self._markers.sum())
        self.slip = float(np.sqrt(table[:, columns["slip"][0]].sum() / markers)) if markers else 0.0
        for name in _ROWS:
            setattr(self, name, np.ascontiguousarray(table[:, slice(*columns[name])]))
        # All holders of a body go on from the same rows.
        part.load, part.inertia = self.load[self.here], self.inertia[self.here]
        for name in _MOTION:
            setattr(part.motion, name, getattr(self, name)[self.here])

    def _order_of_markers(self) -> NDArray[np.int64]:
        """Rows, in the whole list of markers, of those that the ranks own, rank after rank."""
        first = np.concatenate([[0], np.cumsum(self._markers)])
        order = self._sharing.order
        return _ranges(first[order], self._markers[order])


def _ranges(first: NDArray[Any], counts: NDArray[np.int64]) -> NDArray[np.int64]:
    """The rows first[n] to first[n] + counts[n], one range after the other."""
    if not len(counts):
        return np.zeros(0, np.int64)
    begin = np.repeat(first - np.concatenate([[0], np.cumsum(counts)[:-1]]), counts)
    return np.asarray(begin + np.arange(int(counts.sum())), np.int64)
