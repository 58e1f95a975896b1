"""Drafting, kissing and tumbling in numbers that bear noise and coarse sampling: docs/theory/dkt.md defines them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rdpm.results.dkt.geometry import continued, line_of_centres, pair_gap
from rdpm.results.dkt.pair_phases import KISS_GAP, TUMBLE_ANGLE
from rdpm.results.dkt.spells import crossing, merged, spells_below

__all__ = ["DktNumbers", "Kiss", "contact_kisses", "gap_kisses", "pair_numbers"]

RELEASE_GAP = 0.03       # of the smaller diameter: the gap that ends a kiss
RELEASE_ANGLE = 5.0      # degrees on both sides of TUMBLE_ANGLE that a pair has to pass
DRAFTING_DROP = 0.05     # of the smaller diameter: closer than the largest gap by this, the pair drafts
SEPARATION_GAP = 0.5     # of the smaller diameter: the separation rate is measured up to this gap

Floats = NDArray[np.float64]


class Kiss(NamedTuple):
    """One kiss.

    Attributes
    ----------
    start_s, end_s : float
    """

    start_s: float
    end_s: float

    @property
    def duration_s(self) -> float:
        """Length [s]."""
        return self.end_s - self.start_s


@dataclass(frozen=True)
class DktNumbers:
    """A pair's motion in numbers; None where something did not happen.

    Attributes
    ----------
    drafting_start_s : float or None
        Last time before the first kiss at which the gap was within 5 % d of the largest before it, eq. (2).
    gap_kisses : tuple of Kiss
        A gap of at most 2 % d, ended by one above 3 % d, eq. (3).
    contact_kisses : tuple of Kiss
        Mechanical contact; contacts closer than one contact time are one, eq. (4).
    contact_episodes : int
        Contacts as they are in ``contacts.csv``.
    min_gap_fraction : float
        Over the smaller diameter, negative in overlap, eq. (5).
    tumble_start_s : float or None
        The line of centres passes 45 degrees, after the first kiss of either kind began, eq. (6).
    final_angle_deg : float
        See `line_of_centres`.
    separation_rate_m_s : float or None
        Slope of the gap after tumble and last kiss, eq. (7).
    lateral_drift_m : float
        Of the pair's centre across gravity, from the first to the last row, eq. (8).
    """

    drafting_start_s: float | None
    gap_kisses: tuple[Kiss, ...]
    contact_kisses: tuple[Kiss, ...]
    contact_episodes: int
    min_gap_fraction: float
    tumble_start_s: float | None
    final_angle_deg: float
    separation_rate_m_s: float | None
    lateral_drift_m: float

    @property
    def first_kiss_s(self) -> float | None:
        """Start of the first kiss of either kind [s]."""
        return min((kiss.start_s for kiss in self.gap_kisses[:1] + self.contact_kisses[:1]), default=None)


def pair_numbers(
    times: ArrayLike,
    position_0: ArrayLike,
    position_1: ArrayLike,
    diameter_0: float,
    diameter_1: float,
    gravity: ArrayLike,
    contact_time: float = 0.0,
    period: ArrayLike | None = None,
    contacts: Mapping[str, NDArray[Any]] | None = None,
) -> DktNumbers:
    """Put a pair's recorded motion into numbers.

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
        Length of the box along periodic directions, 0 along others. Between two rows a sphere moves less than half.
    contacts : mapping of ndarray, optional
        ``contacts.csv``; rows of other pairs and of walls are passed over.

    Returns
    -------
    DktNumbers

    Raises
    ------
    ValueError
        Fewer than two times, or times that do not increase.

    Notes
    -----
    A gap below 2 % d that begins and ends between two rows is not seen; ``contacts`` see every touch.

    Examples
    --------
    >>> t = np.linspace(0.0, 2.0, 21)
    >>> above = np.stack([0 * t, 0 * t, 1.0 + np.abs(1.0 - t)], axis=1)
    >>> found = pair_numbers(t, np.zeros((21, 3)), above, 1.0, 1.0, (0, 0, -9.81))
    >>> [kiss.duration_s for kiss in found.gap_kisses], found.drafting_start_s
    ([0.04...], 0.05)
    """
    t = np.asarray(times, np.float64)
    if t.size < 2 or not np.all(np.diff(t) > 0.0):
        raise ValueError("a pair's motion needs at least two times, each later than the one before")
    first, second = np.asarray(position_0, np.float64), np.asarray(position_1, np.float64)
    smaller = min(diameter_0, diameter_1)
    fraction = pair_gap(first, second, diameter_0, diameter_1, period) / smaller
    angle = line_of_centres(first, second, gravity, period)
    by_gap = gap_kisses(t, fraction, contact_time)
    rows = _pair_rows(contacts)
    by_contact = contact_kisses(rows, contact_time)
    kisses = by_gap + by_contact
    kiss_time = min(kiss.start_s for kiss in kisses) if kisses else None
    tumble = None if kiss_time is None else _tumble(t, angle, kiss_time)
    overlap = float(np.max(rows["max_overlap_fraction"], initial=-np.inf))
    part = None if tumble is None else max(tumble, *(kiss.end_s for kiss in kisses))
    rate = None if part is None else _separation_rate(t, fraction, part)
    return DktNumbers(
        drafting_start_s=_drafting_start(t, fraction, kiss_time),
        gap_kisses=by_gap,
        contact_kisses=by_contact,
        contact_episodes=len(rows["start_s"]),
        min_gap_fraction=min(float(fraction.min()), -overlap),
        tumble_start_s=tumble,
        final_angle_deg=float(angle[-1]),
        separation_rate_m_s=None if rate is None else rate * smaller,
        lateral_drift_m=_drift((first, diameter_0), (second, diameter_1), gravity, period),
    )


def gap_kisses(times: ArrayLike, gap_fraction: ArrayLike, contact_time: float = 0.0) -> tuple[Kiss, ...]:
    """Kisses by the gap: from the fall to 2 % d until the last rise past it before the gap exceeds 3 % d.

    Parameters
    ----------
    times : array_like, (T,), [s]
        Increasing.
    gap_fraction : array_like, (T,), [-]
        Gap over the smaller diameter.
    contact_time : float, [s]
        Kisses closer than this are one. >= 0.

    Examples
    --------
    >>> wavering = [0.04, 0.0, 0.025, 0.0, 0.04, 0.0, 0.04]
    >>> len(gap_kisses(range(7), wavering))
    2
    """
    level = np.asarray(gap_fraction, np.float64) - KISS_GAP
    spells = spells_below(np.asarray(times, np.float64), level, RELEASE_GAP - KISS_GAP)
    return tuple(Kiss(*spell) for spell in merged(spells, contact_time))


def contact_kisses(contacts: Mapping[str, NDArray[Any]], contact_time: float = 0.0) -> tuple[Kiss, ...]:
    """Kisses by mechanical contact, in the order of time.

    Parameters
    ----------
    contacts : mapping of ndarray
        Columns ``start_s, duration_s`` of one pair.
    contact_time : float, [s]
        Contacts closer than this are one kiss. >= 0.

    Examples
    --------
    >>> contacts = {"start_s": np.array([2.0, 1.0]), "duration_s": np.array([0.5, 0.1])}
    >>> [kiss.start_s for kiss in contact_kisses(contacts, 0.01)]
    [1.0, 2.0]
    """
    start = np.asarray(contacts["start_s"], np.float64)
    end = start + np.asarray(contacts["duration_s"], np.float64)
    spells = sorted(zip(start.tolist(), end.tolist(), strict=True))
    return tuple(Kiss(*spell) for spell in merged(spells, contact_time))


def _pair_rows(contacts: Mapping[str, NDArray[Any]] | None) -> dict[str, Floats]:
    names = ("start_s", "duration_s", "max_overlap_fraction")
    if contacts is None:
        return {name: np.zeros(0) for name in names}
    i, j = np.asarray(contacts["i"]), np.asarray(contacts["j"])
    chosen = (np.minimum(i, j) == 0) & (np.maximum(i, j) == 1)
    return {name: np.asarray(contacts[name], np.float64)[chosen] for name in names}


def _drafting_start(t: Floats, fraction: Floats, kiss_time: float | None) -> float | None:
    until = float(t[np.argmin(fraction)]) if kiss_time is None else kiss_time
    times = np.append(t[t < until], until)
    gap = np.append(fraction[t < until], np.interp(until, t, fraction))
    level = gap - (gap.max() - DRAFTING_DROP)
    if not level[-1] <= 0.0:
        return None
    return crossing(times, level, int(np.flatnonzero(level > 0.0)[-1]))


def _tumble(t: Floats, angle: Floats, after: float) -> float | None:
    """First passage of 45 degrees after which the angle reaches 50 (or the record ends) before it falls below 40."""
    later = t > after
    times = np.concatenate([[after], t[later]])
    level = TUMBLE_ANGLE - np.concatenate([[np.interp(after, t, angle)], angle[later]])
    for start, end in spells_below(times, level, RELEASE_ANGLE):
        within = (times >= start) & (times <= end)
        if end == times[-1] or np.min(level[within]) <= -RELEASE_ANGLE:
            return start
    return None


def _separation_rate(t: Floats, fraction: Floats, start: float) -> float | None:
    """Least-squares slope of the gap over the smaller diameter [1/s]; None from fewer than three rows."""
    rows = np.flatnonzero(t >= start)
    far = np.flatnonzero(fraction[rows] >= SEPARATION_GAP)
    rows = rows[: far[0] + 1] if far.size else rows
    if rows.size < 3:
        return None
    return float(np.polynomial.polynomial.polyfit(t[rows] - t[rows[0]], fraction[rows], 1)[1])


def _drift(
    one: tuple[Floats, float], other: tuple[Floats, float], gravity: ArrayLike, period: ArrayLike | None
) -> float:
    """Of the centre of both volumes."""
    volumes = [diameter**3 for _, diameter in (one, other)]
    moved = [continued(position, period)[-1] for position, _ in (one, other)]
    centre = (volumes[0] * moved[0] + volumes[1] * moved[1]) / sum(volumes)
    down = np.asarray(gravity, np.float64) / np.linalg.norm(np.asarray(gravity, np.float64))
    return float(np.linalg.norm(centre - down * (centre @ down)))
