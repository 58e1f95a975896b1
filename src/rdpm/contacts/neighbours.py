"""Which bodies may meet in the next step, and how near each body's nearest surface is."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rdpm import _core
from rdpm.conventions import FIRST_WALL, NO_NEIGHBOUR
from rdpm.grid import Box
from rdpm.particles.state import Bodies

__all__ = ["Neighbours", "gaps_and_rates", "nearest_gaps"]

Floats = NDArray[np.float64]


class Neighbours:
    """Cell lists over a set of bodies; holds the scratch arrays.

    Parameters
    ----------
    bodies : Bodies
        Read at every call.
    box : Box
    """

    def __init__(self, bodies: Bodies, box: Box) -> None:
        self.bodies, self.box = bodies, box
        self.radius = 0.5 * bodies.diameter
        self._cell_start = np.empty(8 * len(bodies) + 65, np.int32)
        self._cell_order = np.empty(len(bodies), np.int32)
        self._pairs = np.empty((16 + 8 * len(bodies), 2), np.int32)

    def pairs(self, force: Floats, inverse_mass: Floats, dt: float, margin: float) -> NDArray[np.int32]:
        """Pairs whose gap may fall below ``margin`` within ``dt``, sorted by (i, j).

        Parameters
        ----------
        force : ndarray, (N, 3), [N]
        inverse_mass : ndarray, (N,), [1/kg]
            0 for a prescribed motion; pairs in which neither body can move are left out.
        dt : float, [s]
        margin : float, [m]
            >= 0.

        Returns
        -------
        ndarray of int32, (M, 2)
            i and j > i, or j < 0 for a wall (`rdpm.conventions`); a view that the next call overwrites.
        """
        b = self.bodies
        while True:
            found = _core.find_pairs(
                self.box.table, b.position, b.velocity, force, self.radius, inverse_mass, dt, margin,
                self._cell_start, self._cell_order, self._pairs,
            )  # fmt: skip
            if found <= len(self._pairs):
                return self._pairs[:found]
            self._pairs = np.empty((found + found // 4, 2), np.int32)

    def nearest(self) -> tuple[Floats, NDArray[np.int64]]:
        """Nearest surface of each body; see :func:`nearest_gaps`."""
        b = self.bodies
        gap, neighbour = np.full(len(b), np.inf), np.full(len(b), NO_NEIGHBOUR, np.int64)
        if len(b):
            _core.nearest_surfaces(
                self.box.table, b.position, self.radius, self._cell_start, self._cell_order, gap, neighbour
            )
        return gap, neighbour


def nearest_gaps(bodies: Bodies, box: Box) -> tuple[Floats, NDArray[np.int64]]:
    """Distance from each body's surface to the nearest other surface.

    Parameters
    ----------
    bodies : Bodies
        N spheres.
    box : Box

    Returns
    -------
    gap : ndarray, (N,), [m]
        Negative in contact; inf where there is no other surface.
    neighbour : ndarray of int64, (N,)
        Whose surface: a body, a face of the box (-1..-6), a wall within it (-8 and below), or
        `rdpm.conventions.NO_NEIGHBOUR`.

    Examples
    --------
    >>> bodies = Bodies(np.array([1.0, 1.0]), np.ones(2), np.array([[2.0, 2.0, 2.0], [2.0, 2.0, 3.5]]))
    >>> box = Box((4.0, 4.0, 10.0))
    >>> gap, neighbour = nearest_gaps(bodies, box)
    >>> gap.tolist(), neighbour.tolist()
    ([0.5, 0.5], [1, 0])
    """
    return Neighbours(bodies, box).nearest()


def gaps_and_rates(bodies: Bodies, box: Box, pairs: NDArray[np.int32]) -> tuple[Floats, Floats]:
    """Gaps of these pairs, and how fast they open.

    Parameters
    ----------
    bodies : Bodies
    box : Box
    pairs : ndarray of int32, (M, 2)
        i and j, or j < 0 for a wall.

    Returns
    -------
    gap : ndarray, (M,), [m]
        Negative in contact.
    rate : ndarray, (M,), [m/s]
        Of the gap: negative where the surfaces approach.

    Examples
    --------
    >>> bodies = Bodies(np.array([1.0, 1.0]), np.ones(2), np.array([[2.0, 2.0, 2.0], [2.0, 2.0, 3.5]]),
    ...                 velocity=np.array([[0.0, 0.0, 0.1], [0.0, 0.0, -0.1]]))
    >>> box = Box((4.0, 4.0, 10.0))
    >>> gap, rate = gaps_and_rates(bodies, box, np.array([[0, 1], [0, -5]], np.int32))
    >>> gap.tolist(), rate.tolist()
    ([0.5, 1.5], [-0.2, 0.1])
    """
    i, j = pairs.T
    size, period = np.array(box.size), box.period
    wall = j < 0
    other = np.where(wall, i, j)
    apart = bodies.position[i] - bodies.position[other]
    apart -= period * np.rint(np.divide(apart, period, out=np.zeros_like(apart), where=period > 0.0))
    distance = np.linalg.norm(apart, axis=1)
    normal = apart / np.where(distance > 0.0, distance, 1.0)[:, None]
    rate = np.einsum("mx,mx->m", normal, bodies.velocity[i] - bodies.velocity[other])
    gap = distance - 0.5 * (bodies.diameter[i] + bodies.diameter[other])
    face = np.where(wall & (j > NO_NEIGHBOUR), -1 - j, 0)
    axis, is_upper = face // 2, face % 2 == 1
    at, speed = bodies.position[i, axis], bodies.velocity[i, axis]
    from_wall = np.where(is_upper, size[axis] - at, at) - 0.5 * bodies.diameter[i]
    gap, rate = np.where(wall, from_wall, gap), np.where(wall, np.where(is_upper, -speed, speed), rate)
    for n, inner in enumerate(box.walls):
        mine = j == FIRST_WALL - n
        distance, away = inner.distance(bodies.position[i[mine]], period)
        gap[mine] = distance - 0.5 * bodies.diameter[i[mine]]
        rate[mine] = np.einsum("mx,mx->m", away, bodies.velocity[i[mine]])
    return gap, rate
