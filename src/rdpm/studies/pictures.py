"""What drawings have in common: pictures, and the runs of a study in the order of what is varied."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from rdpm.figures.study_charts import colours
from rdpm.figures.style import case_text
from rdpm.results.run import Run
from rdpm.studies.names import Name, parameter, value_text
from rdpm.studies.results import StudyResults
from rdpm.studies.spread import Spread, spread_of

__all__ = ["Drawing", "Picture", "Sweep", "spread_rows", "sweep_of"]

#: Of several parameters that differ, the first of these names the runs.
_FIRST = ("contact.contact_steps", "contact.stiffness", "contact.damping", "time.step", "fluid.viscosity")


@dataclass(frozen=True)
class Picture:
    """A figure or video.

    Attributes
    ----------
    path : pathlib.Path
    title : str
        One sentence.
    """

    path: Path
    title: str


@dataclass(frozen=True)
class Drawing:
    """A figure or video of a study.

    Attributes
    ----------
    draw : callable
        Gets the `StudyResults` and the folder to write to; returns the `Picture` s it made.
    needs_fields : bool
        Whether the runs write fields (``output.fields_every`` of the base case), of which one plane is kept; otherwise
        they write none.
    """

    draw: Callable[[StudyResults, Path], list[Picture]]
    needs_fields: bool = False


@dataclass(frozen=True)
class Sweep:
    """The runs of a study that are done, in the order of what is varied.

    Attributes
    ----------
    rows : list of dict
        Of the table.
    key : str
        Of the case; "" where the runs do not differ in one number.
    labels, colors : list of str
        One a run.
    results : StudyResults
    """

    rows: list[dict[str, Any]]
    key: str
    labels: list[str]
    colors: list[str]
    results: StudyResults

    @property
    def name(self) -> Name:
        """How the parameter is written."""
        return parameter(self.key)

    @property
    def x_label(self) -> str:
        """Of the axis of the parameter."""
        name = self.name
        also = {"N/m": "; 1 N/m = 1000 dyn/cm", "N s/m": "; 0.001 N s/m = 1 dyn s/cm"}.get(name.unit, "")
        return f"{name.symbol} [{name.unit or '-'}{also}]"

    @property
    def values(self) -> np.ndarray[Any, np.dtype[np.float64]]:
        """Of the parameter, (n,)."""
        return np.array([float(row[self.key]) for row in self.rows])

    @property
    def is_log(self) -> bool:
        """Whether the values span more than a decade, all of them above 0."""
        values = self.values
        return bool(values.min() > 0.0 and values.max() / values.min() > 10.0)

    def column(self, name: str) -> np.ndarray[Any, np.dtype[np.float64]]:
        """A measure, nan where a run has none, (n,)."""
        return np.array([_float(row.get(name)) for row in self.rows])

    def runs(self) -> list[Run]:
        """The runs, from time zero on."""
        return [self.results.run(str(row["run"]), str(row["study"])) for row in self.rows]

    def about(self, run: Run) -> str:
        """What was run, as a caption."""
        contact, parts = run.case.get("contact", {}), []
        if len({row.get("contact.lubrication", contact.get("lubrication")) for row in self.rows}) == 1 and (
            "lubrication" in contact and self.key != "contact.lubrication"
        ):
            parts.append("with lubrication" if contact["lubrication"] else "no lubrication")
        parts += [
            value_text(f"contact.{key}", contact[key], formula=False)
            for key in ("stiffness", "damping", "restitution")
            if key in contact and len({row.get(f"contact.{key}", contact[key]) for row in self.rows}) == 1
        ]
        if "ending" in contact:
            parts.append(f"a contact ends at {str(contact['ending']).replace('-', ' ')}")
        return f"{case_text(self.results.title, run.case, run.summary, run.diameter)}; {', '.join(parts)}."


def sweep_of(results: StudyResults) -> Sweep:
    """The runs in their own right of a study (not of one that includes others).

    Raises
    ------
    ValueError
        None is done.
    """
    own = results.runs()
    rows = [{str(key): value for key, value in row.items()} for row in own.to_dict("records")]
    if not rows:
        raise ValueError("no run is done")
    known = next(item["parameters"] for item in results.index["rows"] if item["study"] == rows[0]["study"])
    numeric = [
        key for key in known
        if not key.startswith("bodies") and all(np.isfinite(_float(row.get(key))) for row in rows)
        and len({_float(row[key]) for row in rows}) == len(rows)
    ]  # fmt: skip
    key = next((key for key in (*_FIRST, *numeric) if key in numeric), "")
    if key:
        rows.sort(key=lambda row: float(row[key]))
    labels = [value_text(key, float(row[key])) if key else str(row["run"]) for row in rows]
    return Sweep(rows, key, labels, colours(len(rows)), results)


def spread_rows(results: StudyResults, quantity: str) -> Spread | None:
    """Spread of a quantity by the first run that was repeated; None without one."""
    repeated = [name for name in results.table["spread_of"].fillna("") if name]
    if not repeated:
        return None
    rows = results.spread(repeated[0]).to_dict("records")
    return spread_of(rows, quantity) if len(rows) >= 2 else None


def _float(value: Any) -> float:
    if value is None or isinstance(value, (bool, np.bool_, str)):
        return float("nan")
    try:
        return float(value)
    except TypeError:   # a missing value of pandas
        return float("nan")
