"""What pairs remember from step to step: springs, and the contact that is under way."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["LAW_COLUMNS", "PHASE_TOUCHING", "STATE_COLUMNS", "History"]

Floats = NDArray[np.float64]

# The kernels' structs (pair.hpp), a column a member.
LAW_COLUMNS = (
    "k_n", "eta_n", "k_t", "eta_t", "mu",
    "lub_inverse", "lub_log", "gap_floor", "gap_cut", "gap_touching",
)  # fmt: skip
STATE_COLUMNS = (
    "xi_x", "xi_y", "xi_z", "phase", "start", "end", "impact_speed", "rebound_speed",
    "max_overlap", "overlap", "work",
)  # fmt: skip
PHASE_TOUCHING = 1.0
_PHASE = STATE_COLUMNS.index("phase")
_OVERLAP = STATE_COLUMNS.index("overlap")


class History:
    """Rows of the pairs in contact, sorted by (i, j).

    Parameters
    ----------
    bodies : int
        Number of bodies.

    Attributes
    ----------
    pairs : ndarray of int32, (K, 2)
    states : ndarray, (K, 11)
        Columns of :data:`STATE_COLUMNS`.
    """

    def __init__(self, bodies: int) -> None:
        self._bodies = bodies
        self.pairs: NDArray[np.int32] = np.empty((0, 2), np.int32)
        self.states: Floats = np.empty((0, len(STATE_COLUMNS)))

    def __len__(self) -> int:
        return len(self.pairs)

    @property
    def largest_overlap(self) -> float:
        """Of the pairs in contact, [m]; 0 where there is none."""
        return max(0.0, float(self.states[:, _OVERLAP].max())) if len(self) else 0.0

    def _keys(self, pairs: NDArray[np.int32]) -> NDArray[np.int64]:
        result: NDArray[np.int64] = pairs[:, 0] * np.int64(self._bodies + 6) + pairs[:, 1] + 6
        return result

    def carried_to(self, pairs: NDArray[np.int32]) -> tuple[Floats, NDArray[np.bool_]]:
        """States of a new list of pairs, and which remembered pairs it no longer has.

        Parameters
        ----------
        pairs : ndarray of int32, (M, 2)
            Sorted by (i, j).

        Returns
        -------
        states : ndarray, (M, 11)
        is_lost : ndarray of bool, (K,)
        """
        states = np.zeros((len(pairs), len(STATE_COLUMNS)))
        if not len(self):
            return states, np.zeros(0, np.bool_)
        have, want = self._keys(self.pairs), self._keys(pairs)
        at = np.searchsorted(want, have)
        found = at < len(want)
        found[found] = want[at[found]] == have[found]
        states[at[found]] = self.states[found]
        return states, ~found

    def keep(self, pairs: NDArray[np.int32], states: Floats) -> None:
        """Replace what is remembered by the pairs that are in contact."""
        touching = states[:, _PHASE] > 0.0
        self.pairs, self.states = pairs[touching], states[touching]
