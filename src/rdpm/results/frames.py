"""A run's folder as pandas tables and xarray fields."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from rdpm.errors import CaseError
from rdpm.io.vtkhdf import field_grid, field_times, read_fields
from rdpm.results.run_folder import RunFolder
from rdpm.results.summary import Summary, read_summary

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["FieldSeries", "RunFrames", "open_run"]


class FieldSeries(Sequence[Any]):
    """Pictures of the flow as xarray, each read from the disk when it is asked for.

    Parameters
    ----------
    path : path
        ``fields.vtkhdf``.

    Attributes
    ----------
    times : ndarray, (T,), [s]
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self.times = field_times(self.path)

    def __len__(self) -> int:
        return len(self.times)

    @overload
    def __getitem__(self, step: int) -> Any: ...

    @overload
    def __getitem__(self, step: slice) -> list[Any]: ...

    def __getitem__(self, step: int | slice) -> Any:
        """Return one picture: ``velocity`` (z, y, x, component) [m/s] and ``pressure`` (z, y, x) [Pa]."""
        if isinstance(step, slice):
            return [self[n] for n in range(len(self))[step]]
        try:
            import xarray
        except ImportError:
            raise CaseError(
                "fields", None, "need xarray", "it is not installed", "pip install xarray, or use read_fields."
            ) from None
        time, velocity, pressure = read_fields(self.path, step)
        cells, spacing = field_grid(self.path)
        axes = {name: (np.arange(n) + 0.5) * h for name, n, h in zip("xyz", cells, spacing, strict=True)}
        return xarray.Dataset(
            {
                "velocity": (("z", "y", "x", "component"), velocity, {"units": "m/s"}),
                "pressure": (("z", "y", "x"), pressure, {"units": "Pa"}),
            },
            {**{name: (name, axis, {"units": "m"}) for name, axis in axes.items()}, "component": list("xyz"),
             "time": ((), time, {"units": "s"})},
        )  # fmt: skip


@dataclass(frozen=True)
class RunFrames:
    """What a run left, each table read when it is first asked for.

    Attributes
    ----------
    folder : RunFolder
    particles, contacts, history, timing : pandas.DataFrame
        The tables, under the names of their columns.
    summary : Summary
    fields : FieldSeries
        Empty where the run stored no flow.
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
    def fields(self) -> Sequence[Any]:
        """Pictures of the flow, each read when it is asked for."""
        return FieldSeries(self.folder.fields) if self.folder.fields.is_file() else ()

    def _table(self, name: str) -> pd.DataFrame:
        import pandas as pd

        path = self.folder.table(name)
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
