"""A changed case for each run of a study: keys set, contact parameters replaced, numerics varied."""

from __future__ import annotations

import copy
import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from rdpm.cases import shipped_names
from rdpm.config.body_file import read_body_files
from rdpm.config.case import Case
from rdpm.config.contact import DEFAULT_CONTACT, keys_of_other_models
from rdpm.config.load import load_case
from rdpm.config.overrides import set_value, unset_value
from rdpm.config.source import local_file, parse_toml, read_source
from rdpm.config.write import case_to_toml
from rdpm.errors import CaseError
from rdpm.setup import plan

__all__ = ["base_raw", "base_source", "changed", "flat_case", "start_case", "varied_numerics", "with_start_key"]

Raw = dict[str, Any]

# The four ways to give a contact, each whole; what a study sets chooses among them.
_WAYS = (
    {"stiffness", "damping"},
    {"stiffness", "restitution"},
    {"contact_steps", "restitution"},
    {"max_overlap", "impact_speed", "restitution"},
)
_CONTACT_PARAMETERS = set().union(*_WAYS)
_LUBRICATION = ("lubrication", "lubrication_roughness", "lubrication_in_separation", "lubrication_tangential")


def base_source(source: str, folder: Path | None) -> tuple[str | Path, str]:
    """Where the base case of a study is, and a line to tell where that is not plain.

    Parameters
    ----------
    source : str
        A shipped name, or a path from `folder`.
    folder : pathlib.Path or None
        Of the study file, where a file ``NAME.toml`` goes before the shipped case NAME; None for a study that is no
        file.
    """
    if source not in shipped_names():
        return (folder or Path()) / source, ""
    local = None if folder is None else local_file(source, folder)
    return local or (source, "")


def base_raw(source: str | Raw, folder: Path | None) -> Raw:
    """What the base case of a study holds.

    Parameters
    ----------
    source : str or dict
        As for `base_source`, or the case itself.
    folder : pathlib.Path or None

    Raises
    ------
    CaseError
    """
    if isinstance(source, dict):
        return copy.deepcopy(source)
    text, label, home = read_source(base_source(source, folder)[0])
    raw = parse_toml(text, label)
    read_body_files(raw, home, {})
    return raw


def changed(
    raw: Raw, sets: Iterable[Mapping[str, Any]], unsets: Iterable[str], place: str
) -> tuple[Raw, list[str]]:
    """The same with keys left out and set.

    A contact parameter that is set takes the place of those set before that it cannot stand beside: with
    ``contact.stiffness``, the ``contact_steps`` of a base go and its ``restitution`` stays. With ``contact.model``,
    what that model does not know goes.

    Parameters
    ----------
    raw : dict
    sets : iterable of mapping
        Dotted keys and values; later ones count.
    unsets : iterable of str
        Keys that are left out first.
    place : str
        For messages.

    Returns
    -------
    dict, list of str
        And what was replaced, as sentences.

    Examples
    --------
    >>> raw = {"contact": {"contact_steps": 8, "restitution": 0.5}}
    >>> changed(raw, [{"contact.stiffness": 50}], (), "study")
    ({'contact': {'restitution': 0.5, 'stiffness': 50}}, ['contact.contact_steps gives way to stiffness'])
    """
    made = copy.deepcopy(raw)
    for key in unsets:
        unset_value(made, key, f"{place}: unset")
    notes: list[str] = []
    for values in sets:
        for key, value in values.items():
            set_value(made, key, copy.deepcopy(value), f"{place}: {key}")
        given = {key.partition(".")[2] for key in values if key.startswith("contact.")}
        notes += _give_way_to_model(made, given)
        notes += _give_way(made, given & _CONTACT_PARAMETERS)
    return made, notes


def _give_way_to_model(raw: Raw, given: set[str]) -> list[str]:
    """Leave out what another model of contacts does not know, if it was not set beside the model."""
    contact = raw.get("contact")
    if "model" not in given or not isinstance(contact, dict):
        return []
    gone = sorted((keys_of_other_models(str(contact["model"])) & set(contact)) - given)
    for name in gone:
        del contact[name]
    return [f"contact.{name} gives way to model = {contact['model']}" for name in gone]


def _give_way(raw: Raw, given: set[str]) -> list[str]:
    contact = raw.get("contact")
    if not given or not isinstance(contact, dict) or contact.get("model", "soft-sphere") != "soft-sphere":
        return []
    present = _CONTACT_PARAMETERS & set(contact)
    known = present | (set(DEFAULT_CONTACT) if present == given else set())
    fitting = [way for way in _WAYS if given <= way <= known]
    if not fitting:
        return []  # the case itself says what is missing
    way = min(fitting, key=lambda way: len(way - given))
    for name in sorted(way - present):
        contact[name] = DEFAULT_CONTACT[name]
    gone = sorted(present - way)
    for name in gone:
        del contact[name]
    return [f"contact.{name} gives way to {', '.join(sorted(given))}" for name in gone]


def flat_case(case: Case) -> dict[str, Any]:
    """Dotted keys of a case with their values in SI; lists of numbers as lists.

    Examples
    --------
    >>> flat_case(load_case("dkt"))["fluid.viscosity"]
    0.113
    """
    found: dict[str, Any] = {}

    def walk(value: Any, key: str) -> None:
        """Collect what stands under a key."""
        if isinstance(value, dict):
            for name, item in value.items():
                walk(item, f"{key}.{name}" if key else name)
        elif isinstance(value, list) and any(isinstance(item, dict) for item in value):
            for n, item in enumerate(value):
                walk(item, f"{key}[{n}]")
        else:
            found[key] = value

    walk(tomllib.loads(case_to_toml(case)), "")
    return found


def with_start_key(case: Case) -> str:
    """What runs with a common start share: all but title, end, output, and contact other than lubrication."""
    keys = flat_case(case)
    kept = {
        key: value
        for key, value in keys.items()
        if key not in ("title", "time.end")
        and not key.startswith("output.")
        and (not key.startswith("contact.") or key.removeprefix("contact.") in _LUBRICATION)
    }
    return repr(sorted(kept.items()))


def start_case(case: Case, base: Case | None, at: float) -> Case:
    """The case of a common start.

    Parameters
    ----------
    case : Case
        Of one of the runs.
    base : Case, optional
        Whose contact is taken, as no contact happens; `case`'s without it.
    at : float, [s]
        Its end.
    """
    same = {name: getattr(case.contact, name) for name in _LUBRICATION}
    contact = (base or case).contact.model_copy(update=same)
    output = case.output.model_copy(
        update={"checkpoint_every": None, "report": False, "video": False}
    )
    return case.model_copy(update={
        "contact": contact, "output": output, "time": case.time.model_copy(update={"end": at}),
    })


def varied_numerics(
    case: Case, place: str, *, shift: Any = None, seed: int | None = None, step: float | None = None
) -> Case:
    """A case with a change that physics does not know.

    Parameters
    ----------
    case : Case
        Wet.
    place : str
        For messages.
    shift : (3,) floats, optional, [cells]
        Moves all bodies.
    seed : int, optional
        Turns the markers of all bodies.
    step : float, optional, [s]
        Contacts of a given number of steps keep their length in time.

    Raises
    ------
    CaseError
        It cannot be changed so.
    """
    raw = tomllib.loads(case_to_toml(case))
    if shift is not None:
        cells = plan(case).cells
        if cells is None:
            raise CaseError(place, None, "must not shift the bodies of a dry case", "it has no grid")
        move = [part * length / n for part, length, n in zip(shift, case.domain.size, cells, strict=True)]
        for n, group in enumerate(raw.get("bodies", [])):
            if "centers" in group:
                group["centers"] = [[x + dx for x, dx in zip(c, move, strict=True)] for c in group["centers"]]
            elif "lattice" in group and "origin" in group["lattice"]:
                lattice = group["lattice"]
                lattice["origin"] = [x + dx for x, dx in zip(lattice["origin"], move, strict=True)]
            else:
                raise CaseError(
                    place, None, "must not shift bodies without a given place", f"bodies[{n}] is packed at random",
                    "Vary bodies[0].packing.seed instead.",
                )
    if seed is not None:
        for n, group in enumerate(raw.get("bodies", [])):
            group["orientation_seed"] = seed + n
    if step is not None:
        if case.contact.contact_steps is not None:
            steps = case.contact.contact_steps * plan(case).step.dt / step
            raw["contact"]["contact_steps"] = round(steps, 12)
        raw["time"]["step"] = step
    try:
        return load_case(raw)
    except CaseError as error:
        raise CaseError(f"{place}: {error.place}", error.value, error.rule, error.reason, error.cure) from None
