"""Which bodies may meet in the next step, and how near each body's nearest surface is."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rdpm import _core
from rdpm.particles.state import Bodies

from .walls import Box

__all__ = ["NO_NEIGHBOUR", "Neighbours", "nearest_gaps"]

NO_NEIGHBOUR = -7
"""Neighbour of a body that is alone in a box without sides."""

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
            i and j > i, or j = -1..-6 for the sides; a view that the next call overwrites.
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
        gap, neighbour = np.empty(len(b)), np.empty(len(b), np.int64)
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
        Whose surface: a body, a side (-1..-6), or :data:`NO_NEIGHBOUR`.

    Examples
    --------
    >>> bodies = Bodies(np.array([1.0, 1.0]), np.ones(2), np.array([[2.0, 2.0, 2.0], [2.0, 2.0, 3.5]]))
    >>> box = Box((4.0, 4.0, 10.0), (False, False, False), (True, True, True))
    >>> gap, neighbour = nearest_gaps(bodies, box)
    >>> gap.tolist(), neighbour.tolist()
    ([0.5, 0.5], [1, 0])
    """
    return Neighbours(bodies, box).nearest()
