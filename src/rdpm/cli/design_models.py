"""`rdpm design` of other models than the soft sphere."""

from __future__ import annotations

import json
from typing import Any

from rdpm.errors import CaseError

__all__ = ["check_model", "only_printed", "option", "print_model", "refuse_input"]

# Inputs of the other models, beside bodies, speed and fluid.
_BODIES = {"diameter", "density", "diameter2", "density2", "impact_speed", "time_step", "fluid_density", "viscosity",
           "gravity"}  # fmt: skip
_OF_MODEL = {
    "hertz": _BODIES | {"youngs_modulus", "poisson_ratio", "restitution", "overlap_limit"},
    "repulsive": _BODIES | {"repulsion_range", "repulsion_stiffness", "gap"},
    "hard-sphere": _BODIES | {"restitution", "contact_steps"},
}
_NEEDED_OF_MODEL = {
    "hertz": ("diameter", "density", "youngs_modulus", "poisson_ratio", "restitution"),
    "repulsive": ("diameter", "density", "repulsion_range"),
    "hard-sphere": ("diameter", "density", "restitution", "time_step"),
}


def option(name: str) -> str:
    """Give a name as it is typed."""
    return "--" + name.replace("_", "-")


def refuse_input(name: str, belongs: str, model: str) -> None:
    """Refuse an input of another model."""
    raise CaseError(option(name), None, f"belongs to --model {belongs}", f"this design is of --model {model}",
                    f"Leave it out, or say --model {belongs}.")  # fmt: skip


def check_model(model: str, given: dict[str, Any], swept: dict[str, Any]) -> None:
    """Refuse what does not belong to the model, and what it lacks."""
    for name in given:
        if name not in _OF_MODEL[model]:
            owners = [other for other, names in _OF_MODEL.items() if name in names]
            refuse_input(name, owners[0] if owners else "soft-sphere", model)
    for name in swept:
        rule = f"must be one value with --model {model}"
        raise CaseError(option(name), None, rule, "sweeps are of the soft sphere", "Give one number.")
    for name in _NEEDED_OF_MODEL[model]:
        if name not in given:
            raise CaseError(option(name), None, f"must be given with --model {model}", cure=f"Add {option(name)}.")


def print_model(model: str, single: dict[str, float], wall: bool, ending: Any, as_json: bool) -> int:
    """Print the design of a model other than the soft sphere."""
    from rdpm import design

    short = {"repulsion_range": "range", "repulsion_stiffness": "stiffness"}
    named: dict[str, Any] = {short.get(name, name): value for name, value in single.items()}
    one: Any
    if model == "hertz":
        one = design.hertz_design(**named, wall=wall, ending=ending)
    elif model == "hard-sphere":
        one = design.hard_sphere_design(**named, wall=wall, ending=ending)
    else:
        one = design.repulsive_design(**named, wall=wall)
    print(json.dumps(one.to_dict(), indent=2) if as_json else one)
    return 0


def only_printed(model: str, **others: Any) -> None:
    """Refuse outputs that the other models do not have."""
    for name, value in others.items():
        if value:
            raise CaseError(option(name), None, f"cannot go with --model {model}", "it is of the soft sphere",
                            "Take one away.")  # fmt: skip
