"""What all ranks have, brought to the root."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm.parallel.agreement import on_root
from rdpm.parallel.ranks import Ranks

__all__ = ["Planes", "rows_on_root", "with_planes"]

Floats = NDArray[np.float64]


class Planes:
    """An array of the whole box whose planes the ranks have: the root gets them slab by slab.

    Parameters
    ----------
    ranks : Ranks
    own : ndarray, (planes, ...)
        Of this rank; those of the ranks follow each other in the whole array.

    Attributes
    ----------
    shape : tuple of int
        Of the whole.
    dtype : numpy.dtype

    Examples
    --------
    >>> from rdpm.parallel.ranks import ALONE
    >>> [part.shape for part in Planes(ALONE, np.ones((4, 2, 3)))]
    [(4, 2, 3)]
    """

    def __init__(self, ranks: Ranks, own: NDArray[Any]) -> None:
        self._ranks, self._own = ranks, np.ascontiguousarray(own)
        self._counts = [int(n) for n in ranks.table([len(own)])[:, 0]]
        self.shape, self.dtype = (sum(self._counts), *own.shape[1:]), own.dtype
        self._next = 0

    def __iter__(self) -> Iterator[NDArray[Any]]:
        """On the root, once: the planes of each rank, from bottom to top."""
        while self._next < self._ranks.size:
            yield self._take()

    def _take(self) -> NDArray[Any]:
        rank, self._next = self._next, self._next + 1
        if rank == 0:
            return self._own
        part = np.empty((self._counts[rank], *self.shape[1:]), self.dtype)
        self._ranks.swap([], [(rank, part)])
        return part

    def finish(self) -> None:
        """On the root take what is left; elsewhere send what this rank has."""
        if self._ranks.rank == 0:
            for _ in self:
                pass
        else:
            self._ranks.swap([(0, self._own)], [])


def with_planes(ranks: Ranks, planes: Sequence[Planes], do: Callable[[], None]) -> None:
    """Have the root do something that takes all planes, in their order.

    Examples
    --------
    >>> from rdpm.parallel.ranks import ALONE
    >>> ones = Planes(ALONE, np.ones((4, 2, 3)))
    >>> with_planes(ALONE, [ones], lambda: print(sum(part.sum() for part in ones)))
    24.0
    """

    def take() -> None:
        try:
            do()
        finally:  # nobody must wait for a root that failed
            for each in planes:
                each.finish()

    if ranks.rank != 0:
        for each in planes:
            each.finish()
    on_root(ranks, take)


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
