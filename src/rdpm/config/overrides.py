"""Values set from outside a case file, as ``fluid.viscosity=0.1``."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping, Sequence
from typing import Any

from rdpm.config.rule import Path, shown
from rdpm.errors import CaseError

__all__ = ["apply_overrides", "set_value", "set_values", "unset_value"]

_STEP = re.compile(r"([A-Za-z0-9_-]+)((?:\[\d{1,9}\])*)")


def apply_overrides(raw: dict[str, Any], overrides: Sequence[str]) -> dict[Path, str]:
    """Set values in a nested dict. Changes `raw`.

    Parameters
    ----------
    raw : dict
        What a case file holds.
    overrides : sequence of str
        Each ``key=value``: the value is TOML, or a string where it does not parse; list items by
        ``bodies[0].density``.

    Returns
    -------
    dict
        The paths that were set, each with what set it.

    Raises
    ------
    CaseError
        No ``=``, a key that cannot be, an item that is not there.

    Examples
    --------
    >>> raw = {"fluid": {"density": 1000}}
    >>> apply_overrides(raw, ["fluid.viscosity=0.1 Pa s", "time.end=2"])
    {('fluid', 'viscosity'): '--set', ('time', 'end'): '--set'}
    >>> raw
    {'fluid': {'density': 1000, 'viscosity': '0.1 Pa s'}, 'time': {'end': 2}}
    """
    places: dict[Path, str] = {}
    for override in overrides:
        name, equals, text = override.partition("=")
        if not equals:
            raise CaseError(
                f"--set {_short(override)}",
                None,
                "must be key=value",
                cure="Write for example --set fluid.viscosity=0.1.",
            )
        path = _path(name.strip(), f"--set {_short(name.strip())}")
        _put(raw, path, _value(text.strip()), f"--set {_short(name.strip())}")
        places[path] = "--set"
    return places


def set_value(raw: dict[str, Any], key: str, value: Any, place: str) -> None:
    """Set one value in a nested dict. Changes `raw`.

    Parameters
    ----------
    raw : dict
        What a case file holds.
    key : str
        Dotted; list items by ``bodies[0].density``.
    value : object
        As TOML gives it.
    place : str
        What sets it, for the message.

    Raises
    ------
    CaseError
        A key that cannot be, an item that is not there.

    Examples
    --------
    >>> raw = {"bodies": [{"density": 1000}]}
    >>> set_value(raw, "bodies[0].density", 1120, "study")
    >>> raw
    {'bodies': [{'density': 1120}]}
    """
    _put(raw, _path(key, place), value, place)


def set_values(raw: dict[str, Any], values: Mapping[str, Any]) -> dict[Path, str]:
    """Set values in a nested dict by their dotted keys. Changes `raw`.

    Parameters
    ----------
    raw : dict
        What a case file holds.
    values : mapping of str to object
        As TOML gives them.

    Returns
    -------
    dict
        The paths that were set, each with its key.

    Raises
    ------
    CaseError
        A key that cannot be, an item that is not there.

    Examples
    --------
    >>> raw = {"bodies": [{"density": 1000}]}
    >>> set_values(raw, {"bodies[0].density": 1120, "time.end": 2})
    {('bodies', 0, 'density'): 'bodies[0].density', ('time', 'end'): 'time.end'}
    >>> raw
    {'bodies': [{'density': 1120}], 'time': {'end': 2}}
    """
    places: dict[Path, str] = {}
    for key, value in values.items():
        path = _path(key, key)
        _put(raw, path, value, key)
        places[path] = key
    return places


def unset_value(raw: dict[str, Any], key: str, place: str) -> None:
    """Remove a key from a nested dict. Changes `raw`.

    Parameters
    ----------
    raw : dict
    key : str
        Dotted; of a table.
    place : str
        What removes it, for the message.

    Raises
    ------
    CaseError
        It is not there.

    Examples
    --------
    >>> raw = {"fluid": {"density": 1000}, "time": {"end": 1}}
    >>> unset_value(raw, "fluid", "study")
    >>> raw
    {'time': {'end': 1}}
    """
    container: Any = raw
    *above, last = _path(key, place)
    try:
        for step in above:
            container = container[step]
        del container[last]
    except (KeyError, IndexError, TypeError):
        raise CaseError(place, None, "must name a key of the case", f"{shown(key)} is not there") from None


def _short(text: str) -> str:
    return shown(text)[1:-1]


def _path(name: str, place: str) -> Path:
    path: list[str | int] = []
    for step in name.split("."):
        match = _STEP.fullmatch(step)
        if match is None or len(path) > 20:
            raise CaseError(
                place,
                None,
                "must name a key",
                f"{shown(step)} is not one",
                "Write for example fluid.viscosity, or bodies[0].density.",
            )
        path.append(match[1])
        path.extend(int(index) for index in re.findall(r"\d+", match[2]))
    return tuple(path)


def _value(text: str) -> Any:
    try:
        parsed = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        return text
    return parsed["value"] if set(parsed) == {"value"} else text


def _put(raw: dict[str, Any], path: Path, value: Any, place: str) -> None:
    container: Any = raw
    for n, key in enumerate(path):
        is_last = n == len(path) - 1
        if isinstance(key, int):
            if not isinstance(container, list):
                raise CaseError(place, None, f"must not index {path[n - 1]}", "it is not a list")
            if key >= len(container):
                raise CaseError(
                    place,
                    None,
                    f"must be an item that is there, [0] to [{len(container) - 1}]"
                    if container
                    else "must be an item that is there",
                    "the list ends before it",
                )
        elif not isinstance(container, dict):
            raise CaseError(
                place,
                None,
                f"must not look for {shown(key)} there",
                f"{path[n - 1]} is not a table",
                "List items are written as bodies[0].density." if isinstance(container, list) else "",
            )
        if is_last:
            container[key] = value
            return
        if isinstance(key, str):
            container.setdefault(key, {})
        container = container[key]
