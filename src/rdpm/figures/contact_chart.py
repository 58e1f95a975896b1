"""The contacts of a run: overlap and restitution of each, beside what was designed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rdpm.figures.marks import mark_level
from rdpm.figures.style import OWN, PALETTE, column_chart

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from rdpm.results.summary import ContactDesign

__all__ = ["contact_chart"]

_MARKERS = ("o", "s", "D", "^", "v")
_SOME = 100   # contacts up to which each has a large mark and a stem
_TOP = 1.3   # restitution above which a contact is counted, not drawn


def contact_chart(
    contacts: Mapping[str, NDArray[Any]], pressed: NDArray[np.bool_], design: ContactDesign
) -> Figure:
    """Largest overlap of each contact against time, and restitution of each impact against its Stokes number.

    Without a fluid the restitution is drawn against the impact speed; without an impact it is left out. Hard spheres do
    not overlap.

    Parameters
    ----------
    contacts : mapping of ndarray
        Columns of ``contacts.csv``.
    pressed : ndarray of bool
        Which are no impacts.
    design : ContactDesign
        Marked: the target restitution, the overlap of a dry impact at the bodies' own speed, and the limit of the case.

    Returns
    -------
    matplotlib.figure.Figure
    """
    is_impact = ~pressed & np.isfinite(contacts["restitution"])
    overlaps = bool((np.nan_to_num(contacts["max_overlap_fraction"]) > 0.0).any())
    count = max(1, int(overlaps) + int(is_impact.any()))
    title = "Contacts" if is_impact.any() else "Contacts: all pressed, none is an impact"
    with column_chart(title, 1.0 + 1.75 * count) as figure:
        panels = list(figure.subplots(count, 1, squeeze=False)[:, 0])
        kinds = np.unique(contacts["kind"])
        if overlaps or not is_impact.any():
            _overlaps(panels[0], contacts, kinds, design)
        if is_impact.any():
            _restitutions(panels[-1], {k: v[is_impact] for k, v in contacts.items()}, kinds, design)
    return figure


def _dots(n: int, count: int) -> dict[str, Any]:
    size = 3.5 if count <= _SOME else 1.6
    return {"marker": _MARKERS[n % 5], "ls": "", "ms": size, "color": PALETTE[n % 7], "alpha": 0.8, "mew": 0}


def _overlaps(axes: Axes, contacts: Mapping[str, NDArray[Any]], kinds: NDArray[Any], design: ContactDesign) -> None:
    for n, kind in enumerate(kinds):
        rows = contacts["kind"] == kind
        overlap = 100.0 * contacts["max_overlap_fraction"][rows]
        if len(rows) <= _SOME:
            axes.vlines(contacts["start_s"][rows], 0.0, overlap, color=PALETTE[n % 7], alpha=0.4, linewidth=0.7)
        axes.plot(contacts["start_s"][rows], overlap, label=str(kind), **_dots(n, len(rows)))
    levels = {}
    expected = [pair.max_overlap_fraction for pair in design.pairs if pair.max_overlap_fraction]
    if expected:
        levels[100.0 * max(expected)] = f"{OWN}, dry: {100.0 * max(expected):.3g}"
    if design.overlap_warning is not None:
        at, name = 100.0 * design.overlap_warning, f"limit: {100.0 * design.overlap_warning:.3g}"
        close = next((level for level in levels if abs(level / at - 1.0) < 0.15), None)
        levels[at] = name if close is None else f"{levels.pop(close)}; {name}"
    largest = 100.0 * float(np.nanmax(contacts["max_overlap_fraction"], initial=0.0))
    above = [at for at in levels if at > 12.0 * largest]   # they would flatten the rest
    for at, name in levels.items():
        if at not in above:
            mark_level(axes, at, name)
    axes.set(xlabel="start of the contact [s]", ylabel="largest overlap [% d]")
    axes.set_ylim(0.0, 1.25 * max([largest, *(at for at in levels if at not in above)], default=1.0) or 1.0)


def _restitutions(axes: Axes, impacts: Mapping[str, NDArray[Any]], kinds: NDArray[Any], design: ContactDesign) -> None:
    has_fluid = bool(np.isfinite(impacts["stokes_number"]).any())
    where = impacts["stokes_number"] if has_fluid else impacts["impact_speed_m_s"]
    for n, kind in enumerate(kinds):
        rows = impacts["kind"] == kind
        axes.plot(where[rows], impacts["restitution"][rows], label=str(kind), **_dots(n, len(rows)))
    if design.restitution is not None:
        mark_level(axes, design.restitution, f"{OWN}: {design.restitution:.3g}{' (dry)' if has_fluid else ''}")
    axes.set(xlabel="Stokes number at impact" if has_fluid else "impact speed [m/s]", ylabel="restitution achieved")
    above = int((impacts["restitution"] > _TOP).sum())
    axes.set_ylim(0.0, _TOP if above else max(1.12, 1.05 * float(impacts["restitution"].max())))
    if above:
        axes.set_title(f"{above} of {len(where)} above {_TOP:g}: another force acted", loc="right", pad=2)
    known = where[np.isfinite(where) & (where > 0.0)]
    if known.size and known.max() > 30.0 * known.min():
        axes.set_xscale("log")
