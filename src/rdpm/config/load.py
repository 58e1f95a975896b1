"""From a case file, a shipped name or a dict to a checked :class:`~rdpm.config.case.Case`.

The first problem is told, and only that: unknown keys before all else, as they explain what seems missing,
then in the order of the file.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from rdpm.config.body_file import read_body_files
from rdpm.config.case import Case
from rdpm.config.fields import table_of
from rdpm.config.lines import line_numbers
from rdpm.config.overrides import apply_overrides
from rdpm.config.rule import Path as KeyPath
from rdpm.config.rule import RuleError, shown, suggestion
from rdpm.config.source import case_name, parse_toml, read_source
from rdpm.config.write import case_to_toml
from rdpm.errors import CaseError

__all__ = ["case_name", "case_to_toml", "load_case"]

_CURES = {
    "domain": 'Add [domain] with size = ["10 cm", "10 cm", "50 cm"].',
    "time": 'Add [time] with end = "4 s".',
    "end": 'Write for example end = "4 s".',
    "size": 'Write for example size = ["10 cm", "10 cm", "50 cm"].',
    "diameter": 'Write for example diameter = "15 mm".',
    "density": 'Write for example density = "1120 kg/m^3".',
}


def load_case(source: str | Path | dict[str, Any], overrides: Sequence[str] = ()) -> Case:
    """Load a case and check all that the case alone can tell.

    Parameters
    ----------
    source : str, Path or dict
        A shipped name (``"dkt"``; it goes before a file of that name), a path, or what such a file holds.
    overrides : sequence of str, optional
        ``key=value`` each, as ``--set``: the value is TOML, or a string where it does not parse.

    Returns
    -------
    Case
        Frozen; every quantity in SI, the defaults filled in, files read.

    Raises
    ------
    CaseError
        One message for the first problem: place, value, rule, reason and cure.

    Notes
    -----
    Whether the time step is stable and the grid fits the memory is for the plan of a run to tell.

    Examples
    --------
    >>> case = load_case("dkt", ["time.end=10 ms"])
    >>> case.time.end, case.fluid.viscosity
    (0.01, 0.113)
    """
    places: dict[KeyPath, str] = {}
    label, folder = "", Path()
    try:
        if isinstance(source, dict):
            raw = _copied(source)
        else:
            text, label, folder = read_source(source)
            raw = parse_toml(text, label)
            places = {path: f"{label}:{line}" for path, line in line_numbers(text).items()}
        set_by = apply_overrides(raw, [overrides] if isinstance(overrides, str) else overrides)
        # a value set from outside hides the lines of what it replaces
        places = {
            path: place
            for path, place in places.items()
            if not any(path[: len(key)] == key for key in set_by)
        } | set_by
        read_body_files(raw, folder, places)
        return Case.model_validate(raw)
    except ValidationError as error:
        raise _first(error, raw, places, label) from None
    except RecursionError:
        raise CaseError(
            label or "case", None, "must be of a few levels", "lists or tables are nested too deeply"
        ) from None


def _copied(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _copied(item) for key, item in value.items()}
    return [_copied(item) for item in value] if isinstance(value, list | tuple) else value


def _flat(error: ValidationError, above: KeyPath = ()) -> Iterator[tuple[KeyPath, str, RuleError]]:
    """Each problem with its path and pydantic's name for it."""
    for item in error.errors(include_url=False):
        path = (*above, *item["loc"])
        cause = item.get("ctx", {}).get("error")
        if isinstance(cause, ValidationError):
            yield from _flat(cause, path)
        elif isinstance(cause, RuleError):
            yield (*path, *cause.at), item["type"], cause
        else:
            yield path, item["type"], _translated(item, path)


def _translated(item: Any, path: KeyPath) -> RuleError:
    kind, value = item["type"], item["input"]
    name = str(path[-1]) if path else ""
    if kind == "extra_forbidden":
        table: type[BaseModel] = Case
        for key in path[:-1]:
            if isinstance(key, str):
                table = table_of(table.model_fields[key]) or table
        return RuleError("unknown key", cure=suggestion(name[:80], table.model_fields))
    if kind == "missing":
        return RuleError("is missing", cure=_CURES.get(name, ""))
    if kind.startswith("bool"):
        return RuleError("must be true or false", value=value)
    if kind.startswith("string"):
        return RuleError("must be text", cure="Put it in quotes.", value=value)
    if kind in ("model_type", "dict_type"):
        return RuleError("must be a table", value=value)
    return RuleError(str(item["msg"])[:1].lower() + str(item["msg"])[1:], value=value)


def _first(error: ValidationError, raw: Any, places: dict[KeyPath, str], label: str) -> CaseError:
    found = list(_flat(error))
    order = {path: n for n, path in enumerate(places)}

    def rank(entry: tuple[KeyPath, str, RuleError]) -> tuple[bool, bool, int]:
        path, kind, _ = entry
        known = _known(path, places)
        return kind != "extra_forbidden", known is None, order[known] if known is not None else 0

    path, _, problem = min(found, key=rank)
    name = _dotted(path)
    known = _known(path, places)
    where = places[known] if known is not None else label
    if known is None and any(key[: len(path)] == path for key, place in places.items() if place == "--set"):
        where = "--set"
    outside = [_dotted(key) for key, place in places.items() if place == "--set"]
    if where == "--set":
        place = f"--set {name}"
    else:
        place = ": ".join(part for part in (where, name) if part) or "case"
        place += f" (with --set {', '.join(outside)})" if outside else ""
    value = problem.value if problem.value is not None else _scalar(raw, path)
    is_shown = value is not None and problem.rule not in ("unknown key", "is missing")
    return CaseError(place, shown(value) if is_shown else None, problem.rule, problem.reason, problem.cure)


def _known(path: KeyPath, places: dict[KeyPath, str]) -> KeyPath | None:
    """The path, or the nearest above it, that has a line."""
    for length in range(len(path), 0, -1):
        if path[:length] in places:
            return path[:length]
    return None


def _scalar(raw: Any, path: KeyPath) -> Any:
    """What the case holds at a path, if it is a single value."""
    for key in path:
        try:
            raw = raw[key]
        except (KeyError, IndexError, TypeError):
            return None
    return None if isinstance(raw, dict | list) else raw


def _dotted(path: KeyPath) -> str:
    text = ""
    for key in path:
        if isinstance(key, int):
            text += f"[{key}]"
        else:
            word = key if re.fullmatch(r"[\w-]{1,60}", key) else shown(key)
            text += f".{word}" if text else word
    return text
