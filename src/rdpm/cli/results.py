"""The results of a run as a table on the terminal."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console

    from rdpm.results.summary import Summary

__all__ = ["show_results"]

_MOST_BODIES = 8  # listed one by one


def show_results(summary: Summary, folder: Path, console: Console) -> None:
    """Print what a run found, and where to look further.

    Parameters
    ----------
    summary : Summary
    folder : Path
        The run's.
    console : rich.console.Console
    """
    from rich.table import Table

    from rdpm.results.run_folder import RunFolder

    table = Table(
        title="Results", title_justify="left", title_style="bold", show_header=False, box=None, pad_edge=False
    )
    table.add_column()
    table.add_column(overflow="fold")
    for name, value in (*_bodies(summary), *_pair(summary), *_contacts(summary), *_cost(summary)):
        table.add_row(name, value)
    console.print(table)
    console.print(f"\nResults are in {folder}", markup=False, soft_wrap=True)
    files = RunFolder(folder)
    opened = [(files.report, "in a browser"), (files.video, ""), (files.fields, "in ParaView")]
    for path, where in (*opened, (files.bodies, "in ParaView"), (files.walls, "in ParaView")):
        if path.is_file():
            console.print(f"  open {path} {where}".rstrip(), markup=False, soft_wrap=True)


def _number(value: float | None, unit: str = "", digits: int = 4) -> str:
    return "-" if value is None else f"{value:.{digits}g} {unit}".rstrip()


def _bodies(summary: Summary) -> list[tuple[str, str]]:
    bodies = summary.bodies
    if len(bodies) > _MOST_BODIES:
        fastest = max(bodies, key=lambda body: body.max_speed_m_s or 0.0)
        return [
            (f"{len(bodies)} bodies", f"greatest speed {_number(fastest.max_speed_m_s, 'm/s')}, of body {fastest.id}")
        ]
    return [(f"body {body.id}", f"greatest speed {_number(body.max_speed_m_s, 'm/s')}") for body in bodies]


def _pair(summary: Summary) -> list[tuple[str, str]]:
    pair = summary.dkt
    if pair is None:
        return []
    kiss = tumble = "none"
    if pair.kiss_time_s is not None:
        together = _number(pair.kiss_duration_s, "s")
        kiss = f"at {_number(pair.kiss_time_s, 's')}, {pair.kisses} in all, together {together}"
    if pair.tumble_time_s is not None:
        tumble = f"past 45 degrees at {_number(pair.tumble_time_s, 's')}"
    return [("kissing", kiss), ("tumbling", tumble)]


def _contacts(summary: Summary) -> list[tuple[str, str]]:
    found, deepest = summary.contacts, ""
    if found.count and found.max_overlap_fraction is not None:
        deepest = f", greatest overlap {100 * found.max_overlap_fraction:.3g} % d"
    rows = [("contacts", f"{found.count}{deepest}")]
    if found.pressed:
        rows.append(("of them pressed", str(found.pressed)))
    if found.outside:
        why = ", ".join(f"{reason} {count}" for reason, count in found.outside_reasons.items())
        rows.append(("outside the promised range", f"{found.outside}: {why}"))
    rows += [
        (
            f"contact {pair.kind}",
            f"k_n {_number(pair.stiffness_N_m, 'N/m')}, eta_n {_number(pair.damping_N_s_m, 'N s/m')}",
        )
        for pair in summary.contact.pairs
        if pair.stiffness_N_m is not None
    ]
    return rows


def _cost(summary: Summary) -> list[tuple[str, str]]:
    each = summary.ns_per_cell_step
    cost = f", {_number(each, 'ns a cell and step', 3)}" if each else ""
    return [("wall time", f"{_number(summary.wall_s, 's', 3)}{cost}")]
