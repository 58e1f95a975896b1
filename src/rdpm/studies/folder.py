"""A study's folder: the names of its files, its jobs, and what became of each."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from rdpm.config.case import Case
from rdpm.config.load import load_case
from rdpm.errors import CaseError
from rdpm.io.files import replacing
from rdpm.io.provenance import read_json, write_json
from rdpm.results.run_folder import RunFolder

__all__ = ["DONE", "FAILED", "INTERRUPTED", "STOPPED", "WAITING", "Job", "Record", "StudyFolder"]

DONE, STOPPED, FAILED, INTERRUPTED, WAITING = "done", "stopped", "failed", "interrupted", "waiting"


@dataclass(frozen=True)
class Job:
    """One run to be made, whoever makes it.

    Attributes
    ----------
    name : str
        Also of its folder below ``runs/`` or, for a common start, ``starts/``.
    fingerprint : str
        Of the case, of the start and of the version of rdpm: a run with the same one need not be made again.
    start : str
        The job it goes on from; "" for one that begins at time zero.
    is_start : bool
    steps, cells : int
        What it costs.
    memory : int, [bytes]
    disk, disk_left : int, [bytes]
        At most while it is made, and when it is done.
    """

    name: str
    fingerprint: str
    start: str = ""
    is_start: bool = False
    steps: int = 0
    cells: int = 0
    memory: int = 0
    disk: int = 0
    disk_left: int = 0


@dataclass(frozen=True)
class Record:
    """What became of a job.

    Attributes
    ----------
    fingerprint : str
        Of the job that was tried.
    status : str
        "done"; "stopped" by a guard; "failed" otherwise; "interrupted"; "running".
    reason : str
        Why it is not done.
    rdpm_version : str
    """

    fingerprint: str
    status: str
    reason: str = ""
    rdpm_version: str = ""

    @property
    def is_final(self) -> bool:
        """Whether another try would end in the same way."""
        return self.status in (DONE, STOPPED)


@dataclass(frozen=True)
class StudyFolder:
    """Where the files of a study are.

    Parameters
    ----------
    path : pathlib.Path

    Examples
    --------
    >>> StudyFolder(Path("dkt-stiffness")).run("soft").summary.as_posix()
    'dkt-stiffness/runs/soft/summary.json'
    """

    path: Path

    @property
    def study(self) -> Path:
        """The study as it was run: whole, with the base cases in it."""
        return self.path / "study.toml"

    @property
    def index(self) -> Path:
        """The jobs, and the rows of the table that they fill."""
        return self.path / "study.json"

    @property
    def table_csv(self) -> Path:
        """One row a run."""
        return self.path / "table.csv"

    @property
    def table_parquet(self) -> Path:
        """The same as Parquet."""
        return self.path / "table.parquet"

    @property
    def lock(self) -> Path:
        """Held while the study is run."""
        return self.path / "study.lock"

    @property
    def figures(self) -> Path:
        """The folder of figures."""
        return self.path / "figures"

    def run(self, name: str) -> RunFolder:
        """The folder of a run."""
        return RunFolder(self.path / "runs" / name)

    def work(self, job: Job) -> RunFolder:
        """Where a job is done: as `run`, or below ``starts/`` for a common start."""
        return RunFolder(self.path / "starts" / job.name) if job.is_start else self.run(job.name)

    def _job_file(self, job: Job, ending: str) -> Path:
        return self.path / "jobs" / f"{job.name}.{ending}"

    def case(self, job: Job) -> Path:
        """The case of a job."""
        return self._job_file(job, "toml")

    def errors(self, job: Job) -> Path:
        """What the process of a job said on its error stream."""
        return self._job_file(job, "log")

    def write_case(self, job: Job, text: str) -> None:
        """Write the case of a job."""
        path = self.case(job)
        path.parent.mkdir(parents=True, exist_ok=True)
        with replacing(path) as temporary:
            temporary.write_text(text, encoding="utf-8")

    def read_case(self, job: Job) -> Case:
        """Read the case of a job."""
        return load_case(self.case(job))

    def write_record(self, job: Job, record: Record) -> None:
        """Note what became of a job."""
        path = self._job_file(job, "json")
        path.parent.mkdir(parents=True, exist_ok=True)
        write_json(path, asdict(record))

    def read_record(self, job: Job) -> Record | None:
        """What became of a job; None where it was not tried, or was another one."""
        path = self._job_file(job, "json")
        if not path.is_file():
            return None
        try:
            record = Record(**read_json(path))
        except (CaseError, TypeError):
            return None
        return record if record.fingerprint == job.fingerprint else None

    def status(self, job: Job) -> str:
        """What became of a job in one word; "waiting" where it was not tried."""
        record = self.read_record(job)
        return record.status if record else WAITING

    def write_index(self, content: dict[str, Any], jobs: list[Job]) -> None:
        """Write the jobs and what else belongs to the study."""
        write_json(self.index, content | {"jobs": [asdict(job) for job in jobs]})

    def read_index(self) -> dict[str, Any]:
        """Read what `write_index` wrote.

        Raises
        ------
        CaseError
            It is not the folder of a study.
        """
        if not self.index.is_file():
            raise CaseError(
                str(self.path), None, "must be the folder of a study", "study.json is missing",
                "Name one that `rdpm study` made.",
            )
        return read_json(self.index)

    def jobs(self) -> list[Job]:
        """The jobs, starts first."""
        return list(_jobs(self.read_index(), str(self.index)))


def _jobs(index: dict[str, Any], place: str) -> Iterator[Job]:
    for item in index.get("jobs", []):
        try:
            yield Job(**item)
        except TypeError as error:
            raise CaseError(place, None, "must hold the jobs of this version", str(error)) from None
