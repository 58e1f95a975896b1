"""A study as job arrays of SLURM: scripts to edit and submit."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path

from rdpm.io.files import replacing, reporting
from rdpm.studies.folder import Job, StudyFolder

__all__ = ["write_slurm"]

_HEAD = """#!/bin/bash
#SBATCH --job-name={name}
#SBATCH --output={folder}/slurm/%x-%A_%a.out
#SBATCH --ntasks=1
#SBATCH --cpus-per-task={threads}
#SBATCH --mem={memory}M
#SBATCH --time={time}
"""


def write_slurm(folder: StudyFolder, todo: list[Job], name: str, seconds: float, threads: int = 4) -> Path:
    """Write the scripts into ``slurm/`` of the study's folder.

    Parameters
    ----------
    folder : StudyFolder
        On a disk that the nodes share, under one path.
    todo : list of Job
        What is not done yet, starts first.
    name : str
        Of the study.
    seconds : float
        What the longest job takes on one thread, about; the limit asked for is four times that, at least half an hour.
    threads : int
        Processors a run.

    Returns
    -------
    Path
        ``submit.sh``, which submits the arrays, one after the other, and the step that collects the table.
    """
    home = folder.path.resolve() / "slurm"
    with reporting(home):
        home.mkdir(exist_ok=True)
    minutes = max(30, int(4.0 * seconds / 60.0))
    head = {
        "folder": folder.path.resolve(), "threads": threads, "time": f"{minutes // 60:02d}:{minutes % 60:02d}:00",
        "memory": 500 + int(1.5 * max((job.memory for job in todo), default=0) / 1e6),
    }
    numbers = {job.name: number for number, job in enumerate(folder.jobs())}
    arrays = [(kind, [numbers[job.name] for job in todo if job.is_start == (kind == "starts")])
              for kind in ("starts", "runs")]  # fmt: skip
    python, place = shlex.quote(sys.executable), shlex.quote(str(folder.path.resolve()))
    for kind, jobs in arrays:
        if jobs:
            command = (
                f"#SBATCH --array={_ranges(jobs)}\n\n"
                f'exec {python} -m rdpm.studies.one_job {place} "$SLURM_ARRAY_TASK_ID" '
                '--threads "$SLURM_CPUS_PER_TASK"\n'
            )
            _write(home / f"{kind}.sbatch", _HEAD.format(name=f"{name}-{kind}", **head) + command)
    collecting = _HEAD.format(name=f"{name}-collect", **(head | {"threads": 1}))
    _write(home / "collect.sbatch", f"{collecting}\nexec {python} -m rdpm.cli.main study collect {place}\n")
    _write(home / "submit.sh", _submit(home, [kind for kind, jobs in arrays if jobs]))
    return home / "submit.sh"


def _submit(home: Path, kinds: list[str]) -> str:
    lines = ["#!/bin/bash", "# Submits the study: starts, the runs that go on from them, and the table.", "set -e"]
    after = ""
    for kind in kinds:
        lines.append(f"{kind}=$(sbatch --parsable{after} {shlex.quote(str(home / f'{kind}.sbatch'))})")
        # Runs need all starts; the table is made of what is there.
        after = f" --dependency={'afterok' if kind == 'starts' else 'afterany'}:${kind}"
    lines.append(f"sbatch{after} {shlex.quote(str(home / 'collect.sbatch'))}")
    return "\n".join(lines) + "\n"


def _ranges(numbers: list[int]) -> str:
    """Whole numbers as SLURM lists them: ``0-2,5``.

    Examples
    --------
    >>> _ranges([0, 1, 2, 5])
    '0-2,5'
    """
    parts: list[list[int]] = []
    for number in sorted(numbers):
        if parts and number == parts[-1][-1] + 1:
            parts[-1].append(number)
        else:
            parts.append([number])
    return ",".join(str(part[0]) if len(part) == 1 else f"{part[0]}-{part[-1]}" for part in parts)


def _write(path: Path, text: str) -> None:
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
