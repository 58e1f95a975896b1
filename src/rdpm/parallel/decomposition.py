"""The box cut across z: which planes of cells each rank has."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from rdpm.errors import CaseError

__all__ = ["LEAST_PLANES", "Slab", "cut", "slabs"]

#: Planes of the thinnest slab.
LEAST_PLANES = 8


@dataclass(frozen=True)
class Slab:
    """The planes of one rank.

    Parameters
    ----------
    first : int
        Planes of the box below them.
    planes : int
    whole : int
        Planes of the box.
    lower, upper : int or None
        The ranks of the slabs below and above; None at a face of the box.

    Examples
    --------
    >>> Slab(8, 8, 24, 0, 2).take
    slice(8, 18, None)
    """

    first: int
    planes: int
    whole: int
    lower: int | None
    upper: int | None

    @property
    def take(self) -> slice:
        """Its planes and their halo, among those of a field of the whole box with its halo."""
        return slice(self.first, self.first + self.planes + 2)

    @property
    def own(self) -> slice:
        """Among the planes of a field of the whole box with its halo, what it alone has, and the box's halo."""
        lower = self.first + (0 if self.first == 0 else 1)
        upper = self.first + self.planes + (2 if self.first + self.planes == self.whole else 1)
        return slice(lower, upper)


def cut(cost: NDArray[np.float64], ranks: int, least: int = LEAST_PLANES) -> list[int]:
    """Share planes among ranks: equal costs, as far as whole planes allow.

    Parameters
    ----------
    cost : ndarray, (planes,)
        Of each plane, in any unit; > 0.
    ranks : int
    least : int
        Planes of the thinnest slab.

    Returns
    -------
    list of int, (ranks,)
        Planes of each slab, from bottom to top.

    Raises
    ------
    CaseError
        Too many ranks.

    Examples
    --------
    >>> cut(np.ones(96), 4)
    [24, 24, 24, 24]
    >>> cut(np.r_[np.full(24, 4.0), np.ones(72)], 3)
    [14, 26, 56]
    """
    planes = len(cost)
    if planes < ranks * least:
        raise CaseError(
            "run", f"{ranks} MPI ranks", f"must be at most {planes // least}",
            f"the box has {planes} planes of cells along z, and a rank takes at least {least}",
            "Start fewer ranks, each with more threads.",
        )  # fmt: skip
    before = np.concatenate([[0.0], np.cumsum(cost)])
    ends = [0]
    for rank in range(1, ranks):
        target = before[-1] * rank / ranks
        found = int(np.searchsorted(before, target))
        if found > 0 and target - before[found - 1] < before[found] - target:
            found -= 1
        ends.append(min(max(found, ends[-1] + least), planes - (ranks - rank) * least))
    ends.append(planes)
    return [upper - lower for lower, upper in pairwise(ends)]


def slabs(planes: Sequence[int], is_periodic: bool) -> list[Slab]:
    """Return the slab of each rank.

    Parameters
    ----------
    planes : sequence of int
        Of each rank, from bottom to top.
    is_periodic : bool
        Along z: the first slab then adjoins the last one.

    Examples
    --------
    >>> [slab.first for slab in slabs([8, 10, 8], False)], slabs([8, 8], True)[0].lower
    ([0, 8, 18], 1)
    """
    count, whole = len(planes), sum(planes)
    first = [sum(planes[:rank]) for rank in range(count)]
    return [
        Slab(
            first[rank], planes[rank], whole,
            rank - 1 if rank > 0 else count - 1 if is_periodic else None,
            rank + 1 if rank + 1 < count else 0 if is_periodic else None,
        )
        for rank in range(count)
    ]  # fmt: skip
