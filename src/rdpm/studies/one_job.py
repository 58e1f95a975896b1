"""One job of a study in this process; ``python -m rdpm.studies.one_job FOLDER JOB`` makes it.

JOB is a name, or a number in the order of ``study.json``. Progress goes to the standard output as JSON lines.
"""

from __future__ import annotations

import json
import os
import shutil
import signal
import sys
import threading
import time as clock
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import rdpm
from rdpm.errors import CaseError, CheckpointError, GuardError, RdpmError
from rdpm.io.lock import locked
from rdpm.results.run_folder import RunFolder
from rdpm.studies.folder import DONE, FAILED, INTERRUPTED, STOPPED, Job, Record, StudyFolder
from rdpm.studies.kept_flow import keep_plane

__all__ = ["do_job", "main"]

#: How long to wait for a process that still works on the same run to leave it [s].
PATIENCE = 120.0

_BETWEEN = 0.2  # s, between two lines of progress

Tell = Callable[[dict[str, Any]], None]


class _Reporter:
    """Passes the progress of a run on."""

    def __init__(self, tell: Tell) -> None:
        self._tell, self._said = tell, -_BETWEEN

    def start(self, plan: Any) -> None:
        self._tell({"phase": "stepping"})

    def update(self, step: int, time: float, end: float, message: str = "") -> None:
        now = clock.monotonic()
        if now - self._said >= _BETWEEN or time >= end:
            self._said = now
            self._tell({"phase": "stepping", "step": step, "time": time, "end": end})

    def note(self, text: str) -> None:
        """The run's log has it."""

    def finish(self, summary: Any) -> None:
        self._tell({"phase": "writing"})


def do_job(folder: StudyFolder, job: Job, threads: int | None = None, tell: Tell = lambda _: None) -> Record:
    """Make a run, continue it, or find it made.

    Parameters
    ----------
    folder : StudyFolder
    job : Job
    threads : int, optional
    tell : callable, optional
        Gets dicts with ``phase`` and, while steps are taken, ``step, time, end``.

    Returns
    -------
    Record
        Written to the folder too.

    Notes
    -----
    A run that was broken off continues from its newest checkpoint, to the same bits; without one, or if it was another
    run, its folder is emptied first. Of the checkpoints of a start that is done the newest is kept, of a run's none; of
    its fields one plane where the study draws from it.
    """
    files = folder.work(job)
    files.path.mkdir(parents=True, exist_ok=True)
    _wait_for(files.lock)
    before = folder.read_record(job)
    if before is not None and before.is_final:
        return before
    record = _tried(folder, job, files, before is not None, threads, tell)
    is_reduced = record.status == DONE and folder.read_index()["keeps_plane"]
    if is_reduced:
        keep_plane(files)
    folder.write_record(job, record)
    if is_reduced:
        for path in (files.fields, files.bodies, files.walls):
            path.unlink(missing_ok=True)
    if record.status == DONE and not job.is_start:
        shutil.rmtree(files.checkpoints, ignore_errors=True)
    elif record.status == DONE:
        for path in files.checkpoint_files()[:-1]:  # runs go on from the newest
            path.unlink(missing_ok=True)
    return record


def _tried(
    folder: StudyFolder, job: Job, files: RunFolder, was_begun: bool, threads: int | None, tell: Tell
) -> Record:
    def record(status: str, reason: str = "") -> Record:
        return Record(job.fingerprint, status, reason, rdpm.__version__)

    try:
        case = folder.read_case(job)
        start = None
        if job.start:
            beginning = next(other for other in folder.jobs() if other.name == job.start)
            start = (folder.work(beginning).path, None)
        resume = was_begun and bool(files.checkpoint_files())
        if not resume:
            _emptied(files)
        folder.write_record(job, record("running", "it was broken off"))
        summary = _made(case, files, threads, _Reporter(tell), resume, start)
    except GuardError as error:
        return record(STOPPED, str(error))
    except RdpmError as error:
        return record(FAILED, str(error))
    if summary.status != DONE:
        return record(INTERRUPTED, f"at t = {summary.time_s:.6g} s")
    return record(DONE)


def _made(case: Any, files: RunFolder, threads: int | None, reporter: _Reporter, resume: bool, start: Any) -> Any:
    from rdpm.runs.runner import run_case

    try:
        return run_case(case, files.path, threads=threads, reporter=reporter, resume=resume, start=start)
    except CheckpointError:
        if not resume:
            raise
        _emptied(files)  # no checkpoint of it can be read
        return run_case(case, files.path, threads=threads, reporter=reporter, start=start)


def _emptied(files: RunFolder) -> None:
    for path in files.path.iterdir():
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        else:
            path.unlink()


def _wait_for(lock: Path) -> None:
    """Wait until no other process works in the folder."""
    end = clock.monotonic() + PATIENCE
    while True:
        try:
            with locked(lock):
                return
        except CaseError:
            if clock.monotonic() > end:
                raise
            clock.sleep(0.2)


def _end_with_parent() -> None:
    """Ask this process to end, at a step's end and with a checkpoint, when the one that started it is gone."""

    def watch() -> None:
        while os.read(0, 1):
            pass
        os.kill(os.getpid(), signal.SIGTERM)

    threading.Thread(target=watch, daemon=True).start()


def main(arguments: list[str] | None = None) -> int:
    """Do one job: ``FOLDER JOB [--threads N] [--watched]``.

    Returns
    -------
    int
        0 done, 3 stopped by a guard, 1 failed, 130 interrupted.
    """
    import argparse

    parser = argparse.ArgumentParser(prog="python -m rdpm.studies.one_job", description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("job", help="a name, or a number in the order of study.json")
    parser.add_argument("--threads", type=int)
    parser.add_argument("--watched", action="store_true", help="end when the standard input is closed")
    given = parser.parse_args(arguments)
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # until the run listens itself
    if given.watched:
        _end_with_parent()
    folder = StudyFolder(given.folder)
    try:
        record = do_job(folder, _found(folder, given.job), given.threads, _print)
    except RdpmError as error:
        print(error, file=sys.stderr)
        return error.exit_code
    except KeyboardInterrupt:
        return 130
    _print({"phase": record.status, "reason": record.reason})
    if record.reason:
        print(f"{given.job}: {record.status}: {record.reason}", file=sys.stderr)
    return {DONE: 0, STOPPED: 3, INTERRUPTED: 130}.get(record.status, 1)


def _found(folder: StudyFolder, word: str) -> Job:
    jobs = folder.jobs()
    for number, job in enumerate(jobs):
        if word in (job.name, str(number)):
            return job
    raise CaseError("JOB", word, f"must be a job of {folder.path}", f"there are {len(jobs)}, counted from 0")


def _print(said: dict[str, Any]) -> None:
    with suppress(OSError):
        print(json.dumps(said), flush=True)


if __name__ == "__main__":
    sys.exit(main())
