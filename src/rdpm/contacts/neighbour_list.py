"""Pairs that may meet, listed until a body has moved too far, in an order that follows from where the bodies are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm import _core
from rdpm.grid import Box
from rdpm.particles.state import FREE, Bodies

from .rows import Rows, as_bytes

__all__ = ["NeighbourList", "Selection"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]

#: What a list reaches beyond the range of its first step: in units of how far two bodies may travel in a step, at most
#: this share of the smallest diameter; and a share of that in any case.
SKIN_STEPS, MOST_SKIN, LEAST_SKIN = 3.0, 0.25, 0.02


@dataclass
class Selection:
    """Of a list, the pairs that may meet in one step, in the order in which they act.

    Views that the next step overwrites.

    Parameters
    ----------
    rows : ndarray of int32, (S,)
        Their rows in the list, rising.
    local : ndarray of int32, (S, 2)
        Their bodies as rows of `active`; a negative second is a wall.
    active : ndarray of int32, (A,)
        Bodies that have a pair, by their rank.
    bands : ndarray of int32, (B, 2)
        From and to in the selection, those of even layers first. Bands of one colour share no body.
    even_bands : int
    lost : ndarray of int32, (L,)
        Rows of pairs that cannot meet in the step though a contact is under way.
    shortest : float, [s]
        Smallest time scale; inf without pairs.
    reach : float, [m]
        Largest gap.
    """

    rows: Ints
    local: Ints
    active: Ints
    bands: Ints
    even_bands: int
    lost: Ints
    shortest: float
    reach: float

    def __len__(self) -> int:
        return len(self.rows)


class NeighbourList:
    """Pairs within a cutoff of each other, kept until bodies may have moved further than it allows for.

    The bodies are ranked by layer of cells along z, then by cell, then by position: the order of the pairs is that of
    their bodies, whatever the ids. A layer is as thick as the largest diameter and the cutoff, so that a pair lies in
    one layer or in two that touch.

    Parameters
    ----------
    bodies : Bodies
        Read at every call.
    box : Box

    Attributes
    ----------
    ids : ndarray of int32, (M, 2)
        i and j > i, or a negative j for a wall.
    """

    def __init__(self, bodies: Bodies, box: Box) -> None:
        self.bodies, self.box = bodies, box
        self.radius = 0.5 * bodies.diameter
        n = len(bodies)
        self._smallest = float(bodies.diameter.min()) if n else 0.0
        self._cell_start, self._place = np.empty(8 * n + 65, np.int32), np.empty(n, np.int32)
        self._order, self._active = np.empty(n, np.int32), np.empty(n, np.int32)
        self._resize(16 + 8 * n)
        self._position, self._motion, self._range = bodies.position.copy(), bodies.motion.copy(), -1.0
        self.ids: Ints = self._pairs[:0]

    def _resize(self, capacity: int) -> None:
        self._pairs, self._layer = np.empty((capacity, 2), np.int32), np.empty(capacity, np.int32)
        self._rows, self._local = np.empty(capacity, np.int32), np.empty((capacity, 2), np.int32)
        self._bands = np.empty((capacity, 2), np.int32)

    def update(self, force: Floats, inverse_mass: Floats, dt: float, margin: float) -> tuple[float, bool]:
        """List the pairs anew where the bodies have moved too far, or others move freely.

        Parameters
        ----------
        force : ndarray, (N, 3), [N]
        inverse_mass : ndarray, (N,), [1/kg]
            0 for a prescribed motion; pairs in which neither body can move are left out.
        dt : float, [s]
        margin : float, [m]
            >= 0.

        Returns
        -------
        range : float, [m]
            Pairs with a larger gap do not come nearer than `margin` in this step.
        is_new : bool
            Whether it is another list now.
        """
        b = self.bodies
        travel, moved = _core.list_demand(
            self.box.table, b.position, b.velocity, force, inverse_mass, self._position, dt
        )
        reach = margin + travel
        if reach + 2.0 * moved <= self._range and np.array_equal(b.motion, self._motion):
            return reach, False
        skin = min(SKIN_STEPS * travel, MOST_SKIN * self._smallest) + LEAST_SKIN * self._smallest
        self._position, self._motion, self._range = b.position.copy(), b.motion.copy(), reach + skin
        self._build()
        return reach, True

    def _build(self) -> None:
        inverse_mass = (self._motion == FREE).astype(np.float64)
        while True:
            found = _core.list_pairs(
                self.box.table, self._position, self.radius, inverse_mass, self._range, self._cell_start,
                self._order, self._place, self._pairs, self._layer,
            )  # fmt: skip
            if found <= len(self._pairs):
                break
            self._resize(found + found // 4)
        self.ids = self._pairs[:found]

    def select(self, reach: float, times: Floats, state: Rows) -> Selection:
        """Pairs whose gap is at most `reach` [m] now.

        Parameters
        ----------
        reach : float, [m]
        times : ndarray, (M,), [s]
            Time scale of each pair.
        state : ndarray of :data:`rdpm.contacts.rows.STATE`, (M,)
        """
        m = len(self.ids)
        pairs, bodies, even, bands, lost, shortest = _core.select_pairs(
            self.box.table, self.bodies.position, self.radius, reach, self._order, self.ids, self._layer[:m], times,
            as_bytes(state), self._rows[:m], self._local[:m], self._active, self._place, self._bands[:m],
        )  # fmt: skip
        return Selection(
            self._rows[:pairs], self._local[:pairs], self._active[:bodies], self._bands[:bands], even,
            self._rows[m - lost : m], shortest, reach,
        )  # fmt: skip

    def state(self) -> dict[str, NDArray[Any]]:
        """What the list was made from, as copies: with it :meth:`restore` makes the same list."""
        return {"position": self._position.copy(), "motion": self._motion.copy(), "range": np.array([self._range])}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Make the list again that :meth:`state` was taken of."""
        self._position, self._motion = np.array(state["position"]), np.array(state["motion"])
        self._range = float(state["range"][0])
        if self._range >= 0.0:
            self._build()
