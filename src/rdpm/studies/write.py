"""A study as TOML text."""

from __future__ import annotations

import json
import re
from typing import Any

__all__ = ["study_to_toml"]


def study_to_toml(content: dict[str, Any]) -> str:
    """Write nested tables as TOML.

    Parameters
    ----------
    content : dict
        Of text, numbers, booleans, lists and dicts.

    Examples
    --------
    >>> print(study_to_toml({"title": "a", "vary": {"time.end": [1, 2.0]}, "runs": [{"name": "b"}]}), end="")
    title = "a"
    <BLANKLINE>
    [vary]
    "time.end" = [1, 2.0]
    <BLANKLINE>
    [[runs]]
    name = "b"
    """
    lines: list[str] = []
    _table(content, (), lines)
    return "\n".join(lines).lstrip("\n") + "\n"


def _table(content: dict[str, Any], above: tuple[str, ...], lines: list[str]) -> None:
    tables = {key: value for key, value in content.items() if isinstance(value, dict) and value}
    arrays = {
        key: value for key, value in content.items()
        if isinstance(value, list) and value and all(isinstance(item, dict) for item in value)
    }
    lines.extend(
        f"{_key(key)} = {_value(value)}" for key, value in content.items() if key not in tables and key not in arrays
    )
    for key, table in tables.items():
        path = (*above, _key(key))
        lines.extend(("", f"[{'.'.join(path)}]"))
        _table(table, path, lines)
    for key, items in arrays.items():
        path = (*above, _key(key))
        for item in items:
            lines.extend(("", f"[[{'.'.join(path)}]]"))
            _table(item, path, lines)


def _key(key: str) -> str:
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else _text(key)


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{_key(key)} = {_value(item)}" for key, item in value.items()) + " }"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_value, value)) + "]"
    return repr(value)


def _text(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
