"""The runs of a study: every case, and the common start it goes on from."""

from __future__ import annotations

import itertools
import json
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from rdpm.config.case import Case
from rdpm.config.load import load_case
from rdpm.errors import CaseError
from rdpm.setup import plan
from rdpm.studies.cases import base_raw, base_source, changed, flat_case, start_case, varied_numerics, with_start_key
from rdpm.studies.registry import DRAWINGS
from rdpm.studies.study_file import LoadedStudy, Row

__all__ = ["StudyRun", "expand", "parameters"]


@dataclass(frozen=True)
class StudyRun:
    """One run of a study.

    Attributes
    ----------
    study : str
        The study, or the part of it, that it belongs to.
    name : str
        Within that study.
    case : Case
    start : Case, optional
        The common start it goes on from, at that case's end.
    spread_of : str
        The run whose numerics it varies; "" for a run in its own right.
    notes : tuple of str
        Which file the base case is, where that is not plain; what of it was replaced.
    """

    study: str
    name: str
    case: Case
    start: Case | None = None
    spread_of: str = ""
    notes: tuple[str, ...] = ()


def expand(study: LoadedStudy, quick: bool = False) -> list[StudyRun]:
    """List the runs of a study, those of its parts in their order.

    Parameters
    ----------
    study : LoadedStudy
    quick : bool
        As the file's [quick] says: fewer and smaller runs, without the spread.

    Returns
    -------
    list of StudyRun

    Raises
    ------
    CaseError
        A run's case is wrong, or the study has no [quick]; the message names file, line and run.

    Examples
    --------
    >>> from rdpm.studies.study_file import load_study
    >>> study = load_study({"base": {"case": "dkt"}, "vary": {"contact.stiffness": [50, "100 N/m"]}})
    >>> [(run.name, run.case.contact.stiffness) for run in expand(study)]
    [('stiffness-50', 50.0), ('stiffness-100N_m', 100.0)]
    """
    if study.parts:
        return [run for part in study.parts for run in expand(part, quick)]
    file = study.file
    if quick and file.quick is None:
        raise CaseError(f"{study.name}: quick", None, "is missing", "--quick needs to know what to leave out",
                        "Add [quick] with set = { ... }, or leave --quick away.")  # fmt: skip
    assert file.base is not None  # a study without parts was refused without it
    raw = base_raw(file.base.case, study.folder)
    rows = list(_rows(study))
    if quick and file.quick is not None and len(rows) > file.quick.most_runs:
        last, count = len(rows) - 1, file.quick.most_runs
        rows = [rows[round(n * last / max(count - 1, 1))] for n in range(count)]
    _check_names(study, [row.name for row, _ in rows])
    runs = [_run(study, raw, row, place, quick) for row, place in rows]
    if isinstance(file.base.case, str) and (note := base_source(file.base.case, study.folder)[1]):
        runs = [replace(run, notes=(note, *run.notes)) for run in runs]
    if file.spread is not None and not quick:
        runs += _spread(study, runs)
    return list(_started(study, raw, runs, quick))


def _rows(study: LoadedStudy) -> Iterator[tuple[Row, str]]:
    """All combinations of what varies, then the explicit rows; each with its place."""
    file = study.file
    axes: list[list[tuple[str, dict[str, Any]]]] = []
    for key, values in file.vary.items():
        axes.append([(_labelled(key, value, n), {key: value}) for n, value in enumerate(values)])
    for columns in file.linked:
        keys = [key for key in columns if key != "name"]
        length = len(next(iter(columns.values())))
        axis = []
        for n in range(length):
            cells = {key: columns[key][n] for key in keys}
            label = columns["name"][n] if "name" in columns else "_".join(_labelled(k, v, n) for k, v in cells.items())
            axis.append((label, cells))
        axes.append(axis)
    if axes:
        place = study.place("vary") if file.vary else study.place("linked")
        for number, combination in enumerate(itertools.product(*axes)):
            together = {key: value for _, part in combination for key, value in part.items()}
            # what has one value only tells no runs apart
            name = "_".join(
                label for (label, _), axis in zip(combination, axes, strict=True)
                if len(axis) > 1 or all(len(other) == 1 for other in axes)
            )
            row = Row(name=name if len(name) <= 80 else f"run-{number:03d}")
            yield row.model_copy(update={"set": together}), place
    for n, row in enumerate(file.runs):
        yield row, study.place("runs", n)
    if not axes and not file.runs:
        yield Row(name="run"), study.place("base")


def _labelled(key: str, value: Any, number: int) -> str:
    """A short name of one value: ``stiffness-50``."""
    last = re.sub(r"[^A-Za-z0-9]+", "_", key.rpartition(".")[2]).strip("_")
    if isinstance(value, bool):
        text = "true" if value else "false"
    elif isinstance(value, int | float):
        text = f"{value:.12g}"
    elif isinstance(value, str):
        text = re.sub(r"[^A-Za-z0-9_.+-]+", "_", value.replace(" ", "")).strip("_")
    else:
        text = str(number)
    return f"{last}-{text or number}"


def _check_names(study: LoadedStudy, names: list[str]) -> None:
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        place = next(study.place(key) for key in ("vary", "linked", "runs") if getattr(study.file, key))
        raise CaseError(place, None, "must give each run a name of its own", f"there are two of {twice[0]}",
                        "Leave the doubled value out, or name the rows.")  # fmt: skip


def _run(study: LoadedStudy, raw: dict[str, Any], row: Row, place: str, quick: bool) -> StudyRun:
    file = study.file
    assert file.base is not None
    where = f"{place}: run {row.name}"
    sets = [_output(study), file.base.set, row.set]
    if quick and file.quick is not None:
        sets.append(file.quick.set)
    made, notes = changed(raw, sets, (*file.base.unset, *row.unset), where)
    try:
        case = load_case(made)
        plan(case)
    except CaseError as error:
        where = _where(study, error.place, where)
        raise CaseError(f"{where}: {error.place}", error.value, error.rule, error.reason, error.cure) from None
    return StudyRun(study.name, row.name, case, notes=tuple(notes))


def _output(study: LoadedStudy) -> dict[str, Any]:
    """What a run writes unless the study says otherwise: tables; fields where something is drawn from them."""
    silent: dict[str, Any] = {"output.report": False, "output.video": False}
    if not any(DRAWINGS[name].needs_fields for name in study.file.draw):
        silent["output.fields_every"] = 0.0
    return silent


def _where(study: LoadedStudy, key: str, default: str) -> str:
    """The line that set a key of a run's case, where one line did."""
    name = default.rpartition(": ")[2]
    for path in (("vary", key), ("base", "set", key), ("vary", *key.split(".")), ("base", "set", *key.split("."))):
        if path in study.places:
            return f"{study.places[path]}: {name}"
    return default


def _spread(study: LoadedStudy, runs: list[StudyRun]) -> list[StudyRun]:
    spread = study.file.spread
    assert spread is not None
    by_name = {run.name: run for run in runs}
    for n, name in enumerate(spread.of):
        if name not in by_name:
            from rdpm.config.rule import suggestion

            raise CaseError(f"{study.place('spread', 'of', n)}: spread.of[{n}]", f'"{name}"', "must be a run",
                            cure=suggestion(name[:80], by_name))  # fmt: skip
    found = []
    for name in spread.of or tuple(by_name):
        run = by_name[name]
        changes: list[tuple[str, dict[str, Any]]] = [
            *((f"shift-{n + 1}", {"shift": shift}) for n, shift in enumerate(spread.shifts)),
            *((f"seed-{seed}", {"seed": seed}) for seed in spread.orientation_seeds),
            *((f"step-{step:g}s", {"step": step}) for step in spread.time_steps),
        ]
        for label, change in changes:
            place = f"{study.place('spread')}: run {name}~{label}"
            case = varied_numerics(run.case, place, **change)
            case = case.model_copy(update={"output": case.output.model_copy(update={"fields_every": 0.0})})
            try:
                plan(case)
            except CaseError as error:
                raise CaseError(
                    f"{place}: {error.place}", error.value, error.rule, error.reason, error.cure
                ) from None
            found.append(replace(run, name=f"{name}~{label}", case=case, spread_of=name))
    return found


def _started(study: LoadedStudy, raw: dict[str, Any], runs: list[StudyRun], quick: bool) -> Iterator[StudyRun]:
    """The runs with the start that each goes on from."""
    file = study.file
    at = file.start.at if file.start else 0.0
    if quick and file.quick is not None and file.quick.start_at is not None:
        at = file.quick.start_at
    if at == 0.0:
        yield from runs
        return
    base = _contact_of_base(study, raw)
    starts: dict[str, Case] = {}
    for run in runs:
        if at >= run.case.time.end:
            raise CaseError(
                f"{study.place('start', 'at')}: start.at", f"{at:g} s",
                f"must be before the end of every run, as is {run.case.time.end:g} s of run {run.name}",
            )
        start = starts.setdefault(with_start_key(run.case), start_case(run.case, base, at))
        yield replace(run, start=start)


def _contact_of_base(study: LoadedStudy, raw: dict[str, Any]) -> Case | None:
    """The base by itself, whose contact no change of a run's changes; None where it is no case by itself."""
    assert study.file.base is not None
    try:
        return load_case(changed(raw, [study.file.base.set], study.file.base.unset, "base")[0])
    except CaseError:
        return None


def parameters(runs: list[StudyRun]) -> list[dict[str, Any]]:
    """What differs between runs.

    Parameters
    ----------
    runs : list of StudyRun

    Returns
    -------
    list of dict
        One a run: dotted keys of the case, their values in SI; None where a run has no such key, lists as JSON text.

    Examples
    --------
    >>> from rdpm.studies.study_file import load_study
    >>> parameters(expand(load_study({"base": {"case": "dkt"}, "vary": {"contact.restitution": [0.5, 0.9]}})))
    [{'contact.restitution': 0.5}, {'contact.restitution': 0.9}]
    """
    flat = [flat_case(run.case) for run in runs]
    keys = dict.fromkeys(key for one in flat for key in one if key != "title" and not key.startswith("output."))
    differing = [key for key in keys if any(one.get(key) != flat[0].get(key) for one in flat)]
    return [{key: _cell(one.get(key)) for key in differing} for one in flat]


def _cell(value: Any) -> Any:
    return json.dumps(value) if isinstance(value, list | dict) else value
