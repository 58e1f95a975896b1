"""What each contact did, from the touch to the parting of the surfaces."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rdpm import design
from rdpm.particles.state import Bodies

__all__ = ["EPISODE", "FINISHED_COLUMNS", "Episodes"]

Floats = NDArray[np.float64]

EPISODE = np.dtype(
    [("i", np.int64), ("j", np.int64), ("kind", "U13")]
    + [
        (name, np.float64)
        for name in (
            "start_s", "duration_s", "steps", "max_overlap_fraction", "impact_speed_m_s", "rebound_speed_m_s",
            "restitution", "stokes_number", "work_J",
        )
    ]
)  # fmt: skip
r"""A contact.

``i``, ``j`` (-1..-6: a side of the box), ``kind`` ("sphere-sphere" or "sphere-wall"); ``start_s`` of the
touch; ``duration_s`` from the touch until the force vanished for the last time before the surfaces parted;
``steps``, that over the time step; ``max_overlap_fraction`` of the smaller diameter; normal speeds of
approach at the touch and of rebound at the end; ``restitution``, their ratio (nan where the bodies did not
meet with a speed, or were still in touch); ``stokes_number``
:math:`m_{ij}v/(6\pi\mu a_r^2)=\rho_{eff}v\,d_{eff}/(9\mu)` with :math:`d_{eff}=2a_r`,
:math:`a_r=a_ia_j/(a_i+a_j)` (the body's radius against a wall) and
:math:`\rho_{eff}=m_{ij}/(\tfrac43\pi a_r^3)`, nan when dry; ``work_J`` of the contact force on the pair,
friction included.
"""

# The kernel's struct (substeps.hpp), a column a member.
FINISHED_COLUMNS = ("pair", "start", "end", "max_overlap", "impact_speed", "rebound_speed", "work")


class Episodes:
    """Collects finished contacts.

    Parameters
    ----------
    bodies : Bodies
    viscosity : float or None, [Pa s]
        Of the fluid; None: dry.
    """

    def __init__(self, bodies: Bodies, viscosity: float | None) -> None:
        self._bodies, self._viscosity = bodies, viscosity
        self.rows: NDArray[np.void] = np.empty(0, EPISODE)

    def add(self, pairs: NDArray[np.int32], finished: Floats, dt: float) -> None:
        """Record contacts.

        Parameters
        ----------
        pairs : ndarray of int32, (K, 2)
        finished : ndarray, (K, 7)
            Columns of :data:`FINISHED_COLUMNS`; the first is not read.
        dt : float, [s]
            Time step.
        """
        i, j = pairs[:, 0], pairs[:, 1]
        _, start, end, overlap, impact, rebound, work = finished.T
        rows = np.empty(len(pairs), EPISODE)
        rows["i"], rows["j"] = i, j
        rows["kind"] = np.where(j < 0, "sphere-wall", "sphere-sphere")
        rows["start_s"], rows["duration_s"], rows["steps"] = start, end - start, (end - start) / dt
        rows["max_overlap_fraction"], rows["work_J"] = overlap, work
        rows["impact_speed_m_s"], rows["rebound_speed_m_s"] = impact, rebound
        met = impact > 0.0
        rows["restitution"] = np.where(met, rebound, np.nan) / np.where(met, impact, 1.0)
        rows["stokes_number"] = self._stokes_per_speed(i, j) * np.maximum(impact, 0.0)
        self.rows = np.concatenate([self.rows, rows])

    def _stokes_per_speed(self, i: NDArray[np.int32], j: NDArray[np.int32]) -> Floats:
        """m_ij/(6 pi mu a_r^2) of each pair, [s/m]; nan when dry."""
        if self._viscosity is None:
            return np.full(len(i), np.nan)
        b, wall = self._bodies, j < 0
        other = np.where(wall, i, j)
        inverse_mass = np.where(b.is_free, 1.0 / b.mass, 0.0)
        curvature = 2.0 / b.diameter
        m = 1.0 / (inverse_mass[i] + np.where(wall, 0.0, inverse_mass[other]))
        a_r = 1.0 / (curvature[i] + np.where(wall, 0.0, curvature[other]))
        return np.asarray(design.stokes_number(m, a_r, 1.0, self._viscosity))

    def take(self) -> NDArray[np.void]:
        """Give the finished contacts, dtype :data:`EPISODE`, and forget them."""
        rows, self.rows = self.rows, np.empty(0, EPISODE)
        return rows
