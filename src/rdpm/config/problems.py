"""What pydantic found wrong with a file of keys, as one message: place, value, rule, reason, cure."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from pydantic import BaseModel, ValidationError

from rdpm.config.fields import table_of
from rdpm.config.rule import Path as KeyPath
from rdpm.config.rule import RuleError, shown, suggestion
from rdpm.errors import CaseError

__all__ = ["Known", "first_problem"]


@dataclass(frozen=True)
class Known:
    """The keys of a kind of file.

    Parameters
    ----------
    file : str
        What such a file is called where nothing else names it.
    model : type of BaseModel
        Of the file itself.
    cures : mapping of str to str
        What to write where a key is missing.
    """

    file: str
    model: type[BaseModel]
    cures: Mapping[str, str] = field(default_factory=dict)

    def keys(self, path: KeyPath) -> list[str]:
        """Keys that the table at a path may have."""
        table = self.model
        for key in path:
            if isinstance(key, str) and key in table.model_fields:
                table = table_of(table.model_fields[key]) or table
        return list(table.model_fields)


def _flat(
    error: ValidationError, known: Known, above: KeyPath = ()
) -> Iterator[tuple[KeyPath, str, RuleError]]:
    """Each problem with its path and pydantic's name for it."""
    for item in error.errors(include_url=False):
        path = (*above, *item["loc"])
        cause = item.get("ctx", {}).get("error")
        if isinstance(cause, ValidationError):
            yield from _flat(cause, known, path)
        elif isinstance(cause, RuleError):
            yield (*path, *cause.at), item["type"], cause
        else:
            yield path, item["type"], _translated(item, path, known)


def _translated(item: Any, path: KeyPath, known: Known) -> RuleError:
    kind, value = item["type"], item["input"]
    name = str(path[-1]) if path else ""
    if kind == "extra_forbidden":
        return RuleError("unknown key", cure=suggestion(name[:80], known.keys(path[:-1])))
    if kind == "missing":
        return RuleError("is missing", cure=known.cures.get(name, ""))
    if kind.startswith("bool"):
        return RuleError("must be true or false", value=value)
    if kind.startswith("string"):
        return RuleError("must be text", cure="Put it in quotes.", value=value)
    if kind in ("model_type", "dict_type"):
        return RuleError("must be a table", value=value)
    return RuleError(str(item["msg"])[:1].lower() + str(item["msg"])[1:], value=value)


def first_problem(
    error: ValidationError, raw: Any, places: Mapping[KeyPath, str], label: str, names: Known
) -> CaseError:
    """Tell the first problem of a file: unknown keys before all else, then in the order of the file.

    Parameters
    ----------
    error : ValidationError
    raw : dict
        What the file holds.
    places : mapping
        Where each key stands, as ``file:line`` or ``--set``.
    label : str
        The file.
    names : Known
        The tables of such a file.
    """
    found = list(_flat(error, names))
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
        place = ": ".join(part for part in (where, name) if part) or names.file
        place += f" (with --set {', '.join(outside)})" if outside else ""
    value = problem.value if problem.value is not None else _scalar(raw, path)
    is_shown = value is not None and problem.rule not in ("unknown key", "is missing")
    return CaseError(place, shown(value) if is_shown else None, problem.rule, problem.reason, problem.cure)


def _known(path: KeyPath, places: Mapping[KeyPath, str]) -> KeyPath | None:
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
