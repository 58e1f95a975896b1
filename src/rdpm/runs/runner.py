"""A case from its first step to its tables and summary; and from a checkpoint on."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import Any, Protocol

from rdpm.config.case import Case
from rdpm.config.write import case_to_toml
from rdpm.errors import CaseError, CheckpointError, GuardError, RdpmError
from rdpm.io.files import replacing, reporting
from rdpm.io.lock import LOCK_NAME, locked
from rdpm.io.provenance import read_json, write_json
from rdpm.runs.checkpoints import FOLDER, Checkpoints, Saved, discard_later, load_newest, restore
from rdpm.runs.recorder import TABLES, Recorder
from rdpm.runs.restart import case_to_branch, case_to_continue
from rdpm.runs.stopping import Interrupted, listening
from rdpm.runs.summary import summarise
from rdpm.setup import Plan, Simulation

__all__ = ["Reporter", "run_case"]


_FIRST_FILES = {FOLDER, LOCK_NAME, "case.toml", "run.log", "fields.vtkhdf", "bodies.vtkhdf"} | {
    f"{name}.csv" for name in TABLES
}


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
    case: Case,
    folder: Path,
    *,
    threads: int | None = None,
    reporter: Reporter | None = None,
    resume: bool = False,
    start: tuple[Path, float | None] | None = None,
) -> dict[str, Any]:
    """Run a case to its end; write its tables, fields, checkpoints and summary into a folder.

    Parameters
    ----------
    case : Case
    folder : Path
        Exists; empty, or the folder of the run to be continued.
    threads : int, optional
    reporter : Reporter, optional
    resume : bool
        Continue bit-identically from the newest good checkpoint in the folder; with another ``time.end`` to that.
        A run that made no checkpoint yet begins anew.
    start : tuple of (Path, float or None), optional
        Begin at the newest good checkpoint of another run's folder, not after a time [s].

    Returns
    -------
    dict
        What ``summary.json`` holds. Its ``status`` is "interrupted" where SIGINT, SIGTERM or SIGHUP ended the run: the
        step in hand was finished and a checkpoint written.

    Raises
    ------
    CaseError, CheckpointError
        Nothing was written.
    GuardError, OutputError
        The run was stopped, or the disk is full; what was written stays, the last good checkpoint too.
    """
    with locked(folder):
        teller = _Teller(folder / "run.log", reporter)
        saved = None
        if resume and not _is_untouched(folder):
            saved = load_newest(folder, teller.note)
            case = case_to_continue(case, saved, teller.note)
            done = _finished(folder, case, saved)
            if done is not None:
                teller.note(f"{folder}: the run is done, at t = {saved.time:.6g} s")
                return done
        elif resume:
            teller.note(f"{folder} holds no run to continue: it begins here")
        elif start is not None:
            saved = load_newest(start[0], teller.note, start[1])
            case = case_to_branch(case, saved)
        return _Run(case, folder, threads, teller, saved, resume and saved is not None).to_end()


def _is_untouched(folder: Path) -> bool:
    """Whether a run left no step behind; a folder with anything else in it is not one to write to."""
    if any((folder / FOLDER).glob("step-*")):
        return False
    # The first checkpoint is written before the first step: what is there without one holds no result.
    if all(path.name in _FIRST_FILES or path.name.startswith(".") for path in folder.iterdir()):
        return True
    raise CheckpointError(
        str(folder), None, "must be the folder of a run", "it holds files, but no checkpoint", "Name the run's folder."
    )


def _finished(folder: Path, case: Case, saved: Saved) -> dict[str, Any] | None:
    """The summary of a run that has nothing left to do."""
    if saved.time < case.time.end - 1e-6 * float(saved.facts["dt_s"]):
        return None
    with suppress(CaseError):
        summary = read_json(folder / "summary.json")
        return summary if summary.get("status") == "done" else None
    return None


class _Teller:
    """Tells the log and the reporter; a terminal that is gone does not stop a run."""

    def __init__(self, path: Path, reporter: Reporter | None) -> None:
        self._path, self._reporter = path, reporter
        self._waiting: list[str] | None = []  # until the run begins: one that is refused writes nothing

    def begin(self) -> None:
        waiting, self._waiting = self._waiting or [], None
        self._log("".join(line + "\n" for line in waiting))

    def note(self, text: str, is_shown: bool = True) -> None:
        if self._waiting is None:
            self._log(text + "\n")
        else:
            self._waiting.append(text)
        if is_shown:
            self.tell("note", text)

    def _log(self, lines: str) -> None:
        with reporting(self._path), self._path.open("a", encoding="utf-8") as file:
            file.write(lines)

    def tell(self, method: str, *arguments: Any) -> None:
        if self._reporter:
            with suppress(OSError, SystemExit):  # rich exits where a pipe is broken
                getattr(self._reporter, method)(*arguments)

    def update(self, step: int, time: float, end: float) -> None:
        self.tell("update", step, time, end)


class _Run:
    """One run from its start, or from a checkpoint, to its end."""

    def __init__(
        self, case: Case, folder: Path, threads: int | None, teller: _Teller, saved: Saved | None, is_same: bool
    ) -> None:
        self.case, self.folder, self.teller = case, folder, teller
        self.saved, self.is_same = saved, is_same
        self.simulation = Simulation(case, threads)
        if saved is not None:
            restore(self.simulation, saved, is_same)
            teller.note(f"{'continued' if is_same else 'started'} from {saved.path}, t = {saved.time:.6g} s")

    def to_end(self) -> dict[str, Any]:
        case, folder, simulation, saved = self.case, self.folder, self.simulation, self.saved
        text = case_to_toml(case)
        self.teller.begin()
        with reporting(folder):
            (folder / FOLDER).mkdir(exist_ok=True)
        with replacing(folder / "case.toml") as temporary:
            temporary.write_text(text, encoding="utf-8")
        self.teller.tell("start", simulation.plan)
        if not self.is_same:
            for warning in simulation.plan.warnings:
                self.teller.note(f"warning: {warning}", is_shown=False)
        output = case.output
        resumed = (saved.part("recorder"), saved.facts["recorder"]) if saved is not None and self.is_same else None
        with Recorder(
            simulation, folder, output.table_every or 0.0, output.fields_every or 0.0, resumed, self.teller.note
        ) as recorder:
            every = output.checkpoint_every or 0.0
            checkpoints = Checkpoints(simulation, recorder, folder, text, every, output.checkpoints_kept)
            if saved is not None and self.is_same:
                discard_later(saved)
            else:
                checkpoints.write()
            self.saved = saved = None  # the arrays are no longer needed
            status = self._advance(recorder, checkpoints)
            recorder.close()
        summary = self._summarise(recorder, status)
        for warning in summary["warnings"]:
            self.teller.note(f"warning: {warning}")
        if status == "done":
            self.teller.tell("finish", summary)
        return summary

    def _advance(self, recorder: Recorder, checkpoints: Checkpoints) -> str:
        simulation = self.simulation
        try:
            with listening() as request:
                simulation.on_step(checkpoints.step)
                simulation.on_step(request.check)  # last: by then all of the step is written
                try:
                    simulation.run(self.case.time.end, self.teller.update)
                    status = "done"
                except Interrupted as signal:
                    self.teller.note(f"{signal}: a checkpoint is written at t = {simulation.time:.6g} s")
                    status = "interrupted"
                checkpoints.write()
        except RdpmError as error:
            with suppress(RdpmError):  # what stopped the run is what is told
                self.teller.note(str(error), is_shown=False)
            with suppress(RdpmError):
                recorder.close()
            with suppress(RdpmError):
                self._summarise(recorder, getattr(error, "guard", "failed"))
            if isinstance(error, GuardError):
                self._tell_last_good()
            raise
        return status

    def _summarise(self, recorder: Recorder, status: str) -> dict[str, Any]:
        summary = summarise(self.simulation, recorder, self.folder, status)
        write_json(self.folder / "summary.json", summary)
        return summary

    def _tell_last_good(self) -> None:
        with suppress(RdpmError):
            last = load_newest(self.folder, lambda _: None)
            folder = self.folder
            self.teller.note(
                f"the last good checkpoint is at t = {last.time:.6g} s; to go on from there with other parameters: "
                f"rdpm run {folder} --from {folder} --at {last.time:.6g} --set ..."
            )
