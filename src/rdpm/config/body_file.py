"""Bodies from a CSV table."""

from __future__ import annotations

import csv
import math
from pathlib import Path
from typing import Any

from rdpm.config.bodies import MAX_BODIES, PLACES
from rdpm.config.rule import Path as KeyPath
from rdpm.config.rule import listed, shown, suggestion
from rdpm.config.source import read_text
from rdpm.errors import CaseError

__all__ = ["read_body_files"]

# key of the group, and its columns, named as in the results
_COLUMNS = {
    "centers": ("x_m", "y_m", "z_m"),
    "diameter": ("diameter_m",),
    "density": ("density_kg_m3",),
    "velocity": ("u_m_s", "v_m_s", "w_m_s"),
    "angular_velocity": ("omega_x_rad_s", "omega_y_rad_s", "omega_z_rad_s"),
}


def read_body_files(raw: dict[str, Any], folder: Path, places: dict[KeyPath, str]) -> None:
    """Replace each group's ``file`` by what it holds. Changes `raw` and `places`.

    Parameters
    ----------
    raw : dict
        What a case file holds.
    folder : Path
        Where relative names start.
    places : dict
        Where each key path stands; the rows' lines are added.

    Raises
    ------
    CaseError
        The file cannot be read, or a row or column is wrong; with file and line.
    """
    groups = raw.get("bodies")
    for i, group in enumerate(groups if isinstance(groups, list) else ()):
        if not isinstance(group, dict) or "file" not in group:
            continue
        where = next(
            (places[key] for key in (("bodies", i, "file"), ("bodies", i), ("bodies",)) if key in places), ""
        )
        place = f"{where}{' ' if where == '--set' else ': '}bodies[{i}].file".removeprefix(": ")
        name = group["file"]
        if not isinstance(name, str) or not name:
            raise CaseError(
                place, shown(name), "must be the name of a CSV file", cure='Write file = "bodies.csv".'
            )
        if others := [key for key in PLACES if key != "file" and key in group]:
            raise CaseError(
                place,
                shown(name),
                f"must be the only one of {listed(PLACES)}",
                f"given is also {listed(others)}",
            )
        path = folder / name
        columns, lines = _read(path)
        for key, values in columns.items():
            if key in group:
                raise CaseError(
                    place,
                    shown(name),
                    f"must not have the column {_COLUMNS[key][0]}",
                    f"bodies[{i}].{key} is given too",
                    "Leave one of them out.",
                )
            group[key] = values
            places[("bodies", i, key)] = str(path)
            places.update({("bodies", i, key, n): f"{path}:{line}" for n, line in enumerate(lines)})
        del group["file"]


def _read(path: Path) -> tuple[dict[str, list[Any]], list[int]]:
    """The groups of columns of a CSV file, and each row's line."""
    rows = [
        (n, line)
        for n, line in enumerate(read_text(path).split("\n"), start=1)
        if line.strip() and not line.startswith("#")
    ]
    if len(rows) < 2:
        raise CaseError(str(path), None, "must have a line of column names, then a line a body")
    if len(rows) > MAX_BODIES + 1:
        raise CaseError(str(path), None, f"must hold at most {MAX_BODIES} bodies")
    cells: dict[str, list[float]] = {name: [] for name in _header(path, *rows[0])}
    try:
        parsed = list(csv.reader((line for _, line in rows[1:]), strict=True))
    except csv.Error as error:
        raise CaseError(str(path), None, "must be a CSV table", str(error)) from None
    if len(parsed) != len(rows) - 1:
        raise CaseError(str(path), None, "must have one line a body", "a quote spans lines")
    for (line, _), row in zip(rows[1:], parsed, strict=True):
        if len(row) != len(cells):
            raise CaseError(f"{path}:{line}", None, f"must have {len(cells)} columns, not {len(row)}")
        for name, text in zip(cells, row, strict=True):
            cells[name].append(_number(f"{path}:{line}: {name}", text))
    columns: dict[str, list[Any]] = {}
    for key, names in _COLUMNS.items():
        if names[0] in cells:
            lists = [cells[name] for name in names]
            columns[key] = lists[0] if len(names) == 1 else [list(row) for row in zip(*lists, strict=True)]
    return columns, [line for line, _ in rows[1:]]


def _header(path: Path, line: int, text: str) -> list[str]:
    names = [name.strip() for name in text.split(",")]
    known = [name for columns in _COLUMNS.values() for name in columns]
    for name in names:
        if name not in known:
            raise CaseError(
                f"{path}:{line}", shown(name), "unknown column", cure=suggestion(name[:80], known)
            )
        if names.count(name) > 1:
            raise CaseError(f"{path}:{line}", shown(name), "must stand once")
    for key, columns in _COLUMNS.items():
        missing = [name for name in columns if name not in names]
        if missing and (key == "centers" or len(missing) < len(columns)):
            raise CaseError(f"{path}:{line}", None, f"must have the column {missing[0]}")
    return names


def _number(place: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise CaseError(place, shown(text), "must be a finite number in SI")
    return value
