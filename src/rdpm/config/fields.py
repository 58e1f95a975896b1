"""The kinds of value a case file holds: quantities, vectors, lists, names."""

from __future__ import annotations

import math
import numbers
from collections.abc import Callable
from typing import Any

from pydantic import BaseModel, BeforeValidator, ConfigDict

from rdpm.config.rule import RuleError, suggestion
from rdpm.config.units import parse_quantity

__all__ = [
    "Model",
    "Vector",
    "Vectors",
    "choice",
    "items",
    "number",
    "placed",
    "to_number",
    "to_vector",
    "to_vectors",
    "vector",
    "whole",
    "whole_vector",
]

Vector = tuple[float, float, float]
Vectors = tuple[Vector, ...]


class Model(BaseModel):
    """A table of the case file: frozen, unknown keys refused, its values plain SI numbers."""

    model_config = ConfigDict(frozen=True, extra="forbid")


def items(value: Any) -> list[Any]:
    """Return a TOML array, a tuple or an array as a list."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if not isinstance(value, list | tuple):
        raise RuleError("must be a list", value=value)
    return list(value)


def to_number(
    value: Any, unit: str, *, above: float = -math.inf, least: float = -math.inf, most: float = math.inf
) -> float:
    """Return a quantity in `unit`, with `above` < value, `least` <= value <= `most`."""
    found = parse_quantity(value, unit, bare=False)
    named = f" {unit}" if unit else ""
    if found <= above:
        rule = "must be positive" if above == 0.0 else f"must be above {above:g}{named}"
        raise RuleError(rule, value=value)
    if found < least:
        raise RuleError(
            f"must be at least {least:g}{named}" if least else "must not be negative", value=value
        )
    if found > most:
        raise RuleError(f"must be at most {most:g}{named}", value=value)
    return found


def to_vector(value: Any, unit: str, **limits: float) -> Vector:
    """Return three quantities in `unit`."""
    listed = items(value)
    if len(listed) != 3:
        raise RuleError("must have three components, x, y and z", value=value)
    x, y, z = (placed(i, to_number, item, unit, **limits) for i, item in enumerate(listed))
    return x, y, z


def to_vectors(value: Any, unit: str) -> Vectors:
    """Return a list of vectors."""
    return tuple(placed(i, to_vector, item, unit) for i, item in enumerate(items(value)))


def placed(at: int | str, function: Callable[..., Any], *given: Any, **limits: float) -> Any:
    """Call a function; what goes wrong in it is placed one level deeper, at `at`."""
    try:
        return function(*given, **limits)
    except RuleError as problem:
        raise problem.below(at) from None


def number(unit: str, **limits: float) -> BeforeValidator:
    """Check a quantity in `unit`."""
    return BeforeValidator(lambda value: to_number(value, unit, **limits))


def whole(least: int, most: int) -> BeforeValidator:
    """Check a whole number."""
    return BeforeValidator(lambda value: to_whole(value, least, most))


def whole_vector(least: int, most: int) -> BeforeValidator:
    """Check three whole numbers."""

    def check(value: Any) -> tuple[int, int, int]:
        listed = items(value)
        if len(listed) != 3:
            raise RuleError("must have three components, x, y and z", value=value)
        x, y, z = (placed(i, to_whole, item, least, most) for i, item in enumerate(listed))
        return x, y, z

    return BeforeValidator(check)


def to_whole(value: Any, least: int, most: int) -> int:
    """Return a whole number, `least` <= value <= `most`."""
    if isinstance(value, bool) or not isinstance(value, numbers.Integral):
        raise RuleError("must be a whole number", value=value)
    if not least <= int(value) <= most:
        raise RuleError(f"must lie between {least} and {most}", value=value)
    return int(value)


def vector(unit: str, **limits: float) -> BeforeValidator:
    """Check three quantities."""
    return BeforeValidator(lambda value: to_vector(value, unit, **limits))


def choice(*names: str, later: tuple[str, ...] = ()) -> BeforeValidator:
    """Check one of some names; those of `later` are known but not in this version."""

    def check(value: Any) -> Any:
        if isinstance(value, str) and value in names:
            return value
        if isinstance(value, str) and value in later:
            raise RuleError(
                "is not in this version", cure=f"Use {' or '.join(map(_quoted, names))}.", value=value
            )
        cure = suggestion(value, names) if isinstance(value, str) and len(value) < 80 else ""
        raise RuleError(f"must be {' or '.join(map(_quoted, names))}", cure=cure, value=value)

    return BeforeValidator(check)


def _quoted(name: str) -> str:
    return f'"{name}"'
