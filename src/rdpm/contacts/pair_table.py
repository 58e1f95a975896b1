"""The pairs of a step: who they are, what a law knows of them, its parameters, what they remember."""

from __future__ import annotations

from copy import copy
from math import inf
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from rdpm.conventions import FIRST_WALL, NO_NEIGHBOUR
from rdpm.grid import Box
from rdpm.particles.state import Bodies

from .lubrication import LUBRICATION, Lubrication
from .rows import PAIR, STATE, Rows, zero_rows

__all__ = ["KindParameters", "PairTable", "pairs_of"]


class _RowTypes(Protocol):
    @property
    def parameters(self) -> np.dtype[np.void]: ...

    @property
    def history(self) -> np.dtype[np.void]: ...


class _Law(Protocol):
    """What a table takes of a :class:`rdpm.contacts.law.ContactLaw`."""

    @property
    def driver(self) -> _RowTypes: ...

    def parameters(self, pairs: Rows) -> Rows: ...

    def time_scale(self, pairs: Rows) -> NDArray[np.float64]: ...


def pairs_of(bodies: Bodies, box: Box, ids: NDArray[np.int32]) -> Rows:
    """What a law may know of these pairs.

    Parameters
    ----------
    bodies : Bodies
    box : Box
    ids : ndarray of int32, (M, 2)
        i and j, or -1..-6 for the faces of the box, -8 and below for the walls within it.

    Returns
    -------
    ndarray of :data:`rdpm.contacts.PAIR`, (M,)
        The reduced mass is inf where neither moves freely.

    Examples
    --------
    >>> bodies = Bodies(np.array([1.0, 2.0]), np.ones(2), np.array([[2.0, 2.0, 2.0], [2.0, 2.0, 3.5]]))
    >>> pairs = pairs_of(bodies, Box((4.0, 4.0, 10.0)), np.array([[0, -5], [0, 1]], np.int32))
    >>> pairs["reduced_radius"].round(3).tolist(), pairs["smaller_diameter"].tolist()
    ([0.5, 0.333], [1.0, 1.0])
    """
    i, j = ids.T
    wall = j < 0
    other = np.where(wall, i, j)
    inverse_mass, curvature = bodies.is_free / bodies.mass, 2.0 / bodies.diameter
    result = np.empty(len(ids), PAIR)
    with np.errstate(divide="ignore"):
        result["reduced_mass"] = 1.0 / (inverse_mass[i] + np.where(wall, 0.0, inverse_mass[other]))
    result["reduced_radius"] = 1.0 / (curvature[i] + np.where(wall, 0.0, curvature[other]))
    for n, inner in enumerate(box.walls):  # the mean of both principal curvatures' radii
        mine = j == FIRST_WALL - n
        result["reduced_radius"][mine] = (curvature[i[mine]] * (curvature[i[mine]] + inner.curvature)) ** -0.5
    result["smaller_diameter"] = np.minimum(bodies.diameter[i], bodies.diameter[other])
    is_face = wall & (j > NO_NEIGHBOUR)
    result["is_frictionless"] = is_face & box.is_free_slip_face[np.where(is_face, -1 - j, 0)]
    return result


class KindParameters:
    """Parameters by kind of pair: few kinds, many pairs, so the law is asked once a kind.

    Two pairs are of one kind if their bodies are alike in diameter, mass and freedom to move, and walls in friction.

    Parameters
    ----------
    bodies : Bodies
        N spheres; their diameters and masses stay.
    law : ContactLaw
    walls : int
        Within the box; each is of its own kind.
    """

    def __init__(self, bodies: Bodies, law: _Law, walls: int = 0) -> None:
        self._bodies, self._law, self._walls = bodies, law, walls
        alike = np.unique(np.column_stack([bodies.diameter, bodies.mass]), axis=0, return_inverse=True)[1]
        self._alike: NDArray[np.int64] = alike.reshape(-1).astype(np.int64)
        self._forget()

    def _forget(self) -> None:
        self._keys: NDArray[np.int64] = np.empty(0, np.int64)  # rising
        self._rows: Rows = np.empty(0, self._law.driver.parameters)
        self._times: NDArray[np.float64] = np.empty(0)

    def of(
        self, ids: NDArray[np.int32], pairs: Rows
    ) -> tuple[Rows, NDArray[np.int32], NDArray[np.float64]]:
        """Parameters by kind, (K,); the kind of each of M >= 1 pairs; their time scales, (M,) [s]."""
        keys = self._keys_of(ids, pairs)
        if len(self._keys) > 1000 + 4 * len(ids):
            self._forget()
        at = np.searchsorted(self._keys, keys)
        unknown = np.append(self._keys, -1)[at] != keys
        if unknown.any():
            new, first = np.unique(keys[unknown], return_index=True)
            examples = pairs[unknown][first]
            self._keys = np.append(self._keys, new)
            order = np.argsort(self._keys)
            self._keys = self._keys[order]
            self._rows = np.append(self._rows, self._law.parameters(examples))[order]
            self._times = np.append(self._times, self._law.time_scale(examples))[order]
            at = np.searchsorted(self._keys, keys)
        return self._rows, at.astype(np.int32), self._times[at]

    def _keys_of(self, ids: NDArray[np.int32], pairs: Rows) -> NDArray[np.int64]:
        i, j = ids.T
        wall = j < 0
        body = 2 * self._alike + self._bodies.is_free
        bodies = 2 * np.int64(len(self._bodies))
        partner = np.where(wall, pairs["is_frictionless"], 2 + body[np.where(wall, i, j)])
        inner = j <= FIRST_WALL
        partner[inner] = bodies + 2 + FIRST_WALL - j[inner]
        keys: NDArray[np.int64] = body[i] * (bodies + 2 + self._walls) + partner
        return keys


class PairTable:
    """M pairs with all that the driver reads and writes of them.

    Parameters
    ----------
    ids : ndarray of int32, (M, 2)
        i and j > i; j < 0 for walls.
    bodies : Bodies
    box : Box
    law : ContactLaw
    kinds : KindParameters
    lubrication : Lubrication or None

    Attributes
    ----------
    pairs : ndarray of :data:`rdpm.contacts.PAIR`, (M,)
    kinds : ndarray of ``law.driver.parameters``, (K,)
        Parameters of each kind of pair.
    kind : ndarray of int32, (M,)
        Of each pair.
    lubrication : ndarray of :data:`rdpm.contacts.lubrication.LUBRICATION`, (M,)
        (0,) without lubrication.
    state : ndarray of :data:`rdpm.contacts.rows.STATE`, (M,)
        Contact under way; apart until :meth:`rdpm.contacts.history.History.carry_to` fills it.
    history : ndarray of ``law.driver.history``, (M,)
        What the law remembers of it.
    times : ndarray, (M,), [s]
        Time scale of each pair.
    """

    def __init__(
        self,
        ids: NDArray[np.int32],
        bodies: Bodies,
        box: Box,
        law: _Law,
        kinds: KindParameters,
        lubrication: Lubrication | None,
    ) -> None:
        self.ids = ids.copy()
        self.pairs = pairs_of(bodies, box, ids)
        self.state, self.history = zero_rows(len(ids), STATE), np.zeros(len(ids), law.driver.history)
        self.kinds, self.kind, self.times = np.zeros(0, law.driver.parameters), np.zeros(0, np.int32), np.zeros(0)
        self.lubrication = np.zeros(0, LUBRICATION)
        if not len(ids):
            return
        self.kinds, self.kind, self.times = kinds.of(ids, self.pairs)
        if lubrication:
            radius, (i, j) = 0.5 * bodies.diameter, ids.T
            other = np.where(j < 0, inf, radius[np.where(j < 0, i, j)])
            self.lubrication = lubrication.rows(np.minimum(radius[i], other), np.maximum(radius[i], other))
            for n, wall in enumerate(box.walls):
                mine = j == FIRST_WALL - n
                own = radius[i[mine]]
                self.lubrication[mine] = lubrication.rows_of_inner_walls(own, np.full_like(own, wall.curvature))
            self.lubrication[self.pairs["is_frictionless"]] = 0.0

    def __len__(self) -> int:
        return len(self.ids)

    @property
    def parameters(self) -> Rows:
        """Parameters of each pair, (M,)."""
        return self.kinds[self.kind]

    def part(self, rows: NDArray[np.int32]) -> PairTable:
        """Some of the pairs, as copies."""
        result = copy(self)
        for name in ("ids", "pairs", "state", "history", "kind", "times"):
            setattr(result, name, getattr(self, name)[rows])
        if len(self.lubrication):
            result.lubrication = self.lubrication[rows]
        return result
