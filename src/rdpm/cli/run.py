"""``rdpm run``: a case from its file to figures and a report."""

from __future__ import annotations

import os
import signal
import threading
from contextlib import suppress
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from rdpm.cli.progress import Reporter
from rdpm.errors import CaseError

__all__ = ["run"]

# set for each process by the launchers; SLURM's batch script itself has no step
_RANKS = (
    "OMPI_COMM_WORLD_SIZE",
    "PMI_SIZE",
    "MV2_COMM_WORLD_SIZE",
    "MPI_LOCALNRANKS",
    "SLURM_STEP_NUM_TASKS",
)


def run(
    case: str,
    /,
    *,
    out: Path | None = None,
    set_: Annotated[tuple[str, ...], Parameter(name="--set", negative="", show_default=False)] = (),
    threads: int | None = None,
    quiet: Annotated[bool, Parameter(negative="", show_default=False)] = False,
) -> None:
    """Run a case, and make its tables, fields, figures, video and report.

    Parameters
    ----------
    case : str
        A case file, or the name of a shipped case.
    out : Path, optional
        The folder for the results, new or empty; ./NAME, ./NAME-2, ... when left out.
    set_ : tuple of str
        key=value, instead of what the case says; may be repeated. A whole table is replaced by
        'contact={stiffness=50, damping=0.1}'.
    threads : int, optional
        OpenMP threads; all cores, or OMP_NUM_THREADS, when left out.
    quiet : bool
        Say nothing but errors.

    Raises
    ------
    CaseError
        The case or the folder is wrong; nothing was written.
    GuardError
        The numbers could no longer be trusted.
    """
    _refuse_ranks()
    if threads is not None and not 1 <= threads <= 1024:
        raise CaseError("--threads", threads, "must lie between 1 and 1024")
    from rdpm.config.load import case_name, load_case

    loaded = load_case(case, set_)
    from rdpm.setup import plan  # a case that is wrong is told before the solver is loaded
    from rdpm.studies.runner import run_case

    plan(loaded)  # refuses what cannot run, before a folder is made
    _end_on_sigterm()
    folder = _folder(out, case_name(case))
    try:
        with Reporter(quiet) as reporter:
            summary = run_case(loaded, folder, threads=threads, reporter=reporter)
        if loaded.output.report:
            _report(folder, loaded.output.video, quiet)
    except CaseError:
        with suppress(OSError):
            folder.rmdir()  # only if nothing is in it
        raise
    except Exception as error:
        vars(error)["run_folder"] = folder  # where its traceback belongs
        raise
    if not quiet:
        _show(summary, folder)


def _report(folder: Path, video: bool, quiet: bool) -> None:
    from rdpm.cli.progress import say
    from rdpm.figures.report import make_report

    make_report(folder, video=video, progress=None if quiet else say)


def _show(summary: dict[str, Any], folder: Path) -> None:
    from rich.console import Console

    from rdpm.cli.results import show_results

    show_results(summary, folder, Console(highlight=False, markup=False))


def _refuse_ranks() -> None:
    for name in _RANKS:
        count = os.environ.get(name, "")
        if count.isdigit() and int(count) > 1:
            raise CaseError(
                "run",
                f"{count} MPI ranks ({name})",
                "must be one process in this version",
                "each rank would run the whole case",
                "Start it without mpiexec or srun; use --threads.",
            )


def _end_on_sigterm() -> None:
    """Treat SIGTERM as Ctrl-C, so that a queue's end of time leaves whole files."""

    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGTERM, stop)


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


def _made(folder: Path) -> Path:
    try:
        if folder.exists() and not folder.is_dir():
            raise CaseError(
                f"--out {folder}", None, "must be a folder", "a file of that name is there", "Name another."
            )
        if folder.is_dir() and any(folder.iterdir()):
            raise CaseError(
                f"--out {folder}",
                None,
                "must be new or empty",
                "it holds files, perhaps results",
                "Name another folder, or leave --out away.",
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
