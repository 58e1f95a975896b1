"""The jobs of a study on the workers of a Dask scheduler."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import rdpm
from rdpm.errors import CaseError
from rdpm.studies.folder import FAILED, Job, Record, StudyFolder
from rdpm.studies.local import Watcher

__all__ = ["run_on_dask"]


def run_on_dask(folder: StudyFolder, jobs: list[Job], address: str, watcher: Watcher) -> None:
    """Do jobs on the workers of a scheduler.

    Parameters
    ----------
    folder : StudyFolder
        On a disk that this machine and the workers share, under one path.
    jobs : list of Job
        Starts among them are done before what goes on from them.
    address : str
        Such as ``"tcp://head:8786"``.
    watcher : Watcher

    Raises
    ------
    CaseError
        The package distributed is missing, or no scheduler answers.

    Notes
    -----
    A job whose worker dies is done again by another, from the run's newest checkpoint. Each job is a process of its own
    with one thread, or OMP_NUM_THREADS of the worker's environment.
    """
    try:
        from distributed import Client, as_completed
    except ImportError:
        raise CaseError(
            "--scheduler", address, "needs the package distributed", "it is not installed",
            "Install it: pip install 'rdpm[dask]'.",
        ) from None
    try:
        client = Client(address, timeout="20s")
    except (OSError, ValueError) as error:
        raise CaseError(
            "--scheduler", address, "must be the address of a Dask scheduler that answers", str(error).splitlines()[0],
            'It looks like "tcp://head:8786".',
        ) from None
    with client:
        workers = client.scheduler_info()["workers"]
        watcher.begin(jobs, sum(worker["nthreads"] for worker in workers.values()))
        futures: dict[str, Any] = {}
        path = str(folder.path.resolve())
        for job in jobs:
            after = [futures[job.start]] if job.start in futures else []
            key = f"{path}:{job.name}:{job.fingerprint}"
            futures[job.name] = client.submit(_do, path, job.name, after, key=key)
        by_key = {future.key: job for job, future in zip(jobs, futures.values(), strict=True)}
        for future in as_completed(futures.values()):
            _note(folder, by_key[future.key], future, watcher)


def _note(folder: StudyFolder, job: Job, future: Any, watcher: Watcher) -> None:
    """Pass on how a job ended."""
    record = folder.read_record(job)
    if future.status == "error" or record is None or record.status == "running":
        why = str(future.exception()) if future.status == "error" else str(future.result())
        record = Record(job.fingerprint, FAILED, why or "its process was killed", rdpm.__version__)
        folder.write_record(job, record)
    watcher.update(job, {"phase": record.status, "reason": record.reason})


def _do(path: str, name: str, _after: list[str]) -> str:
    """On a worker: one job in a process, which ends with the worker."""
    threads = os.environ.get("OMP_NUM_THREADS", "1")
    command = [sys.executable, "-m", "rdpm.studies.one_job", str(Path(path)), name, "--threads", threads, "--watched"]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stderr is not None
        said = process.stderr.read()  # the standard input stays open: it is closed when this process is gone
    return said.strip()[-500:]
