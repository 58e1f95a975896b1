"""What each contact did, from the touch to the parting of the surfaces."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rdpm import _core, design
from rdpm.grid import Box
from rdpm.particles.state import Bodies

from .pair_table import pairs_of
from .rows import Rows, check_layout

__all__ = ["EPISODE", "FINISHED", "Episodes"]

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

``i``, ``j`` (-1..-6: a face of the box; -8 and below: a wall within it), ``kind`` ("sphere-sphere" or "sphere-wall");
``start_s`` of the touch; ``duration_s`` from the touch until the force vanished for the last time before the
surfaces parted;
``steps``, that over the time step; ``max_overlap_fraction`` of the smaller diameter; normal speeds of
approach at the touch and of rebound at the end; ``restitution``, their ratio (nan where the bodies did not
meet with a speed, or were still in touch); ``stokes_number``
:math:`m_{ij}v/(6\pi\mu a_r^2)=\rho_{eff}v\,d_{eff}/(9\mu)` with :math:`d_{eff}=2a_r`,
:math:`a_r=a_ia_j/(a_i+a_j)` (the body's radius against a wall) and
:math:`\rho_{eff}=m_{ij}/(\tfrac43\pi a_r^3)`, nan when dry; ``work_J`` of the contact force on the pair,
friction included.
"""

FINISHED = np.dtype(
    [("pair", np.int64)]
    + [
        (name, np.float64)
        for name in ("start", "end", "max_overlap", "impact_speed", "rebound_speed", "work")
    ]
)
"""A finished contact as the driver gives it; ``pair``: row of its table, the rest as in the contact's state."""
check_layout(FINISHED, _core.contact_layouts()["finished"], "finished contacts")


class Episodes:
    """Collects finished contacts.

    Parameters
    ----------
    bodies : Bodies
    box : Box
    viscosity : float or None, [Pa s]
        Of the fluid; None: dry.
    """

    def __init__(self, bodies: Bodies, box: Box, viscosity: float | None) -> None:
        self._bodies, self._box, self._viscosity = bodies, box, viscosity
        self._parts: list[Rows] = []

    @property
    def rows(self) -> Rows:
        """All that are recorded, dtype :data:`EPISODE`."""
        if len(self._parts) != 1:
            self._parts = [np.concatenate([np.empty(0, EPISODE), *self._parts])]
        return self._parts[0]

    @rows.setter
    def rows(self, rows: Rows) -> None:
        self._parts = [rows]

    def add(self, ids: NDArray[np.int32], finished: Rows, dt: float) -> None:
        """Record contacts.

        Parameters
        ----------
        ids : ndarray of int32, (K, 2)
        finished : ndarray, (K,)
            With the fields of :data:`FINISHED`; ``pair`` is not read.
        dt : float, [s]
            Time step.
        """
        i, j = ids[:, 0], ids[:, 1]
        start, end = finished["start"], finished["end"]
        impact, rebound = finished["impact_speed"], finished["rebound_speed"]
        rows = np.empty(len(ids), EPISODE)
        rows["i"], rows["j"] = i, j
        rows["kind"] = np.where(j < 0, "sphere-wall", "sphere-sphere")
        rows["start_s"], rows["duration_s"], rows["steps"] = start, end - start, (end - start) / dt
        rows["max_overlap_fraction"], rows["work_J"] = finished["max_overlap"], finished["work"]
        rows["impact_speed_m_s"], rows["rebound_speed_m_s"] = impact, rebound
        met = impact > 0.0
        rows["restitution"] = np.where(met, rebound, np.nan) / np.where(met, impact, 1.0)
        rows["stokes_number"] = self._stokes_per_speed(ids) * np.maximum(impact, 0.0)
        self._parts.append(rows)

    def _stokes_per_speed(self, ids: NDArray[np.int32]) -> Floats:
        """m_ij/(6 pi mu a_r^2) of each pair, [s/m]; nan when dry."""
        if self._viscosity is None:
            return np.full(len(ids), np.nan)
        pairs = pairs_of(self._bodies, self._box, ids)
        m, a_r = pairs["reduced_mass"].copy(), pairs["reduced_radius"].copy()
        return np.asarray(design.stokes_number(m, a_r, 1.0, self._viscosity))

    def take(self) -> Rows:
        """Give the finished contacts, dtype :data:`EPISODE`, and forget them."""
        rows, self.rows = self.rows, np.empty(0, EPISODE)
        return rows
