"""The jobs of a study on this machine: each in a process of its own, as many at once as it has room for."""

from __future__ import annotations

import json
import queue
import subprocess
import sys
import threading
from collections.abc import Iterable
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from typing import Any, Protocol

import rdpm
from rdpm.parallel.threads import available_threads
from rdpm.setup.scales import available_memory
from rdpm.studies.folder import DONE, FAILED, INTERRUPTED, Job, Record, StudyFolder

__all__ = ["Watcher", "run_locally", "workers_here"]

#: What a process needs beside the fields of its run [bytes].
PROCESS_MEMORY = 200e6


class Watcher(Protocol):
    """Who is told how the jobs go."""

    def begin(self, jobs: list[Job], workers: int) -> None:
        """Before the first one."""

    def update(self, job: Job, said: dict[str, Any]) -> None:
        """``phase`` and perhaps ``step, time, end``; at a job's end its status and ``reason``."""


def workers_here(jobs: Iterable[Job], asked: int | None = None) -> int:
    """How many jobs at once: one a processor, as far as the memory lasts.

    Parameters
    ----------
    jobs : iterable of Job
    asked : int, optional
        What the user wants; it counts.

    Notes
    -----
    Runs side by side never wait for one another, as the threads of one run do several times a step; start and end of a
    run, which one thread does, leave no processor idle.
    """
    largest = max((job.memory for job in jobs), default=0) + PROCESS_MEMORY
    if asked is not None:
        return asked
    return max(1, min(available_threads(), int(0.8 * available_memory() / largest)))


@dataclass
class _Running:
    job: Job
    process: subprocess.Popen[str]
    threads: int


class _Pool:
    def __init__(self, folder: StudyFolder, workers: int, watcher: Watcher) -> None:
        self.folder, self.workers, self.watcher = folder, workers, watcher
        self.cores = max(available_threads(), workers)
        self.running: dict[str, _Running] = {}
        self.events: queue.Queue[tuple[Job, dict[str, Any] | None]] = queue.Queue()

    def start(self, job: Job, others: int) -> None:
        """Start a job, with its share of the processors that are free."""
        free = self.cores - sum(item.threads for item in self.running.values())
        slots = min(self.workers - len(self.running), others + 1)
        threads = max(1, free // max(1, slots))
        command = [sys.executable, "-m", "rdpm.studies.one_job", str(self.folder.path), job.name]
        errors = self.folder.errors(job)
        with errors.open("w", encoding="utf-8") as log:
            # A session of its own: an interrupt from the keyboard reaches this process alone, which passes it on.
            process = subprocess.Popen(
                [*command, "--threads", str(threads), "--watched"],
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=log, text=True, start_new_session=True,
            )
        self.running[job.name] = _Running(job, process, threads)
        threading.Thread(target=self._listen, args=(job, process), daemon=True).start()
        self.watcher.update(job, {"phase": "starting", "threads": threads})

    def _listen(self, job: Job, process: subprocess.Popen[str]) -> None:
        assert process.stdout is not None
        with process.stdout:
            for line in process.stdout:
                with suppress(ValueError):
                    said = json.loads(line)
                    if isinstance(said, dict):
                        self.events.put((job, said))
        process.wait()
        _close(process)
        self.events.put((job, None))

    def wait(self) -> Job | None:
        """Pass on one event; return a job that ended."""
        job, said = self.events.get()
        if said is not None:
            if said.get("phase") in ("stepping", "writing"):
                self.watcher.update(job, said)
            return None
        ended = self.running.pop(job.name).process
        record = self.folder.read_record(job)
        if record is None or record.status == "running":
            record = Record(job.fingerprint, FAILED, self._last_words(job, ended.returncode), rdpm.__version__)
            self.folder.write_record(job, record)
        self.watcher.update(job, {"phase": record.status, "reason": record.reason})
        return job

    def _last_words(self, job: Job, code: int) -> str:
        if code < 0:
            return f"its process was killed by signal {-code}"
        with suppress(OSError):
            lines = self.folder.errors(job).read_text(encoding="utf-8").strip().splitlines()
            if lines:
                return f"its process ended with exit code {code}: {lines[-1]}"
        return f"its process ended with exit code {code}"

    def stop(self) -> None:
        """Have all end at the end of the step in hand, a checkpoint written; and wait for that."""
        for item in self.running.values():
            _close(item.process)
        for item in self.running.values():
            try:
                item.process.wait(60)
            except subprocess.TimeoutExpired:
                item.process.kill()


def _close(process: subprocess.Popen[str]) -> None:
    """Close the standard input of a process: it ends, if it has not ended yet."""
    if process.stdin is not None:
        with suppress(OSError):
            process.stdin.close()


def run_locally(folder: StudyFolder, jobs: list[Job], workers: int, watcher: Watcher) -> None:
    """Do jobs that are not done yet, starts before what goes on from them, the longest first.

    Parameters
    ----------
    folder : StudyFolder
        With the case of each job.
    jobs : list of Job
    workers : int
        At once. The processors are shared out among them; what is left when few jobs remain goes to those that start
        then.
    watcher : Watcher

    Notes
    -----
    A job whose process dies is noted as failed, and the others go on. An interrupt lets every run end its step and
    write a checkpoint, and is raised again.
    """
    waiting = sorted(jobs, key=lambda job: -job.steps * max(job.cells, 1))
    pool = _Pool(folder, workers, watcher)
    watcher.begin(jobs, workers)
    by_name = {job.name: job for job in folder.jobs()}
    with ExitStack() as stack:
        stack.callback(pool.stop)
        while waiting or pool.running:
            _launch(folder, pool, waiting, by_name, watcher)
            if pool.running:
                pool.wait()


def _launch(
    folder: StudyFolder, pool: _Pool, waiting: list[Job], by_name: dict[str, Job], watcher: Watcher
) -> None:
    """Start what can start, and give up what cannot any more."""
    for job in list(waiting):
        begun = pool.running.get(job.start) or next((item for item in waiting if item.name == job.start), None)
        if job.start and begun is None and folder.status(by_name[job.start]) != DONE:
            waiting.remove(job)
            record = folder.read_record(by_name[job.start])
            why = f"its common start {job.start} is not done: {record.reason if record else 'it was not made'}"
            status = INTERRUPTED if record and record.status == INTERRUPTED else FAILED
            folder.write_record(job, Record(job.fingerprint, status, why, rdpm.__version__))
            watcher.update(job, {"phase": status, "reason": why})
    ready = [
        job for job in waiting
        if not job.start or (job.start not in pool.running and all(item.name != job.start for item in waiting))
    ]
    ready.sort(key=lambda job: not job.is_start)
    while ready and len(pool.running) < pool.workers:
        job = ready.pop(0)
        waiting.remove(job)
        pool.start(job, len(ready))


