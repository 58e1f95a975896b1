"""What the design page asks for, as one state that fits into an address."""

from __future__ import annotations

import inspect
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from rdpm.app.materials import FLUIDS, MATERIALS
from rdpm.config.rule import RuleError
from rdpm.config.units import parse_quantity
from rdpm.design import Design, soft_sphere
from rdpm.errors import CaseError

__all__ = ["DEFAULTS", "EMPTY", "INPUTS", "WAYS", "Input", "designed", "query_of", "shown", "state_of"]


@dataclass(frozen=True)
class Input:
    """A quantity of :func:`rdpm.design.soft_sphere`; unit and help are of its docstring.

    Attributes
    ----------
    name, label, unit, help : str
    low, high : float, [`unit`]
        Where its slider ends; a number beyond may be typed.
    is_log : bool
        Equal ways on the slider are equal factors.
    """

    name: str
    label: str
    unit: str
    help: str
    low: float
    high: float
    is_log: bool = True


#: What may be known of the spring: the inputs of each way.
WAYS: dict[str, tuple[str, tuple[str, ...]]] = {
    "steps": ("contact steps, time step, restitution", ("contact_steps", "time_step", "restitution")),
    "overlap": ("overlap at impact, restitution", ("max_overlap", "restitution", "time_step")),
    "stiffness": ("stiffness, restitution", ("stiffness", "restitution", "time_step")),
    "damping": ("stiffness, damping", ("stiffness", "damping", "time_step")),
    "time": ("contact time, restitution", ("contact_time", "restitution", "time_step")),
    "material": ("Hertz time of the material, restitution", ("restitution", "time_step")),
}

_RANGES: dict[str, tuple[str, float, float, bool]] = {
    "diameter": ("diameter", 1e-4, 0.1, True),
    "density": ("density of the sphere", 100.0, 20000.0, True),
    "diameter2": ("diameter of the other sphere", 1e-4, 0.1, True),
    "density2": ("density of the other sphere", 100.0, 20000.0, True),
    "youngs_modulus": ("Young's modulus", 1e5, 1e12, True),
    "poisson_ratio": ("Poisson's ratio", 0.0, 0.5, False),
    "fluid_density": ("density of the fluid", 1.0, 2000.0, True),
    "viscosity": ("dynamic viscosity", 1e-5, 10.0, True),
    "impact_speed": ("impact speed", 1e-3, 10.0, True),
    "contact_steps": ("contact steps N_c", 2.0, 50.0, False),
    "time_step": ("time step dt", 1e-7, 0.1, True),
    "restitution": ("restitution e_n", 0.05, 1.0, False),
    "stiffness": ("stiffness k_n", 1e-1, 1e7, True),
    "damping": ("damping eta_n", 1e-4, 1e3, True),
    "contact_time": ("contact time t_c", 1e-7, 0.1, True),
    "max_overlap": ("peak overlap over the diameter", 1e-4, 0.05, True),
    "friction": ("friction coefficient", 0.0, 1.0, False),
}

#: What a first visit shows: the sphere of the case `settling`.
DEFAULTS = {
    "material": "", "diameter": "15 mm", "density": "1120 kg/m^3", "partner": "pair", "fluid": "silicone oil (E3)",
    "way": "steps", "contact_steps": "8", "time_step": "1 ms", "restitution": "0.9", "ending": "zero-force",
}  # fmt: skip

_CHOICES: dict[str, tuple[str, ...]] = {
    "material": ("", *MATERIALS),
    "fluid": ("", "none", *FLUIDS),
    "partner": ("pair", "other", "wall"),
    "way": tuple(WAYS),
    "ending": ("zero-force", "zero-overlap"),
}
_TYPICAL = {"stiffness": "100 N/m", "damping": "0.1 N s/m", "contact_time": "8 ms", "max_overlap": "0.5 %"}
#: What holds where an input that may be left empty is empty.
EMPTY = {
    "impact_speed": "empty: the settling velocity", "youngs_modulus": "empty: not known",
    "poisson_ratio": "empty: not known", "friction": "empty: none", "density2": "empty: the same",
    "time_step": "empty: chosen",
}  # fmt: skip
_LONGEST = 80  # characters of one value


def _inputs() -> dict[str, Input]:
    text = inspect.cleandoc(soft_sphere.__doc__ or "")
    found = {}
    for match in re.finditer(r"^(\w[\w, ]*) : ([^\n]*)\n((?:    [^\n]*\n)*)", text, re.MULTILINE):
        unit = re.search(r"\[(.*?)\]", match[2])
        for name in match[1].split(", "):
            if name in _RANGES and unit is not None:
                label, low, high, is_log = _RANGES[name]
                said = re.sub(r"``(\w+)``", lambda m: m[1].replace("_", " "), " ".join(match[3].split()))
                found[name] = Input(name, label, unit[1].replace("-", ""), said, low, high, is_log)
    return found


#: By name, in the order of `rdpm.design.soft_sphere`.
INPUTS = _inputs()


def state_of(query: Mapping[str, str]) -> dict[str, str]:
    """Read a state from an address; what it does not know is left out, what is not said is as on a first visit.

    Examples
    --------
    >>> state_of({"diameter": "2 mm", "nonsense": "1"})["diameter"]
    '2 mm'
    """
    known = {key: str(value)[:_LONGEST] for key, value in query.items() if key in INPUTS or key in _CHOICES}
    state = dict(known) if known else dict(DEFAULTS)
    for key, choices in _CHOICES.items():
        if state.get(key) not in choices:
            state[key] = DEFAULTS[key] if not known else choices[0]
    for name in WAYS[state["way"]][1]:
        if name not in state and name != "time_step":
            state[name] = DEFAULTS.get(name) or _TYPICAL[name]
    return state


def carried_over(state: Mapping[str, str], name: str, value: str, design: Design | None) -> dict[str, str]:
    """Give the state after a choice; numbers that were known stay known.

    Parameters
    ----------
    state : mapping of str to str
    name, value : str
        What was chosen: "own numbers" begins with those of the material or fluid before, another way to name the
        contact with what the contact has.
    design : Design or None
        Of the state before.

    Examples
    --------
    >>> glass = state_of({"material": "soda-lime glass", "diameter": "2 mm"})
    >>> carried_over(glass, "material", "", None)["density"]
    '2500 kg/m^3'
    """
    known: dict[str, float | None] = {}
    if name == "material" and not value and state["material"]:
        solid = MATERIALS[state["material"]]
        known = {key: getattr(solid, key) for key in ("density", "youngs_modulus", "poisson_ratio")}
    elif name == "fluid" and not value and state["fluid"] in FLUIDS:
        fluid = FLUIDS[state["fluid"]]
        known = {"fluid_density": fluid.density, "viscosity": fluid.viscosity}
    elif name == "way" and design is not None:
        known = {
            "stiffness": design.stiffness_N_m, "damping": design.damping_N_s_m, "contact_time": design.contact_time_s,
            "contact_steps": design.contact_steps, "max_overlap": design.max_overlap_fraction,
        }  # fmt: skip
        known = {key: number for key, number in known.items() if key not in _used(state)}
    told = {
        key: shown(number, INPUTS[key].unit)
        for key, number in known.items()
        if number is not None and INPUTS[key].low <= number <= INPUTS[key].high
    }
    return state_of({**state, **told, name: value})


def query_of(state: Mapping[str, str]) -> dict[str, str]:
    """Give what an address must say: only what is used, and not empty."""
    used = set(_used(state)) | set(_CHOICES)
    return {key: value for key, value in state.items() if key in used and value != ""}


def _used(state: Mapping[str, str]) -> list[str]:
    names = ["diameter", "impact_speed", "friction", *WAYS[state["way"]][1]]
    if not state["material"]:
        names += ["density", "youngs_modulus", "poisson_ratio"]
    if not state["fluid"]:
        names += ["fluid_density", "viscosity"]
    return names + (["diameter2", "density2"] if state["partner"] == "other" else [])


def designed(state: Mapping[str, str]) -> Design:
    """Design what a state says.

    Raises
    ------
    CaseError
        Its place is the name of the input.

    Examples
    --------
    >>> round(designed(state_of({})).stiffness_N_m, 1)
    146.2
    """
    given: dict[str, Any] = {}
    for name in _used(state):
        text = state.get(name, "").strip()
        if text:
            given[name] = _value(name, text)
    if state["material"]:
        solid = MATERIALS[state["material"]]
        given |= {
            "density": solid.density,
            "youngs_modulus": solid.youngs_modulus,
            "poisson_ratio": solid.poisson_ratio,
        }
    if state["fluid"] in FLUIDS:
        fluid = FLUIDS[state["fluid"]]
        given |= {"fluid_density": fluid.density, "viscosity": fluid.viscosity}
    ending: Literal["zero-force", "zero-overlap"] = (
        "zero-overlap" if state["ending"] == "zero-overlap" else "zero-force"
    )
    return soft_sphere(**given, wall=state["partner"] == "wall", ending=ending)


def _value(name: str, text: str) -> float:
    try:
        return parse_quantity(text, INPUTS[name].unit)
    except RuleError as error:
        raise CaseError(name, f'"{text}"', error.rule, error.reason, error.cure) from None


_PREFIXES = {
    "m": ((1.0, "m"), (1e-3, "mm"), (1e-6, "um")),
    "s": ((1.0, "s"), (1e-3, "ms"), (1e-6, "us"), (1e-9, "ns")),
    "Pa": ((1e9, "GPa"), (1e6, "MPa"), (1e3, "kPa"), (1.0, "Pa")),
    "Pa s": ((1.0, "Pa s"), (1e-3, "mPa s")),
    "m/s": ((1.0, "m/s"), (1e-2, "cm/s"), (1e-3, "mm/s")),
}


def shown(value: float, unit: str) -> str:
    """Write a quantity in a unit that reads well.

    Examples
    --------
    >>> shown(0.015, "m"), shown(7.2e10, "Pa"), shown(0.9, "")
    ('15 mm', '72 GPa', '0.9')
    """
    scales = _PREFIXES.get(unit, ((1.0, unit),))
    factor, name = next(((f, n) for f, n in scales if abs(value) >= 0.9999 * f), scales[-1])
    return f"{value / factor:.4g} {name}".rstrip() if math.isfinite(value) else "-"
