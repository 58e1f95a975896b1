"""A run's folder as arrays: what figures, video and report are made from."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm.errors import CaseError
from rdpm.io.tables import read_table
from rdpm.io.vtkhdf import field_times
from rdpm.results.contacts import is_pressed, outside_range
from rdpm.results.dkt import DktPhases, from_particles_table
from rdpm.results.run_folder import RunFolder
from rdpm.results.summary import Summary, read_summary
from rdpm.results.tracks import Tracks, tracks_from_table
from rdpm.surfaces import Surface, surface_of

__all__ = ["Run", "load_run"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Run:
    """What a run left; parts that do not exist are None.

    Attributes
    ----------
    folder : RunFolder
    title : str
    case : dict
        Of ``case.toml``.
    summary : Summary
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

    folder: RunFolder
    title: str
    case: dict[str, Any]
    summary: Summary
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
    def pressed(self) -> NDArray[np.bool_]:
        """Which contacts were no impacts, see `rdpm.results.contacts.is_pressed`: (rows,)."""
        if self.contacts is None:
            return np.zeros(0, np.bool_)
        kind, stokes, duration = (self.contacts[name] for name in ("kind", "stokes_number", "duration_s"))
        return is_pressed(kind, stokes, duration, self.summary.contact.contact_times)

    @property
    def walls(self) -> tuple[Surface, ...]:
        """Within the box."""
        return tuple(surface_of(wall) for wall in self.case.get("walls", ()))

    @property
    def outside(self) -> NDArray[np.str_]:
        """What of each contact left the promised range, see `rdpm.results.contacts.outside_range`: (rows,)."""
        if self.contacts is None:
            return np.zeros(0, np.str_)
        return outside_range(self.contacts, self.pressed, self.summary.contact)

    @property
    def period(self) -> Floats:
        """Length of the box along periodic directions, 0 along others: (3,), [m]."""
        return np.where(self.periodic, self.box, 0.0)


def load_run(folder: str | Path) -> Run:
    """Read the files of a run's folder.

    Parameters
    ----------
    folder : path
        With ``case.toml`` and ``summary.json`` at least.

    Returns
    -------
    Run

    Raises
    ------
    CaseError
        The folder is not a run's (the message says what is missing), or a file of it is broken.
    """
    files = RunFolder(Path(folder))
    case, summary = _read_case(files), read_summary(files.summary)
    domain = case.get("domain", {})
    boundary = domain.get("boundary", {})
    kinds = [boundary.get(axis, "wall") if isinstance(boundary, dict) else boundary for axis in "xyz"]
    periodic = np.array([kind == "periodic" for kind in kinds])
    box = _box(files, domain, summary)
    period = np.where(periodic, box, 0.0)
    particles = _rows(files.table("particles"))
    tracks = tracks_from_table(particles, period) if particles else None
    gravity = np.array(_numbers(domain.get("gravity"), 3) or [0.0, 0.0, -9.81])
    diameter = _diameters(files, case, summary, tracks.count if tracks else 0)
    return Run(
        folder=files,
        title=str(case.get("title") or files.path.resolve().name),
        case=case,
        summary=summary,
        box=box,
        periodic=periodic,
        gravity=gravity,
        diameter=diameter,
        tracks=tracks,
        contacts=_rows(files.table("contacts")),
        history=_rows(files.table("history")),
        fields=files.fields if files.fields.is_file() and len(field_times(files.fields)) else None,
        phases=_phases(particles, tracks, diameter, gravity, period, summary),
    )


def _read_case(files: RunFolder) -> dict[str, Any]:
    missing = [path.name for path in (files.case, files.summary) if not path.is_file()]
    if missing:
        reason = f"{' and '.join(missing)} missing" if files.path.is_dir() else "there is no such folder"
        cure = "Name one that `rdpm run` wrote."
        raise CaseError(str(files), None, "must be the folder of a run", reason, cure)
    try:
        return tomllib.loads(files.case.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise CaseError(str(files.case), None, "must be a readable case", str(error)) from error


def _rows(path: Path) -> dict[str, NDArray[Any]] | None:
    table = read_table(path) if path.is_file() else {}
    return table if any(len(column) for column in table.values()) else None


def _numbers(value: Any, count: int) -> list[float] | None:
    fits = isinstance(value, list) and len(value) == count
    return [float(v) for v in value] if fits and all(isinstance(v, (int, float)) for v in value) else None


def _box(files: RunFolder, domain: dict[str, Any], summary: Summary) -> Floats:
    size = _numbers(domain.get("size"), 3)
    if size is None and summary.cells and summary.spacing_m:
        size = [n * d for n, d in zip(summary.cells, summary.spacing_m, strict=True)]
    if size is None:
        raise CaseError(str(files.case), None, "must give domain.size as three numbers in metres")
    return np.array(size)


def _diameters(files: RunFolder, case: dict[str, Any], summary: Summary, count: int) -> Floats:
    """From summary.json, else from the groups of case.toml (one diameter holds for all of its group)."""
    listed = [body.diameter_m for body in summary.bodies]
    if len(listed) != count or not all(listed):
        groups = case.get("bodies", [])
        listed = [
            d for group in groups for d in _group_diameters(group, count if len(groups) == 1 else None)
        ]
    if len(listed) != count:
        reason = f"particles.csv holds {count} bodies, diameters of {len(listed)} are known"
        raise CaseError(str(files.summary), None, "must give diameter_m of every body", reason)
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
    summary: Summary,
) -> DktPhases | None:
    if particles is None or tracks is None or tracks.count != 2 or len(tracks.times) < 2 or not gravity.any():
        return None
    contact_time = summary.contact.contact_time_s or 0.0
    return from_particles_table(particles, diameter, gravity, contact_time, period)
