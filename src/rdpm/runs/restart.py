"""Which case a checkpoint can go on with: the same one for a run that continues, a changed one for a new run."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterator
from typing import Any

from rdpm.config.case import Case
from rdpm.config.load import load_case
from rdpm.config.write import case_to_toml
from rdpm.errors import CaseError, CheckpointError
from rdpm.runs.checkpoints import Saved

__all__ = ["case_to_branch", "case_to_continue"]

#: Keys of [output] that a run that continues may change: the files of the run go on as they began.
_FREE_OUTPUT = ("checkpoint_every", "checkpoints_kept", "report", "video", "figure_format")
_FREE = ("title", "time.end", "output")
_AUTOMATIC = ("time.step", "time.diffusion")  # chosen when the run began
_FREE_IN_A_BRANCH = ("title", "time", "output", "contact")


def case_to_continue(requested: Case, saved: Saved, tell: Callable[[str], None]) -> Case:
    """The case with which a run continues bit-identically.

    Parameters
    ----------
    requested : Case
        As given now; its end, its report and its checkpoints count.
    saved : Saved
    tell : callable
        Gets a sentence about what stays as it was.

    Returns
    -------
    Case

    Raises
    ------
    CheckpointError
        It is another case; the differences are named.
    """
    began = load_case(tomllib.loads(saved.case))
    different = list(_differences(began, requested))
    refused = [
        (key, was, now)
        for key, was, now in different
        if not _is_in(key, _FREE) and not (key in _AUTOMATIC and now == "auto")
    ]
    if refused:
        raise CheckpointError(
            str(saved.path),
            None,
            "must be of the case that is to be continued",
            _named(refused),
            "Leave these as they were, or start a new run from it with --from.",
        )
    for key, was, now in different:
        if key.startswith("output.") and key.partition(".")[2] not in _FREE_OUTPUT:
            unit = " s" if key.endswith(("_every", "_from")) else ""
            tell(f"note: {key} stays {_short(was)}{unit} in a run that continues, not {_short(now)}{unit}")
    free = {name: getattr(requested.output, name) for name in _FREE_OUTPUT}
    update: dict[str, Any] = {"title": requested.title, "output": began.output.model_copy(update=free)}
    if requested.time.end != began.time.end:
        same = _same_steps(saved, began.time.step == "adaptive")
        update["time"] = began.time.model_copy(update={"end": requested.time.end, **same})
    return began.model_copy(update=update)


def _same_steps(saved: Saved, is_adaptive: bool) -> dict[str, Any]:
    """The step and the way of diffusion, which an automatic choice would fit to the new end."""
    same: dict[str, Any] = {} if is_adaptive else {"step": float(saved.facts["dt_s"])}
    if "fluid/is_explicit" in saved.arrays:
        same["diffusion"] = "explicit" if saved.arrays["fluid/is_explicit"] else "stabilised"
    return same


def case_to_branch(requested: Case, saved: Saved) -> Case:
    """The case of a new run that starts from a checkpoint of another, with changed parameters.

    Parameters
    ----------
    requested : Case
        Its time, contact and output may be others.
    saved : Saved

    Returns
    -------
    Case

    Raises
    ------
    CheckpointError
        Its grid, fluid, box or bodies are others; the differences are named.
    CaseError
        It would end before it starts.
    """
    began = load_case(tomllib.loads(saved.case))
    refused = [item for item in _differences(began, requested) if not _is_in(item[0], _FREE_IN_A_BRANCH)]
    if refused:
        raise CheckpointError(
            str(saved.path),
            None,
            "must fit the case of the new run",
            _named(refused),
            "Only contact, time and output may change; name the other run's folder as CASE to take its case.",
        )
    if not requested.time.end > saved.time:
        raise CaseError(
            "time.end", f"{requested.time.end:g} s", f"must be later than the checkpoint, at {saved.time:.6g} s",
            cure="Raise it with --set time.end, or take an earlier checkpoint with --at.",
        )
    return requested


def _differences(one: Case, other: Case) -> Iterator[tuple[str, Any, Any]]:
    """Keys whose values differ, with both values."""
    a, b = (dict(_flat(tomllib.loads(case_to_toml(case)))) for case in (one, other))
    for key in [*a, *(key for key in b if key not in a)]:
        if a.get(key) != b.get(key):
            yield key, a.get(key), b.get(key)


def _flat(value: Any, key: str = "") -> Iterator[tuple[str, Any]]:
    if isinstance(value, dict):
        for name, item in value.items():
            yield from _flat(item, f"{key}.{name}" if key else name)
    elif isinstance(value, list) and any(isinstance(item, dict) for item in value):
        for n, item in enumerate(value):
            yield from _flat(item, f"{key}[{n}]")
    else:
        yield key, value


def _is_in(key: str, tables: tuple[str, ...]) -> bool:
    return any(key == table or key.startswith(f"{table}.") for table in tables)


def _named(different: list[tuple[str, Any, Any]]) -> str:
    """The first few differences as a reader wants them."""
    said = [f"{key} was {_short(was)} and is {_short(now)}" for key, was, now in different[:4]]
    return "; ".join(said) + (f"; and {len(different) - 4} more" if len(different) > 4 else "")


def _short(value: Any) -> str:
    if value is None:
        return "left out"
    text = f"{value:g}" if isinstance(value, float) else str(value)
    return text if len(text) <= 40 else f"{text[:37]}..."
