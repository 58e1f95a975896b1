"""Which ranks hold which bodies, and what these say to each other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from rdpm.grid import Grid
from rdpm.parallel.ranks import Ranks
from rdpm.particles.state import Bodies

__all__ = ["Common", "Cuts", "Sharing"]

Floats = NDArray[np.float64]
Ids = NDArray[np.int64]

#: Planes beyond a body's surface that its markers and its interior may touch: the delta's two, one for the body's own
#: surface being between planes.
MARGIN = 3.0

#: Planes by which a body that is held may be farther away before it is let go: bodies do not come and go every step.
PATIENCE = 1.0


class Cuts:
    """Where the slabs of the ranks lie along z.

    Parameters
    ----------
    planes : sequence of int
        Of each rank, from bottom to top.
    spacing : tuple of float, (3,), [m]
    period : float, [m]
        Along z; 0 between faces of the box.

    Examples
    --------
    >>> cuts = Cuts([8, 8], (1.0, 1.0, 1.0), 0.0)
    >>> cuts.owner(np.array([2.0, 11.0])), cuts.beyond(np.array([2.0]), np.array([1.0]))[:, 0]
    (array([0, 1]), array([-6.5,  1.5]))
    """

    def __init__(self, planes: Sequence[int], spacing: tuple[float, float, float], period: float) -> None:
        self.dz, self._period = spacing[2], period
        self._ends = np.concatenate([[0.0], np.cumsum(planes)])
        self._middle = 0.5 * self.dz * (self._ends[1:] + self._ends[:-1])
        self._half = 0.5 * self.dz * np.diff(self._ends)
        self._margin = MARGIN * self.dz + 0.5 * float(np.cbrt(np.prod(spacing)))

    def beyond(self, z: Floats, radius: Floats) -> Floats:
        """How far from each slab spheres at these heights are, with what their markers touch: (ranks, N) [m]."""
        apart = z[None, :] - self._middle[:, None]
        if self._period:
            apart -= self._period * np.round(apart / self._period)
        distance: Floats = np.abs(apart) - self._half[:, None] - (radius + self._margin)[None, :]
        return distance

    def owner(self, z: Floats) -> Ids:
        """The rank in whose slab each centre lies."""
        plane = np.clip(np.floor(z / self.dz), 0.0, self._ends[-1] - 1.0)
        return np.asarray(np.searchsorted(self._ends, plane, side="right") - 1, np.int64)


class Common:
    """Rows that several ranks hold, each with its part of them.

    Parameters
    ----------
    ranks : Ranks
    rows : mapping of int to ndarray of int
        By other rank, which rows here it has too, in the same order as there.
    are_pairs : bool
        No row is held by more than two.
    """

    def __init__(self, ranks: Ranks, rows: Mapping[int, Ids], are_pairs: bool) -> None:
        self._ranks, self._rows, self._are_pairs = ranks, rows, are_pairs

    def add_up(self, rows: Floats) -> None:
        """Change rows to the sum of what their holders have, added up in the order of ranks: all get the same."""
        index = self._rows
        if not index:
            return
        received = {rank: np.empty((len(at), rows.shape[1])) for rank, at in index.items()}
        self._ranks.swap([(rank, rows[at]) for rank, at in index.items()], list(received.items()))
        if self._are_pairs:  # a + b = b + a
            for rank, at in index.items():
                rows[at] += received[rank]
            return
        shared = np.unique(np.concatenate(list(index.values())))
        own = rows[shared]
        rows[shared] = 0.0
        for rank in sorted([*index, self._ranks.rank]):
            if rank == self._ranks.rank:
                rows[shared] += own
            else:
                rows[index[rank]] += received[rank]


class Sharing:
    """Who holds, and who owns, each body.

    Parameters
    ----------
    grid : Grid
        Of this rank's slab.
    ranks : Ranks
    diameter : ndarray, (N,), [m]

    Attributes
    ----------
    holders : ndarray of bool, (ranks, N)
        Ranks whose planes a body's markers touch.
    here : ndarray of int, (n,)
        Ids of those held by this rank, rising.
    is_own : ndarray of bool, (n,)
        Of these, those whose centre lies in this slab.
    order, counts : ndarray of int, (N,), list of int, (ranks,)
        Ids by owner, and how many each rank owns.
    """

    def __init__(self, grid: Grid, ranks: Ranks, diameter: Floats) -> None:
        assert grid.slab is not None
        self._ranks, self._radius = ranks, 0.5 * diameter
        period = grid.size[2] if grid.is_periodic[2] else 0.0
        self._cuts = Cuts([int(n) for n in ranks.table([grid.slab.planes])[:, 0]], grid.spacing, period)
        self.holders = np.zeros((ranks.size, len(diameter)), bool)

    def hold(self, bodies: Bodies, dt: float) -> NDArray[np.bool_]:
        """Find who holds the bodies at their positions, and half a step of `dt` before; arrivals (ranks, N)."""
        z = bodies.position[:, 2]
        if not np.isfinite(z).all():
            raise ValueError("position: a body is not finite")
        before = self.holders
        beyond = self._cuts.beyond(z, self._radius + 0.5 * dt * np.abs(bodies.velocity[:, 2]))
        self.holders = beyond <= np.where(before, PATIENCE * self._cuts.dz, 0.0)
        owner, rank = self._cuts.owner(z), self._ranks.rank
        self.here = np.flatnonzero(self.holders[rank])
        self.is_own = owner[self.here] == rank
        self.order = np.argsort(owner, kind="stable")
        self.counts = np.bincount(owner, minlength=self._ranks.size).tolist()
        arrivals: NDArray[np.bool_] = self.holders & ~before
        self._before = before
        return arrivals

    def own_rows(self, first: NDArray[np.int32]) -> NDArray[np.bool_]:
        """Which rows are of owned bodies, where those from first[n] to first[n + 1] are of body n here."""
        return np.repeat(self.is_own, np.diff(first))

    def bring(
        self, arrivals: NDArray[np.bool_], values: Floats, before: Ids, first: NDArray[np.int32], counts: Ids
    ) -> list[tuple[Ids, Floats]]:
        """Give what bodies have, row after row, to the ranks where they arrive.

        Parameters
        ----------
        arrivals : ndarray of bool, (ranks, N)
        values : ndarray, (rows, 3)
            Of the bodies held so far.
        before, first : ndarray of int
            Ids of these, and where their rows begin.
        counts : ndarray of int, (N,)
            Rows of each body.

        Returns
        -------
        list of (ids, values)
            Of bodies that arrive here.
        """
        if not arrivals.any():
            return []
        giver = np.argmax(self._before, axis=0)  # the lowest that holds it
        me, sends, gained = self._ranks.rank, [], []
        receives: list[tuple[int, Floats]] = []
        for rank in range(self._ranks.size):
            to = np.flatnonzero(arrivals[rank] & (giver == me)) if rank != me else np.zeros(0, np.int64)
            if len(to):
                at = np.searchsorted(before, to)
                sends.append((rank, np.concatenate([values[first[n] : first[n + 1]] for n in at])))
            coming = np.flatnonzero(arrivals[me] & (giver == rank)) if rank != me else np.zeros(0, np.int64)
            if len(coming):
                received = np.empty((int(counts[coming].sum()), values.shape[1]))
                receives.append((rank, received))
                gained.append((coming, received))
        self._ranks.swap(sends, receives)
        return gained

    def index(self, first: NDArray[np.int32]) -> None:
        """Find the rows here of bodies that others hold too; `first`: where each body's markers begin."""
        bodies: dict[int, Ids] = {}
        markers: dict[int, Ids] = {}
        held = self.holders[:, self.here]
        are_pairs = not (held.sum(axis=0) > 2).any()
        lengths = np.diff(first)
        for rank in np.flatnonzero(held.any(axis=1)):
            common = held[rank]
            if rank != self._ranks.rank and common.any():
                bodies[int(rank)] = np.flatnonzero(common)
                markers[int(rank)] = np.flatnonzero(np.repeat(common, lengths))
        self._of_bodies, self._of_markers = (Common(self._ranks, rows, are_pairs) for rows in (bodies, markers))

    def complete(self, rows: Floats, is_of_markers: bool) -> None:
        """Change rows of shared bodies to the sum of what their holders have, added up in the order of ranks."""
        (self._of_markers if is_of_markers else self._of_bodies).add_up(rows)
