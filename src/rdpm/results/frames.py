"""A run's folder as pandas tables and xarray fields."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from rdpm.errors import CaseError
from rdpm.results.fields import open_fields
from rdpm.results.run_folder import RunFolder
from rdpm.results.summary import Summary, read_summary

if TYPE_CHECKING:
    import pandas as pd
    import xarray

__all__ = ["RunFrames", "open_run"]


@dataclass(frozen=True)
class RunFrames:
    """What a run left, each table read when it is first asked for.

    Attributes
    ----------
    folder : RunFolder
    particles, contacts, history, timing : pandas.DataFrame
        The tables, under the names of their columns.
    summary : Summary
    fields : xarray.Dataset
        ``velocity`` (time, z, y, x, component) [m/s] and ``pressure`` (time, z, y, x) [Pa], ``vorticity`` and
        ``q_criterion`` where the case asked for them. Values are read from the disk as they are used:
        ``run.fields.isel(time=-1)`` reads the last picture alone. Without variables where the run stored no flow.
    planes : list of xarray.Dataset
        Likewise of each plane of the case.
    averages : xarray.Dataset
        ``mean_velocity``, ``mean_pressure``, ``velocity_variance`` at the end; without variables where none was made.
    points, lines : pandas.DataFrame
        Samples of the flow; `CaseError` where the case asked for none.
    records : dict of str to pandas.DataFrame
        The user's own tables by name.
    """

    folder: RunFolder

    @cached_property
    def summary(self) -> Summary:
        """What ``summary.json`` holds."""
        return read_summary(self.folder.summary)

    @cached_property
    def particles(self) -> pd.DataFrame:
        """Motion of the bodies."""
        return self._table("particles")

    @cached_property
    def contacts(self) -> pd.DataFrame:
        """Contacts that ended, a row each."""
        return self._table("contacts")

    @cached_property
    def history(self) -> pd.DataFrame:
        """Sums over the box."""
        return self._table("history")

    @cached_property
    def timing(self) -> pd.DataFrame:
        """Wall time of the parts of a step."""
        return self._table("timing")

    @cached_property
    def fields(self) -> xarray.Dataset:
        """The flow, read as it is used."""
        return open_fields(self.folder.fields)

    @cached_property
    def planes(self) -> list[xarray.Dataset]:
        """The flow on the planes of the case."""
        return [open_fields(path) for path in self.folder.plane_files]

    @cached_property
    def averages(self) -> xarray.Dataset:
        """Time averages of the flow."""
        found = open_fields(self.folder.averages)
        return found.isel(time=0) if "time" in found.dims else found

    @cached_property
    def points(self) -> pd.DataFrame:
        """Samples of the flow at points."""
        return _frame(self.folder.points)

    @cached_property
    def lines(self) -> pd.DataFrame:
        """Samples of the flow along lines."""
        return _frame(self.folder.lines)

    @cached_property
    def records(self) -> dict[str, pd.DataFrame]:
        """The user's own tables."""
        return {path.stem: _frame(path) for path in sorted(self.folder.records.glob("*.csv"))}

    def _table(self, name: str) -> pd.DataFrame:
        return _frame(self.folder.table(name))


def _frame(path: Path) -> pd.DataFrame:
    import pandas as pd

    try:
        return pd.read_csv(path)
    except (OSError, ValueError) as error:
        raise CaseError(str(path), None, "must be a table of a run", str(error)) from None


def open_run(folder: str | Path) -> RunFrames:
    """Open the folder of a run; also as ``rdpm.results.open``.

    Parameters
    ----------
    folder : path

    Returns
    -------
    RunFrames

    Raises
    ------
    CaseError
        The folder is not a run's.

    Examples
    --------
    >>> import rdpm, tempfile
    >>> bead = {"diameter": 0.01, "density": 2500, "centers": [[0.05, 0.05, 0.05]]}
    >>> case = {"domain": {"size": [0.1, 0.1, 0.1]}, "bodies": [bead], "time": {"end": 0.05, "step": "1 ms"},
    ...         "output": {"report": False}}
    >>> folder = rdpm.run(case, out=tempfile.mkdtemp()).folder.path
    >>> run = rdpm.results.open(folder)
    >>> run.summary.status, round(float(run.particles["w_m_s"].iloc[-1]), 3), len(run.contacts), len(run.fields)
    ('done', -0.49, 0, 0)
    """
    files = RunFolder(Path(folder))
    if not files.case.is_file():
        reason = "it holds no case.toml" if files.path.is_dir() else "there is no such folder"
        raise CaseError(str(files), None, "must be the folder of a run", reason, "Name one that `rdpm run` wrote.")
    return RunFrames(files)
