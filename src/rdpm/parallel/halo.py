"""Halos of a slab: planes that the slabs below and above it have."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rdpm.parallel.decomposition import Slab
from rdpm.parallel.ranks import Ranks

__all__ = ["Halo"]

Field = NDArray[np.float64]


class Halo:
    """Exchanges planes with the slabs below and above.

    Parameters
    ----------
    ranks : Ranks
    slab : Slab
    """

    def __init__(self, ranks: Ranks, slab: Slab) -> None:
        self._ranks, self._slab = ranks, slab

    def exchange(self, up: Sequence[Field] = (), down: Sequence[Field] = ()) -> None:
        """Change halos: of `up` the lower ones, from the slab below; of `down` the upper ones, from the slab above.

        Parameters
        ----------
        up, down : sequence of ndarray, (planes+2, ny+2, nx+2)
        """
        n, (lower, upper) = self._slab.planes, (self._slab.lower, self._slab.upper)
        self._swap(
            [(upper, f[n]) for f in up] + [(lower, f[1]) for f in down],
            [(lower, f[0]) for f in up] + [(upper, f[n + 1]) for f in down],
        )

    def deep(self, field: Field, depth: int) -> tuple[Field, Field]:
        """Planes of a field in the slabs below and above: (depth, ny+2, nx+2) each, none at a face of the box."""
        n, (lower, upper) = self._slab.planes, (self._slab.lower, self._slab.upper)
        below, above = (np.empty((depth if side is not None else 0, *field.shape[1:])) for side in (lower, upper))
        self._swap(
            [(upper, field[n - depth + 1 : n + 1]), (lower, field[1 : depth + 1])], [(lower, below), (upper, above)]
        )
        return below, above

    def _swap(self, sends: Sequence[tuple[int | None, Field]], receives: Sequence[tuple[int | None, Field]]) -> None:
        self._ranks.swap(
            [(rank, plane) for rank, plane in sends if rank is not None],
            [(rank, plane) for rank, plane in receives if rank is not None],
        )
