"""The markers at a slab: of bodies that lie across slabs each rank has those that touch its planes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rdpm import _core
from rdpm.grid import Grid
from rdpm.parallel.ranks import Ranks
from rdpm.particles.calibration import Calibration
from rdpm.particles.markers import MarkerSet, layer_matrices, means
from rdpm.particles.sharing import Sharing, add_up
from rdpm.particles.state import Bodies

__all__ = ["SlabMarkers"]

Floats = NDArray[np.float64]
Velocity = tuple[Floats, Floats, Floats]
List = tuple[NDArray[np.int64], NDArray[np.int32], Floats]


class SlabMarkers(MarkerSet):
    """As `MarkerSet`, of the markers that a rank holds.

    A marker that touches planes of two slabs is held by both: each interpolates in its planes, and they add up. What
    has a value without the grid, as a lagged force, is summed by the rank in whose slab the marker lies. All sums of a
    body are those of its holders, added up in the order of ranks. They run over markers that follow from their places
    alone, not over all that are held: the kernels' sums depend, in the last bit, on what stands in the list.

    Parameters
    ----------
    bodies : Bodies
        Those here.
    grid : Grid
        Of the slab.
    calibration : Calibration
    ranks : Ranks
    sharing : Sharing
        Who holds what.

    Attributes
    ----------
    is_own : ndarray of bool, (M,)
        Markers in this slab.
    slip_square : ndarray, (N,), [m^2/s^2]
        Of each body, the sum over the markers of the square of the last change: known after `interior_motion`.
    """

    def __init__(self, bodies: Bodies, grid: Grid, calibration: Calibration, ranks: Ranks, sharing: Sharing) -> None:
        super().__init__(bodies, grid, calibration, sharing.chosen)
        self._ranks, self._sharing = ranks, sharing
        self.is_own = np.ones(len(self), np.bool_)
        self._touching = self._own = self._listed(self.is_own)
        self.slip_square = np.zeros(len(bodies))
        self._moments_of_all, self._velocity_sums = np.zeros((len(bodies), 10)), np.zeros((len(bodies), 6))

    def velocity_sums(self, velocity: Velocity) -> Floats:
        """See `MarkerSet.velocity_sums`; the markers and sums that ranks have in common are completed."""
        sharing, at_markers = self._sharing, self.interpolate(velocity)
        self._velocity_sums = self._summed(self._touching, at_markers, self.volume)
        add_up(self._ranks, (sharing.of_bodies, self._velocity_sums), (sharing.of_markers, at_markers))
        return self._velocity_sums

    def interior_motion(self, velocity: Velocity, bodies: Bodies) -> Floats:
        """See `MarkerSet.interior_motion`; `slip_square` travels with it."""
        change = self._summed(self._own, self._velocity**2, np.ones(len(self)))[:, :3].sum(axis=1)
        rows = np.concatenate([self._inner_sums(velocity, bodies), change[:, None]], axis=1)
        add_up(self._ranks, (self._sharing.of_bodies, rows))
        self.slip_square = rows[:, 12]
        return means(rows[:, :12])

    def before_forcing(self, velocity: Velocity, bodies: Bodies) -> tuple[Floats, Floats, Floats]:
        """See `MarkerSet.before_forcing`."""
        lagged = self._summed(self._own, self.force, self.volume)
        rows = np.concatenate([self._inner_sums(velocity, bodies), lagged, self._own_moments()], axis=1)
        add_up(self._ranks, (self._sharing.of_bodies, rows))
        self._moments_of_all = rows[:, 18:]
        return np.ascontiguousarray(rows[:, 12:18]), means(rows[:, :12]), layer_matrices(self._moments_of_all)

    def force_rigid(self, bodies: Bodies, dt: float) -> tuple[Floats, Floats]:
        """See `MarkerSet.force_rigid`; sums follow from those of the velocity, whoever else holds the body."""
        change, sums = super().force_rigid(bodies, dt)
        rigid = np.einsum("nij,nj->ni", layer_matrices(self._moments_of_all), bodies.velocities)
        sums[:, :6] = rigid - self._velocity_sums
        return change, sums

    def layer_inertia(self) -> tuple[Floats, Floats]:
        """See `MarkerSet.layer_inertia`; of the volumes that the forcing began with."""
        volume = self._moments_of_all[:, 0]
        return volume, 2.0 / 3.0 * volume * self._layer_arm_square

    def place_all(self, bodies: Bodies) -> None:
        """Place the markers of a state that was just made or restored, and sum up their volumes."""
        self.place(bodies.position, bodies.orientation)
        self._find_lists()
        self._moments_of_all = self._own_moments()
        add_up(self._ranks, (self._sharing.of_bodies, self._moments_of_all))

    def exclude(self, bodies: Bodies, close: NDArray[np.int32], least: float) -> None:
        """See `MarkerSet.exclude`; the markers are where they stay in this step."""
        self._find_lists()
        super().exclude(bodies, close, least)

    def _find_lists(self) -> None:
        """Find the markers that touch planes of this slab, and those in it, at their places now."""
        self.is_own, touches = self._sharing.own_and_touching(self.position[:, 2])
        self._touching, self._own = self._listed(touches), self._listed(self.is_own)

    def _listed(self, chosen: NDArray[np.bool_]) -> List:
        """Rows of some markers, where those of each body begin among them, and their arms."""
        rows = np.flatnonzero(chosen)
        counts = np.bincount(self.body[rows], minlength=self.first.size - 1)
        return rows, np.concatenate([[0], np.cumsum(counts)]).astype(np.int32), self.arm[rows]

    def _summed(self, of: List, values: Floats, volume: Floats) -> Floats:
        """As `MarkerSet.sums`, over some markers."""
        rows, first, arm = of
        out = np.empty((first.size - 1, 6))
        _core.sum_over_markers(first, arm, volume[rows], values[rows], self.grid.threads, out)
        return out

    def _own_moments(self) -> Floats:
        """Of each body's markers in this slab, (N, 10): volume, first and second moments."""
        rows, first, arm = self._own
        out = np.empty((first.size - 1, 10))
        _core.marker_moments(first, arm, self.volume[rows], self.grid.threads, out)
        return out
