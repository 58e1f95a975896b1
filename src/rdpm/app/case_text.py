"""A case file as text that a form changes value by value; comments and order stay."""

from __future__ import annotations

import re
import tomllib
from contextlib import suppress
from typing import Any

import tomlkit
from tomlkit.exceptions import TOMLKitError
from tomlkit.items import AoT

from rdpm.config.rule import Path
from rdpm.config.source import parse_toml
from rdpm.errors import CaseError

__all__ = ["drop", "found_at", "path_of", "put", "read", "value_of", "written_value"]


def read(text: str) -> dict[str, Any]:
    """Parse a case file; a `CaseError` names the line on which it breaks."""
    return parse_toml(text, "line")


def found_at(values: Any, path: Path) -> Any:
    """Give what a case holds at a path; None where it holds nothing.

    Examples
    --------
    >>> found_at({"bodies": [{"density": 1120}]}, ("bodies", 0, "density"))
    1120
    """
    for key in path:
        try:
            values = values[key]
        except (KeyError, IndexError, TypeError):
            return None
    return values


def value_of(text: str) -> Any:
    """Read what was typed into a field: a TOML value, or text such as 15 mm.

    Examples
    --------
    >>> value_of("8"), value_of("15 mm"), value_of('["1 cm", 0.02]'), value_of(" ")
    (8, '15 mm', ['1 cm', 0.02], None)
    """
    text = text.strip()
    if not text:
        return None
    if "\n" not in text or text[0] in "[{":
        with suppress(ValueError, RecursionError):
            held = tomllib.loads(f"value = {text}")
            if set(held) == {"value"}:
                return held["value"]
    return text.strip('"')


def written_value(value: Any) -> str:
    """Write a value as a field shows it; `value_of` reads it back.

    Examples
    --------
    >>> written_value(0.9), written_value("15 mm"), written_value(True), written_value([1, "2 cm"]), written_value(None)
    ('0.9', '15 mm', 'true', '[1, "2 cm"]', '')
    """
    if value is None:
        return ""
    if isinstance(value, str):
        return value
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list) and value and isinstance(value[0], list):
        return "[\n" + "".join(f"  {tomlkit.item(one).as_string()},\n" for one in value) + "]"
    return str(tomlkit.item(value).as_string())


def put(text: str, path: Path, value: Any) -> str:
    """Set a value in a case file, or take the key away where the value is None.

    Parameters
    ----------
    text : str
        TOML; comments and order stay.
    path : tuple of str and int
        Tables on the way are made.
    value : object

    Raises
    ------
    CaseError
        The text is not TOML, or the path leads through a value.

    Examples
    --------
    >>> put("[time]  # of all\\nend = 1\\n", ("time", "end"), "2 s")
    '[time]  # of all\\nend = "2 s"\\n'
    >>> put("[time]\\nend = 1\\nstep = 2\\n", ("time", "step"), None)
    '[time]\\nend = 1\\n'
    """
    read(text)  # the same words about what is no TOML
    try:
        document = tomlkit.parse(text)
        place: Any = document
        for key in path[:-1]:
            if isinstance(key, str) and key not in place:
                if value is None:
                    return text
                place[key] = tomlkit.table()
            place = place[key]
        last = path[-1]
        if value is None:
            if last in place if isinstance(last, str) else last < len(place):
                del place[last]
        else:
            _set(place, last, value)
        return tomlkit.dumps(document)
    except (TOMLKitError, KeyError, IndexError, TypeError, AttributeError, ValueError) as error:
        raise CaseError(dotted(path), None, "cannot be set here", str(error), "Change it in the text.") from None


def _set(place: Any, key: str | int, value: Any) -> None:
    if isinstance(place, AoT) and isinstance(key, int) and key == len(place):
        table = tomlkit.table()
        table.update(value)
        place.append(table)
    elif isinstance(value, list) and value and all(isinstance(one, dict) for one in value):
        tables = tomlkit.aot()
        for one in value:
            table = tomlkit.table()
            table.update(one)
            tables.append(table)
        place[key] = tables
    elif isinstance(value, list) and len(value) > 3:
        array = tomlkit.array()
        array.extend(value)
        place[key] = array.multiline(True)
    else:
        place[key] = value


def drop(text: str, path: Path) -> str:
    """Take a key, a table or a group away."""
    return put(text, path, None)


def dotted(path: Path) -> str:
    """Write a path as messages do.

    Examples
    --------
    >>> dotted(("bodies", 0, "density")), path_of("bodies[0].density")
    ('bodies[0].density', ('bodies', 0, 'density'))
    """
    return "".join(f"[{key}]" if isinstance(key, int) else f".{key}" for key in path).removeprefix(".")


def path_of(place: str) -> Path:
    """Read a path from where a message stands; empty where it names no key."""
    name = place.rpartition(": ")[2].partition(" ")[0]
    if not re.fullmatch(r"[a-z_A-Z][\w.\[\]-]*", name):
        return ()
    return tuple(int(part) if part.isdecimal() else part for part in re.findall(r"[A-Za-z_][\w-]*|\d+", name))
