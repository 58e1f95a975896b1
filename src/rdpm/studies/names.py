"""Symbols and units of parameters and measures, for axes, legends, tables and sentences."""

from __future__ import annotations

import re
from typing import Any, NamedTuple

from rdpm.studies.measures import QUANTITIES

__all__ = ["SHORT", "Name", "in_words", "parameter", "value_text"]


class Name(NamedTuple):
    """How a parameter is written.

    Attributes
    ----------
    symbol : str
        As a formula of matplotlib.
    plain : str
    unit : str
        "" for a pure number.
    """

    symbol: str
    plain: str
    unit: str


_PARAMETERS = {
    "contact.stiffness": Name("$k_n$", "k_n", "N/m"),
    "contact.damping": Name("$\\eta_n$", "eta_n", "N s/m"),
    "contact.contact_steps": Name("$N_c$", "N_c", ""),
    "contact.restitution": Name("$e_n$", "e_n", ""),
    "contact.lubrication": Name("lubrication", "lubrication", ""),
    "fluid.viscosity": Name("$\\mu$", "viscosity", "Pa s"),
    "time.step": Name("$\\delta t$", "dt", "s"),
    "resolution.cells_per_diameter": Name("cells a diameter", "cells a diameter", ""),
}

#: Short words for the measures that tables and sentences name.
SHORT = {
    "kiss_time_s": "first kiss",
    "tumble_start_s": "tumble",
    "gap_kisses": "kisses by gap",
    "gap_kiss_total_s": "time with a gap below 2 % d",
    "contact_kisses": "kisses by contact",
    "contact_kiss_total_s": "time in contact",
    "max_overlap_fraction": "largest overlap",
    "max_stokes_number": "largest Stokes number",
    "settling_speed_max_m_s": "largest settling speed",
    "final_angle_deg": "angle at the end",
    "wet_restitution": "restitution in the fluid",
    "approach_stokes_number": "Stokes number",
    "damping_ratio": "damping ratio",
    "end_height_m": "height at the end",
}


def parameter(key: str) -> Name:
    """How a key of the case is written.

    Examples
    --------
    >>> parameter("contact.stiffness").unit, parameter("fluid.density").plain
    ('N/m', 'fluid.density')
    """
    return _PARAMETERS.get(key, Name(key.replace("_", " "), key, ""))


def value_text(key: str, value: Any, formula: bool = True) -> str:
    """A parameter with its value.

    Examples
    --------
    >>> value_text("contact.stiffness", 50.0, formula=False)
    'k_n = 50 N/m'
    """
    name = parameter(key)
    text = f"{value:g}" if isinstance(value, (int, float)) and not isinstance(value, bool) else str(value)
    return f"{name.symbol if formula else name.plain} = {text} {name.unit}".strip()


def in_words(sentence: str) -> str:
    """A sentence with words instead of the names of columns.

    Examples
    --------
    >>> in_words("contact_kisses is 1, 2 at contact.stiffness = 1, 500")
    'kisses by contact: 1, 2 at k_n = 1, 500 N/m'
    """
    text = sentence
    for key, name in _PARAMETERS.items():
        if name.unit:
            text = re.sub(rf"{re.escape(key)} = ([\d.e+\-]+(?:, [\d.e+\-]+)*)", rf"{key} = \1 {name.unit}", text)
        text = text.replace(key, name.plain)
    for column in sorted(QUANTITIES, key=len, reverse=True):
        words = SHORT.get(column, re.sub(r"_(s|m|m_s|J|deg|fraction)$", "", column).replace("_", " "))
        text = re.sub(rf"\b{column}\b(?: is\b(?! not))", f"{words}:", text)
        text = re.sub(rf"\b{column}\b", words, text)
    return text
