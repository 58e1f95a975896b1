"""The contacts of a run in a report: what was designed beside what was achieved, for each kind and each model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from rdpm.figures import page
from rdpm.results.contacts import LEAST_STOKES, MOST_CONTACT_TIMES, NOT_OUTSIDE, RESTITUTION_TOLERANCE, count_reasons
from rdpm.results.run import Run
from rdpm.results.summary import ContactDesign, PairDesign

__all__ = ["contact_parts", "number_text", "range_text"]

_PRESSED = (
    f"A contact is pressed where a flow or a load holds the bodies together: its Stokes number is below "
    f"{LEAST_STOKES:g}, or it lasts longer than {MOST_CONTACT_TIMES:g} contact times. It is no impact: it has no "
    "restitution, and its time and steps have no target."
)
_OUTSIDE = (
    f"Promised are: an overlap below the limit, 4 steps, and the restitution to {RESTITUTION_TOLERANCE:g} (in a fluid: "
    "no more than it). Fast impact: it alone does that at its speed. Pushed: another force acted during the impact: "
    "another body, the flow, or the weight in a slow one. The column outside of contacts.csv has it for each contact."
)
_TOUCHED = "Promised is that the force keeps surfaces apart: each of these touched. Raise its stiffness, or its range."
_WET = "The target restitution is that of a dry contact; in a fluid it falls with the Stokes number."
_LAWS = {
    "soft-sphere": "a linear spring and dashpot", "hertz": "Hertz's spring, damped",
    "hard-sphere": "impulses without overlap", "repulsive": "a short-range force that keeps surfaces apart",
}  # fmt: skip
Line = tuple[str, str, str]


def number_text(value: Any, unit: str = "", factor: float = 1.0) -> str:
    """Say a value, four digits of it; a dash where there is none.

    Examples
    --------
    >>> number_text(0.012345, "ms", 1e3), number_text(12000), number_text(None)
    ('12.35 ms', '12 000', '–')
    """
    if value is None:
        return "–"
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return str(value)
    is_count = isinstance(value, int) and factor == 1.0
    number = f"{value:,}".replace(",", " ") if is_count else f"{factor * value:.4g}"
    return f"{number} {unit}".rstrip()


def range_text(values: Any, unit: str = "", factor: float = 1.0) -> str:
    """One value, or the smallest to the largest of those that are known.

    Examples
    --------
    >>> range_text([0.1, None, 0.3], "m/s"), range_text([])
    ('0.1 to 0.3 m/s', '–')
    """
    known = np.array([v for v in values if v is not None], np.float64)
    known = factor * known[np.isfinite(known)]
    if known.size == 0:
        return "–"
    low, high = f"{known.min():.3g}", f"{known.max():.3g}"
    return f"{low if low == high else f'{low} to {high}'} {unit}".rstrip()


def contact_parts(run: Run) -> list[str]:
    """What was designed beside what was achieved, a table for each kind of contact; then what left the promised range.

    Parameters
    ----------
    run : Run

    Returns
    -------
    list of str
        HTML.
    """
    design, rows = run.summary.contact, run.contacts
    kinds = {pair.kind.split(" ")[0] for pair in design.pairs}
    kinds |= set(rows["kind"].tolist()) if rows else set()
    parts = []
    if design.model:
        ends = f", ending at {design.ending.replace('-', ' ')}" if design.ending else ""
        law = f"Law: {design.model}, {_LAWS.get(design.model, '')}{ends}."
        parts.append(page.paragraph(f"{law} {_WET if run.case.get('fluid') and design.restitution else ''}".rstrip()))
    for kind in sorted(kinds):
        pairs = [pair for pair in design.pairs if pair.kind.split(" ")[0] == kind]
        of_kind = rows["kind"] == kind if rows else None
        found = {name: column[of_kind] for name, column in rows.items()} if rows else {}
        if rows:
            found["pressed"] = run.pressed[of_kind]
        verdicts = "\n".join(dict.fromkeys(verdict for pair in pairs for verdict in pair.verdicts))
        judged = page.folded("Verdicts on the design", verdicts) if verdicts else ""
        parts.append(page.section(kind, [_table(run, pairs, found), judged], level=3))
    return [*parts, *_outside_parts(run)]


def _outside_parts(run: Run) -> list[str]:
    """How many contacts left the range that the design promises, and why."""
    if run.contacts is None or not run.summary.contact.model:
        return []
    outside = run.outside
    count = int((outside != NOT_OUTSIDE).sum())
    if not count:
        return [page.section("Outside the promised range", [page.paragraph("No contact.")], level=3)]
    kind = run.contacts["kind"]
    lines = [
        (reason, *(str(sum(reason in text.split("; ") for text in outside[kind == name])) for name in np.unique(kind)))
        for reason in count_reasons(outside)
    ]
    told = page.paragraph(f"{count} of {len(outside)} contacts.")
    meaning = _TOUCHED if run.summary.contact.model == "repulsive" else _OUTSIDE
    table = page.table(lines, ("what (why)", *map(str, np.unique(kind))))
    return [page.section("Outside the promised range", [told, table, page.paragraph(meaning, soft=True)], level=3)]


def _table(run: Run, pairs: Sequence[PairDesign], found: dict[str, Any]) -> str:
    design = run.summary.contact
    pressed = found["pressed"] if found else np.zeros(0, bool)
    is_repulsive = design.model == "repulsive"
    lines: list[Line] = [("touches" if is_repulsive else "impacts", "", str(int((~pressed).sum())))]
    lines += _hard_sphere_lines(run, found) if design.model == "hard-sphere" else _lasting_lines(design, pairs, found)
    lines += [
        ("impact speed", _designed_speed(pairs), range_text(found.get("impact_speed_m_s", []), "m/s")),
        ("Stokes number", "", range_text(found.get("stokes_number", []))),
        ("work of the contact force", "0" if is_repulsive else "≤ 0", range_text(found.get("work_J", []), "J")),
        *_designed_lines(pairs),
    ]
    note = page.paragraph(_PRESSED, soft=True) if pressed.any() else ""
    return page.table([line for line in lines if set(line[1:]) - {"", "–"}], ("", "design", "achieved")) + note


def _designed_speed(pairs: Sequence[PairDesign]) -> str:
    known = [pair.impact_speed_m_s for pair in pairs if pair.impact_speed_m_s is not None]
    return range_text(known, "m/s") if known else ""


def _hard_sphere_lines(run: Run, found: dict[str, Any]) -> list[Line]:
    """Of an impulse: neither time, nor steps, nor overlap."""
    design, totals = run.summary.contact, run.summary.contacts
    return [
        ("restitution", number_text(design.restitution), range_text(found.get("restitution", []))),
        ("rest speed", number_text(design.rest_speed_m_s, "m/s"), ""),
        ("came to rest, all kinds", "", number_text(totals.came_to_rest) if totals.came_to_rest else ""),
        ("of them by the most events of a step", "", number_text(totals.capped) if totals.capped else ""),
    ]


def _lasting_lines(design: ContactDesign, pairs: Sequence[PairDesign], found: dict[str, Any]) -> list[Line]:
    """Of a force that lasts: its time and steps, the overlap, and of an impact the restitution."""
    pressed = found["pressed"] if found else np.zeros(0, bool)
    impacts = {name: column[~pressed] for name, column in found.items()}
    held = {name: column[pressed] for name, column in found.items()}
    steps = [pair.contact_time_s / design.contact_time_s * design.contact_steps
             for pair in pairs if pair.contact_time_s and design.contact_time_s and design.contact_steps]  # fmt: skip
    expected = range_text([pair.max_overlap_fraction for pair in pairs], "% d", 100.0)
    overlaps = [] if expected == "–" else [f"{expected} in a dry impact at the impact speed"]
    if design.overlap_warning is not None:
        overlaps.append(f"warned of above {100 * design.overlap_warning:.3g} % d")
    is_repulsive = design.model == "repulsive"
    time, count = ("repulsion time", "steps in it") if is_repulsive else ("contact time", "steps in a contact")
    restitutions = [pair.restitution for pair in pairs] or [design.restitution]
    times = range_text([pair.contact_time_s for pair in pairs], "ms", 1e3)
    if is_repulsive:   # what lasts is the force; a touch is a part of it that should not be
        impacts = {}
    lines: list[Line] = [
        ("restitution", range_text(restitutions), range_text(impacts.get("restitution", []))),
        (time, times, range_text(impacts.get("duration_s", []), "ms", 1e3)),
        (count, range_text(steps), range_text(impacts.get("steps", []))),
    ]
    if pressed.any():
        lines += [
            ("pressed contacts", "", str(int(pressed.sum()))),
            ("time of a pressed contact", "", range_text(held["duration_s"], "s")),
            ("steps of a pressed contact", "", range_text(held["steps"])),
        ]
    deepest = range_text(found.get("max_overlap_fraction", []), "% d", 100.0)
    lines.append(("largest overlap", "; ".join(overlaps), deepest))
    return lines[1:] if is_repulsive else lines


def _designed_lines(pairs: Sequence[PairDesign]) -> list[Line]:
    """The parameters of the model; those told already are left out."""
    told = {"restitution, dry", "contact time", "contact steps", "time step", "impact speed", "approach speed",
            "peak overlap", "repulsion time", "steps in it", "reduced mass"}  # fmt: skip
    lines: list[Line] = [
        ("stiffness k_n", range_text([pair.stiffness_N_m for pair in pairs], "N/m"), ""),
        ("damping η_n", range_text([pair.damping_N_s_m for pair in pairs], "N s/m"), ""),
    ]
    for one in pairs[0].quantities if pairs else ():
        if one.name not in told:
            values = [q.value for pair in pairs for q in pair.quantities if q.name == one.name]
            lines.append((one.name, range_text(values, one.unit), ""))
    return [*lines, ("reduced mass", range_text([pair.reduced_mass_kg for pair in pairs], "kg"), "")]
