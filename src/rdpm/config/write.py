"""A case as TOML text."""

from __future__ import annotations

from typing import Any

from rdpm.config.fields import Model

__all__ = ["case_to_toml", "content"]

_ESCAPES = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\t": "\\t", "\r": "\\r"}


def case_to_toml(case: Model) -> str:
    """Write a case as TOML that loads back to an equal case.

    Parameters
    ----------
    case : Case

    Returns
    -------
    str
        Every value in SI, defaults included.

    Examples
    --------
    >>> from rdpm.config.load import load_case
    >>> import tomllib
    >>> case = load_case("dkt")
    >>> load_case(tomllib.loads(case_to_toml(case))) == case
    True
    """
    found = content(case)
    lines = [f"title = {_text(found.pop('title'))}"]
    for name, value in found.items():
        tables = value if isinstance(value, list) else [value]
        header = f"[[{name}]]" if isinstance(value, list) else f"[{name}]"
        for table in tables:
            lines += ["", header, *(f"{key} = {_value(item)}" for key, item in table.items())]
    return "\n".join(lines) + "\n"


def content(case: Model) -> dict[str, Any]:
    """What a case file with all of a case would hold.

    Examples
    --------
    >>> from rdpm.config.load import load_case
    >>> content(load_case("dkt"))["fluid"]["viscosity"]
    0.113
    """
    found: dict[str, Any] = _plain(case)
    return found


def _plain(value: Any) -> Any:
    """Models as dicts without what was left out, tuples as lists."""
    if isinstance(value, Model):
        items = {name: _plain(getattr(value, name)) for name in type(value).model_fields}
        return {name: item for name, item in items.items() if item is not None and item != {}}
    return [_plain(item) for item in value] if isinstance(value, tuple) else value


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_value(item)}" for key, item in value.items()) + " }"
    if isinstance(value, list):
        if len(value) > 1 and isinstance(value[0], list):
            return "[\n    " + ",\n    ".join(map(_value, value)) + ",\n]"
        return "[" + ", ".join(map(_value, value)) + "]"
    return repr(value)


def _text(text: str) -> str:
    return '"' + "".join(_ESCAPES.get(c, c if c.isprintable() else f"\\U{ord(c):08x}") for c in text) + '"'
