"""The results of a run as a table on the terminal."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console

__all__ = ["show_results"]

_MOST_BODIES = 8  # listed one by one


def show_results(summary: dict[str, Any], folder: Path, console: Console) -> None:
    """Print what a run found, and where to look further.

    Parameters
    ----------
    summary : dict
        What ``summary.json`` holds.
    folder : Path
        The run's.
    console : rich.console.Console
    """
    from rich.table import Table

    table = Table(
        title="Results", title_justify="left", title_style="bold", show_header=False, box=None, pad_edge=False
    )
    table.add_column()
    table.add_column(overflow="fold")
    for name, value in (*_bodies(summary), *_pair(summary), *_contacts(summary), *_cost(summary)):
        table.add_row(name, value)
    console.print(table)
    console.print(f"\nResults are in {folder}", markup=False, soft_wrap=True)
    opened = [
        ("report.html", "in a browser"),
        ("video.mp4", ""),
        ("fields.vtkhdf", "in ParaView"),
        ("bodies.vtkhdf", "in ParaView"),
    ]
    for name, where in opened:
        if (folder / name).is_file():
            console.print(f"  open {folder / name} {where}".rstrip(), markup=False, soft_wrap=True)


def _number(value: Any, unit: str = "", digits: int = 4) -> str:
    return f"{value:.{digits}g} {unit}".rstrip() if isinstance(value, int | float) else "-"


def _bodies(summary: dict[str, Any]) -> list[tuple[str, str]]:
    bodies = summary.get("bodies") or []
    if len(bodies) > _MOST_BODIES:
        fastest = max(bodies, key=lambda body: body.get("max_speed_m_s") or 0.0)
        return [
            (
                f"{len(bodies)} bodies",
                f"greatest speed {_number(fastest.get('max_speed_m_s'), 'm/s')}, of body {fastest.get('id')}",
            )
        ]
    return [
        (f"body {body.get('id')}", f"greatest speed {_number(body.get('max_speed_m_s'), 'm/s')}")
        for body in bodies
    ]


def _pair(summary: dict[str, Any]) -> list[tuple[str, str]]:
    pair = summary.get("dkt")
    if not pair:
        return []
    kiss = (
        "none"
        if pair.get("kiss_time_s") is None
        else (
            f"at {_number(pair['kiss_time_s'], 's')}, {pair.get('kisses')} in all, together "
            f"{_number(pair.get('kiss_duration_s'), 's')}"
        )
    )
    tumble = (
        "none"
        if pair.get("tumble_time_s") is None
        else f"past 45 degrees at {_number(pair['tumble_time_s'], 's')}"
    )
    return [("kissing", kiss), ("tumbling", tumble)]


def _contacts(summary: dict[str, Any]) -> list[tuple[str, str]]:
    law, found = summary.get("contact") or {}, summary.get("contacts") or {}
    rows = []
    if found:
        overlap = found.get("max_overlap_fraction")
        deepest = (
            f", greatest overlap {100 * overlap:.3g} % d"
            if overlap is not None and found.get("count")
            else ""
        )
        rows.append(("contacts", f"{found.get('count')}{deepest}"))
    rows += [
        (
            f"contact {pair.get('kind')}",
            f"k_n {_number(pair.get('stiffness_N_m'), 'N/m')}, eta_n "
            f"{_number(pair.get('damping_N_s_m'), 'N s/m')}",
        )
        for pair in law.get("pairs") or []
    ]
    return rows


def _cost(summary: dict[str, Any]) -> list[tuple[str, str]]:
    each = summary.get("ns_per_cell_step")
    cost = f", {_number(each, 'ns a cell and step', 3)}" if each else ""
    return [("wall time", f"{_number(summary.get('wall_s'), 's', 3)}{cost}")]
