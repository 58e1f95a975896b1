"""Halos of a slab: planes that the slabs below and above it have."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rdpm.parallel.decomposition import Slab
from rdpm.parallel.ranks import Ranks

__all__ = ["Halo"]

Field = NDArray[np.float64]
Planes = list[tuple[int | None, Field]]


class Halo:
    """Exchanges planes with the slabs below and above: all that travels at a moment in one message a neighbour.

    Parameters
    ----------
    ranks : Ranks
    slab : Slab
    """

    def __init__(self, ranks: Ranks, slab: Slab) -> None:
        self._ranks, self._slab = ranks, slab
        self._buffers: dict[tuple[bool, int, int], Field] = {}

    def exchange(self, up: Sequence[Field] = (), down: Sequence[Field] = ()) -> None:
        """Change halos: of `up` the lower ones, from the slab below; of `down` the upper ones, from the slab above.

        Parameters
        ----------
        up, down : sequence of ndarray, (planes+2, ny+2, nx+2)
        """
        n, (lower, upper) = self._slab.planes, (self._slab.lower, self._slab.upper)
        received = self._swap(
            [(upper, f[n]) for f in up] + [(lower, f[1]) for f in down],
            [(lower, f[0]) for f in up] + [(upper, f[n + 1]) for f in down],
        )
        for target, values in received:
            np.copyto(target, values)

    def deep(self, fields: Sequence[Field], depth: int) -> list[tuple[Field, Field]]:
        """Of each field the planes in the slabs below and above, (depth, ny+2, nx+2) each, none at a face of the box.

        They are overwritten by the next call.
        """
        n, (lower, upper) = self._slab.planes, (self._slab.lower, self._slab.upper)
        none = np.empty((0, *fields[0].shape[1:]))
        like = [f[:depth] for f in fields]
        received = self._swap(
            [(upper, f[n - depth + 1 : n + 1]) for f in fields] + [(lower, f[1 : depth + 1]) for f in fields],
            [(lower, f) for f in like] + [(upper, f) for f in like],
        )
        planes = [values for _, values in received]
        below = planes[: len(fields)] if lower is not None else [none] * len(fields)
        above = planes[-len(fields) :] if upper is not None else [none] * len(fields)
        return list(zip(below, above, strict=True))

    def _swap(self, sends: Planes, receives: Planes) -> list[tuple[Field, Field]]:
        """Send planes, those to one rank together; to each place where some are expected, what came for it."""
        ranks = list(dict.fromkeys(rank for rank, _ in sends + receives if rank is not None))
        out, into, found = [], [], []
        for rank in ranks:
            mine = [planes for to, planes in sends if to == rank]
            theirs = [planes for of, planes in receives if of == rank]
            if mine:
                sent = self._buffer(True, rank, mine)
                for target, planes in zip(_parts(sent, mine), mine, strict=True):
                    np.copyto(target, planes)
                out.append((rank, sent))
            if theirs:
                into.append((rank, self._buffer(False, rank, theirs)))
        self._ranks.swap(out, into)
        of_rank = {rank: iter(_parts(buffer, [f for of, f in receives if of == rank])) for rank, buffer in into}
        for of, target in receives:
            if of is not None:
                found.append((target, next(of_rank[of])))
        return found

    def _buffer(self, is_sent: bool, rank: int, planes: Sequence[Field]) -> Field:
        """One that was used for as much before: of the size of planes, new memory is dear."""
        key = is_sent, rank, sum(each.size for each in planes)
        if key not in self._buffers:
            self._buffers[key] = np.empty(key[2])
        return self._buffers[key]


def _parts(buffer: Field, like: Sequence[Field]) -> list[Field]:
    """Views of a buffer, one after the other, of the shapes of these arrays."""
    ends = np.cumsum([each.size for each in like])
    return [buffer[end - each.size : end].reshape(each.shape) for end, each in zip(ends, like, strict=True)]
