"""A run's folder as arrays: what figures, video and report are made from."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rdpm.errors import CaseError
from rdpm.io.provenance import read_json
from rdpm.io.tables import read_table
from rdpm.io.vtkhdf import field_times
from rdpm.results.dkt import DktPhases, from_particles_table

__all__ = ["Plane", "RunFolder", "Tracks", "load_run", "tracks_from_table", "viewing_plane"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Tracks:
    """Motion of all bodies at the times of the table.

    Attributes
    ----------
    times : ndarray, (T,), [s]
    position : ndarray, (T, N, 3), [m]
        Without jumps: continued through periodic sides.
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


@dataclass(frozen=True)
class Plane:
    """A vertical plane to look at: numbers of its axes, and where it lies.

    Attributes
    ----------
    across, up, normal : int
        0, 1, 2 for x, y, z: drawn to the right, drawn upwards, out of the picture.
    position : float, [m]
        Along the normal.
    """

    across: int
    up: int
    normal: int
    position: float


def viewing_plane(tracks: Tracks | None, box: ArrayLike, gravity: ArrayLike) -> Plane:
    """The vertical plane through the bodies in which they move most.

    Parameters
    ----------
    tracks : Tracks or None
        None without bodies: the plane through the middle of the box.
    box : array_like, (3,), [m]
    gravity : array_like, (3,), [m/s^2]
        Its largest component is vertical; z without gravity.

    Examples
    --------
    >>> viewing_plane(None, (1.0, 2.0, 3.0), (0.0, 0.0, -9.81))
    Plane(across=0, up=2, normal=1, position=1.0)
    """
    size, g = np.asarray(box, np.float64), np.abs(np.asarray(gravity, np.float64))
    up = int(np.argmax(g)) if g.any() else 2
    first, second = (n for n in range(3) if n != up)
    if tracks is None or tracks.count == 0 or tracks.count > 8:
        return Plane(first, up, second, float(0.5 * size[second]))
    spread = np.ptp(tracks.position, axis=(0, 1))
    across, normal = (second, first) if spread[second] > 1.5 * spread[first] else (first, second)
    return Plane(across, up, normal, float(np.mean(tracks.position[..., normal]) % size[normal]))


@dataclass(frozen=True)
class RunFolder:
    """What a run left; parts that do not exist are None.

    Attributes
    ----------
    folder : pathlib.Path
    title : str
    case, summary : dict
        Of ``case.toml`` and ``summary.json``.
    box : ndarray, (3,), [m]
    periodic : ndarray of bool, (3,)
    gravity : ndarray, (3,), [m/s^2]
    diameter : ndarray, (N,), [m]
    tracks, contacts, history
        Of ``particles.csv``, ``contacts.csv``, ``history.csv``; None without rows.
    fields : pathlib.Path or None
        ``fields.vtkhdf`` when it holds at least one step.
    phases : DktPhases or None
        Of a pair.
    """

    folder: Path
    title: str
    case: dict[str, Any]
    summary: dict[str, Any]
    box: Floats
    periodic: NDArray[np.bool_]
    gravity: Floats
    diameter: Floats
    tracks: Tracks | None
    contacts: dict[str, NDArray[Any]] | None
    history: dict[str, NDArray[Any]] | None
    fields: Path | None
    phases: DktPhases | None

    @property
    def period(self) -> Floats:
        """Length of the box along periodic directions, 0 along others: (3,), [m]."""
        return np.where(self.periodic, self.box, 0.0)

    @property
    def plane(self) -> Plane:
        """The plane pictures are drawn in."""
        return viewing_plane(self.tracks, self.box, self.gravity)


def load_run(folder: str | Path) -> RunFolder:
    """Read the files of a run's folder.

    Parameters
    ----------
    folder : path
        With ``case.toml`` and ``summary.json`` at least.

    Returns
    -------
    RunFolder

    Raises
    ------
    CaseError
        The folder is not a run's (the message says what is missing), or a file of it is broken.
    """
    folder = Path(folder)
    missing = [name for name in ("case.toml", "summary.json") if not (folder / name).is_file()]
    if missing:
        reason = f"{' and '.join(missing)} missing" if folder.is_dir() else "there is no such folder"
        cure = "Name one that `rdpm run` wrote."
        raise CaseError(str(folder), None, "must be the folder of a run", reason, cure)
    try:
        case = tomllib.loads((folder / "case.toml").read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise CaseError(str(folder / "case.toml"), None, "must be a readable case", str(error)) from error
    summary = read_json(folder / "summary.json")
    domain = case.get("domain", {})
    boundary = domain.get("boundary", {})
    kinds = [boundary.get(axis, "wall") if isinstance(boundary, dict) else boundary for axis in "xyz"]
    periodic = np.array([kind == "periodic" for kind in kinds])
    box = _box(folder, domain, summary)
    particles = _rows(folder / "particles.csv")
    tracks = tracks_from_table(particles, np.where(periodic, box, 0.0)) if particles else None
    gravity = np.array(_numbers(domain.get("gravity"), 3) or [0.0, 0.0, -9.81])
    diameter = _diameters(folder, case, summary, tracks.count if tracks else 0)
    fields = folder / "fields.vtkhdf"
    return RunFolder(
        folder=folder,
        title=str(case.get("title") or folder.resolve().name),
        case=case,
        summary=summary,
        box=box,
        periodic=periodic,
        gravity=gravity,
        diameter=diameter,
        tracks=tracks,
        contacts=_rows(folder / "contacts.csv"),
        history=_rows(folder / "history.csv"),
        fields=fields if fields.is_file() and len(field_times(fields)) else None,
        phases=_phases(particles, tracks, diameter, gravity, np.where(periodic, box, 0.0), summary),
    )


def _rows(path: Path) -> dict[str, NDArray[Any]] | None:
    table = read_table(path) if path.is_file() else {}
    return table if any(len(column) for column in table.values()) else None


def _numbers(value: Any, count: int) -> list[float] | None:
    fits = isinstance(value, list) and len(value) == count
    return [float(v) for v in value] if fits and all(isinstance(v, (int, float)) for v in value) else None


def _box(folder: Path, domain: dict[str, Any], summary: dict[str, Any]) -> Floats:
    size = _numbers(domain.get("size"), 3)
    cells, spacing = _numbers(summary.get("cells"), 3), _numbers(summary.get("spacing_m"), 3)
    if size is None and cells and spacing:
        size = [n * d for n, d in zip(cells, spacing, strict=True)]
    if size is None:
        raise CaseError(str(folder / "case.toml"), None, "must give domain.size as three numbers in metres")
    return np.array(size)


def _diameters(folder: Path, case: dict[str, Any], summary: dict[str, Any], count: int) -> Floats:
    """From summary.json, else from the groups of case.toml (one diameter holds for all of its group)."""
    listed = [body.get("diameter_m") for body in summary.get("bodies") or []]
    if len(listed) != count or not all(listed):
        groups = case.get("bodies", [])
        listed = [
            d for group in groups for d in _group_diameters(group, count if len(groups) == 1 else None)
        ]
    if len(listed) != count:
        reason = f"particles.csv holds {count} bodies, diameters of {len(listed)} are known"
        raise CaseError(str(folder / "summary.json"), None, "must give diameter_m of every body", reason)
    return np.array(listed, np.float64)


def _group_diameters(group: dict[str, Any], count: int | None) -> list[float]:
    given = group.get("diameter")
    if isinstance(given, list):
        return [float(d) for d in given]
    if not isinstance(given, (int, float)):
        return []
    return [float(given)] * (len(group.get("centers", [])) or count or 0)


def _phases(
    particles: dict[str, NDArray[Any]] | None,
    tracks: Tracks | None,
    diameter: Floats,
    gravity: Floats,
    period: Floats,
    summary: dict[str, Any],
) -> DktPhases | None:
    if particles is None or tracks is None or tracks.count != 2 or len(tracks.times) < 2 or not gravity.any():
        return None
    contact_time = (summary.get("contact") or {}).get("contact_time_s") or 0.0
    return from_particles_table(particles, diameter, gravity, float(contact_time), period)
