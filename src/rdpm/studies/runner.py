"""A case from its first step to its tables and summary."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Protocol

from rdpm.config.case import Case
from rdpm.config.write import case_to_toml
from rdpm.errors import RdpmError
from rdpm.io.files import replacing
from rdpm.io.provenance import write_json
from rdpm.setup import Plan, Simulation
from rdpm.simulation.recorder import Recorder
from rdpm.studies.summary import summarise

__all__ = ["Reporter", "run_case"]


class Reporter(Protocol):
    """Who is told how a run goes."""

    def start(self, plan: Plan) -> None:
        """Before the first step."""

    def update(self, step: int, time: float, end: float, message: str = "") -> None:
        """After each step."""

    def note(self, text: str) -> None:
        """A warning."""

    def finish(self, summary: dict[str, Any]) -> None:
        """At the end."""


def run_case(
    case: Case, folder: Path, *, threads: int | None = None, reporter: Reporter | None = None
) -> dict[str, Any]:
    """Run a case to its end; write its tables, fields and summary into a folder.

    Parameters
    ----------
    case : Case
    folder : Path
        Exists and is empty.
    threads : int, optional
    reporter : Reporter, optional

    Returns
    -------
    dict
        What ``summary.json`` holds.

    Raises
    ------
    RdpmError
        A guard stopped the run, or the disk is full; what was written stays, and the summary says so.
    """
    simulation = Simulation(case, threads)
    with replacing(folder / "case.toml") as temporary:
        temporary.write_text(case_to_toml(case), encoding="utf-8")
    log = _Log(folder / "run.log", reporter)
    if reporter:
        reporter.start(simulation.plan)
    for warning in simulation.plan.warnings:
        log.note(f"warning: {warning}", is_shown=False)
    recorder = Recorder(
        simulation, folder, float(case.output.table_every or 0.0), float(case.output.fields_every or 0.0)
    )
    status = "failed"
    try:
        simulation.run(case.time.end, reporter.update if reporter else False)
        status = "done"
    except RdpmError as error:
        status = getattr(error, "guard", "failed")
        log.note(str(error), is_shown=False)
        raise
    except KeyboardInterrupt:
        status = "interrupted"
        raise
    finally:
        recorder.close()
        summary = summarise(simulation, recorder, folder, status)
        write_json(folder / "summary.json", summary)
    for warning in summary["warnings"]:
        log.note(f"warning: {warning}")
    if reporter:
        reporter.finish(summary)
    return summary


class _Log:
    """Lines of run.log, and the same to the reporter."""

    def __init__(self, path: Path, reporter: Reporter | None) -> None:
        self._path, self._reporter = path, reporter
        path.write_text("", encoding="utf-8")

    def note(self, text: str, is_shown: bool = True) -> None:
        with self._path.open("a", encoding="utf-8") as file:
            file.write(text + "\n")
        if self._reporter and is_shown:
            self._reporter.note(text)
