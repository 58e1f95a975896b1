"""Runs as processes of their own: started in turn, paused, resumed, stopped; found again by the files they leave."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
import time
from contextlib import suppress

from rdpm.app.status import CONSOLE, QUEUED, QueueMark, is_rdpm, queue_mark
from rdpm.app.workspace import Workspace
from rdpm.config.case import Case
from rdpm.config.write import case_to_toml
from rdpm.errors import CaseError
from rdpm.io.files import replacing, reporting
from rdpm.io.lock import holder, locked
from rdpm.results.run_folder import RunFolder

__all__ = ["Launcher"]

_LOCK = ".rdpm-app.lock"  # of the one that starts runs in this folder


class Launcher:
    """Starts what is queued, one run after the other.

    A run is queued by a file in its folder, which is all there is to know: another ``rdpm app`` on the same folder
    takes the queue over.

    Parameters
    ----------
    work : Workspace
    at_once : int
        Runs that may go on side by side; those started on the command line count.
    threads : int, optional
        Of each run.
    """

    def __init__(self, work: Workspace, at_once: int = 1, threads: int | None = None) -> None:
        self.work, self.at_once, self.threads = work, at_once, threads
        self._started: dict[str, subprocess.Popen[bytes]] = {}
        self._is_due = True  # there may be runs queued by one before us

    def add(self, case: Case, name: str) -> str:
        """Queue a new run; its folder is made here and now, so that nobody else takes the name.

        Raises
        ------
        CaseError
            The name is taken, or none.
        """
        path = self.work.new(name)
        with reporting(path):
            try:
                path.mkdir()
            except FileExistsError:
                cure = f"Take another name, such as {self.work.free_name(name)}."
                raise CaseError("name", f'"{name}"', "must be new", "a folder of that name is there", cure) from None
        with replacing(path / "case.toml") as temporary:
            temporary.write_text(case_to_toml(case), encoding="utf-8")
        self._queue(RunFolder(path))
        return self.work.name(path)

    def resume(self, name: str) -> None:
        """Queue a run again, to go on from its newest checkpoint."""
        files = self.work.run(name)
        if self.process(name) is not None:
            raise CaseError(
                f'"{name}"', None, "must not be running", "a process works in its folder", "Wait for its end."
            )
        self._queue(files)

    def withdraw(self, name: str) -> bool:
        """Take a run from the queue; its folder goes too, where nothing was run in it. Tells whether it went."""
        files = self.work.run(name)
        with suppress(FileNotFoundError):
            (files.path / QUEUED).unlink()
        if {path.name for path in files.path.iterdir()} <= {"case.toml"}:
            files.case.unlink()
            files.path.rmdir()
            return True
        return False

    def pause(self, name: str) -> None:
        """Have the run end after its step, with a checkpoint written."""
        self._tell(name, signal.SIGTERM)

    def stop(self, name: str) -> None:
        """Have the run end at once; the last checkpoint is what is left to go on from."""
        self._tell(name, signal.SIGTERM, signal.SIGINT)  # a second one does not wait for the step

    def process(self, name: str) -> int | None:
        """Give the process that works on a run, or has been started to."""
        files = self.work.run(name)
        mark = queue_mark(files)
        return holder(files.lock) or (mark.process if mark else None)

    def dispatch(self) -> list[str]:
        """Start what is due, if it is not another's task; give the names of what was started."""
        self._settle()
        if not self._is_due:
            return []
        try:
            with locked(self.work.root / _LOCK):
                return self._start_due()
        except CaseError:
            return []

    def _settle(self) -> None:
        """Take runs that have begun, or could not, from the queue; forget processes that ended."""
        for name, child in list(self._started.items()):
            path = self.work.root / name
            is_over = child.poll() is not None
            if is_over or holder(RunFolder(path).lock) is not None:
                with suppress(OSError):
                    (path / QUEUED).unlink()
            if is_over:
                del self._started[name]

    def _start_due(self) -> list[str]:
        names = self.work.runs()
        busy = sum(self._is_busy(name) for name in names)
        waiting = [(asked, name) for name in names if (asked := self._asked(name)) is not None]
        started = []
        for _, name in sorted(waiting)[: max(0, self.at_once - busy)]:
            self._start(name)
            started.append(name)
        # Marks are looked after until each run has begun, whoever started it.
        self._is_due = any((self.work.root / name / QUEUED).exists() for name in names)
        return started

    def _is_busy(self, name: str) -> bool:
        with suppress(CaseError):
            return self.process(name) is not None
        return False

    def _asked(self, name: str) -> int | None:
        """When a run was queued; None where it was not, or goes on already."""
        files = self.work.run(name)
        mark = queue_mark(files)
        if mark is None or holder(files.lock) is not None:  # a start that came to nothing, or that has come to pass
            with suppress(OSError):
                (files.path / QUEUED).unlink()
            return None
        return None if mark.process else mark.asked_ns

    def _queue(self, files: RunFolder) -> None:
        _write(files, QueueMark(time.time_ns()))
        self._is_due = True

    def _start(self, name: str) -> None:
        """Start the command, in a session of its own: it goes on when the page's process ends."""
        files = self.work.run(name)
        command = [sys.executable, "-m", "rdpm.cli.main", "run", str(files.case), "--out", str(files.path), "--resume"]
        command += ["--threads", str(self.threads)] if self.threads else []
        with (files.path / CONSOLE).open("wb") as console:
            child = subprocess.Popen(
                command, cwd=files.path.parent, stdin=subprocess.DEVNULL, stdout=console, stderr=console,
                start_new_session=True,
            )  # fmt: skip
        threading.Thread(target=child.wait, daemon=True).start()  # the system is told that its end was noticed
        self._started[name] = child
        _write(files, QueueMark(time.time_ns(), child.pid))  # within the lock: no other page starts it again

    def _tell(self, name: str, *numbers: signal.Signals) -> None:
        process = holder(self.work.run(name).lock)
        if process is None or not is_rdpm(process):
            raise CaseError(f'"{name}"', None, "must be running on this machine", "no process of it is found here")
        with suppress(ProcessLookupError):  # it may end between two signals
            for number in numbers:
                os.kill(process, number)


def _write(files: RunFolder, mark: QueueMark) -> None:
    with replacing(files.path / QUEUED) as temporary:
        temporary.write_text(json.dumps(mark._asdict()), encoding="utf-8")
