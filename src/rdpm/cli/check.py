"""``rdpm check``: what a case implies, before it is run."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from rdpm.cli.source import case_source

if TYPE_CHECKING:
    from rich.console import Console

    from rdpm.setup.plan import Plan
    from rdpm.setup.rank_plan import RanksPlan

__all__ = ["check", "show_plan"]

_COLOURS = {"ok": "green", "warning": "yellow"}


def check(
    case: str,
    /,
    *,
    set_: Annotated[tuple[str, ...], Parameter(name="--set", negative="", show_default=False)] = (),
    ranks: Annotated[int, Parameter(show_default=False)] = 0,
    threads: Annotated[int, Parameter(show_default=False)] = 1,
    json: Annotated[bool, Parameter(negative="", show_default=False)] = False,
) -> None:
    """Show what a case implies: grid, numbers, time step, contacts, memory, time; with verdicts.

    Parameters
    ----------
    case : str
        A case file, the name of a shipped case, or the folder of a run. A file NAME.toml here goes before the shipped
        case NAME.
    set_ : tuple of str
        key=value, instead of what the case says; may be repeated.
    ranks : int
        What it implies on so many MPI ranks: planes, memory and messages of each, and how well they work together.
    threads : int
        Of each rank, for the estimate of their time.
    json : bool
        Write JSON for machines.

    Raises
    ------
    CaseError
        The case is wrong.
    """
    from rdpm.config.load import load_case

    source, _, note = case_source(case)
    if note:
        print(note, file=sys.stderr)
    loaded = load_case(source, set_)
    from rdpm.setup import plan  # a case that is wrong is told before the solver is loaded

    planned, of_ranks = plan(loaded, machines=ranks) if ranks else plan(loaded), None
    if ranks:
        of_ranks = _on_ranks(planned, ranks, threads)
    if json:
        import json as encoder

        added = {"on_ranks": of_ranks.to_dict()} if of_ranks else {}
        print(encoder.dumps(planned.to_dict() | added, indent=2))
        return
    from rich.console import Console

    if of_ranks:
        planned.sections.append((f"{ranks} MPI ranks", of_ranks.rows()))
    show_plan(planned, Console(highlight=False, markup=False))


def _on_ranks(planned: Plan, ranks: int, threads: int) -> RanksPlan:
    """What it implies on several ranks, with the speed of this machine."""
    from rdpm.parallel.threads import processors
    from rdpm.setup.cell_speed import measured_ns
    from rdpm.setup.rank_plan import plan_ranks

    plan_ranks(planned, ranks, threads)  # refuses what cannot run
    return plan_ranks(planned, ranks, threads, measured_ns(planned, min(processors(), ranks * threads)))


def show_plan(plan: Any, console: Console) -> None:
    """Print a plan as tables, one a section.

    Parameters
    ----------
    plan : rdpm.setup.Plan
    console : rich.console.Console
    """
    from rich.table import Table

    from rdpm.design.wording import said

    for title, rows in plan.sections:
        table = Table(
            title=title, title_justify="left", title_style="bold", show_header=False, box=None, pad_edge=False
        )
        for _ in range(4):
            table.add_column(overflow="fold")
        for row in rows:
            if not row.severity:
                table.add_row(row.name, row.value, row.verdict, row.note, style=_COLOURS.get(row.verdict))
        console.print(table)
        for row in rows:
            if row.severity:
                console.print(said(row.severity, row.note), style=_COLOURS.get(row.verdict), soft_wrap=True)
        console.print()
