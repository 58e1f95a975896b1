"""The time step of a case: automatic, adaptive, or the one asked for where its limits allow it."""

from __future__ import annotations

import math
from dataclasses import replace

from rdpm.config.case import Case
from rdpm.design.verdicts import LEAST_CONTACT_STEPS
from rdpm.errors import CaseError
from rdpm.fluid.timestep import Choice, advective_limit, choose_step

__all__ = ["time_step"]

Spacing = tuple[float, float, float]


def time_step(
    case: Case,
    spacing: Spacing | None,
    speed: tuple[float, float, float],
    contact: float,
    contact_step: float | None = None,
) -> Choice:
    """Choose the time step of a case, or take the one it asks for.

    Parameters
    ----------
    case : Case
    spacing : tuple of float, (3,), [m]
        Of the grid; None for a dry case.
    speed : tuple of float, (3,), [m/s]
        Largest expected along each direction.
    contact : float, [s]
        Limit by the contacts.
    contact_step : float, optional, [s]
        Step with which a run began that automatic steps now continue.

    Returns
    -------
    Choice

    Raises
    ------
    CaseError
        The step asked for is above a limit of the flow, or of contacts whose stiffness is given: nothing that a user
        wrote is replaced.
    """
    if not isinstance(case.time.step, str):
        _check_contact(case, case.time.step, contact)
    if spacing is None or case.fluid is None:
        return _dry(case, contact)
    asked = case.time.step
    if not isinstance(asked, str):
        return _asked(case, spacing, speed, asked)
    advective = advective_limit(spacing, speed, case.time.cfl)
    limits = {"advective": advective, "contact": contact, "output": case.time.end}
    choice = choose_step(spacing, case.fluid.nu, case.time.diffusion, limits)
    choice = replace(choice, dt=contact_step or _to_end(case.time.end, choice.dt))
    return choice if asked == "auto" else _adaptive(case, spacing, choice, limits)


def _dry(case: Case, contact: float) -> Choice:
    asked = case.time.step
    if isinstance(asked, str):
        return Choice(_to_end(case.time.end, contact), "contact", True, 0, {"contact": contact})
    return Choice(asked, "user", True, 0, {"contact": contact})


def _check_contact(case: Case, asked: float, contact: float) -> None:
    """Refuse a step in which a contact of given stiffness has too few steps."""
    if case.contact.way == "contact-steps" or asked <= contact * (1.0 + 1e-9):
        return
    raise CaseError(
        "time.step",
        f"{asked:g} s",
        f"must be at most {contact:.3g} s",
        f"the shortest contact of this stiffness lasts {LEAST_CONTACT_STEPS * contact:.3g} s "
        f"and needs {LEAST_CONTACT_STEPS} steps",
        'Lower it, use "auto", or give a softer contact.',
    )


def _asked(case: Case, spacing: Spacing, speed: tuple[float, float, float], dt: float) -> Choice:
    """The step asked for, within the limits of the flow."""
    assert case.fluid is not None
    # A step that is asked for may use the whole cell that time.cfl keeps a share of.
    hardest = advective_limit(spacing, speed, 1.0)
    limits = {"user": dt, "advective": hardest}
    if dt > hardest * (1.0 + 1e-9):
        raise CaseError(
            "time.step",
            f"{dt:g} s",
            f"must be at most {hardest:.3g} s",
            "the flow would cross more than a cell in a step",
            'Lower it, or use "auto".',
        )
    choice = choose_step(spacing, case.fluid.nu, case.time.diffusion, limits)
    if choice.dt < dt * (1.0 - 1e-9) and case.time.diffusion == "auto":
        choice = choose_step(spacing, case.fluid.nu, "stabilised", limits)
    if choice.dt < dt * (1.0 - 1e-9):
        raise CaseError(
            "time.step",
            f"{dt:g} s",
            f"must be at most {choice.dt:.3g} s",
            f"the limit of {'explicit' if choice.is_explicit else 'stabilised'} diffusion on this grid",
            'Lower it, or set time.diffusion = "auto".' if case.time.diffusion == "explicit" else "Lower it.",
        )
    return Choice(dt, "user", choice.is_explicit, choice.stages, choice.limits)


def _adaptive(case: Case, spacing: Spacing, contact: Choice, limits: dict[str, float]) -> Choice:
    """Steps from that of `contact` to the longest that all limits but the contact's allow; diffusion is made for it."""
    assert case.fluid is not None
    others = {name: limit for name, limit in limits.items() if name != "contact"}
    wide = choose_step(spacing, case.fluid.nu, case.time.diffusion, others)
    limits = contact.limits | {"viscous": wide.limits["viscous"]}
    return Choice(contact.dt, contact.limit, wide.is_explicit, wide.stages, limits, max(wide.dt, contact.dt))


def _to_end(end: float, dt: float) -> float:
    """The longest step not above dt of which a whole number ends at the end."""
    return end / math.ceil(end / dt - 1e-9)
