"""What a tuning found: tables, verdict, the case that has the chosen values, and its files."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from rdpm import design
from rdpm.design.wording import speed_text, time_text
from rdpm.io.files import replacing
from rdpm.io.provenance import environment, write_json
from rdpm.studies.cases import changed
from rdpm.studies.measures import QUANTITIES
from rdpm.studies.spread import Spread, number
from rdpm.studies.tuning.choice import StepChoice, Window, keeps_overlap, makes_no_work, relative_changes
from rdpm.studies.tuning.confirm import Confirmation
from rdpm.studies.tuning.options import ROOM_STEPS, TuneOptions
from rdpm.studies.tuning.reading import Probed
from rdpm.studies.write import study_to_toml

__all__ = ["Tuning"]


@dataclass(frozen=True)
class Tuning:
    """A case whose time step and contact steps were found by running it.

    Attributes
    ----------
    name : str
        Of the case.
    folder : pathlib.Path
    raw : dict
        What the case file holds.
    seen : Probed
        What the case does.
    options : TuneOptions
    restitution : float, [-]
        Dry, the same in all runs.
    overlap_limit : float, [-]
    step_rows : tuple of dict
        One a time step: ``dt_s, status, reason, value`` of the measure. Empty where the step was given.
    step : StepChoice
    rows : tuple of dict
        One a value of N_c: the contact it implies, what happened in its run, and what the dry design predicted.
    spread : Spread or None
        Of the outcome, by numerics alone.
    window : Window or None
    dry : rdpm.design.Design
        What ``rdpm design`` says of the chosen contact (the stiffest without a window) at the terminal speed.
    kind : str
        The kind of pair whose contact is given.
    command : str
    confirmation : Confirmation, optional
        The chosen contact on a finer grid, where that was asked for.
    """

    name: str
    folder: Path
    raw: Mapping[str, Any]
    seen: Probed
    options: TuneOptions
    restitution: float
    overlap_limit: float
    step_rows: tuple[dict[str, Any], ...]
    step: StepChoice
    rows: tuple[dict[str, Any], ...]
    spread: Spread | None
    window: Window | None
    dry: design.Design
    kind: str
    command: str
    confirmation: Confirmation | None = None

    @property
    def chosen(self) -> dict[str, Any] | None:
        """The row of the contact steps that were taken."""
        if self.window is None:
            return None
        return next(row for row in self.rows if row["contact_steps"] == self.window.chosen)

    @property
    def case_file(self) -> Path:
        """The case with the chosen values."""
        return self.folder / f"{self.name}-tuned.toml"

    def reason(self, row: Mapping[str, Any]) -> str:
        """Why contact steps are outside of the range; "" inside it."""
        if self.window is not None and row["contact_steps"] in self.window.members:
            return ""
        if row["status"] != "done":
            return str(row["reason"] or row["status"])
        if not keeps_overlap(row, self.overlap_limit):
            return "overlap" if number(row, "overlap_fraction") is not None else "no contact"
        return "the outcome differs" if makes_no_work(row, self.options.work_tolerance) else "a contact makes energy"

    def verdict(self) -> str:
        """What was chosen and why, in three sentences; with a finer run what that says."""
        confirmed = () if self.confirmation is None else (self.confirmation.sentence(),)
        return " ".join((self._step_said(), self._window_said(), self._dry_said(), *confirmed))

    def _step_said(self) -> str:
        step, dt = self.step, time_text(self.step.dt_s)
        if not self.step_rows:
            return f"dt = {dt} is the one given: its convergence was not tried."
        what, within = self.seen.measure, _percent(self.options.tolerance)
        finest = time_text(min(row["dt_s"] for row in self.step_rows))
        if not step.is_converged:
            return f"dt = {dt} is the shortest tried: {what} is not converged to {within}; name shorter --time-steps."
        if not step.has_room:
            return f"dt = {dt} is the shortest tried: {what} is converged, but contacts of {ROOM_STEPS:g} steps are " \
                   f"expected to overlap by more than {_percent(self.overlap_limit)} d."  # fmt: skip
        longer = [row for row in self.step_rows if row["dt_s"] > step.dt_s]
        converged = [
            dt for dt, change in relative_changes(self.step_rows).items()
            if dt > step.dt_s and change <= self.options.tolerance
        ]  # fmt: skip
        known = f"{what} is within {within} of that at {finest}"
        if step.change is not None:
            known += f" ({_percent(step.change)})"
        if not longer:
            why = f"the longest tried: {known}"
        elif converged:
            why = f"the longest that leaves room for contacts of {ROOM_STEPS:g} steps below the overlap limit; {known}"
        else:
            why = f"the longest at which {known}"
        return f"dt = {dt} is {why}."

    def _window_said(self) -> str:
        limit = _percent(self.overlap_limit)
        if self.window is None or self.chosen is None:
            said = "; ".join(f"{row['contact_steps']:g}: {self.reason(row)}" for row in self.rows)
            return f"No two neighbouring N_c keep the overlap below {limit} d, do no positive work and agree in " \
                   f"{self.seen.outcome} ({said})."  # fmt: skip
        members = [row for row in self.rows if row["contact_steps"] in self.window.members]
        most = _percent(max(row["overlap_fraction"] for row in members))
        chosen = self.chosen
        same = f"agrees within {_percent(self.options.of_outcome)}"
        if self.spread is not None:
            is_known = math.isfinite(self.spread.half_width)
            same += f"{' or the spread of numerics' if is_known else ''} ({self.spread.describe()})"
        ends = " (all that were tried)" if len(members) == len(self.rows) else ""
        return (
            f"For N_c from {self.window}{ends}, the overlap is at most {most} d (limit {limit} d), no contact makes "
            f"energy, and {self.seen.outcome} {same}: N_c = {chosen['contact_steps']:g} lies between the ends, with "
            f"k_n = {chosen['stiffness_N_m']:.4g} N/m and eta_n = {chosen['damping_N_s_m']:.4g} N s/m ({self.kind})."
        )

    def _dry_said(self) -> str:
        if self.dry.impact_speed_m_s is None:
            return "The dry design knows no impact speed before a run, and so no overlap."
        found = self.dry.advice.contact_steps_range
        allowed = f"N_c {found[0]} to {found[1]}" if found else "no N_c"
        real = self.seen.impact_speed_m_s
        met = "" if real is None else f"; the fastest impact of the run had {speed_text(real)}"
        return f"The dry design, at {speed_text(self.dry.impact_speed_m_s)}, allows {allowed} at this dt{met}."

    def to_dict(self) -> dict[str, Any]:
        """Plain types under the names of the JSON output."""
        found = self.dry.advice.contact_steps_range
        return environment() | {
            "case": self.name, "command": self.command, "verdict": self.verdict(),
            "kind": self.seen.kind, "measure": self.seen.measure, "outcome": self.seen.outcome,
            "tolerance": self.options.tolerance, "outcome_tolerance": self.options.of_outcome,
            "outcome_spread": None if self.spread is None or not math.isfinite(self.spread.half_width)
            else asdict(self.spread),
            "first_contact_s": self.seen.contact_s, "restitution": self.restitution,
            "overlap_limit_fraction": self.overlap_limit,
            "time_step": asdict(self.step), "time_steps": list(self.step_rows),
            "window": None if self.window is None else list(self.window.members),
            "chosen": self.chosen, "pair": self.kind,
            "contact_steps": [{**row, "in_window": not self.reason(row), "excluded_by": self.reason(row)}
                              for row in self.rows],
            "dry_design": {
                "impact_speed_m_s": self.dry.impact_speed_m_s,
                "contact_steps_range": list(found) if found else None, "text": self.dry.advice.text,
            },
            "case_file": None if self.window is None else str(self.case_file),
            "confirmation": None if self.confirmation is None
            else asdict(self.confirmation) | {"holds": self.confirmation.holds},
        }  # fmt: skip

    def case_text(self) -> str:
        """The case file with the chosen values, in the user's own units.

        Raises
        ------
        ValueError
            There is no range.
        """
        if self.window is None:
            raise ValueError("no contact steps were found")
        steps = self.window.chosen
        values = {
            "contact.contact_steps": int(steps) if steps == int(steps) else steps,
            "contact.restitution": self.restitution,
            "time.step": f"{1e3 * self.step.dt_s:.12g} ms",
        }
        content, _ = changed(dict(self.raw), [values], (), self.name)
        how = self.command or "rdpm tune"
        head = f"# The case {self.name} with the time step and the contact steps that `{how}` found."
        return f"{head}\n# N_c from {self.window} keeps to all rules.\n{study_to_toml(content)}"

    def save(self) -> list[Path]:
        """Write ``tune.json``, the tables and ``tune.png``; with a range also the case.

        Returns
        -------
        list of pathlib.Path
            The files.
        """
        from rdpm.figures.tuning import plot_tuning

        files = [self.folder / "tune.json", self.folder / "contact_steps.csv"]
        content = json.loads(json.dumps(self.to_dict(), default=float))
        write_json(files[0], content)
        _write_csv(files[1], content["contact_steps"])
        if self.step_rows:
            files.append(self.folder / "time_steps.csv")
            _write_csv(files[-1], content["time_steps"])
        if self.confirmation is not None:
            files.append(self.folder / "confirmation.csv")
            _write_csv(files[-1], self.confirmation.rows)
        files.append(plot_tuning(self.folder / "tune.png", content, _axis_names(self.seen)))
        if self.window is not None:
            with replacing(self.case_file) as temporary:
                temporary.write_text(self.case_text(), encoding="utf-8")
            files.append(self.case_file)
        else:
            self.case_file.unlink(missing_ok=True)  # of a tuning before
        return files


def _axis_names(seen: Probed) -> dict[str, str]:
    return {name: f"{name} [{QUANTITIES[name].unit}]" for name in (seen.measure, seen.outcome)}


def _percent(fraction: float) -> str:
    """A fraction as percent.

    Examples
    --------
    >>> _percent(0.01), _percent(0.00372)
    ('1 %', '0.37 %')
    """
    return f"{100.0 * fraction:.2g} %"


def _write_csv(path: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    with replacing(path) as temporary, open(temporary, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
