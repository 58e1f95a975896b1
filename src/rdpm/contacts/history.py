"""What pairs remember from step to step: the contact that is under way, and what their law remembers of it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .pair_table import PairTable
from .rows import APART, STATE, Rows

__all__ = ["History"]

class History:
    """Rows of the pairs in contact, sorted by (i, j).

    Parameters
    ----------
    bodies : int
        Number of bodies.
    dtype : dtype
        Of what the law remembers.
    partners : int
        `rdpm.grid.Box.partners`: -partners is the lowest id of a wall.

    Attributes
    ----------
    ids : ndarray of int32, (K, 2)
    states : ndarray of :data:`STATE`, (K,)
    histories : ndarray of `dtype`, (K,)
    """

    def __init__(self, bodies: int, dtype: np.dtype[np.void], partners: int = 7) -> None:
        self._bodies, self._partners = bodies, partners
        self.ids: NDArray[np.int32] = np.empty((0, 2), np.int32)
        self.states: Rows = np.empty(0, STATE)
        self.histories: Rows = np.empty(0, dtype)
        self._table: PairTable | None = None  # whose rows are these

    def __len__(self) -> int:
        return len(self.ids)

    @property
    def largest_overlap(self) -> float:
        """Of the pairs in contact, [m]; 0 where there is none."""
        return max(0.0, float(self.states["overlap"].max())) if len(self) else 0.0

    def _keys(self, ids: NDArray[np.int32]) -> NDArray[np.int64]:
        result: NDArray[np.int64] = (
            ids[:, 0] * np.int64(self._bodies + self._partners) + ids[:, 1] + self._partners
        )
        return result

    def carry_to(self, table: PairTable) -> NDArray[np.bool_]:
        """Fill the states and histories of a table; those of pairs that are not in contact become zero.

        Parameters
        ----------
        table : PairTable

        Returns
        -------
        ndarray of bool, (K,)
            Remembered pairs that the table does not have.
        """
        if table is self._table:
            return np.zeros(len(self), np.bool_)
        table.state, table.history = (np.zeros(len(table), rows.dtype) for rows in (table.state, table.history))
        if not len(self):
            return np.zeros(0, np.bool_)
        have, want = self._keys(self.ids), self._keys(table.ids)
        at = np.searchsorted(want, have)
        found = at < len(want)
        found[found] = want[at[found]] == have[found]
        table.state[at[found]] = self.states[found]
        table.history[at[found]] = self.histories[found]
        return ~found

    def keep(self, table: PairTable) -> None:
        """Replace what is remembered by the pairs of a table that are in contact."""
        touching = table.state["phase"] != APART
        self.ids, self.states, self.histories = table.ids[touching], table.state[touching], table.history[touching]
        self._table = table
