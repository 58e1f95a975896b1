"""Quantities with units."""

import math
from decimal import Decimal
from fractions import Fraction

import pytest

from rdpm.config.units import parse_quantity


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("1 g/cm3", "kg/m^3", 1000.0),
        ("1 g/cm^3", "kg/m^3", 1000.0),
        ("15 mm", "m", 0.015),
        ("  15mm ", "m", 0.015),
        ("1e1 ms", "s", 0.01),
        ("-9.81 m s-2", "m/s^2", -9.81),
        ("113 mPa s", "Pa s", 0.113),
        ("1 P", "Pa s", 0.1),
        ("1 cSt", "m^2/s", 1e-6),
        ("1e5 dyn/cm", "N/m", 100.0),
        ("100 dyn s/cm", "N s/m", 0.1),
        ("5 cm/s", "m/s", 0.05),
        ("20 %", "", 0.2),
        ("0.5", "", 0.5),
        (0.015, "m", 0.015),
        (3, "m", 3.0),
        (Decimal("0.015"), "m", 0.015),
        (Fraction(1, 4), "m", 0.25),
    ],
)
def test_conversion_is_exact(text, unit, value):
    assert parse_quantity(text, unit) == value  # decimal, hence equality and no tolerance


def test_turns_become_radians():
    assert math.isclose(parse_quantity("60 rpm", "rad/s"), 2 * math.pi, rel_tol=1e-15)


@pytest.mark.parametrize(
    ("given", "unit", "said"),
    [
        ("10 kg", "m", "must be a length"),
        ("10 flurb", "m", '"flurb" is not a unit known here'),
        ("ten mm", "m", "does not start with a number"),
        ("", "m", "does not start with a number"),
        ("1 m^999999999", "m", "not a unit known here"),
        ("1 __import__", "m", "not a unit known here"),
        ("1" * 100 + " m", "m", "does not start with a number"),
        ("1e9999 m", "m", "finite"),
        ("1e40 m", "m", "must lie between"),
        ("1e-40 m", "m", "must lie between"),
        (math.nan, "m", "finite"),
        (math.inf, "m", "finite"),
        (10**400, "m", "finite"),
        (True, "m", "true or false is not a number"),
        (None, "m", "nothing is not a number"),
        ([1], "m", "a list is not a number"),
        ({}, "m", "a table is not a number"),
        (1j, "m", "a complex is not a number"),
    ],
)
def test_refused_with_what_was_expected(given, unit, said):
    with pytest.raises(ValueError, match="must") as refused:
        parse_quantity(given, unit)
    assert said in str(refused.value)


def test_a_case_file_needs_the_unit():
    assert parse_quantity("15", "m") == 15.0
    with pytest.raises(ValueError, match="the unit is missing"):
        parse_quantity("15", "m", bare=False)
