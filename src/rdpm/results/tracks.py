"""Motion of the bodies of a run, by time and body."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Tracks", "tracks_from_table"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Tracks:
    """Motion of all bodies at the times of the table.

    Attributes
    ----------
    times : ndarray, (T,), [s]
    position : ndarray, (T, N, 3), [m]
        Without jumps: continued through periodic boundaries.
    velocity, angular_velocity : ndarray, (T, N, 3), [m/s], [rad/s]
    gap : ndarray, (T, N), [m]
        Smallest gap of each body to any body or wall; nan where there is neither.
    """

    times: Floats
    position: Floats
    velocity: Floats
    angular_velocity: Floats
    gap: Floats

    @property
    def count(self) -> int:
        """Number of bodies."""
        return int(self.position.shape[1])


def tracks_from_table(table: Mapping[str, NDArray[Any]], period: ArrayLike | None = None) -> Tracks:
    """Arrange the rows of ``particles.csv`` by time and body.

    Times at which a body is missing (a table cut short) are left out.

    Parameters
    ----------
    table : mapping of ndarray
        Columns of ``particles.csv``.
    period : array_like, (3,), optional, [m]
        Length of the box along periodic directions, 0 along others.

    Returns
    -------
    Tracks

    Examples
    --------
    >>> from rdpm.io.tables import PARTICLE_COLUMNS
    >>> table = {name: np.zeros(4) for name in PARTICLE_COLUMNS}
    >>> table |= {"time_s": np.array([0., 0., 1., 1.]), "id": np.array([0, 1, 0, 1])}
    >>> tracks_from_table(table).position.shape
    (2, 2, 3)
    """
    times, row = np.unique(table["time_s"], return_inverse=True)
    ids, column = np.unique(table["id"], return_inverse=True)

    def arranged(*names: str) -> Floats:
        values = np.full((times.size, ids.size, len(names)), np.nan)
        values[row, column] = np.stack([table[name] for name in names], axis=1)
        return values

    position = arranged("x_m", "y_m", "z_m")
    whole = np.isfinite(position).all(axis=(1, 2))
    position = position[whole]
    if period is not None and whole.any():
        length = np.asarray(period, np.float64)
        jump = length * np.rint(np.diff(position, axis=0) / np.where(length > 0.0, length, np.inf))
        position[1:] -= np.cumsum(jump, axis=0)
    return Tracks(
        times[whole],
        position,
        arranged("u_m_s", "v_m_s", "w_m_s")[whole],
        arranged("omega_x_rad_s", "omega_y_rad_s", "omega_z_rad_s")[whole],
        arranged("gap_m")[whole, :, 0],
    )
