"""Whether spheres in a box overlap, periodic images included."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["first_overlap", "wrapped"]

Floats = NDArray[np.float64]

_FEW = 200  # below, all pairs at once are cheaper than a tree (and than importing one)


def wrapped(position: Floats, box: Floats, periodic: NDArray[np.bool_]) -> Floats:
    """Return points (N, 3) with their periodic coordinates in [0, box)."""
    with np.errstate(invalid="ignore"):  # NaN stands for no place yet
        inside = np.where(periodic, np.mod(position, box), position)
    return np.where(periodic & (inside >= box), 0.0, inside)


def first_overlap(
    position: Floats, diameter: Floats, box: Floats, periodic: NDArray[np.bool_], tolerance: float
) -> tuple[int, int, float] | None:
    """Find two spheres that overlap.

    Parameters
    ----------
    position : ndarray, (N, 3), [m]
        Wrapped into the box along periodic directions.
    diameter : ndarray, (N,), [m]
        At most half the box along a periodic direction, so that the nearest image is the only one to meet.
    box : ndarray, (3,), [m]
    periodic : ndarray of bool, (3,)
    tolerance : float, [-]
        Overlap over the smaller diameter that passes for a touch.

    Returns
    -------
    tuple (i, j, gap) or None
        Ids i < j of an overlapping pair, the lowest among up to 200 spheres, and their gap [m] < 0.

    Examples
    --------
    >>> box, periodic = np.ones(3), np.array([True, False, False])
    >>> centres = np.array([[0.05, 0.5, 0.5], [0.96, 0.5, 0.5]])
    >>> i, j, gap = first_overlap(centres, np.full(2, 0.1), box, periodic, 0.0)
    >>> i, j, round(gap, 12)
    (0, 1, -0.01)
    """
    if len(diameter) < 2:
        return None
    i, j = (
        _all_pairs(len(diameter))
        if len(diameter) <= _FEW
        else _near_pairs(position, diameter, box, periodic, tolerance)
    )
    delta = position[i] - position[j]
    delta -= np.where(periodic, box * np.round(delta / box), 0.0)
    gap = np.linalg.norm(delta, axis=1) - 0.5 * (diameter[i] + diameter[j])
    hits = np.flatnonzero(gap < -tolerance * np.minimum(diameter[i], diameter[j]))
    if hits.size == 0:
        return None
    hit = hits[np.lexsort((np.maximum(i, j)[hits], np.minimum(i, j)[hits]))[0]]
    return int(min(i[hit], j[hit])), int(max(i[hit], j[hit])), float(gap[hit])


def _all_pairs(count: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    i, j = np.triu_indices(count, k=1)
    return i.astype(np.int64), j.astype(np.int64)


def _near_pairs(
    position: Floats, diameter: Floats, box: Floats, periodic: NDArray[np.bool_], tolerance: float
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Pairs among which is an overlap if there is one: of nearest neighbours, or of all near a larger sphere."""
    from scipy.spatial import cKDTree

    tree = cKDTree(position, boxsize=np.where(periodic, box, 0.0))
    ids = np.arange(len(diameter))
    distance, nearest = tree.query(position, k=2)
    j = np.where(nearest[:, 0] == ids, nearest[:, 1], nearest[:, 0])
    # A touch to round-off is no overlap, and must not end the search.
    overlapping = distance[:, 1] - 0.5 * (diameter + diameter[j]) < -tolerance * np.minimum(diameter, diameter[j])
    large = np.flatnonzero(diameter > diameter.min())
    if overlapping.any() or large.size == 0:  # equal spheres: the nearest is the only one to ask
        return ids[overlapping], j[overlapping]
    # a larger sphere meets only centres within its diameter; none of these touch each other, so they are few
    hits = tree.query_ball_point(position[large], diameter[large])
    i = np.repeat(large, [len(hit) for hit in hits])
    near = np.concatenate([np.asarray(hit, dtype=np.int64) for hit in hits])
    return i[i != near], near[i != near]
