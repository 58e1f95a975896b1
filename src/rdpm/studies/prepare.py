"""From a study to its jobs: what must be run, what it costs, and the folder that holds it."""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import rdpm
from rdpm.config.case import Case
from rdpm.config.write import case_to_toml
from rdpm.errors import CaseError
from rdpm.io.files import replacing, reporting
from rdpm.io.provenance import environment
from rdpm.setup import plan
from rdpm.setup.disk import bodies_disk, checkpoint_bytes, fields_disk, tables_disk
from rdpm.setup.rows import EXPECTED_NS
from rdpm.studies.cases import base_raw
from rdpm.studies.expand import StudyRun, expand, parameters
from rdpm.studies.folder import Job, StudyFolder
from rdpm.studies.registry import DRAWINGS
from rdpm.studies.study_file import LoadedStudy
from rdpm.studies.write import study_to_toml

__all__ = ["Prepared", "prepare", "write_folder"]

#: Checkpoints of a run at work; of a start that is done one stays.
CHECKPOINTS = 2

#: What a kept plane takes of a cell and picture: three speeds in half precision [bytes].
PLANE_CELL = 6


@dataclass(frozen=True)
class Prepared:
    """The work of a study.

    Attributes
    ----------
    study : LoadedStudy
    runs : list of StudyRun
        One a row of the table.
    names : list of str
        The job of each run; runs of several parts that are the same share one.
    jobs : list of Job
        Starts first.
    cases : dict of Case
        By the job's name.
    """

    study: LoadedStudy
    runs: list[StudyRun]
    names: list[str]
    jobs: list[Job]
    cases: dict[str, Case]

    @property
    def cell_steps(self) -> float:
        """Cells times steps of all jobs."""
        return float(sum(job.cells * job.steps for job in self.jobs))

    def expected_seconds(self, workers: int) -> float:
        """Wall time on so many processors, about [s]."""
        longest = max((job.cells * job.steps for job in self.jobs), default=0)
        return max(self.cell_steps / workers, longest) * EXPECTED_NS * 1e-9

    def memory(self, workers: int) -> int:
        """What so many jobs at once need [bytes]."""
        return sum(sorted((job.memory for job in self.jobs), reverse=True)[:workers])

    def disk(self, workers: int) -> int:
        """What the folder takes at most while it is worked on, fields of runs that keep a plane included [bytes]."""
        at_work = sorted((job.disk - job.disk_left for job in self.jobs), reverse=True)
        return sum(at_work[:workers]) + self.disk_left

    @property
    def disk_left(self) -> int:
        """What stays when all is done, about, without the page and its videos [bytes]."""
        return sum(job.disk_left for job in self.jobs)


def prepare(study: LoadedStudy, quick: bool = False) -> Prepared:
    """Work out the jobs of a study.

    Parameters
    ----------
    study : LoadedStudy
    quick : bool

    Returns
    -------
    Prepared

    Raises
    ------
    CaseError
        A run's case is wrong.

    Examples
    --------
    >>> from rdpm.studies.study_file import load_study
    >>> made = prepare(load_study("dkt-stiffness"), quick=True)
    >>> [job.name for job in made.jobs]
    ['start-1', 'stiffness-1000dyn_cm', 'stiffness-5e4dyn_cm', 'stiffness-5e5dyn_cm']
    """
    runs = _with_most_fields(expand(study, quick))
    keeps_plane = _keeps_plane(study)
    starts: dict[str, Job] = {}
    jobs: dict[str, Job] = {}
    cases: dict[str, Case] = {}
    names = []
    for run in runs:
        start = None
        if run.start is not None:
            key = _fingerprint(run.start)
            if key not in starts:
                starts[key] = _job(f"start-{len(starts) + 1}", run.start, key, keeps_plane, is_start=True)
                cases[starts[key].name] = run.start
            start = starts[key]
        key = _fingerprint(run.case, start)
        if key not in jobs:
            name = f"{run.study}/{run.name}" if study.parts else run.name
            if name in cases:  # "start-1" is the name of a common start
                raise CaseError(name, None, "must be another name", "a common start has it", "Name the run otherwise.")
            jobs[key] = _job(name, run.case, key, keeps_plane, start, run.start.time.end if run.start else 0.0)
            cases[name] = run.case
        names.append(jobs[key].name)
    return Prepared(study, runs, names, [*starts.values(), *jobs.values()], cases)


def _with_most_fields(runs: list[StudyRun]) -> list[StudyRun]:
    """Of runs and starts that differ only in the fields they write, all become the one that writes most."""

    def written(case: Case) -> float:
        """Fields a second."""
        every = case.output.fields_every
        return 1.0 / every if every else 0.0

    def key(case: Case) -> str:
        return _fingerprint(case.model_copy(update={"output": case.output.model_copy(update={"fields_every": 0.0})}))

    most: dict[str, Case] = {}
    for case in (case for run in runs for case in (run.case, run.start) if case is not None):
        if written(case) >= written(most.setdefault(key(case), case)):
            most[key(case)] = case
    return [replace(run, case=most[key(run.case)], start=run.start and most[key(run.start)]) for run in runs]


def _fingerprint(case: Case, start: Job | None = None) -> str:
    """Of all that a run's results depend on but the machine: the same one, the same results."""
    text = "\n".join((rdpm.__version__, start.fingerprint if start else "", case_to_toml(case)))
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def _job(
    name: str, case: Case, key: str, keeps_plane: bool, start: Job | None = None, start_end: float = 0.0, *,
    is_start: bool = False,
) -> Job:
    made = plan(case)
    steps = max(1, math.ceil((case.time.end - start_end) / made.step.dt - 1e-6))
    cells = math.prod(made.cells) if made.cells else 0
    disk, left = _disk(case, made.cells, steps, start_end, keeps_plane, is_start)
    return Job(name, key, start.name if start else "", is_start, steps, cells, made.memory, disk, left)


def _disk(
    case: Case, cells: tuple[int, int, int] | None, steps: int, start: float, keeps_plane: bool, is_start: bool
) -> tuple[int, int]:
    """What a job takes while it is at work, and when it is done [bytes]."""
    checkpoint = checkpoint_bytes(case, cells)
    fields = fields_disk(case, cells, steps, start)
    bodies = len(case.expanded_bodies().diameter)
    pictures = fields.most + bodies_disk(bodies, fields.count) if fields else 0
    kept = pictures
    if fields and cells and keeps_plane:
        kept = PLANE_CELL * fields.count * cells[2] * max(cells[:2])
    tables = sum(tables_disk(case, start).values())
    return tables + pictures + CHECKPOINTS * checkpoint, tables + kept + (checkpoint if is_start else 0)


def write_folder(prepared: Prepared, path: Path, command: str) -> StudyFolder:
    """Make or renew the folder of a study; runs that are in it already stay.

    Parameters
    ----------
    prepared : Prepared
    path : Path
        New, empty, or the folder of a study.
    command : str
        That makes the study again.

    Raises
    ------
    CaseError
        It holds something else.
    OutputError
        It cannot be written.
    """
    folder = StudyFolder(path)
    if path.exists() and not path.is_dir():
        raise CaseError(f"--out {path}", None, "must be a folder", "a file of that name is there", "Name another.")
    if path.is_dir() and any(path.iterdir()) and not folder.index.is_file():
        raise CaseError(
            f"--out {path}", None, "must be new, empty, or the folder of a study", "it holds other files",
            "Name another folder with --out.",
        )
    with reporting(path):
        path.mkdir(parents=True, exist_ok=True)
        for job in prepared.jobs:
            folder.write_case(job, case_to_toml(prepared.cases[job.name]))
    with replacing(folder.study) as temporary:
        temporary.write_text(study_to_toml(_whole(prepared.study)), encoding="utf-8")
    folder.write_index(_index(prepared, command), prepared.jobs)
    return folder


def _whole(study: LoadedStudy) -> dict[str, Any]:
    """What the file holds, with the base case and the included studies in it."""
    raw = dict(study.raw) | {"name": study.name}
    if study.parts:
        raw["include"] = [_whole(part) for part in study.parts]
    if study.file.base is not None:
        raw["base"] = dict(raw["base"]) | {"case": base_raw(study.file.base.case, study.folder)}
    return raw


def _index(prepared: Prepared, command: str) -> dict[str, Any]:
    study = prepared.study
    rows = []
    by_study: dict[str, list[int]] = {}
    for n, run in enumerate(prepared.runs):
        by_study.setdefault(run.study, []).append(n)
    differing: dict[int, dict[str, Any]] = {}
    for numbers in by_study.values():
        differing |= dict(zip(numbers, parameters([prepared.runs[n] for n in numbers]), strict=True))
    for n, (run, job) in enumerate(zip(prepared.runs, prepared.names, strict=True)):
        rows.append({
            "study": run.study, "run": run.name, "spread_of": run.spread_of, "job": job, "parameters": differing[n],
        })
    return environment() | {
        "name": study.name,
        "title": study.file.title,
        "question": study.file.question,
        "command": command,
        "keeps_plane": _keeps_plane(study),
        "parts": [
            {
                "name": part.name, "title": part.file.title, "question": part.file.question,
                "measure": list(part.file.measure), "draw": list(part.file.draw),
                "claims": list(part.file.claims),
            }
            for part in _leaves(study)
        ],
        "own": {"draw": list(study.file.draw), "claims": list(study.file.claims)},
        "rows": rows,
    }


def _keeps_plane(study: LoadedStudy) -> bool:
    """Whether of the fields of the runs one plane is kept, for drawings."""
    return any(DRAWINGS[name].needs_fields for part in _leaves(study) for name in part.file.draw)


def _leaves(study: LoadedStudy) -> list[LoadedStudy]:
    """The studies that have runs of their own."""
    return [leaf for part in study.parts for leaf in _leaves(part)] if study.parts else [study]
