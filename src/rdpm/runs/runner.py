"""A case from its first step to its tables, summary and report; and from a checkpoint on."""

from __future__ import annotations

from collections.abc import Callable, Container, Mapping
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any, Protocol

from rdpm.config.case import Case
from rdpm.config.write import case_to_toml
from rdpm.errors import CaseError, CheckpointError, GuardError, RdpmError
from rdpm.io.files import replacing, reporting
from rdpm.io.lock import locked
from rdpm.parallel.agreement import guarding, on_root, together
from rdpm.parallel.ranks import Ranks, world
from rdpm.results.run_folder import RunFolder
from rdpm.results.summary import Summary, read_summary, write_summary
from rdpm.results.warnings import RunWarning
from rdpm.runs.checkpoints import FIELDS, Checkpoints, Saved, discard_later, load_newest, recorded, restore
from rdpm.runs.record_tables import RecordTables
from rdpm.runs.recorder import Recorder
from rdpm.runs.restart import case_to_branch, case_to_continue
from rdpm.runs.stopping import Interrupted, listening
from rdpm.runs.summary import contact_design, summarise
from rdpm.runs.warnings import crowded, planned
from rdpm.setup import Plan, Simulation
from rdpm.setup.build import interval_of
from rdpm.simulation.record import Record

__all__ = ["OwnRecord", "Reporter", "run_case"]

#: A function of the simulation, alone or with how often it is asked: seconds, or text with a unit.
OwnRecord = Callable[[Simulation], Any] | tuple[Callable[[Simulation], Any], float | str]


class Reporter(Protocol):
    """Who is told how a run goes."""

    def start(self, plan: Plan) -> None:
        """Before the first step."""

    def update(self, step: int, time: float, end: float, message: str = "") -> None:
        """After each step."""

    def note(self, text: str) -> None:
        """A warning."""

    def finish(self, summary: Summary) -> None:
        """At the end, before the report is made."""


def run_case(
    case: Case,
    folder: str | Path,
    *,
    threads: int | None = None,
    reporter: Reporter | None = None,
    resume: bool = False,
    start: tuple[Path, float | None] | None = None,
    within: float | None = None,
    on_step: Callable[[Simulation], None] | None = None,
    ranks: Ranks | None = None,
    record: Mapping[str, OwnRecord] | None = None,
) -> Summary:
    """Run a case to its end; write its tables, fields, checkpoints, summary and report into a folder.

    On several ranks each calls this with the same arguments; the root writes and reports.

    Parameters
    ----------
    case : Case
    folder : path
        Exists; empty, or the folder of the run to be continued.
    threads : int, optional
    reporter : Reporter, optional
    resume : bool
        Continue bit-identically from the newest good checkpoint in the folder; with another ``time.end`` to that.
        A run that made no checkpoint yet begins anew.
    start : tuple of (Path, float or None), optional
        Begin at the newest good checkpoint of another run's folder, not after a time [s].
    within : float, optional, [s]
        How long before that time the checkpoint may be; 1 % of the time when left out.
    on_step : callable, optional
        Called after every step with the simulation, before the step's rows are written; on every rank.
    record : mapping of str to callable, or to (callable, float or str), optional
        Own tables by name, each written to ``records/NAME.csv``: a function of the simulation, and how often (as often
        as the tables where it is not said); see `rdpm.simulation.record.Record` for what it may give. Checkpoints hold
        no functions: to continue a table, give its function again with `resume`.
    ranks : Ranks, optional
        That share the run; those that a launcher started when left out.

    Returns
    -------
    Summary
        What ``summary.json`` holds. Its ``status`` is "interrupted" where SIGINT, SIGTERM or SIGHUP ended the run: the
        step in hand was finished and a checkpoint written.

    Raises
    ------
    CaseError, CheckpointError
        Nothing was written.
    GuardError, OutputError
        The run was stopped, or the disk is full; what was written stays, the last good checkpoint too.
    """
    ranks = world() if ranks is None else ranks
    files = RunFolder(Path(folder))
    with guarding(ranks), locked(files.lock, ranks):
        teller = _Teller(files.log, reporter, ranks)
        leave = FIELDS if ranks.size > 1 else frozenset()
        case, saved, summary = on_root(ranks, lambda: _start(case, files, teller, resume, start, within, leave))
        if summary is None:
            summary = _Run(
                case, files, threads, teller, saved, resume and saved is not None, on_step, record or {}
            ).to_end()
        on_root(ranks, lambda: _report(case, files, summary, teller))
        return summary


def _start(
    case: Case, files: RunFolder, teller: _Teller, resume: bool, start: tuple[Path, float | None] | None,
    within: float | None, leave: Container[str],
) -> tuple[Case, Saved | None, Summary | None]:
    """The case that is run, where from, and the summary of a run that has nothing left to do.

    Arrays to `leave` are not read from the checkpoint.
    """
    if start is not None and not resume:
        saved = load_newest(RunFolder(Path(start[0])), teller.warn, start[1], within, leave)
        return case_to_branch(case, saved), saved, None
    if not resume:
        return case, None, None
    if _is_untouched(files):
        teller.note(f"{files} holds no run to continue: it begins here")
        return case, None, None
    saved = load_newest(files, teller.warn, leave=leave)
    case = case_to_continue(case, saved, teller.note)
    done = _finished(files, case, saved)
    if done is not None:
        teller.note(f"{files}: the run is done, at t = {saved.time:.6g} s")
    return case, saved, done


def _is_untouched(files: RunFolder) -> bool:
    """Whether a run left no step behind; a folder with anything else in it is not one to write to."""
    if files.checkpoint_files():
        return False
    # The first checkpoint is written before the first step: what is there without one holds no result.
    first = {files.case, files.log, files.lock, files.checkpoints, files.fields, files.bodies, *files.tables}
    first |= {files.walls, files.points, files.lines, files.records, *files.plane_files}
    if all(path in first or path.name.startswith(".") for path in files.path.iterdir()):
        return True
    raise CheckpointError(
        str(files), None, "must be the folder of a run", "it holds files, but no checkpoint", "Name the run's folder."
    )


def _finished(files: RunFolder, case: Case, saved: Saved) -> Summary | None:
    """The summary of a run that has nothing left to do."""
    if saved.time < case.time.end - 1e-6 * float(saved.facts["dt_s"]):
        return None
    with suppress(CaseError):
        summary = read_summary(files.summary)
        return summary if summary.status == "done" else None
    return None


def _is_reported(files: RunFolder) -> bool:
    """Whether the report is that of the results, as in a run that was done already."""
    report, summary = files.report, files.summary
    return report.is_file() and summary.is_file() and report.stat().st_mtime_ns >= summary.stat().st_mtime_ns


def _report(case: Case, files: RunFolder, summary: Summary, teller: _Teller) -> None:
    if summary.status != "done" or not case.output.report or _is_reported(files):
        return
    from rdpm.figures.report import make_report  # loads the libraries that draw

    make_report(files.path, video=case.output.video, progress=lambda text: teller.tell("note", text))


class _Teller:
    """Tells the log and the reporter, on the root; a terminal that is gone does not stop a run."""

    def __init__(self, path: Path, reporter: Reporter | None, ranks: Ranks) -> None:
        self.ranks, self._is_root = ranks, ranks.rank == 0
        self._path, self._reporter = path, reporter if self._is_root else None
        self._waiting: list[str] | None = []  # until the run begins: one that is refused writes nothing
        self.warnings: tuple[RunWarning, ...] = ()

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

    def warn(self, warning: RunWarning | str, is_logged: bool = True) -> None:
        """Say it once, and keep it for the summary."""
        told = warning if isinstance(warning, RunWarning) else RunWarning(warning)
        if str(told) in map(str, self.warnings):
            return
        self.warnings = (*self.warnings, told)
        if is_logged:
            self.note(f"warning: {told}")
        else:
            self.tell("note", f"warning: {told}")

    def _log(self, lines: str) -> None:
        if not self._is_root:
            return
        with reporting(self._path), self._path.open("a", encoding="utf-8") as file:
            file.write(lines)

    def tell(self, method: str, *arguments: Any) -> None:
        if self._reporter:
            with suppress(OSError, SystemExit):  # rich exits where a pipe is broken
                getattr(self._reporter, method)(*arguments)

    def update(self, step: int, time: float, end: float) -> None:
        self.tell("update", step, time, end)


def _own_record(simulation: Simulation, name: str, given: OwnRecord) -> Record:
    function, every = given if isinstance(given, tuple) and len(given) == 2 else (given, None)
    return Record(name, function, simulation.asked(interval_of(name, every, simulation.case)))


class _Run:
    """One run from its start, or from a checkpoint, to its end."""

    def __init__(
        self, case: Case, files: RunFolder, threads: int | None, teller: _Teller, saved: Saved | None, is_same: bool,
        on_step: Callable[[Simulation], None] | None,
        record: Mapping[str, OwnRecord],
    ) -> None:
        self.case, self.files, self.teller = case, files, teller
        self.saved, self.is_same = saved, is_same
        # Adaptive steps stay tied to the contact step with which the run began, whatever its end is now.
        contact_step = saved.facts["contact_step_s"] if saved is not None and is_same else None
        self.ranks = ranks = teller.ranks
        self.simulation = simulation = together(
            ranks, lambda: Simulation(case, threads, contact_step=contact_step, ranks=ranks)
        )
        if on_step is not None:
            simulation.on_step(lambda _: on_step(simulation))
        if saved is not None:
            together(ranks, lambda: restore(simulation, saved, is_same))
        own = [(_own_record(simulation, name, given), files.record(name)) for name, given in record.items()]
        self.records = RecordTables(simulation, own)
        if saved is not None:
            teller.note(f"{'continued' if is_same else 'started'} from {saved.path}, t = {saved.time:.6g} s")

    def to_end(self) -> Summary:
        """Run, and write all but the report."""
        case, files, simulation, saved = self.case, self.files, self.simulation, self.saved
        text = case_to_toml(case)
        on_root(self.ranks, lambda: self._begin(text))
        self.teller.tell("start", simulation.plan)
        used = simulation.fluid.grid.threads if simulation.fluid else 1
        for warning in (*planned(simulation.plan), *crowded(used * self.ranks.sharers)):
            self.teller.warn(warning, is_logged=not self.is_same)
        output = case.output
        resumed = None
        if saved is not None and self.is_same:
            resumed = recorded(simulation, saved), saved.facts["recorder"]
        with Recorder(
            simulation, files, output, resumed, self.teller.warn, contact_design(simulation), self.records,
        ) as recorder:
            every = output.checkpoint_every or 0.0
            checkpoints = Checkpoints(simulation, recorder, files, text, every, output.checkpoints_kept)
            if saved is not None and self.is_same:
                on_root(self.ranks, partial(discard_later, saved))
            else:
                checkpoints.write()
            self.saved = saved = None  # the arrays are no longer needed
            status = self._advance(recorder, checkpoints)
            recorder.close()
        self._tell_messages()
        summary = on_root(self.ranks, lambda: self._summarise(recorder, status))
        for warning in summary.warning_details:
            self.teller.warn(warning)
        if status == "done":
            self.teller.tell("finish", summary)
        return summary

    def _begin(self, text: str) -> None:
        """Write what a run has before its first step."""
        self.teller.begin()
        with reporting(self.files.path):
            self.files.checkpoints.mkdir(exist_ok=True)
        with replacing(self.files.case) as temporary:
            temporary.write_text(text, encoding="utf-8")

    def _advance(self, recorder: Recorder, checkpoints: Checkpoints) -> str:
        simulation = self.simulation
        try:
            with listening(self.ranks) as request:
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
            guard = getattr(error, "guard", "failed")
            with suppress(RdpmError):
                on_root(self.ranks, lambda: self._summarise(recorder, guard))
            if isinstance(error, GuardError) and self.ranks.rank == 0:
                self._tell_last_good()
            raise
        return status

    def _tell_messages(self) -> None:
        """What the ranks had to say to each other, into the log."""
        ranks, steps = self.ranks, max(1, self.simulation.steps)
        if ranks.size > 1:
            told = f"{ranks.seconds:.3g} s in messages of rank 0"
            sent = f"{ranks.messages / steps:.1f} of them and {1e-6 * ranks.sent_bytes / steps:.3g} MB a step sent"
            self.teller.note(f"{ranks.size} ranks: {told}, {sent}", is_shown=False)

    def _summarise(self, recorder: Recorder, status: str) -> Summary:
        summary = summarise(self.simulation, recorder, self.files, status, self.teller.warnings)
        write_summary(self.files.summary, summary)
        return summary

    def _tell_last_good(self) -> None:
        with suppress(RdpmError):
            last = load_newest(self.files, lambda _: None)
            folder = self.files
            self.teller.note(
                f"the last good checkpoint is at t = {last.time:.6g} s; to go on from there with other parameters: "
                f"rdpm run {folder} --from {folder} --at {last.time:.6g} --set ..."
            )
