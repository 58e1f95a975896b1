"""A case tuned by its own runs: one to see what happens, some for the time step, some for the contact steps."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from rdpm.config.body_file import read_body_files
from rdpm.config.case import Case
from rdpm.config.load import load_case
from rdpm.config.overrides import apply_overrides
from rdpm.config.source import case_name, parse_toml, read_source
from rdpm.errors import CaseError
from rdpm.setup import plan
from rdpm.setup.kinds import kinds_of_pairs
from rdpm.studies.cases import changed
from rdpm.studies.display import Display, span
from rdpm.studies.local import workers_here
from rdpm.studies.prepare import prepare
from rdpm.studies.results import StudyResults
from rdpm.studies.spread import Spread, spread_of
from rdpm.studies.study import run_study
from rdpm.studies.study_file import LoadedStudy, load_study
from rdpm.studies.tuning.choice import StepChoice, choose_step, choose_window, differs
from rdpm.studies.tuning.confirm import FINER, finer, measured
from rdpm.studies.tuning.options import ROOM_STEPS, SHIFTS, TuneOptions, step_candidates
from rdpm.studies.tuning.reading import (
    BEFORE_CONTACT,
    Probed,
    columns,
    dry_design,
    first_kind,
    probed,
    work_fraction,
)
from rdpm.studies.tuning.result import Tuning

__all__ = ["tune"]

Row = dict[str, Any]

#: Steps that a common start must be worth.
LEAST_START = 20


def tune(
    source: str | Path,
    out: Path,
    options: TuneOptions | None = None,
    *,
    overrides: Sequence[str] = (),
    workers: int | None = None,
    quiet: bool = False,
    command: str = "",
    confirm: bool = False,
) -> Tuning:
    """Find the time step and the contact steps of a case by running it.

    Parameters
    ----------
    source : str or Path
        A case file, or the name of a shipped case.
    out : Path
        The folder: new, empty, or that of a tuning from before, of which finished runs are kept.
    options : TuneOptions, optional
    overrides : sequence of str
        ``key=value``, as ``--set``.
    workers : int, optional
        Runs at once; one a processor when left out.
    quiet : bool
        Show no progress.
    command : str
        That makes it again; kept in the folder.
    confirm : bool
        Whether the chosen contact is run once more, at twice the resolution.

    Returns
    -------
    Tuning

    Raises
    ------
    CaseError
        The case or an option is wrong, no two bodies ever touch, or no run can tell anything.
    KeyboardInterrupt
        Runs were stopped at the end of a step; the same command continues.
    """
    options = options or TuneOptions()
    name = case_name(source)
    case = load_case(source, overrides)
    raw = _raw(source, overrides)
    if options.quick and case.resolution is not None:
        raw["resolution"] = {"cells_per_diameter": 4}
        case = load_case(raw)
    plan(case)  # refuses what cannot run
    if not kinds_of_pairs(case):
        raise CaseError(name, None, "must have bodies that can touch", "a contact is what is tuned",
                        "Add a second body, or a wall.")  # fmt: skip
    if confirm:
        finer(case, 8.0, 1.0, case.time.end)  # refuses a dry case
    tuner = _Tuner(name, raw, case, out, options, workers, quiet, command)
    found = tuner.done()
    return tuner.confirmed(found) if confirm and found.chosen is not None else found


def _raw(source: str | Path, overrides: Sequence[str]) -> dict[str, Any]:
    """What the case file holds, in the user's own units."""
    text, label, home = read_source(source)
    raw = parse_toml(text, label)
    apply_overrides(raw, overrides)
    read_body_files(raw, home, {})
    return raw


@dataclass
class _Tuner:
    name: str
    raw: dict[str, Any]
    case: Case
    out: Path
    options: TuneOptions
    workers: int | None
    quiet: bool
    command: str

    def done(self) -> Tuning:
        """Find the time step, then the contact steps, and write what was found."""
        self.restitution = _restitution(self.case)
        self.candidates = list(self.options.time_steps) or step_candidates(self.case, self.options.quick)
        self._make_folder()
        seen = self._probe()
        if self.options.measure and self.options.measure != seen.measure:
            seen = replace(seen, measure=self.options.measure, measured_s=self.case.time.end)
        if self.options.outcome and self.options.outcome != seen.outcome:
            seen = replace(seen, outcome=self.options.outcome, judged_s=self.case.time.end)
        steps, choice = self._time_step(seen)
        rows, spread, kind = self._contact_steps(seen, choice.dt_s)
        limit = self.case.contact.overlap_warning
        is_other = differs(spread, self.options.of_outcome)
        window = choose_window(rows, limit, self.options.work_tolerance, is_other)
        speed = plan(self.case).scales.fall
        chosen = window.chosen if window else min(self.options.contact_steps)
        design = dry_design(self.case, kind, self.restitution, chosen, choice.dt_s, speed)
        return Tuning(
            self.name, self.out, self.raw, seen, self.options, self.restitution, limit, tuple(steps), choice,
            tuple(rows), spread, window, design, kind.name, self.command,
        )  # fmt: skip

    def confirmed(self, found: Tuning) -> Tuning:
        """The same with the chosen contact run at twice the resolution."""
        chosen, dt = found.chosen, found.step.dt_s
        assert chosen is not None
        same = {"contact.restitution": self.restitution}
        candidates = [same | more for more in finer(self.case, chosen["contact_steps"], dt, found.seen.judged_s)]
        refusals = [self._refusal(changes) for changes in candidates]
        n = next((n for n, refusal in enumerate(refusals) if not refusal), None)
        status, run, used = ("refused", refusals[-1]), None, candidates[n if n is not None else -1]
        if n is not None:
            title = "confirmation at twice the resolution"
            results = self._run(self._study("confirm", title, [{"name": "fine", "set": used}]))
            row = results.table.iloc[0]
            status = str(row["status"]), str(row["reason"] or "")
            run = results.run("fine") if status[0] == "done" else None
        coarse = _across(self.case)
        return replace(found, confirmation=measured(
            chosen, run, (found.seen.measure, found.seen.outcome), status,
            (found.overlap_limit, self.options.work_tolerance), differs(found.spread, self.options.of_outcome),
            (coarse, FINER * coarse), (dt, used["time.step"]),
        ))  # fmt: skip

    def _make_folder(self) -> None:
        is_old = (self.out / "probe" / "study.json").is_file()
        if self.out.exists() and not is_old and (not self.out.is_dir() or any(self.out.iterdir())):
            raise CaseError(f"--out {self.out}", None, "must be new, empty, or the folder of a tuning",
                            "it holds files, perhaps results", "Name another folder with --out.")  # fmt: skip
        if not self.out.parent.is_dir():
            raise CaseError(f"--out {self.out}", None, "must lie in a folder that is there",
                            f"{self.out.parent} is not", f"Make it first: mkdir -p {self.out.parent}")  # fmt: skip
        with suppress(FileExistsError):
            try:
                self.out.mkdir()
            except PermissionError as error:
                raise CaseError(f"--out {self.out}", None, "must be a place to write to", error.strerror or "",
                                "Name another folder with --out.") from None  # fmt: skip

    def _study(self, name: str, title: str, runs: list[Row], **more: Any) -> LoadedStudy:
        return load_study({"name": name, "title": title, "base": {"case": self.raw}, "runs": runs, **more})

    def _run(self, study: LoadedStudy) -> StudyResults:
        prepared = prepare(study)
        count = workers_here(prepared.jobs, self.workers)
        with Display(self.quiet) as display:
            display.note(f"{study.file.title}: about {span(prepared.expected_seconds(count))} alone on this machine")
            return run_study(
                study, self.out / study.name, workers=self.workers, watcher=display, tell=display.note,
                command=self.command,
            )  # fmt: skip

    def _contact(self, contact_steps: float, dt: float, end: float) -> Row:
        return {
            "time.step": dt, "time.end": end, "contact.contact_steps": round(contact_steps, 9),
            "contact.restitution": self.restitution,
        }  # fmt: skip

    def _kept_contact(self, dt: float, end: float) -> Row:
        """A contact as long in time as the case's own, or of the fewest steps where these last longer."""
        return self._contact(min(max(4.0, _own_contact_time(self.case) / dt), 1000.0), dt, end)

    def _refusal(self, changes: Row) -> str:
        """Why the plan refuses a run; "" where it does not."""
        try:
            plan(load_case(changed(self.raw, [changes], (), self.name)[0]))
        except CaseError as error:
            return str(error)
        return ""

    def _probe(self) -> Probed:
        """Run the case once with its own contact: what happens, and when."""
        end = self.case.time.end
        longest = min(plan(self.case).step.limits.get("advective", math.inf), _own_contact_time(self.case) / 4.0)
        reason = ""
        for dt in [dt for dt in self.candidates if dt <= longest * (1.0 + 1e-9)] or self.candidates[-1:]:
            changes = self._kept_contact(dt, end)
            reason = self._refusal(changes)
            if reason:
                continue
            results = self._run(self._study("probe", "1 of 3, one run to the end", [{"name": "probe", "set": changes}]))
            row = results.table.iloc[0]
            if row["status"] == "done":
                run = results.run("probe")
                seen = probed(run)
                if seen is None:
                    raise _no_contact(self.name, end, columns(run)["min_gap_m"])
                return seen
            reason = str(row["reason"])
        raise CaseError(self.name, None, "must come to its end at one of the time steps", reason,
                        "Name shorter ones with --time-steps.")  # fmt: skip

    def _time_step(self, seen: Probed) -> tuple[list[Row], StepChoice]:
        """Runs that differ in the time step, as far as the measure is known."""
        room = _room(seen, self.case.contact.overlap_warning)
        if len(self.candidates) == 1:
            dt = self.candidates[0]
            return [], StepChoice(dt, None, False, dt <= room)
        coarsest = max(self.candidates)
        end = min(self.case.time.end, math.ceil(seen.measured_s / coarsest) * coarsest)
        rows: list[Row] = []
        runs: list[Row] = []
        for dt in self.candidates:
            changes = self._kept_contact(dt, end)
            reason = self._refusal(changes)
            rows.append({"dt_s": dt, "status": "refused" if reason else "", "reason": reason, "value": None})
            if not reason:
                runs.append({"name": _step_name(dt), "set": changes})
        if not runs:
            raise CaseError("--time-steps", None, "must hold one that the case can be run with", rows[-1]["reason"])
        results = self._run(self._study("time-step", "2 of 3, time steps", runs))
        found = {row["run"]: row for row in results.table.to_dict("records")}
        for row in rows:
            if row["status"]:
                continue
            of = found[_step_name(row["dt_s"])]
            row |= {"status": of["status"], "reason": of["reason"] or ""}
            if of["status"] == "done":
                row["value"] = columns(results.run(of["run"]))[seen.measure]
        choice = choose_step(rows, self.options.tolerance, room)
        if choice is None:
            raise CaseError("--measure", seen.measure, "must be a number that the runs have",
                            "it has no value at any time step", "Name another measure.")  # fmt: skip
        return rows, choice

    def _contact_steps(self, seen: Probed, dt: float) -> tuple[list[Row], Spread | None, Any]:
        """Runs that differ in N_c, from one start, and one of them repeated with other numerics."""
        end = min(self.case.time.end, math.ceil(seen.judged_s / dt) * dt)
        values = self.options.contact_steps
        runs = [{"name": f"N_c-{n:g}", "set": self._contact(n, dt, end)} for n in values]
        more: dict[str, Any] = {}
        start = math.floor(BEFORE_CONTACT * seen.contact_s / dt)
        if start >= LEAST_START:
            more["start"] = {"at": start * dt}
        middle = runs[len(runs) // 2]["name"]
        if self.options.outcome_tolerance is None and not self.options.quick:
            more["spread"] = {"of": [middle], "shifts": SHIFTS}
        study = self._study("contact-steps", "3 of 3, contact steps", runs, **more)
        if "spread" in more:
            try:
                prepare(study)
            except CaseError:  # bodies that cannot be moved
                del more["spread"]
                study = self._study("contact-steps", "3 of 3, contact steps", runs, **more)
        results = self._run(study)
        found = {row["run"]: row for row in results.table.to_dict("records")}
        first = next((run for run in found if found[run]["status"] == "done"), None)
        contacts = results.run(first).contacts if first else None
        is_wall = bool(contacts["j"][contacts["start_s"].argmin()] < 0) if contacts else seen.kind == "wall"
        kind = first_kind(self.case, is_wall)
        speed = plan(self.case).scales.fall
        rows = []
        for n in values:
            dry = dry_design(self.case, kind, self.restitution, n, dt, speed)
            rows.append(_row(n, dry, results, found[f"N_c-{n:g}"], seen.outcome))
        repeated = [name for name, row in found.items() if row["spread_of"] == middle and row["status"] == "done"]
        outcomes = [{seen.outcome: columns(results.run(name))[seen.outcome]} for name in (*repeated, middle)] if (
            repeated and found[middle]["status"] == "done") else []  # fmt: skip
        return rows, spread_of(outcomes, seen.outcome) if outcomes else None, kind


def _row(n: float, dry: Any, results: StudyResults, found: Mapping[str, Any], outcome: str) -> Row:
    row: Row = {
        "contact_steps": n, "contact_time_s": dry.contact_time_s, "stiffness_N_m": dry.stiffness_N_m,
        "damping_N_s_m": dry.damping_N_s_m, "dry_overlap_fraction": dry.max_overlap_fraction,
        "status": found["status"], "reason": found["reason"] or "",
    }  # fmt: skip
    names = (
        "overlap_fraction", "work_fraction", "contacts", "contact_total_time_s", "contact_longest_time_s",
        "max_impact_speed_m_s", "max_stokes_number", "kiss_time_s", "gap_kiss_total_s", "outcome",
    )  # fmt: skip
    row |= dict.fromkeys(names)
    if found["status"] == "done":
        run = results.run(found["run"])
        values = columns(run)
        row |= {name: values.get(name) for name in names}
        row["overlap_fraction"] = values["max_overlap_fraction"]
        row["work_fraction"] = work_fraction(run)
        row["outcome"] = values[outcome]
    return row


def _own_contact_time(case: Case) -> float:
    """Shortest contact time of a case as it is [s]."""
    made = plan(case)
    times = [pair.design.contact_time_s for pair in made.pairs if pair.design.contact_time_s is not None]
    return min(times, default=ROOM_STEPS * made.step.dt)


def _across(case: Case) -> float:
    """Cells a diameter: as given, or those of the smallest body."""
    assert case.resolution is not None  # `finer` refuses a dry case
    if case.resolution.cells_per_diameter is not None:
        return case.resolution.cells_per_diameter
    largest = max(length / n for length, n in zip(case.domain.size, case.resolution.cells or (), strict=True))
    return float(case.expanded_bodies().diameter.min()) / largest


def _step_name(dt: float) -> str:
    return f"dt-{1e3 * dt:.6g}ms"


def _restitution(case: Case) -> float:
    """The dry restitution that N_c goes with: the case's, or that of its spring and dashpot."""
    given = case.contact.restitution
    designed = [pair.design.restitution for pair in plan(case).pairs]
    value = given if given is not None else next(iter(designed), None)
    if value is None or value <= 0.0:
        raise CaseError("contact.restitution", value, "must be above 0", "a contact follows from N_c and e_n, and this "
                        "spring and dashpot have none", "Add --set contact.restitution=0.5.")  # fmt: skip
    return float(value)


def _room(seen: Probed, limit: float) -> float:
    """Longest time step in which a contact of `ROOM_STEPS` steps keeps to the overlap limit [s].

    The overlap of an impact grows as the contact time, that of a steady load as its square: the safe one counts.
    """
    if seen.overlap_fraction <= 0.0:
        return math.inf
    ratio = limit / seen.overlap_fraction
    return seen.contact_time_s * (math.sqrt(ratio) if ratio > 1.0 else ratio) / ROOM_STEPS


def _no_contact(name: str, end: float, gap: float | None) -> CaseError:
    near = "" if gap is None else f", the smallest gap is {1e3 * gap:.3g} mm"
    return CaseError(f"{name}: time.end", f"{end:g} s", "must be after the first contact", f"nothing touches{near}",
                     "Raise it; lubrication may keep bodies apart: --set contact.lubrication=false.")  # fmt: skip
