"""Values that a study varies: lists, and linear or logarithmic ranges."""

from __future__ import annotations

import math
import re
from typing import Any

from rdpm.config.rule import RuleError

__all__ = ["is_range", "to_values"]

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?"
_RANGE = re.compile(rf"\s*(log\s+)?({_NUMBER})\s*:\s*({_NUMBER})\s*:\s*(\d{{1,4}})\s*(.*?)\s*")
_EXAMPLES = 'Write a list, "0.1:0.9:9", "log 5e3:1e5:5 dyn/cm", or { log = ["5e3 dyn/cm", "1e5 dyn/cm", 5] }.'
_KINDS = ("linear", "log")

#: Digits of the values of a range: 0.1:0.9:9 gives 0.3, not 0.30000000000000004.
DIGITS = 12


def is_range(value: Any) -> bool:
    """Whether a table is a range and not keys one level down.

    Examples
    --------
    >>> is_range({"log": [1, 10, 3]}), is_range({"stiffness": [1, 2]})
    (True, False)
    """
    return isinstance(value, dict) and len(value) == 1 and next(iter(value)) in _KINDS


def to_values(given: Any) -> tuple[Any, ...]:
    """List the values of a key that varies.

    Parameters
    ----------
    given : list, str or dict
        A list is taken as it is. Text is a range ``first:last:count`` with a unit behind it, ``log`` before it for
        equal ratios; so is a table ``{ linear = [first, last, count] }`` or ``{ log = [...] }``.

    Returns
    -------
    tuple
        At least one; numbers, or text with the unit that was given.

    Raises
    ------
    RuleError
        It is neither, or a range that cannot be.

    Examples
    --------
    >>> to_values("0.1:0.5:5")
    (0.1, 0.2, 0.3, 0.4, 0.5)
    >>> to_values("log 1e3:1e5:3 dyn/cm")
    ('1000 dyn/cm', '10000 dyn/cm', '100000 dyn/cm')
    >>> to_values({"linear": ["1 ms", "2 ms", 3]})
    ('1 ms', '1.5 ms', '2 ms')
    """
    if isinstance(given, list | tuple):
        if not given:
            raise RuleError("must have at least one value", value=given)
        return tuple(given)
    if is_range(given):
        return _table(given)
    if isinstance(given, str):
        match = _RANGE.fullmatch(given)
        if match is not None:
            first, last = float(match[2]), float(match[3])
            return _spaced(bool(match[1]), first, last, int(match[4]), match[5], given)
    raise RuleError("must be a list of values or a range", cure=_EXAMPLES, value=given)


def _table(given: dict[str, Any]) -> tuple[Any, ...]:
    ((kind, items),) = given.items()
    if not isinstance(items, list | tuple) or len(items) != 3:
        raise RuleError("must have three items: first, last, count", cure=_EXAMPLES, value=items)
    (first, unit), (last, other) = (_split(item) for item in items[:2])
    if unit != other:
        raise RuleError("must have one unit at both ends", f'"{unit}" and "{other}" are given', value=items)
    count = items[2]
    if isinstance(count, bool) or not isinstance(count, int):
        raise RuleError("must end with a whole number of values", cure=_EXAMPLES, value=count)
    return _spaced(kind == "log", first, last, count, unit, items)


def _split(item: Any) -> tuple[float, str]:
    """Number and unit."""
    if isinstance(item, int | float) and not isinstance(item, bool):
        return float(item), ""
    match = re.fullmatch(rf"\s*({_NUMBER})\s*(.*?)\s*", item) if isinstance(item, str) else None
    if match is None:
        raise RuleError("must be a number, or a number and a unit", cure=_EXAMPLES, value=item)
    return float(match[1]), match[2]


def _spaced(is_log: bool, first: float, last: float, count: int, unit: str, given: Any) -> tuple[Any, ...]:
    if not 2 <= count <= 1000:
        raise RuleError("must have 2 to 1000 values", f"the range counts {count}", value=given)
    if not math.isfinite(first) or not math.isfinite(last) or first == last:
        raise RuleError("must have two different ends", value=given)
    if is_log and not (first > 0.0 and last > 0.0):
        raise RuleError("must have positive ends", "its values have equal ratios", value=given)
    parts = [n / (count - 1) for n in range(count)]
    if is_log:
        numbers = [first * (last / first) ** part for part in parts]
    else:
        numbers = [first + (last - first) * part for part in parts]
    numbers[0], numbers[-1] = first, last
    texts = [f"{number:.{DIGITS}g}" for number in numbers]
    return tuple(f"{text} {unit}" for text in texts) if unit else tuple(float(text) for text in texts)
