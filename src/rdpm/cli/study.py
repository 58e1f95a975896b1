"""``rdpm study``: a family of runs, from its file to one table."""

from __future__ import annotations

import os
import shlex
import signal
import sys
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from rdpm.errors import CaseError

if TYPE_CHECKING:
    from rdpm.studies.prepare import Prepared
    from rdpm.studies.results import StudyResults

__all__ = ["study"]

STOPPED = 3  # exit code: a run was not done

_Flag = Annotated[bool, Parameter(negative="", show_default=False)]


def study(
    *words: str,
    out: Path | None = None,
    workers: int | None = None,
    quick: _Flag = False,
    scheduler: str | None = None,
    slurm: _Flag = False,
    copy: _Flag = False,
    quiet: _Flag = False,
) -> int:
    """List the shipped studies, or run one: a family of runs, and its table.

    Parameters
    ----------
    words : str
        STUDY, a study file, the name of a shipped study (a file NAME.toml here goes before it) or the folder of a
        study; or "check STUDY", which says runs, cost, memory and disk before anything starts; or "collect FOLDER",
        which makes the table of the runs that are there. With --copy: NAME, or NAME and a folder.
    out : Path, optional
        The folder; ./NAME when left out. Runs that are finished there are not made again.
    workers : int, optional
        Runs at once; one a processor when left out.
    quick : bool
        The miniature that the study file describes.
    scheduler : str, optional
        Address of a Dask scheduler, such as tcp://head:8786, whose workers make the runs.
    slurm : bool
        Write the scripts of a SLURM job array instead of running.
    copy : bool
        Write a shipped study as a file to edit.
    quiet : bool
        Say nothing but errors.

    Returns
    -------
    int
        0, or 3 where a run was stopped or failed.

    Raises
    ------
    CaseError
        The study or the case of a run is wrong; nothing was written.
    """
    if not words:
        _list()
        return 0
    verb, *rest = words
    if verb == "check" and len(rest) == 1:
        _check(rest[0], workers, quick)
        return 0
    if verb == "collect" and len(rest) == 1:
        return _collect(rest[0], quiet)
    if copy and len(rest) <= 1:
        _copy(verb, Path(*rest))
        return 0
    if rest:
        raise CaseError("study", " ".join(words), "must be STUDY, check STUDY or collect FOLDER",
                        cure="See `rdpm study --help`.")  # fmt: skip
    return _run(verb, out, workers, quick, scheduler, slurm, quiet)


def _list() -> None:
    from rdpm.cases import shipped_studies, shipped_study_text

    width = max(map(len, shipped_studies()))
    for name in shipped_studies():
        print(f"{name:{width}}  {tomllib.loads(shipped_study_text(name))['title']}")
    print("\nRun one with: rdpm study NAME. First see what it costs: rdpm study check NAME")
    print("Copy one to edit with: rdpm study NAME --copy")


def _copy(name: str, folder: Path) -> None:
    from rdpm.cases import shipped_studies, shipped_study_text
    from rdpm.config.rule import shown, suggestion
    from rdpm.io.files import replacing

    if name not in shipped_studies():
        raise CaseError("STUDY", shown(name), "must be a shipped study to be copied",
                        cure=suggestion(name[:80], shipped_studies()))  # fmt: skip
    path = folder / f"{name}.toml"
    if path.exists():
        raise CaseError(str(path), None, "must not be there yet", "it may hold your changes",
                        "Name another folder, or move it.")  # fmt: skip
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise CaseError(str(folder), None, "must be a place to write to", error.strerror or "",
                        "Name another folder.") from None  # fmt: skip
    with replacing(path) as temporary:
        temporary.write_text(shipped_study_text(name), encoding="utf-8")
    print(f"Wrote {path}. Edit it, then: rdpm study {path}")


def _source(word: str) -> tuple[str, Path | None]:
    """The study that a word means, and its folder where the word is one."""
    from rdpm.cases import shipped_studies
    from rdpm.cli.progress import say
    from rdpm.config.source import local_file
    from rdpm.studies.folder import StudyFolder

    folder = StudyFolder(Path(word))
    if word not in shipped_studies():
        return (str(folder.study), folder.path) if folder.study.is_file() else (word, None)
    local = local_file(word, what="study")
    if local is None:
        return word, None
    say(local[1])
    return str(local[0]), None


def _check(word: str, workers: int | None, quick: bool) -> None:
    from rdpm.studies.local import workers_here
    from rdpm.studies.prepare import prepare
    from rdpm.studies.study_file import load_study

    prepared = prepare(load_study(_source(word)[0]), quick)
    _show_plan(prepared, workers_here(prepared.jobs, workers))


def _show_plan(prepared: Prepared, workers: int) -> None:
    from rich.console import Console
    from rich.table import Table

    from rdpm.setup.rows import EXPECTED_NS
    from rdpm.studies.display import span

    console = Console(highlight=False, markup=False)
    console.width = max(console.width, 60 + max(len(job.name) for job in prepared.jobs))  # a name stays on one line
    table = Table(box=None, pad_edge=False, title=prepared.study.file.title, title_justify="left", title_style="bold")
    for heading, justify in (("run", "left"), ("starts from", "left"), ("cells", "right"), ("steps", "right"),
                             ("one thread", "right"), ("memory", "right")):  # fmt: skip
        table.add_column(heading, justify=justify, overflow="fold")  # type: ignore[arg-type]
    for job in prepared.jobs:
        table.add_row(
            job.name, job.start, f"{job.cells}", f"{job.steps}", span(job.cells * job.steps * EXPECTED_NS * 1e-9),
            f"{job.memory / 1e6:.0f} MB",
        )
    console.print(table)
    rows = len(prepared.runs)
    shared = rows + sum(job.is_start for job in prepared.jobs) - len(prepared.jobs)
    console.print(f"\n{rows} rows of the table" + (f", {shared} of runs that are made once" if shared else ""))
    console.print(
        f"{workers} at once: about {span(prepared.expected_seconds(workers))}, {prepared.memory(workers) / 1e6:.0f} MB "
        f"of memory, at most {prepared.disk(workers) / 1e6:.0f} MB of disk; {prepared.disk_left / 1e6:.0f} MB stay"
    )
    for note in dict.fromkeys(note for run in prepared.runs for note in run.notes):
        console.print(note if note.startswith("note: ") else f"note: {note}")


def _collect(word: str, quiet: bool) -> int:
    from rdpm.cli.progress import say
    from rdpm.studies.collect import collect
    from rdpm.studies.finish import finish
    from rdpm.studies.folder import StudyFolder

    results = collect(StudyFolder(Path(word)))
    finish(results, say)
    return _end(results, quiet)


def _run(
    word: str, out: Path | None, workers: int | None, quick: bool, scheduler: str | None, slurm: bool, quiet: bool
) -> int:
    from rdpm.parallel.launcher import single
    from rdpm.studies.display import Display
    from rdpm.studies.study import run_study
    from rdpm.studies.study_file import load_study

    single("rdpm study")  # shares nothing among ranks
    source, folder = _source(word)
    loaded = load_study(source)
    path = out or folder or Path(loaded.name)
    command = shlex.join(["rdpm", "study", *([word] if folder is None else [str(folder)]),
                          *(["--quick"] if quick else [])])  # fmt: skip
    if slurm:
        return _write_slurm(loaded, path, quick, command)
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        with Display(quiet) as display:
            results = run_study(
                loaded, path, workers=workers, quick=quick, scheduler=scheduler, watcher=display, tell=display.note,
                command=command,
            )
    except KeyboardInterrupt:
        print(f"rdpm: interrupted. To continue: {command} --out {path}", file=sys.stderr)
        return 130
    return _end(results, quiet)


def _write_slurm(loaded: Any, path: Path, quick: bool, command: str) -> int:
    from rdpm.setup.rows import EXPECTED_NS
    from rdpm.studies.prepare import prepare, write_folder
    from rdpm.studies.slurm import write_slurm
    from rdpm.studies.study import still_to_do

    prepared = prepare(loaded, quick)
    folder = write_folder(prepared, path, command)
    todo = still_to_do(folder, prepared.jobs)
    longest = max((job.cells * job.steps for job in todo), default=0) * EXPECTED_NS * 1e-9
    script = write_slurm(folder, todo, loaded.name, longest)
    print(f"Wrote {script.parent}{os.sep}: look at the limits and add your partition, then: bash {script}")
    return 0


def _end(results: StudyResults, quiet: bool) -> int:
    """Say what came out; the exit code."""
    table = results.table
    open_ = table[table["status"] != "done"]
    for row in open_.itertuples():
        print(f"rdpm: {row.study}/{row.run}: {row.status}: {row.reason}", file=sys.stderr)
    if not quiet:
        print(f"{len(table) - len(open_)} of {len(table)} runs are done. Table: {results.folder.table_csv}")
    return STOPPED if len(open_) else 0
