"""Which time step and how many contact steps: of a spring that is given, or of one that follows from them."""

from __future__ import annotations

import math

from rdpm.design.result import Advice
from rdpm.design.verdicts import LEAST_CONTACT_STEPS, MOST_CONTACT_STEPS
from rdpm.design.wording import time_text

__all__ = ["BEST_CONTACT_STEPS", "advise_on_spring", "advise_on_steps"]

BEST_CONTACT_STEPS = 8
"""Time steps a contact of a given spring should last in rdpm; it locates touch and end inside a step."""

_NEAR = 1e-9  # round-off of a design that sits on a limit


def advise_on_steps(
    *,
    shortest: float | None,
    longest: float | None,
    time_step: float,
    contact_steps: float,
    asks: str = "Hertz",
    decides: str = "the overlap",
) -> Advice:
    """Turn bounds on the contact time into contact steps and a time step, where the spring follows from these.

    Parameters
    ----------
    shortest : float or None, [s]
        Of the real material.
    longest : float or None, [s]
        By the overlap limits; None where no impact speed or load is known.
    time_step : float, [s]
    contact_steps : float, [-]
        Of the design itself.
    asks : str
        Which bound the shortest is: Hertz or Rayleigh.
    decides : str
        Which bound the longest is.

    Returns
    -------
    Advice
        The best contact steps are the most that the limits allow, up to 15.

    Examples
    --------
    >>> advise_on_steps(shortest=None, longest=8.5e-3, time_step=1e-3, contact_steps=10.0).best_contact_steps
    8
    """
    least, most = LEAST_CONTACT_STEPS, MOST_CONTACT_STEPS
    if longest is None:
        text = "Give a diameter and an impact speed (or a fluid): nothing bounds the overlap yet."
        return Advice(shortest, None, None, None, None, None, time_step, text)
    at_most, at_design = longest / least, longest / contact_steps
    if shortest is not None and shortest > longest:
        return Advice(
            shortest, longest, None, None, at_most, at_design, None, _no_contact(shortest, asks, longest, decides)
        )
    low = max(least, math.ceil((shortest or 0.0) / time_step * (1.0 - _NEAR)))
    high = math.floor(longest / time_step * (1.0 + _NEAR))
    ends = f" Of the upper limits {decides} decides."
    if high < low:
        text = f"No N_c keeps to all limits at dt = {time_text(time_step)}: lower it to {time_text(at_most)} or less"
        text += f" ({least} contact steps)"
        fits = contact_steps > least and (shortest or 0.0) <= contact_steps * at_design * (1.0 + _NEAR)
        text += f"; at these {contact_steps:g}, to {time_text(at_design)}." if fits else "."
        return Advice(
            shortest, longest, None, None, at_most, at_design, min(at_most, at_design), text + ends
        )
    best = max(low, min(high, most))
    text = f"N_c from {low} to {high} keeps to all limits at dt = {time_text(time_step)}; {best} is best: "
    text += f"the softest allowed, up to {most} where more gains nothing." if high > most else (
        "the softest allowed, best resolved in time.")  # fmt: skip
    return Advice(shortest, longest, (low, high), best, at_most, at_design, time_step, text + ends)


def advise_on_spring(
    *,
    stiffness: float,
    contact_time: float | None,
    shortest: float | None,
    longest: float | None,
    time_step: float | None,
    contact_steps: float | None,
    asks: str = "Hertz",
    decides: str = "the overlap",
) -> Advice:
    """Turn the contact time of a given spring into a time step, and say which springs keep to the limits.

    Parameters
    ----------
    stiffness : float, [N/m]
    contact_time : float or None, [s]
        None where the contact never ends.
    shortest, longest : float or None, [s]
        Bounds on the contact time, as for :func:`advise_on_steps`.
    time_step : float or None, [s]
    contact_steps : float or None, [-]
        Of the design itself.
    asks, decides : str
        Which bound the shortest, the longest is.

    Returns
    -------
    Advice
        No time step in it is above a quarter of the contact time.

    Examples
    --------
    >>> a = advise_on_spring(stiffness=1e5, contact_time=8e-6, shortest=None, longest=None, time_step=None,
    ...                      contact_steps=None)
    >>> a.time_step_s, a.largest_time_step_s, a.text
    (1e-06, 2e-06, 'For this spring take dt = 1 us (8 contact steps), at most 2 us (4).')
    """
    least = LEAST_CONTACT_STEPS
    if contact_time is None:
        text = "This contact never ends, so that no time step resolves it: lower the damping."
        return Advice(shortest, longest, None, None, None, None, None, text)
    at_most = contact_time / least
    is_resolved = contact_steps is not None and contact_steps >= least * (1.0 - _NEAR)
    best, step = BEST_CONTACT_STEPS, contact_time / BEST_CONTACT_STEPS
    if contact_steps is not None and time_step is not None and is_resolved:
        best, step = math.floor(contact_steps * (1.0 + _NEAR)), time_step
        text = f"dt = {time_text(step)} resolves this spring by {contact_steps:.3g} steps;"
        text += f" at most {time_text(at_most)} ({least})."
    else:
        text = f"For this spring take dt = {time_text(step)} ({best} contact steps),"
        text += f" at most {time_text(at_most)} ({least})."
    text += _springs(stiffness, contact_time, (shortest, asks), (longest, decides))
    at_design = None if contact_steps is None else contact_time / contact_steps
    return Advice(shortest, longest, None, best, at_most, at_design, step, text)


def _no_contact(shortest: float, asks: str, longest: float, decides: str) -> str:
    """Say that the limits leave no room, and which two collide."""
    return (
        f"No contact keeps to all limits: {asks} asks {time_text(shortest)} at least, "
        f"{decides} allows {time_text(longest)}."
    )


def _springs(
    stiffness: float, contact_time: float, lower: tuple[float | None, str], upper: tuple[float | None, str]
) -> str:
    """Say which springs keep to the limits at this damping ratio, where this one does not or need not be so stiff."""
    (shortest, asks), (longest, decides) = lower, upper
    if shortest is not None and longest is not None and shortest > longest:
        return " " + _no_contact(shortest, asks, longest, decides)
    if longest is not None and contact_time > longest * (1.0 + _NEAR):
        return f" It is too soft: {decides} asks k_n of at least {stiffness * (contact_time / longest) ** 2:.3g} N/m."
    if shortest is not None and contact_time < shortest * (1.0 - _NEAR):
        return f" It is too stiff: {asks} allows k_n of at most {stiffness * (contact_time / shortest) ** 2:.3g} N/m."
    if longest is not None and contact_time < 0.5 * longest:
        softest = stiffness * (contact_time / longest) ** 2
        return f" Any k_n from {softest:.3g} N/m on keeps to {decides}: a softer spring allows longer steps."
    return ""
