"""What a study left: its table, its runs and its parts."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rdpm.errors import CaseError
from rdpm.results.run import Run
from rdpm.results.run_folder import RunFolder
from rdpm.studies.folder import StudyFolder
from rdpm.studies.whole import load_whole

if TYPE_CHECKING:
    import pandas

__all__ = ["StudyResults", "load", "read_results"]


@dataclass(frozen=True)
class StudyResults:
    """A study that was run.

    Attributes
    ----------
    folder : StudyFolder
    name, title, question : str
        Of the study, or of the part of it that `part` gave.
    table : pandas.DataFrame
        One row a run, in the order of the study; see `rdpm.studies.load`.
    index : dict
        Of ``study.json``: ``parts`` with ``name, title, question, measure, draw, claims`` each, ``rows``, ``command``.

    Examples
    --------
    A drawing or a claim takes the rows it is about, and reads a run where the table does not say enough::

        for row in results.runs().itertuples():
            tracks = results.run(row.run, row.study).tracks
    """

    folder: StudyFolder
    name: str
    title: str
    question: str
    table: pandas.DataFrame
    index: dict[str, Any]

    def runs(self) -> pandas.DataFrame:
        """Rows of the runs in their own right that are done."""
        own = self.table["spread_of"].fillna("") == ""
        return self.table[own & (self.table["status"] == "done")]

    def spread(self, run: str) -> pandas.DataFrame:
        """Rows of a run and of its repetitions with other numerics that are done."""
        same = (self.table["run"] == run) | (self.table["spread_of"] == run)
        return self.table[same & (self.table["status"] == "done")]

    def run(self, name: str, study: str = "") -> Run:
        """Read a run from time zero on, its common start included.

        Parameters
        ----------
        name : str
            As in the column ``run``.
        study : str, optional
            As in the column ``study``, where several have a run of that name.

        Raises
        ------
        CaseError
            There is no such run, or its folder is not whole.
        """
        folder = self.run_folder(name, study)
        jobs = {self.folder.work(job).path: job for job in self.folder.jobs()}
        start = next((job for job in jobs.values() if job.name == jobs[folder].start), None)
        return load_whole(RunFolder(folder), self.folder.work(start) if start else None)

    def run_folder(self, name: str, study: str = "") -> Path:
        """Where a run is; see `run`."""
        rows = self.table[self.table["run"] == name]
        if study:
            rows = rows[rows["study"] == study]
        if rows.empty:
            raise CaseError(str(self.folder.path), None, f"has no run {study + '/' if study else ''}{name}")
        return self.folder.path / str(rows["folder"].iloc[0])

    def part(self, name: str) -> StudyResults:
        """One of the included studies.

        Raises
        ------
        CaseError
            There is none of that name.
        """
        for part in self.index["parts"]:
            if part["name"] == name:
                table = self.table[self.table["study"] == name].reset_index(drop=True)
                return StudyResults(self.folder, name, part["title"], part["question"], table, self.index)
        raise CaseError(str(self.folder.path), None, f"has no part {name}")

    @property
    def parts(self) -> list[str]:
        """Names of the included studies; of the study alone where it includes none."""
        return [part["name"] for part in self.index["parts"]]


def read_results(folder: str | Path) -> StudyResults:
    """Read the folder of a study.

    Parameters
    ----------
    folder : path

    Returns
    -------
    StudyResults

    Raises
    ------
    CaseError
        It is not the folder of a study, or no table was made yet.
    """
    files = StudyFolder(Path(folder))
    index = files.read_index()
    return StudyResults(files, index["name"], index["title"], index["question"], load(folder), index)


def load(folder: str | Path) -> pandas.DataFrame:
    """Read the table of a study.

    Parameters
    ----------
    folder : path
        That ``rdpm study`` made.

    Returns
    -------
    pandas.DataFrame
        One row a run. Columns: ``study``, ``run``, ``spread_of`` ("" for a run in its own right), ``status``,
        ``reason``, ``folder``; what differs between the runs, by the dotted key of the case, in SI; the measures;
        ``cells``, ``steps``, ``dt_s``, ``wall_s``, ``rdpm_version``. What a run does not have is missing (NaN, None).

    Raises
    ------
    CaseError
        It is not the folder of a study, or no table was made yet.
    """
    import pandas

    files = StudyFolder(Path(folder))
    files.read_index()
    if not files.table_parquet.is_file():
        raise CaseError(
            str(files.path), None, "must hold the table of a study", "no run was collected yet",
            f"Make it: rdpm study collect {files.path}",
        )
    return pandas.read_parquet(files.table_parquet)
