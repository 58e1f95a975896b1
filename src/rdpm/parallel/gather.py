"""What all ranks have, brought to the root."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rdpm.parallel.ranks import Ranks

__all__ = ["rows_on_root"]

Floats = NDArray[np.float64]


def rows_on_root(ranks: Ranks, mine: Floats) -> Floats:
    """Return on the root the rows of all ranks, rank after rank; on others none.

    Parameters
    ----------
    ranks : Ranks
    mine : ndarray, (n, columns)
        Of any number of rows.

    Examples
    --------
    >>> from rdpm.parallel.ranks import ALONE
    >>> rows_on_root(ALONE, np.ones((2, 3))).shape
    (2, 3)
    """
    mine = np.ascontiguousarray(mine)
    counts = [int(n) for n in ranks.table([len(mine)])[:, 0]]
    if ranks.rank != 0:
        ranks.swap([(0, mine)] if len(mine) else [], [])
        return mine[:0]
    parts = [mine] + [np.empty((n, mine.shape[1])) for n in counts[1:]]
    ranks.swap([], [(rank, part) for rank, part in enumerate(parts) if rank and len(part)])
    return np.concatenate(parts)
