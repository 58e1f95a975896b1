"""What pairs remember from step to step: the contact that is under way, and what their law remembers of it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .pair_table import PairTable
from .rows import APART, STATE, Rows

__all__ = ["History"]

class History:
    """Rows of the pairs in contact.

    Parameters
    ----------
    bodies : int
        Number of bodies.
    dtype : dtype
        Of what the law remembers.
    partners : int
        `rdpm.grid.Box.partners`: -partners is the lowest id of a wall.
    """

    def __init__(self, bodies: int, dtype: np.dtype[np.void], partners: int = 7) -> None:
        self._bodies, self._partners = bodies, partners
        self._rows: tuple[NDArray[np.int32], Rows, Rows] = (
            np.empty((0, 2), np.int32), np.empty(0, STATE), np.empty(0, dtype)
        )  # fmt: skip
        self._table: PairTable | None = None  # that holds the rows
        self.count, self.largest_overlap = 0, 0.0

    def __len__(self) -> int:
        return self.count

    def rows(self) -> tuple[NDArray[np.int32], Rows, Rows]:
        """Ids (K, 2), states and what the law remembers, (K,) each, sorted by (i, j)."""
        if self._table is not None:
            table = self._table
            touching = np.flatnonzero(table.state["phase"] != APART)
            touching = touching[np.argsort(self._keys(table.ids[touching]))]
            self._rows = table.ids[touching], table.state[touching], table.history[touching]
        return self._rows

    def restore(self, ids: NDArray[np.int32], states: Rows, histories: Rows) -> None:
        """Remember these; sorted by (i, j)."""
        self._rows, self._table = (ids, states, histories), None
        self.count = len(ids)
        self.largest_overlap = max(0.0, float(states["overlap"].max(initial=0.0)))

    def _keys(self, ids: NDArray[np.int32]) -> NDArray[np.int64]:
        result: NDArray[np.int64] = (
            ids[:, 0] * np.int64(self._bodies + self._partners) + ids[:, 1] + self._partners
        )
        return result

    def carry_to(self, table: PairTable) -> tuple[NDArray[np.int32], Rows]:
        """Fill the states and histories of a table.

        Parameters
        ----------
        table : PairTable
            New: nothing of it is in contact.

        Returns
        -------
        ids : ndarray of int32, (L, 2)
        states : ndarray of :data:`STATE`, (L,)
            Of remembered pairs that the table does not have.
        """
        ids, states, histories = self.rows()
        self._table = table
        if not len(ids):
            return ids, states
        have, want = self._keys(ids), self._keys(table.ids)
        order = np.argsort(want)
        at = np.searchsorted(want, have, sorter=order)
        found = at < len(want)
        at[found] = order[at[found]]
        found[found] = want[at[found]] == have[found]
        table.state[at[found]], table.history[at[found]] = states[found], histories[found]
        return ids[~found], states[~found]

    def keep(self, count: int, largest_overlap: float) -> None:
        """Take note of how many pairs of the table are in contact, and of their overlap [m]."""
        self.count, self.largest_overlap = count, largest_overlap
