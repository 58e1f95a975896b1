"""``rdpm run``: a case from its file to figures and a report."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from rdpm.cli.progress import Reporter, say
from rdpm.cli.source import case_source
from rdpm.errors import CaseError, CheckpointError
from rdpm.parallel.threads import available_threads, checked_threads

if TYPE_CHECKING:
    from rdpm.config.case import Case
    from rdpm.parallel.ranks import Ranks
    from rdpm.results.summary import Summary

__all__ = ["run"]


def run(
    case: str,
    /,
    *,
    out: Path | None = None,
    set_: Annotated[tuple[str, ...], Parameter(name="--set", negative="", show_default=False)] = (),
    threads: int | None = None,
    resume: Annotated[bool, Parameter(negative="", show_default=False)] = False,
    from_: Annotated[Path | None, Parameter(name="--from")] = None,
    at: str | None = None,
    within: str | None = None,
    slurm: Annotated[int | None, Parameter(show_default=False)] = None,
    quiet: Annotated[bool, Parameter(negative="", show_default=False)] = False,
) -> int:
    """Run a case, and make its tables, fields, figures, video and report.

    Parameters
    ----------
    case : str
        A case file, the name of a shipped case, or the folder of a run, whose case is then taken. A file NAME.toml here
        goes before the shipped case NAME.
    out : Path, optional
        The folder for the results, new or empty; ./NAME, ./NAME-2, ... when left out.
    set_ : tuple of str
        key=value, instead of what the case says; may be repeated. A whole table is replaced by
        'contact={stiffness=50, damping=0.1}'.
    threads : int, optional
        OpenMP threads of each process; all cores, or OMP_NUM_THREADS, when left out. Under mpiexec or srun the ranks of
        a node share its cores.
    resume : bool
        Continue the run in ./NAME, or in --out, from its newest checkpoint, to the same bits as if it had not stopped.
    from_ : Path, optional
        Start a new run from a checkpoint of the run in this folder; time, contact and output may be changed.
    at : str, optional
        With --from: the checkpoint of this time, such as 1.5 or "1500 ms"; the newest that is not after it.
    within : str, optional
        With --at: how long before that time the checkpoint may be, such as "0.1 s"; 1 % of the time when left out.
    slurm : int, optional
        Run nothing: write OUT.sbatch, a job of SLURM on so many MPI ranks with --threads each; submitted again it goes
        on.
    quiet : bool
        Say nothing but errors.

    Raises
    ------
    CaseError, CheckpointError
        The case, the folder or the checkpoint is wrong; nothing was written.
    GuardError
        The numbers could no longer be trusted.
    """
    from rdpm.parallel.agreement import guarding, on_root
    from rdpm.parallel.ranks import world

    if slurm is not None:
        return _write_slurm(case, out, set_, threads or 1, slurm, resume or from_ is not None or at is not None)
    ranks = world()
    with guarding(ranks):
        _keep_streams()
        quiet = quiet or ranks.rank != 0
        loaded, folder, how = on_root(
            ranks, lambda: _prepared(case, out, set_, threads, resume, from_, at, within, quiet)
        )
        return _run(loaded, folder, quiet, ranks, how)


def _write_slurm(case: str, out: Path | None, changes: tuple[str, ...], threads: int, ranks: int, goes_on: bool) -> int:
    """Write the job that runs a case."""
    from rdpm.config.load import case_name, load_case
    from rdpm.io.files import replacing
    from rdpm.setup import plan
    from rdpm.setup.slurm_script import slurm_script

    if ranks < 1:
        raise CaseError("--slurm", ranks, "must be at least 1", "a run has one rank at least")
    if goes_on:
        raise CaseError("--slurm", ranks, "goes with neither --resume, --from nor --at", "its job continues by itself")
    source, run_folder, _ = case_source(case)
    folder = out or Path(run_folder.name if run_folder else case_name(case))
    sets = [word for change in changes for word in ("--set", change)]
    made = plan(load_case(source, changes), machines=ranks)
    text = slurm_script(made, folder.name, [case, *sets, "--out", str(folder)], ranks, threads)
    path = folder.with_name(f"{folder.name}.sbatch")
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
    print(f"sbatch {path}")
    return 0


def _run(case: Case, folder: Path, quiet: bool, ranks: Ranks, how: dict[str, Any]) -> int:
    _end_on_signals()
    try:
        summary = _computed(case, folder, quiet, ranks, **how)
        if summary.status == "interrupted":
            if ranks.rank == 0:
                _unheard(_say_how_to_resume, folder, summary)
            return 130
    except (CaseError, CheckpointError):
        with suppress(OSError):
            folder.rmdir()  # only if nothing is in it
        raise
    except Exception as error:
        vars(error)["run_folder"] = folder  # where its traceback belongs
        raise
    if not quiet:
        _show(summary, folder)
    return 0


def _prepared(
    case: str, out: Path | None, changes: tuple[str, ...], threads: int | None, resume: bool, from_: Path | None,
    at: str | None, within: str | None, quiet: bool,
) -> tuple[Case, Path, dict[str, Any]]:
    """The case that is run, the folder for its results, made, and how it is run."""
    if threads is None:
        available_threads()  # refuses what the environment says
    else:
        checked_threads(threads, "--threads")
    start = _start(from_, at, resume)
    if within is not None and at is None:
        raise CaseError("--within", within, "needs --at", "it says how far from that time a checkpoint may be")
    how: dict[str, Any] = {"threads": threads, "resume": resume, "start": start}
    if within is not None:
        how["within"] = _seconds("--within", within)
    from rdpm.config.load import case_name, load_case

    source, run_folder, note = case_source(case, (resume and out is None) or from_ == Path(case))
    if note and not quiet:
        say(note)
    loaded = load_case(source, changes)
    from rdpm.setup import plan  # a case that is wrong is told before the solver is loaded

    plan(loaded)  # refuses what cannot run, before a folder is made
    if resume:
        return loaded, _made(out or run_folder or Path(case_name(case)), holds_run=True), how
    return loaded, _folder(out, run_folder.name if run_folder else case_name(case)), how


def _computed(case: Case, folder: Path, quiet: bool, ranks: Ranks, **how: Any) -> Summary:
    from rdpm.runs.runner import run_case

    with ExitStack() as stack:
        reporter = Reporter(quiet)
        stack.callback(_unheard, reporter.close)
        return run_case(case, folder, reporter=reporter, ranks=ranks, **how)


def _start(folder: Path | None, at: str | None, resume: bool) -> tuple[Path, float | None] | None:
    """Where a run starts that does not start at rest."""
    if folder is None:
        if at is not None:
            raise CaseError("--at", at, "needs --from", "it names a checkpoint of another run")
        return None
    if resume:
        raise CaseError(
            "--from", folder, "must not stand beside --resume", "one starts a new run, the other continues one",
            "Leave one of them out.",
        )
    if at is None:
        return folder, None
    return folder, _seconds("--at", at)


def _seconds(option: str, text: str) -> float:
    from rdpm.config.rule import RuleError
    from rdpm.config.units import parse_quantity

    try:
        return parse_quantity(text, "s")
    except RuleError as error:
        raise CaseError(option, text, error.rule, error.reason, error.cure) from None


def _keep_streams() -> None:
    """Open what of the standard streams is closed: else the first result file would take its place."""
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest number that is free
        if getattr(sys, name) is None:
            setattr(sys, name, open(number, "r" if number == 0 else "w", encoding="utf-8", closefd=False))  # noqa: SIM115


def _unheard(tell: Callable[..., None], *arguments: Any) -> None:
    """Tell it to a terminal that may be gone."""
    with suppress(OSError, SystemExit):  # rich exits where a pipe is broken
        tell(*arguments)


def _say_how_to_resume(folder: Path, summary: Summary) -> None:
    say(f"rdpm: interrupted at t = {summary.time_s:.6g} s. To continue: rdpm run {folder} --resume")


def _show(summary: Summary, folder: Path) -> None:
    from rich.console import Console

    from rdpm.cli.results import show_results

    show_results(summary, folder, Console(highlight=False, markup=False))


def _end_on_signals() -> None:
    """Treat SIGTERM and a lost terminal as Ctrl-C, so that whole files are left."""

    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGTERM, stop)
        hangup = getattr(signal, "SIGHUP", None)
        if hangup is not None and signal.getsignal(hangup) != signal.SIG_IGN:  # nohup
            signal.signal(hangup, stop)


def _folder(out: Path | None, name: str) -> Path:
    """Make the folder for the results."""
    if out is not None:
        return _made(out)
    number = 1
    while True:
        folder = Path(name if number == 1 else f"{name}-{number}")
        try:
            folder.mkdir()
            return folder
        except FileExistsError:
            number += 1
        except OSError as error:
            raise _unwritable(folder, error) from None


def _made(folder: Path, holds_run: bool = False) -> Path:
    try:
        if folder.exists() and not folder.is_dir():
            raise CaseError(
                f"--out {folder}", None, "must be a folder", "a file of that name is there", "Name another."
            )
        if not holds_run and folder.is_dir() and any(folder.iterdir()):
            raise CaseError(
                f"--out {folder}",
                None,
                "must be new or empty",
                "it holds files, perhaps results",
                "Name another folder, leave --out away, or continue the run in it with --resume.",
            )
        if not folder.parent.is_dir():
            raise CaseError(
                f"--out {folder}",
                None,
                "must lie in a folder that is there",
                f"{folder.parent} is not",
                f"Make it first: mkdir -p {folder.parent}",
            )
        folder.mkdir(exist_ok=True)
        probe = folder / f".rdpm-{os.getpid()}"  # permissions do not tell of a read-only disk
        probe.touch()
        probe.unlink()
    except (OSError, ValueError) as error:
        if isinstance(error, CaseError):
            raise
        raise _unwritable(folder, error) from None
    return folder


def _unwritable(folder: Path, error: Exception) -> CaseError:
    reason = error.strerror if isinstance(error, OSError) and error.strerror else "the name is not valid"
    return CaseError(
        f"--out {folder}", None, "must be a place to write to", reason, "Name another folder with --out."
    )
