"""What a run is warned of: by its plan before it starts, and by what then happened."""

from __future__ import annotations

from rdpm.parallel.threads import processors
from rdpm.results.summary import ContactTotals
from rdpm.results.warnings import RunWarning, each_once
from rdpm.setup import Plan

__all__ = ["crowded", "happened", "planned"]

_STIFFEN = "stiffen the contact (fewer contact_steps, or a shorter time.step)"
_CURES = {
    "regime": "lower contact.damping",
    "contact_steps": "raise contact.contact_steps, or lower time.step",
    "max_overlap": _STIFFEN,
    "static_overlap": _STIFFEN,
    "hertz_contact_time": "soften the contact: more contact_steps",
    "rayleigh_time": "soften the contact: more contact_steps",
}


def planned(plan: Plan) -> tuple[RunWarning, ...]:
    """What a plan warns of, each once.

    Examples
    --------
    >>> import rdpm, rdpm.setup
    >>> case = rdpm.load_case("settling", ["contact.overlap_warning=0.005"])
    >>> print(planned(rdpm.setup.plan(case))[0])
    overlap 2.5 % d > 0.5 % (at 9.44 cm/s): stiffen the contact (fewer contact_steps, or a shorter time.step)
    """
    found = []
    for _, rows in plan.sections:
        for row in rows:
            if row.verdict == "warning" and row.name in _CURES:
                found.append(RunWarning.from_verdict(row.note, _CURES[row.name]))
            elif row.verdict == "warning":
                found.append(RunWarning(row.name, row.value, cure=row.note))
    return each_once(found)


def crowded(threads: int) -> tuple[RunWarning, ...]:
    """Whether more threads than processors were asked for.

    Examples
    --------
    >>> crowded(1)
    ()
    """
    if threads <= processors():
        return ()
    limit = f"{processors()} processors here"
    return (RunWarning("threads", str(threads), ">", limit, "they slow each other", "leave --threads out"),)


def happened(contacts: ContactTotals, plan: Plan) -> tuple[RunWarning, ...]:
    """Where what happened lies outside what was designed.

    Parameters
    ----------
    contacts : ContactTotals
    plan : Plan
    """
    found = []
    overlap, limit = contacts.max_overlap_fraction or 0.0, plan.case.contact.overlap_warning
    reached = f"{100 * overlap:.3g} % d"
    if overlap > limit:
        found.append(RunWarning("largest overlap", reached, ">", f"{100 * limit:.3g} %", "of the run", _STIFFEN))
    designed = max((pair.design.max_overlap_fraction or 0.0 for pair in plan.pairs), default=0.0)
    if 0.0 < designed < overlap:
        expected = f"{100 * designed:.3g} %, the design's at the bodies' own speed"
        cause = "several bodies pressed together, or an impact was faster"
        found.append(RunWarning("largest overlap", reached, ">", expected, cause, _STIFFEN))
    if contacts.capped:
        most, cure = plan.case.contact.most_events, "raise contact.most_events, or contact.rest_speed"
        came = f"{contacts.capped} contacts of hard spheres came to rest"
        found.append(RunWarning(came, "", ">", f"{most} events of a pair in a step", "contact.most_events", cure))
    return tuple(found)
