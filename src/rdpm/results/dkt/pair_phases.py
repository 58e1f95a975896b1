"""Drafting, kissing and tumbling of two settling spheres: when each phase began and how long it took."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rdpm.results.dkt.geometry import line_of_centres, separation, speed
from rdpm.results.dkt.spells import merged, spells_below

__all__ = [
    "KISS_GAP",
    "TUMBLE_ANGLE",
    "DktPhases",
    "from_particles_table",
    "phases",
]

KISS_GAP = 0.02        # of the smaller diameter: a kiss is a gap of at most this
TUMBLE_ANGLE = 45.0    # degrees between the line of centres and gravity
DRAFTING_RATE = 0.01   # of the pair's mean speed: closing faster than this is drafting

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class DktPhases:
    """Phases of a pair; None where one did not happen.

    Attributes
    ----------
    kiss_time_s : float or None
        Start of the first kiss.
    kiss_duration_s : float or None
        Total of all kisses.
    kisses : int
        Kisses closer than one contact time are one.
    tumble_time_s : float or None
        Line of centres past 45 degrees from gravity, after the first kiss began.
    final_angle_deg : float or None
        From the line against gravity to the line from the sphere that led at first to the other: 0 as
        at a start one above the other, 90 side by side, 180 when they have changed places.
    drafting_time_s : float or None
        Start of the longest spell, before the first kiss, in which the gap closes by more than 1 % of
        the pair's mean speed.
    """

    kiss_time_s: float | None
    kiss_duration_s: float | None
    kisses: int
    tumble_time_s: float | None
    final_angle_deg: float | None
    drafting_time_s: float | None = None

    def to_dict(self) -> dict[str, Any]:
        """The phases by name, as in summary.json."""
        return asdict(self)


def phases(
    times: ArrayLike,
    position_0: ArrayLike,
    position_1: ArrayLike,
    diameter_0: float,
    diameter_1: float,
    gravity: ArrayLike,
    contact_time: float,
    period: ArrayLike | None = None,
) -> DktPhases:
    """Find the phases of a pair in its recorded positions.

    Times are interpolated between the rows; what begins and ends between two rows is not seen.

    Parameters
    ----------
    times : array_like, (T,), [s]
        Increasing; at least two.
    position_0, position_1 : array_like, (T, 3), [m]
    diameter_0, diameter_1 : float, [m]
        > 0.
    gravity : array_like, (3,), [m/s^2]
        Not zero; only its direction matters.
    contact_time : float, [s]
        Kisses closer than this are one. >= 0.
    period : array_like, (3,), optional, [m]
        Length of the box along periodic directions, 0 along others.

    Raises
    ------
    ValueError
        Fewer than two times, or times that do not increase.

    Examples
    --------
    >>> t = np.linspace(0.0, 1.0, 11)
    >>> above = np.stack([0 * t, 0 * t, 2.0 - t], axis=1)
    >>> found = phases(t, np.zeros((11, 3)), above, 1.0, 1.0, (0, 0, -9.81), 1e-3)
    >>> round(found.kiss_time_s, 3), found.kisses, found.tumble_time_s
    (0.98, 1, None)
    """
    t = np.asarray(times, np.float64)
    if t.size < 2 or not np.all(np.diff(t) > 0.0):
        raise ValueError("phases of a pair need at least two times, each later than the one before")
    first, second = np.asarray(position_0, np.float64), np.asarray(position_1, np.float64)
    gap = np.linalg.norm(separation(first, second, period), axis=1) - 0.5 * (diameter_0 + diameter_1)
    spells = spells_below(t, gap - KISS_GAP * min(diameter_0, diameter_1))
    kisses = merged(spells, contact_time)
    angle = line_of_centres(first, second, gravity, period)
    kiss_time = kisses[0][0] if kisses else None
    return DktPhases(
        kiss_time_s=kiss_time,
        kiss_duration_s=sum(end - start for start, end in kisses) if kisses else None,
        kisses=len(kisses),
        tumble_time_s=None if kiss_time is None else _first_past(t, angle, kiss_time),
        final_angle_deg=float(angle[-1]),
        drafting_time_s=_drafting(t, gap, speed(t, first, period) + speed(t, second, period), kiss_time),
    )


def from_particles_table(
    table: Mapping[str, NDArray[Any]],
    diameter: ArrayLike,
    gravity: ArrayLike,
    contact_time: float,
    period: ArrayLike | None = None,
) -> DktPhases:
    """Find the phases of bodies 0 and 1 in a run's ``particles.csv``.

    Parameters
    ----------
    table : mapping of ndarray
        Columns ``time_s, id, x_m, y_m, z_m`` with ids 0 and 1 at the same times.
    diameter : array_like, (2,), [m]
        Of bodies 0 and 1.
    gravity, contact_time, period
        As for `phases`.

    Returns
    -------
    DktPhases

    Raises
    ------
    ValueError
        The two bodies have no two times in common.

    Examples
    --------
    >>> table = {"time_s": np.array([0., 0., 1., 1.]), "id": np.array([0, 1, 0, 1]), "x_m": np.zeros(4),
    ...          "y_m": np.zeros(4), "z_m": np.array([0., 3., 0., 2.])}
    >>> from_particles_table(table, (1.0, 1.0), (0, 0, -9.81), 1e-3).kisses
    0
    """
    rows = [table["id"] == n for n in (0, 1)]
    t, at_0, at_1 = np.intersect1d(table["time_s"][rows[0]], table["time_s"][rows[1]], return_indices=True)
    centres = np.stack([table[name] for name in ("x_m", "y_m", "z_m")], axis=1)
    d_0, d_1 = np.asarray(diameter, np.float64)
    one, other = centres[rows[0]][at_0], centres[rows[1]][at_1]
    return phases(t, one, other, float(d_0), float(d_1), gravity, contact_time, period)


def _first_past(t: Floats, angle: Floats, after: float) -> float | None:
    level = TUMBLE_ANGLE - angle
    times = np.concatenate([[after], t[t > after]])
    level = np.concatenate([[np.interp(after, t, level)], level[t > after]])
    spells = spells_below(times, level)
    return spells[0][0] if spells else None


def _drafting(t: Floats, gap: Floats, speeds: Floats, kiss_time: float | None) -> float | None:
    before = t.size if kiss_time is None else int(np.searchsorted(t, kiss_time))
    if before < 2:
        return None
    excess = DRAFTING_RATE * 0.5 * speeds + np.gradient(gap, t)   # negative: closes faster than that
    spells = spells_below(t[:before], excess[:before] + np.finfo(float).tiny)   # a pair at rest does not draft
    return max(spells, key=lambda spell: spell[1] - spell[0])[0] if spells else None
