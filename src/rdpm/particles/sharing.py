"""Which ranks hold which bodies and markers, and what these say to each other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from rdpm.grid import Grid
from rdpm.parallel.ranks import Ranks
from rdpm.particles.calibration import Calibration
from rdpm.particles.seeding import marker_arms, marker_count
from rdpm.particles.state import Bodies

__all__ = ["SKIN", "Common", "Cuts", "Sharing", "add_up", "held_markers", "ranges"]

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
Ids = NDArray[np.int64]

#: Planes beyond a body's surface that its markers and its interior may touch: the delta's two, one for the body's own
#: surface being between planes.
MARGIN = 3.0

#: Planes by which a body that is held may be farther away before it is let go: bodies do not come and go every step.
PATIENCE = 1.0

#: Planes that a marker touches below and above itself: the delta's 1.5, of faces and of centres half a cell below them.
BELOW, ABOVE = 1.5, 2.0

#: Planes that markers may move before it is found anew which of them ranks have in common.
SKIN = 0.5


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
    >>> cuts.touched(np.array([6.9, 7.1, 9.4, 9.6])).tolist()
    [[True, True, True, False], [False, True, True, True]]
    """

    def __init__(self, planes: Sequence[int], spacing: tuple[float, float, float], period: float) -> None:
        self.dz, self._period = spacing[2], period
        self._ends = np.concatenate([[0.0], np.cumsum(planes)])
        self._middle = 0.5 * self.dz * (self._ends[1:] + self._ends[:-1])
        self._half = 0.5 * self.dz * np.diff(self._ends)
        self._margin = MARGIN * self.dz + 0.5 * float(np.cbrt(np.prod(spacing)))

    @classmethod
    def of(cls, grid: Grid, ranks: Ranks) -> Cuts:
        """Those of the ranks that share a box; `grid`: of this rank's slab."""
        assert grid.slab is not None
        planes = [int(n) for n in ranks.table([grid.slab.planes])[:, 0]]
        return cls(planes, grid.spacing, grid.size[2] if grid.is_periodic[2] else 0.0)

    def nearest(self, apart: Floats) -> Floats:
        """Of distances along z those to the nearest image [m]."""
        return apart - self._period * np.round(apart / self._period) if self._period else apart

    def beyond(self, z: Floats, radius: Floats) -> Floats:
        """How far from each slab spheres at these heights are, with what their markers touch: (ranks, N) [m]."""
        apart = self.nearest(z[None, :] - self._middle[:, None])
        distance: Floats = np.abs(apart) - self._half[:, None] - (radius + self._margin)[None, :]
        return distance

    def touched(self, z: Floats, skin: float = 0.0) -> Bools:
        """Whether markers at these heights touch planes of each slab, or would so many planes away: (ranks, M)."""
        if not self._period:  # what lies behind a face of the box is mirrored
            z = np.clip(z, 0.0, self.dz * self._ends[-1])
        apart, half = self.nearest(z[None, :] - self._middle[:, None]), self._half[:, None]
        low, high = (ABOVE - 1.0 + skin) * self.dz, (BELOW + skin) * self.dz
        found: Bools = (apart > -half - low) & (apart < half + high)
        return found

    def owner(self, z: Floats) -> Ids:
        """The rank in whose slab each point lies."""
        plane = np.floor(z / self.dz)
        plane = plane % self._ends[-1] if self._period else np.clip(plane, 0.0, self._ends[-1] - 1.0)
        return np.asarray(np.searchsorted(self._ends, plane, side="right") - 1, np.int64)


class Common:
    """Rows that several ranks hold, each with its part of them.

    Parameters
    ----------
    rank : int
    rows : mapping of int to ndarray of int
        By other rank, which rows here it has too, in the same order as there.
    """

    def __init__(self, rank: int, rows: Mapping[int, Ids]) -> None:
        self.rows, self._rank = rows, rank
        every = np.concatenate([*rows.values(), np.zeros(0, np.int64)])
        self.shared = np.unique(every)
        self._are_pairs = len(self.shared) == len(every)

    def take(self, rows: Floats, received: Mapping[int, Floats]) -> None:
        """Add what the others have, in the order of ranks: all holders get the same."""
        if self._are_pairs:  # a + b = b + a
            for rank, at in self.rows.items():
                rows[at] += received[rank]
            return
        own = rows[self.shared]
        rows[self.shared] = 0.0
        for rank in sorted([*self.rows, self._rank]):
            if rank == self._rank:
                rows[self.shared] += own
            else:
                rows[self.rows[rank]] += received[rank]


def add_up(ranks: Ranks, *tables: tuple[Common, Floats]) -> None:
    """Change rows of tables to the sum of what their holders have: one message to each rank that holds some too.

    Parameters
    ----------
    ranks : Ranks
    *tables : (Common, ndarray (rows, columns))
    """
    others = sorted({rank for common, _ in tables for rank in common.rows})
    if not others:
        return
    sends, receives = [], []
    parts: list[dict[int, Floats]] = [{} for _ in tables]
    for rank in others:
        has = [n for n, (common, _) in enumerate(tables) if rank in common.rows]
        mine = [tables[n][1][tables[n][0].rows[rank]] for n in has]
        sends.append((rank, np.concatenate([rows.ravel() for rows in mine])))
        received = np.empty(sum(rows.size for rows in mine))
        receives.append((rank, received))
        end = 0
        for n, rows in zip(has, mine, strict=True):
            begin, end = end, end + rows.size
            parts[n][rank] = received[begin:end].reshape(rows.shape)
    ranks.swap(sends, receives)
    for (common, rows), of_ranks in zip(tables, parts, strict=True):
        common.take(rows, of_ranks)


def ranges(first: NDArray[np.integer], counts: Ids) -> Ids:
    """The rows first[n] to first[n] + counts[n], one range after the other.

    Examples
    --------
    >>> ranges(np.array([0, 10]), np.array([2, 3]))
    array([ 0,  1, 10, 11, 12])
    """
    begin = np.repeat(first - np.cumsum(counts) + counts, counts)
    return np.asarray(begin + np.arange(len(begin)), np.int64)


def held_markers(
    cuts: Cuts, holders: Bools, z: Floats, orientation: Floats, arms: Sequence[Floats], skin: float = SKIN
) -> Bools:
    """Which ranks hold which markers of some bodies, body after body: (ranks, markers).

    Of a body that several ranks hold, each has the markers that touch its planes, or would after a short way.

    Parameters
    ----------
    cuts : Cuts
    holders : ndarray of bool, (ranks, K)
        Of these bodies.
    z : ndarray, (K,), [m]
        Of their centres.
    orientation : ndarray, (K, 4), [-]
    arms : sequence of ndarray, (markers, 3), [m]
        Of their markers, in the bodies' axes.
    skin : float, [cells]
    """
    counts = [len(each) for each in arms]
    x, y, up = np.concatenate([*arms, np.zeros((0, 3))]).T
    w, i, j, k = np.repeat(orientation, counts, axis=0).T
    height = np.repeat(z, counts) + 2.0 * (i * k - w * j) * x + 2.0 * (j * k + w * i) * y
    height += (1.0 - 2.0 * (i * i + j * j)) * up
    of_bodies: Bools = np.repeat(holders, counts, axis=1)
    is_alone = of_bodies.sum(axis=0) == 1
    found: Bools = of_bodies & (cuts.touched(height, skin) | is_alone)
    return found


class Sharing:
    """Who holds, and who owns, each body, and each marker of it.

    Parameters
    ----------
    grid : Grid
        Of this rank's slab.
    ranks : Ranks
    bodies : Bodies
    calibration : Calibration
        Depth of the markers.

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
    markers : int
        Of all bodies.
    ids : ndarray of int, (m,)
        Of the markers held by this rank, numbers among those of all bodies, rising.
    chosen : ndarray of bool
        Of the markers of the bodies here, those held.
    of_bodies, of_markers : Common
        Rows here that other ranks hold too.
    """

    def __init__(self, grid: Grid, ranks: Ranks, bodies: Bodies, calibration: Calibration) -> None:
        self._ranks, self._radius, self._diameter = ranks, 0.5 * bodies.diameter, bodies.diameter
        self._cuts, self._retraction = Cuts.of(grid, ranks), calibration.marker_retraction
        self._h = h = float(np.cbrt(np.prod(grid.spacing)))
        self._counts = np.array([marker_count(a, h) for a in self._radius], np.int64)
        self._first = np.concatenate([[0], np.cumsum(self._counts)])
        self.markers = int(self._first[-1])
        self.holders = np.zeros((ranks.size, len(bodies)), bool)
        # Of the last time that it was found who holds the markers.
        self._settled, self._skin = (self.holders, SKIN), SKIN
        self._z, self._orientation = bodies.position[:, 2].copy(), bodies.orientation.copy()
        self.ids, self.chosen = np.zeros(0, np.int64), np.zeros(0, bool)
        self.of_bodies, self.of_markers = Common(ranks.rank, {}), Common(ranks.rank, {})
        self.hold(bodies, 0.0)
        self.renew(bodies)

    def hold(self, bodies: Bodies, dt: float) -> bool:
        """Find who holds the bodies at their positions, and half a step of `dt` before.

        Returns
        -------
        bool
            Who holds the markers must be found anew, by `renew`: bodies come and go, or have moved. All ranks agree.
        """
        z = bodies.position[:, 2]
        if not np.isfinite(z).all():
            raise ValueError("position: a body is not finite")
        before, travel = self.holders, 0.5 * dt * np.abs(bodies.velocity[:, 2])
        beyond = self._cuts.beyond(z, self._radius + travel)
        self.holders = beyond <= np.where(before, PATIENCE * self._cuts.dz, 0.0)
        owner, rank = self._cuts.owner(z), self._ranks.rank
        self.here = np.flatnonzero(self.holders[rank])
        self.is_own = owner[self.here] == rank
        self.order = np.argsort(owner, kind="stable")
        self.counts = np.bincount(owner, minlength=self._ranks.size).tolist()
        self._skin = max(SKIN, 2.0 * float(travel.max(initial=0.0)) / self._cuts.dz)
        if not before.any() or (self.holders != before).any():
            return bool(len(z))
        several = self.holders.sum(axis=0) > 1
        cosine = np.einsum("ni,ni->n", bodies.orientation[several], self._orientation[several])
        turned = 2.0 * self._radius[several] * np.sqrt(np.maximum(1.0 - cosine**2, 0.0))
        moved = np.abs(self._cuts.nearest(z - self._z)) + travel
        return bool((moved[several] + turned > 0.99 * self._settled[1] * self._cuts.dz).any())

    def renew(self, bodies: Bodies, values: Floats | None = None) -> Floats:
        """Find who holds the markers; those that come here bring their values.

        Parameters
        ----------
        bodies : Bodies
        values : ndarray, (m, columns), optional
            Of the markers held so far; none at a start.

        Returns
        -------
        ndarray, (m, columns)
            Of those held now.
        """
        me, new = self._ranks.rank, self.holders
        old, skin = (new, SKIN) if values is None else self._settled
        involved = (old[me] | new[me]) & ((old | new).sum(axis=0) > 1)
        at = np.flatnonzero(involved)
        arms = marker_arms(self._diameter[at], self._h, self._retraction)
        now = held_markers(self._cuts, new[:, at], bodies.position[at, 2], bodies.orientation[at], arms, self._skin)
        ids = ranges(self._first[at], self._counts[at])
        counts = self._counts[self.here]
        self.chosen = np.ones(int(counts.sum()), bool)
        self.chosen[np.repeat(involved[self.here], counts)] = now[me][np.repeat(new[me, at], self._counts[at])]
        kept, self.ids = self.ids, ranges(self._first[self.here], counts)[self.chosen]
        gained = np.zeros((0, 3))
        if values is not None:
            then = held_markers(self._cuts, old[:, at], self._z[at], self._orientation[at], arms, skin)
            gained = self._moved(ids, then, now, kept, values)
        self._find_common(ids, now)
        self._settled = new, self._skin
        self._z, self._orientation = bodies.position[:, 2].copy(), bodies.orientation.copy()
        return gained

    def own_and_touching(self, z: Floats) -> tuple[Bools, Bools]:
        """Of the markers here, at these heights, those in this slab, and those that touch its planes: (m,) each."""
        own, touching = np.ones((2, len(z)), bool)
        shared, rank = self.of_markers.shared, self._ranks.rank
        own[shared] = self._cuts.owner(z[shared]) == rank
        touching[shared] = self._cuts.touched(z[shared])[rank]
        return own, touching

    def _moved(self, ids: Ids, then: Bools, now: Bools, kept: Ids, values: Floats) -> Floats:
        """Values of the markers held now: `ids`, which ranks held `then`, and hold `now`; `kept`: those held here."""
        out = np.zeros((len(self.ids), values.shape[1]))
        place = np.minimum(np.searchsorted(self.ids, kept), len(self.ids) - 1)
        stays = self.ids[place] == kept if len(self.ids) else np.zeros(len(kept), bool)
        out[place[stays]] = values[stays]
        me, giver, coming = self._ranks.rank, np.argmax(then, axis=0), now & ~then
        sends: list[tuple[int, Floats]] = []
        receives: list[tuple[int, Floats]] = []
        gained: list[Ids] = []
        for rank in range(self._ranks.size):
            to, of = ids[coming[rank] & (giver == me)], ids[coming[me] & (giver == rank)]
            if rank != me and len(to):
                sends.append((rank, values[np.searchsorted(kept, to)]))
            if rank != me and len(of):
                gained.append(of)
                receives.append((rank, np.empty((len(of), values.shape[1]))))
        self._ranks.swap(sends, receives)
        for of, (_, received) in zip(gained, receives, strict=True):
            out[np.searchsorted(self.ids, of)] = received
        return out

    def _find_common(self, ids: Ids, now: Bools) -> None:
        """Find the rows here of bodies and markers that others hold too."""
        bodies: dict[int, Ids] = {}
        markers: dict[int, Ids] = {}
        me, held = self._ranks.rank, self.holders[:, self.here]
        for rank in range(self._ranks.size):
            both = now[me] & now[rank]
            if rank != me and held[rank].any():
                bodies[rank] = np.flatnonzero(held[rank])
            if rank != me and both.any():
                markers[rank] = np.searchsorted(self.ids, ids[both])
        self.of_bodies, self.of_markers = Common(me, bodies), Common(me, markers)
