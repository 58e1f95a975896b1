"""What a run is warned of: by its plan before it starts, and by what then happened."""

from __future__ import annotations

from rdpm.config.contact import Way
from rdpm.parallel.threads import processors
from rdpm.results.summary import ContactTotals
from rdpm.results.warnings import RunWarning, each_once
from rdpm.setup import Plan

__all__ = ["crowded", "happened", "planned"]

# What keeps a contact from sinking in, by the way its parameters are given.
_STIFFEN: dict[Way, str] = {
    "contact-steps": "stiffen the contact (fewer contact_steps, or a shorter time.step)",
    "stiffness-damping": "raise contact.stiffness",
    "stiffness-restitution": "raise contact.stiffness",
    "max-overlap": "raise contact.impact_speed, or lower contact.max_overlap",
    "material": "raise contact.youngs_modulus",
    "impulses": "lower time.step",
    "repulsion": "raise contact.repulsion_stiffness, or contact.repulsion_range",
}
_RESOLVE: dict[Way, str] = {
    "contact-steps": "raise contact.contact_steps",
    "stiffness-damping": "lower time.step, or contact.stiffness",
    "stiffness-restitution": "lower time.step, or contact.stiffness",
    "max-overlap": "lower time.step",
    "material": "lower time.step, or contact.youngs_modulus",
    "repulsion": "lower time.step",
}
_SOFTEN: dict[Way, str] = {
    "contact-steps": "soften the contact: more contact_steps",
    "stiffness-damping": "lower contact.stiffness",
    "stiffness-restitution": "lower contact.stiffness",
    "max-overlap": "lower contact.impact_speed",
    "material": "lower contact.youngs_modulus",
}


def _cure(name: str, way: Way) -> str:
    """What to change, of the keys that the case has."""
    if name == "regime":
        return "lower contact.damping" if way == "stiffness-damping" else "raise contact.restitution"
    if name == "contact_steps":
        return _RESOLVE.get(way, "")
    if name in ("hertz_contact_time", "rayleigh_time"):
        return _SOFTEN.get(way, "")
    return _STIFFEN[way]


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
            if row.verdict == "warning" and row.severity:
                found.append(RunWarning.from_verdict(row.note, _cure(row.name, plan.case.contact.way)))
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
    found, stiffen = [], _STIFFEN[plan.case.contact.way]
    overlap, limit = contacts.max_overlap_fraction or 0.0, plan.case.contact.overlap_warning
    reached = f"{100 * overlap:.3g} % d"
    if overlap > limit:
        found.append(RunWarning("largest overlap", reached, ">", f"{100 * limit:.3g} %", "of the run", stiffen))
    designed = max((pair.design.max_overlap_fraction or 0.0 for pair in plan.pairs), default=0.0)
    if 0.0 < designed < overlap:
        expected = f"{100 * designed:.3g} %, the design's at the bodies' own speed"
        cause = "several bodies pressed together, or an impact was faster"
        found.append(RunWarning("largest overlap", reached, ">", expected, cause, stiffen))
    if contacts.capped:
        most, cure = plan.case.contact.most_events, "raise contact.most_events, or contact.rest_speed"
        came = f"{contacts.capped} contacts of hard spheres came to rest"
        found.append(RunWarning(came, "", ">", f"{most} events of a pair in a step", "contact.most_events", cure))
    return tuple(found)
