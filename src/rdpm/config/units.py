"""Quantities with units, as SI floats.

A number is in SI; a string is a number and a unit. The conversion is decimal: 1 g/cm3 is exactly 1000 kg/m3.
"""

from __future__ import annotations

import math
import numbers
import re
from decimal import Decimal, InvalidOperation
from functools import cache, lru_cache
from typing import Any

from rdpm.config.rule import RuleError, shown

__all__ = ["LARGEST", "QUANTITIES", "parse_quantity"]

LARGEST = 1e30  # beyond it, and below its inverse, squares and cubes leave the range of a double

_NUMBER = re.compile(r"\s*([+-]?(?:\d[\d_]*\.?\d*|\.\d+)(?:[eE][+-]?\d{1,4})?)\s*(.*?)\s*", re.DOTALL)
_UNIT = re.compile(r"(?:[^\W\d_]+|%|°)?(?:[\s*/·.^()-]|[^\W\d_]|_|(?<![\d.])\d(?!\d)|°|%)*")

#: What is expected, by SI unit: the quantity's name and an example for the message.
QUANTITIES = {
    "m": ("a length", "15 mm"),
    "s": ("a time", "10 ms"),
    "m/s": ("a velocity", "5 cm/s"),
    "rad/s": ("an angular velocity", "10 rad/s"),
    "m/s^2": ("an acceleration", "-9.81 m/s^2"),
    "kg": ("a mass", "1 g"),
    "kg/m^3": ("a density", "1120 kg/m^3"),
    "Pa s": ("a dynamic viscosity", "0.113 Pa s"),
    "m^2/s": ("a kinematic viscosity", "1e-6 m^2/s"),
    "Pa/m": ("a pressure gradient", "10 Pa/m"),
    "Pa": ("a pressure", "1 MPa"),
    "N": ("a force", "1 mN"),
    "N/m": ("a stiffness", "100 N/m"),
    "J/m^2": ("a surface energy", "50 mJ/m^2"),
    "N s/m": ("a damping coefficient", "0.1 N s/m"),
    "": ("a plain number", "0.5"),
}


def parse_quantity(value: Any, unit: str, *, bare: bool = True) -> float:
    """Turn a number, or a string with a unit, into a float in an SI unit.

    Parameters
    ----------
    value : float, int or str
        A number already in `unit`, or text such as ``"15 mm"``; finite.
    unit : str
        The SI unit wanted: ``"m"``, ``"kg/m^3"``, ``"Pa s"``; ``""`` for a pure number (``"20 %"`` is 0.2).
    bare : bool, optional
        Whether text may be a number without a unit (as on a command line).

    Returns
    -------
    float, [`unit`]

    Raises
    ------
    RuleError
        A ``ValueError``: not a number, not finite, an unknown unit, or another dimension; it says what was
        expected.

    Notes
    -----
    Angles count as pure numbers: ``"1/s"`` is taken as rad/s, and ``"rpm"`` is turned into it.
    Temperatures and logarithmic units are not covered.

    Examples
    --------
    >>> parse_quantity("1 g/cm3", "kg/m^3")
    1000.0
    >>> parse_quantity("15 mm", "m"), parse_quantity(0.015, "m")
    (0.015, 0.015)
    >>> parse_quantity("10 kg", "m")   # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ...
    rdpm.config.rule.RuleError: "10 kg": must be a length (kg is not one). Write a number in m, or ...
    """
    if isinstance(value, str):
        number = _from_text(value, unit, bare)
    elif not isinstance(value, bool) and isinstance(value, numbers.Real | Decimal):
        try:
            number = float(value)
        except (OverflowError, ValueError):  # a huge integer, a signalling NaN
            number = math.inf
    else:
        raise _expected(unit, value, f"{_kind(value)} is not a number")
    if not math.isfinite(number):
        raise RuleError("must be a finite number", value=value)
    if abs(number) > LARGEST or 0.0 < abs(number) < 1.0 / LARGEST:
        raise RuleError(
            f"must lie between {1 / LARGEST:g} and {LARGEST:g} in {unit or 'size'}",
            "nothing physical lies beyond",
            value=value,
        )
    return number


def _from_text(text: str, unit: str, bare: bool) -> float:
    match = _NUMBER.fullmatch(text) if len(text) <= 80 else None
    if match is None:
        raise _expected(unit, text, "it does not start with a number")
    given = match[2]
    try:
        number = Decimal(match[1])
        if not given:
            if unit and not bare:
                raise _expected(unit, text, "the unit is missing")
            return float(number)
        return float(number * _factor(given, unit, text))
    except (InvalidOperation, OverflowError):
        return math.inf


def _factor(given: str, unit: str, text: str) -> Decimal:
    found = _conversion(given, unit)
    if isinstance(found, Decimal):
        return found
    raise _expected(unit, text, found)


@lru_cache(maxsize=1024)
def _conversion(given: str, unit: str) -> Decimal | str:
    """One `given` in `unit`, or why there is no such factor."""
    unknown = f"{shown(given)} is not a unit known here"
    if not _UNIT.fullmatch(given) or len(given) > 40:
        return unknown
    # "cm3" and "m s-2" are what people write; pint wants the caret
    spelled = re.sub(r"(?<=[^\W\d_])(-?\d)", r"^\1", given.replace("·", "*"))
    try:
        factor = _registry().Quantity(Decimal(1), spelled)
    except Exception:  # pint's parser raises nearly any kind for text that is no unit
        return unknown
    try:
        return Decimal(factor.to(unit).magnitude)
    except Exception:
        return f"{given} is not one"


@cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry(non_int_type=Decimal)


def _expected(unit: str, value: Any, reason: str) -> RuleError:
    name, example = QUANTITIES.get(unit, (f"a quantity in {unit}", f"1 {unit}"))
    cure = (
        f'Write a number in {unit}, or text such as "{example}".'
        if unit
        else f"Write a number such as {example}."
    )
    return RuleError(f"must be {name}", reason, cure, value=value)


def _kind(value: Any) -> str:
    names = {bool: "true or false", list: "a list", tuple: "a list", dict: "a table", type(None): "nothing"}
    return names.get(type(value), f"a {type(value).__name__}")
