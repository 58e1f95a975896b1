"""The table of a study from the folders of its runs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from rdpm.errors import CaseError
from rdpm.io.files import replacing
from rdpm.studies.folder import DONE, STOPPED, Job, StudyFolder
from rdpm.studies.registry import MEASURES
from rdpm.studies.results import StudyResults, read_results
from rdpm.studies.whole import load_whole

if TYPE_CHECKING:
    import pandas

__all__ = ["collect"]


def collect(folder: StudyFolder) -> StudyResults:
    """Measure the runs that are there; write ``table.csv`` and ``table.parquet``.

    Parameters
    ----------
    folder : StudyFolder

    Returns
    -------
    StudyResults
        Runs that are not done have their status and its reason, and no measures.

    Raises
    ------
    CaseError
        It is not the folder of a study.
    """
    index = folder.read_index()
    jobs = {job.name: job for job in folder.jobs()}
    measures = {part["name"]: part["measure"] for part in index["parts"]}
    measured: dict[tuple[str, str], Mapping[str, Any]] = {}
    rows = []
    for entry in index["rows"]:
        job = jobs[entry["job"]]
        record = folder.read_record(job)
        row: dict[str, Any] = {
            "study": entry["study"], "run": entry["run"], "spread_of": entry["spread_of"],
            "status": record.status if record else "waiting", "reason": record.reason if record else "",
            "folder": folder.work(job).path.relative_to(folder.path).as_posix(),
        }
        row |= entry["parameters"]
        if record is not None and record.status in (DONE, STOPPED):
            names = measures[entry["study"]] if record.status == DONE else []
            row |= _measured(folder, job, jobs.get(job.start), names, measured, row)
        row["rdpm_version"] = record.rdpm_version if record else None
        rows.append(row)
    _write(folder, _frame(rows))
    return read_results(folder.path)


def _measured(
    folder: StudyFolder, job: Job, start: Job | None, names: list[str],
    measured: dict[tuple[str, str], Mapping[str, Any]], row: dict[str, Any],
) -> dict[str, Any]:
    """Measures of a run, each taken once, and what it cost."""
    try:
        run = load_whole(folder.work(job), folder.work(start) if start else None)
    except CaseError as error:
        row["status"], row["reason"] = "failed", str(error)
        return {}
    found: dict[str, Any] = {}
    for name in names:
        if (job.name, name) not in measured:
            measured[job.name, name] = MEASURES[name](run)
        found |= measured[job.name, name]
    summary = run.summary
    cells = summary.cells or (None, None, None)
    found |= {f"cells_{axis}": count for axis, count in zip("xyz", cells, strict=True)}
    return found | {"steps": summary.steps, "dt_s": summary.dt_s, "time_s": summary.time_s, "wall_s": summary.wall_s}


#: Last in the table, whatever else it has.
_COST = ("cells_x", "cells_y", "cells_z", "steps", "dt_s", "time_s", "wall_s", "rdpm_version")


def _frame(rows: list[dict[str, Any]]) -> pandas.DataFrame:
    """Columns of one kind each, so that tables of equal runs are equal whatever the order of work was."""
    import pandas

    names = list(dict.fromkeys(key for row in rows for key in row if key not in _COST))
    columns = {}
    for name in (*names, *_COST):
        values = [row.get(name) for row in rows]
        given = [value for value in values if value is not None]
        if given and all(isinstance(value, bool) for value in given):
            columns[name] = pandas.array(values, dtype="boolean")
        elif given and all(isinstance(value, int) and not isinstance(value, bool) for value in given):
            columns[name] = pandas.array(values, dtype="Int64")
        elif all(isinstance(value, int | float) and not isinstance(value, bool) for value in given):
            columns[name] = pandas.array([float("nan") if v is None else float(v) for v in values], dtype="float64")
        else:  # words, or a key that is a word in one run and a number in another
            columns[name] = pandas.array([None if v is None else str(v) for v in values], dtype="object")
    return pandas.DataFrame(columns)


def _write(folder: StudyFolder, table: pandas.DataFrame) -> None:
    with replacing(folder.table_csv) as temporary:
        table.to_csv(temporary, index=False)
    with replacing(folder.table_parquet) as temporary:
        table.to_parquet(temporary, engine="pyarrow", index=False)
