"""The pairs of a step: who they are, what a law knows of them, its parameters, what they remember."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rdpm.grid import Box
from rdpm.particles.state import Bodies

from .history import STATE
from .law import PAIR
from .lubrication import LUBRICATION, Lubrication
from .rows import Rows

if TYPE_CHECKING:
    from .law import ContactLaw

__all__ = ["PairTable", "body_kinds", "pairs_of"]


def pairs_of(bodies: Bodies, box: Box, ids: NDArray[np.int32]) -> Rows:
    """What a law may know of these pairs.

    Parameters
    ----------
    bodies : Bodies
    box : Box
    ids : ndarray of int32, (M, 2)
        i and j, or -1..-6 for the faces of the box.

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
    result["smaller_diameter"] = np.minimum(bodies.diameter[i], bodies.diameter[other])
    result["is_frictionless"] = wall & box.is_free_slip_face[np.where(wall, -1 - j, 0)]
    return result


def body_kinds(bodies: Bodies) -> NDArray[np.int64]:
    """Number bodies of equal diameter and mass alike, (N,)."""
    columns = np.column_stack([bodies.diameter, bodies.mass])
    return np.unique(columns, axis=0, return_inverse=True)[1].reshape(-1).astype(np.int64)


class PairTable:
    """M pairs with all that the driver reads and writes of them.

    Parameters
    ----------
    ids : ndarray of int32, (M, 2)
        Sorted by (i, j); j = -1..-6 for the faces of the box.
    bodies : Bodies
    kinds : ndarray of int64, (N,)
        From :func:`body_kinds`. Few kinds of pairs, many pairs: the law is asked once a kind.
    box : Box
    law : ContactLaw
    lubrication : Lubrication or None

    Attributes
    ----------
    pairs : ndarray of :data:`rdpm.contacts.PAIR`, (M,)
    parameters : ndarray of ``law.driver.parameters``, (M,)
    lubrication : ndarray of :data:`rdpm.contacts.lubrication.LUBRICATION`, (M,)
        (0,) without lubrication.
    state : ndarray of :data:`rdpm.contacts.history.STATE`, (M,)
        Contact under way; apart until :meth:`rdpm.contacts.history.History.carry_to` fills it.
    history : ndarray of ``law.driver.history``, (M,)
        What the law remembers of it.
    shortest : float, [s]
        Smallest time scale of the pairs; inf without pairs.
    """

    def __init__(
        self,
        ids: NDArray[np.int32],
        bodies: Bodies,
        kinds: NDArray[np.int64],
        box: Box,
        law: ContactLaw,
        lubrication: Lubrication | None,
    ) -> None:
        self.ids, self._motion = ids.copy(), bodies.motion.copy()
        self.pairs = pairs_of(bodies, box, ids)
        self.state, self.history = np.zeros(len(ids), STATE), np.zeros(len(ids), law.driver.history)
        self.parameters, self.shortest = np.zeros(len(ids), law.driver.parameters), inf
        self.lubrication = np.zeros(len(ids) if lubrication else 0, LUBRICATION)
        if not len(ids):
            return
        first, kind = self._kinds(kinds, bodies)
        few = self.pairs[first]
        self.parameters[:] = law.parameters(few)[kind]
        self.shortest = float(law.time_scale(few).min())
        if lubrication:
            radius, (i, j) = 0.5 * bodies.diameter, ids.T
            self.lubrication[:] = lubrication.rows(radius[i], np.where(j < 0, inf, radius[np.where(j < 0, i, j)]))
            self.lubrication[self.pairs["is_frictionless"]] = 0.0

    def _kinds(self, kinds: NDArray[np.int64], bodies: Bodies) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """First pair of each kind, and the kind of each pair."""
        i, j = self.ids.T
        of_body = 2 * kinds + bodies.is_free
        count = 2 * (int(kinds.max()) + 1)
        partner = np.where(j < 0, self.pairs["is_frictionless"], 2 + of_body[np.where(j < 0, i, j)])
        _, first, kind = np.unique(of_body[i] * (count + 2) + partner, return_index=True, return_inverse=True)
        return first, kind

    def __len__(self) -> int:
        return len(self.ids)

    def is_of(self, ids: NDArray[np.int32], bodies: Bodies) -> bool:
        """Whether these are still the pairs, and the same bodies move freely."""
        return np.array_equal(ids, self.ids) and np.array_equal(bodies.motion, self._motion)
