"""``rdpm tune``: the time step and the contact steps of a case, found by running it."""

from __future__ import annotations

import shlex
import signal
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from rdpm.errors import CaseError

if TYPE_CHECKING:
    from rdpm.studies.tuning.confirm import Confirmation
    from rdpm.studies.tuning.result import Tuning

__all__ = ["tune"]

NO_RANGE = 1  # exit code

_Flag = Annotated[bool, Parameter(negative="", show_default=False)]


def tune(
    case: str,
    /,
    *,
    out: Path | None = None,
    workers: int | None = None,
    set_: Annotated[tuple[str, ...], Parameter(name="--set", negative="", show_default=False)] = (),
    measure: str = "",
    tolerance: str = "1 %",
    outcome: str = "",
    outcome_tolerance: str | None = None,
    contact_steps: str = "",
    time_steps: str = "",
    confirm: _Flag = False,
    json: _Flag = False,
    quick: _Flag = False,
    quiet: _Flag = False,
) -> int:
    """Find the time step of a case by convergence, then the range of contact steps N_c, with k_n and eta_n.

    One run of the case shows what happens in it. Runs to there at several time steps give dt. Runs at that dt that
    differ in N_c alone, from one checkpoint shortly before the first contact, give the range in which the overlap stays
    below contact.overlap_warning, no contact does positive work, and the outcome no longer depends on N_c. The dry
    design at the terminal speed stands beside it.

    Parameters
    ----------
    case : str
        A case file, or the name of a shipped case. Its time.step is not used.
    out : Path, optional
        The folder; ./NAME-tune when left out. Runs that are finished there are not made again.
    workers : int, optional
        Runs at once; one a processor when left out.
    set_ : tuple of str
        key=value, instead of what the case says; may be repeated.
    measure : str
        By what the time step is judged: a measure of the studies, such as kiss_time_s; the kiss time of a pair that
        kisses, the height of a rebound from a wall, or the settling speed before the first contact, when left out.
    tolerance : str
        Change of the measure to the finest time step that counts as none, such as "1 %".
    outcome : str
        By what N_c is judged; the start of tumbling, the height of the rebound or the mean settling speed when left
        out.
    outcome_tolerance : str, optional
        Difference of the outcome that counts as none. When left out one run is repeated from three other places in a
        cell, and differences within their spread, or within the tolerance, count as none.
    contact_steps : str
        N_c to try, such as "4,8,12"; 4,6,8,10,12,15,20 when left out.
    time_steps : str
        dt to try, such as "4 ms,2 ms,1 ms"; chosen by the flow when left out. One alone is taken.
    confirm : bool
        Run the chosen contact once more at twice the resolution, with the same stiffness and damping, and compare.
    json : bool
        Write JSON for machines.
    quick : bool
        A first look: four cells a diameter, fewer values, no repetition.
    quiet : bool
        Show no progress.

    Returns
    -------
    int
        0, or 1 where no range of N_c was found, or what was chosen does not hold at twice the resolution.

    Raises
    ------
    CaseError
        The case or an option is wrong, or nothing touches.
    """
    from rdpm.cli.progress import say
    from rdpm.cli.source import case_source
    from rdpm.config.load import case_name
    from rdpm.parallel.launcher import single
    from rdpm.studies.tuning.options import TuneOptions
    from rdpm.studies.tuning.tune import tune as run

    single("rdpm tune")  # shares nothing among ranks
    if workers is not None and not 1 <= workers <= 1024:
        raise CaseError("--workers", workers, "must lie between 1 and 1024")
    options = TuneOptions(
        measure=measure, outcome=outcome, tolerance=_quantity("--tolerance", tolerance),
        outcome_tolerance=None if outcome_tolerance is None else _quantity("--outcome-tolerance", outcome_tolerance),
        contact_steps=_list("--contact-steps", contact_steps), time_steps=_list("--time-steps", time_steps, "s"),
        quick=quick,
    )  # fmt: skip
    words = sys.argv[1:] if sys.argv[1:2] == ["tune"] else ["tune", case]
    command = shlex.join(["rdpm", *words])
    path = out or Path(f"{case_name(case)}-tune")
    source, _, note = case_source(case)
    if note and not quiet:
        say(note)
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        found = run(source, path, options, overrides=set_, workers=workers, quiet=quiet, command=command,
                    confirm=confirm)  # fmt: skip
    except KeyboardInterrupt:
        print(f"rdpm: interrupted. To continue: {command}", file=sys.stderr)
        return 130
    files = found.save()
    if json:
        import json as encoder

        print(encoder.dumps(found.to_dict(), indent=2, default=float))
    else:
        _show(found, files)
    holds = found.confirmation is None or found.confirmation.holds
    return 0 if found.window and holds else NO_RANGE


def _quantity(option: str, text: str, unit: str = "") -> float:
    from rdpm.config.rule import RuleError
    from rdpm.config.units import parse_quantity

    try:
        return parse_quantity(text, unit)
    except RuleError as error:
        raise CaseError(option, text, error.rule, error.reason, error.cure) from None


def _list(option: str, text: str, unit: str = "") -> tuple[float, ...]:
    return tuple(_quantity(option, item.strip(), unit) for item in text.split(",")) if text.strip() else ()


def _show(found: Tuning, files: list[Path]) -> None:
    from rich.console import Console

    console = Console(highlight=False, markup=False)
    width, console.width = console.width, max(console.width, 120)  # a row of the table stays on one line
    if found.step_rows:
        console.print(_step_table(found))
        console.print()
    console.print(_contact_table(found))
    console.print()
    if found.confirmation is not None:
        console.print(_confirmation_table(found.confirmation))
        console.print()
    console.width = width
    console.print(found.verdict())
    if found.window is not None:
        console.print(f"\nRun it with: rdpm run {found.case_file}")
    console.print(f"Written: {', '.join(str(path) for path in files)}")


def _table(title: str, headings: tuple[str, ...]) -> Any:
    from rich.table import Table

    table = Table(box=None, pad_edge=False, title=title, title_justify="left", title_style="bold")
    for n, heading in enumerate(headings):
        is_last = n == len(headings) - 1
        table.add_column(heading, justify="left" if is_last else "right", overflow="fold")
    return table


def _step_table(found: Tuning) -> Any:
    from rdpm.studies.tuning.choice import relative_changes

    changes = relative_changes(found.step_rows)
    table = _table("Time step", ("dt [ms]", found.seen.measure, "change [%]", ""))
    for row in found.step_rows:
        change = changes.get(row["dt_s"])
        note = "taken" if row["dt_s"] == found.step.dt_s else row["reason"] if row["status"] != "done" else ""
        table.add_row(
            f"{1e3 * row['dt_s']:.6g}", _number(row["value"]), "" if change is None else f"{100 * change:.2g}", note,
            style="bold" if note == "taken" else None,
        )  # fmt: skip
    return table


def _contact_table(found: Tuning) -> Any:
    headings = (
        "N_c", "t_c [ms]", "k_n [N/m]", "eta_n [N s/m]", "overlap [% d]", "dry [% d]", "work [-]", "v_n [m/s]",
        found.seen.outcome, "",
    )  # fmt: skip
    table = _table(f"Contact steps, {found.kind}", headings)
    for row in found.rows:
        is_chosen = row is found.chosen
        reason = found.reason(row)
        table.add_row(
            f"{row['contact_steps']:g}", _number(row["contact_time_s"], 1e3), _number(row["stiffness_N_m"]),
            _number(row["damping_N_s_m"]), _number(row["overlap_fraction"], 100.0, 3),
            _number(row["dry_overlap_fraction"], 100.0, 3), _number(row["work_fraction"], 1.0, 2),
            _number(row["max_impact_speed_m_s"], 1.0, 3), _number(row["outcome"]),
            "taken" if is_chosen else reason or "in range", style="bold" if is_chosen else "dim" if reason else None,
        )  # fmt: skip
    return table


def _confirmation_table(found: Confirmation) -> Any:
    from rdpm.studies.measures import QUANTITIES
    from rdpm.studies.tuning.confirm import COMPARED

    (coarse, fine), (long, short) = found.cells_per_diameter, found.dt_s
    table = _table(
        f"Confirmation: dt = {1e3 * long:.4g} ms and {1e3 * short:.4g} ms, contacts of the same length",
        ("", f"{coarse:g} cells a diameter", f"{fine:g} cells a diameter", "change [%]", ""),
    )
    for row in found.rows:
        name = row["quantity"]
        factor, unit = COMPARED.get(name, (1.0, QUANTITIES[name].unit if name in QUANTITIES else "-"))
        change = "-" if row["change"] is None else f"{100.0 * row['change']:.2g}"
        table.add_row(f"{name} [{unit}]", _number(row["coarse"], factor), _number(row["fine"], factor), change, "")
    return table


def _number(value: Any, factor: float = 1.0, digits: int = 4) -> str:
    return "-" if value is None else f"{factor * float(value):.{digits}g}"
