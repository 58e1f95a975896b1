"""From any two things known of a contact to its stiffness and damping; from three to its mass as well."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

from rdpm.design._checks import Ending, check_ending, not_negative, positive
from rdpm.design.oscillator import (
    damping_ratio,
    dimensionless_contact_time,
    peak_overlap_factor,
    peak_time,
    restitution,
)
from rdpm.design.soft_sphere import contact_parameters, damping_from_stiffness, stiffness_from_overlap
from rdpm.errors import CaseError

__all__ = ["Known", "solve_contact"]


class Known(NamedTuple):
    """What is known of a contact; None where it is sought."""

    mass: float | None = None
    """Reduced mass [kg]."""
    stiffness: float | None = None
    """[N/m]."""
    damping: float | None = None
    """[N s/m]."""
    restitution: float | None = None
    """Dry, normal [-]."""
    contact_time: float | None = None
    """Touch to end [s]."""
    overlap_time: float | None = None
    """Peak overlap over impact speed [s]."""


_WORDS = {
    "mass": "mass",
    "stiffness": "stiffness",
    "damping": "damping",
    "restitution": "restitution",
    "contact_time": "contact time (or contact_steps with time_step)",
    "overlap_time": "overlap limit at an impact speed",
}


def solve_contact(known: Known, ending: Ending = "zero-force") -> tuple[float, float, float]:
    r"""Stiffness and damping from two known quantities and the mass, or all three from three without it.

    Parameters
    ----------
    known : Known
        Mass [kg] and two of stiffness [N/m], damping [N s/m], restitution [-], contact_time [s],
        overlap_time [s] (peak overlap over impact speed); or, without the mass, restitution with two
        of stiffness, damping and contact_time. Quantities > 0; damping may be 0, restitution is in (0, 1].
    ending : {"zero-force", "zero-overlap"}
        When the contact is over.

    Returns
    -------
    reduced_mass : float, [kg]
    stiffness : float, [N/m]
    damping : float, [N s/m]

    Raises
    ------
    CaseError
        Too little or too much is known, the message naming it; or no contact fits what is known.

    Examples
    --------
    >>> m, k_n, eta_n = solve_contact(Known(mass=1e-3, stiffness=100.0, contact_time=0.0101), "zero-overlap")
    >>> round(eta_n, 3)
    0.114
    """
    check_ending(ending)
    for name, value in known._asdict().items():
        if value is not None:
            (not_negative if name in ("damping", "restitution") else positive)(name, value)
    given = tuple(n for n in Known._fields[1:] if getattr(known, n) is not None)
    needed = 2 if known.mass is not None else 3
    if len(given) != needed:
        _refuse_count(given, needed)
    if known.mass is None:
        return _with_mass(known, given, ending)
    k_n, eta_n = _PAIRS[given](known, known.mass, ending)
    return float(known.mass), float(k_n), float(eta_n)


def _refuse_count(given: tuple[str, ...], needed: int) -> None:
    """Name what is missing or too much."""
    have = ", ".join(_WORDS[n] for n in given) or "nothing"
    if len(given) > needed:
        rule = (
            f"must be {needed} quantities beside the mass" if needed == 2 else "must be three without a mass"
        )
        reason = f"the rest follows from {needed}, so more contradict each other"
        raise CaseError("contact", f"{{{have}}}", rule, reason, "Take one away.")
    rest = " or ".join(_WORDS[n] for n in _WORDS if n not in given and (n != "mass" or needed == 3))
    what = "two quantities" if needed == 2 else "a mass and two quantities"
    reason = f"{needed - len(given)} more is missing"
    raise CaseError("contact", f"{{{have}}}", f"must be given by {what}", reason, f"Add {rest}.")


def _with_mass(known: Known, given: tuple[str, ...], ending: Ending) -> tuple[float, float, float]:
    """Give mass, stiffness and damping from three of stiffness, damping, restitution, contact time."""
    k, eta, e, t_c = known.stiffness, known.damping, known.restitution, known.contact_time
    if known.overlap_time is not None or e is None:
        reason = "more than one mass, or none, may fit these three"
        cure = "Give the mass, or restitution with two of stiffness, damping and contact time."
        raise CaseError("mass", None, "must be given", reason, cure)
    zeta = float(damping_ratio(e, ending))
    if eta is not None and not (zeta > 0.0 and eta > 0.0):
        reason = "restitution 1 and damping 0 say the same"
        raise CaseError(
            "damping", f"{eta:g}", "must be above 0, with a restitution below 1", reason, "Give the mass."
        )
    if k is not None and eta is not None:
        return (0.5 * eta / zeta) ** 2 / k, k, eta
    assert t_c is not None
    tau = float(dimensionless_contact_time(zeta, ending))
    if not math.isfinite(tau):
        raise CaseError(
            "restitution", f"{e:g}", "must be above 0 when a contact time is given", "it never ends"
        )
    if k is not None:
        m = k * (t_c / tau) ** 2
        return m, k, float(damping_from_stiffness(m, e, k, ending))
    assert eta is not None
    m = 0.5 * eta * t_c / (zeta * tau)
    return m, m * (tau / t_c) ** 2, eta


def _root(function: Callable[[float], float], target: float, what: str, reason: str) -> float:
    """Find the damping ratio where an increasing function of it meets a target (bisection)."""
    least = function(0.0)
    if abs(target - least) <= 1e-12 * abs(least):
        return 0.0
    low, high = math.log(1e-16), math.log(1e9)
    if not function(math.exp(low)) < target < function(math.exp(high)):
        raise CaseError("contact", what, "fits no damping", reason, "Change one of the two.")
    while high - low > 1e-16 * max(1.0, abs(low)):
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        low, high = (middle, high) if function(math.exp(middle)) < target else (low, middle)
    return math.exp(0.5 * (low + high))


def _of(value: float | None) -> float:
    """Give a known value; the table below asks only for what is given."""
    assert value is not None
    return float(value)


def _by_stiffness_and_time(q: Known, m: float, ending: Ending) -> tuple[float, float]:
    k, t_c = _of(q.stiffness), _of(q.contact_time)
    tau = t_c * math.sqrt(k / m)
    what = f"contact time {t_c:g} s with stiffness {k:g} N/m"
    half = f"without damping it lasts {math.pi * math.sqrt(m / k):g} s, and damping only"
    if ending == "zero-overlap":
        if tau < math.pi * (1.0 - 1e-12):
            reason = f"{half} lengthens it"
            raise CaseError("contact", what, "fits no damping", reason, "Change one of the two.")
        zeta = math.sqrt(max(0.0, 1.0 - (math.pi / tau) ** 2))
    else:
        zeta = _root(lambda z: -2.0 * float(peak_time(z)), -tau, what, f"{half} shortens it")
    return k, 2.0 * zeta * math.sqrt(k * m)


def _by_stiffness_and_overlap(q: Known, m: float, ending: Ending) -> tuple[float, float]:
    k, s = _of(q.stiffness), _of(q.overlap_time)
    factor = s * math.sqrt(k / m)
    if factor > 1.0 + 1e-12:
        what = f"overlap per speed {s:g} s with stiffness {k:g} N/m"
        reason = f"without damping it is {math.sqrt(m / k):g} s already"
        raise CaseError("contact", what, "fits no damping", reason, "Lower the overlap or the stiffness.")
    # the zero-force restitution is the square of the peak-overlap factor
    return k, 2.0 * float(damping_ratio(min(1.0, factor) ** 2, "zero-force")) * math.sqrt(k * m)


def _by_damping_and_restitution(q: Known, m: float, ending: Ending) -> tuple[float, float]:
    eta, zeta = _of(q.damping), float(damping_ratio(_of(q.restitution), ending))
    if not (eta > 0.0 and zeta > 0.0):
        reason = "restitution 1 is damping 0 at any stiffness"
        cure = "Give the stiffness or the contact time instead of the damping."
        raise CaseError("damping", f"{eta:g}", "must be above 0, with a restitution below 1", reason, cure)
    return (0.5 * eta / zeta) ** 2 / m, eta


def _by_damping_and_time(q: Known, m: float, ending: Ending) -> tuple[float, float]:
    eta, t_c = _of(q.damping), _of(q.contact_time)
    # eta = -2 m ln(e)/t_c for both endings
    k_n, _ = contact_parameters(m, math.exp(-0.5 * eta * t_c / m), t_c, ending)
    return float(k_n), eta


def _by_damping_and_overlap(q: Known, m: float, ending: Ending) -> tuple[float, float]:
    eta, s = _of(q.damping), _of(q.overlap_time)
    if eta == 0.0:
        return m / s**2, 0.0
    what = f"overlap per speed {s:g} s with damping {eta:g} N s/m"
    reason = f"this damping alone stops the sphere within {m / eta:g} s times its speed"
    zeta = _root(lambda z: z * float(peak_overlap_factor(z)), 0.5 * eta * s / m, what, reason)
    return (0.5 * eta / zeta) ** 2 / m, eta


def _by_time_and_overlap(q: Known, m: float, ending: Ending) -> tuple[float, float]:
    t_c, s = _of(q.contact_time), _of(q.overlap_time)

    def ratio(zeta: float) -> float:
        return float(dimensionless_contact_time(zeta, ending)) / float(peak_overlap_factor(zeta))

    what = f"contact time {t_c:g} s with overlap per speed {s:g} s"
    zeta = _root(ratio, t_c / s, what, f"their ratio is pi without damping, more with; here {t_c / s:g}")
    k_n, eta_n = contact_parameters(m, restitution(zeta, ending), t_c, ending)
    return float(k_n), float(eta_n)


_PAIRS: dict[tuple[str, ...], Callable[[Known, float, Ending], tuple[float, float]]] = {
    ("stiffness", "damping"): lambda q, m, end: (_of(q.stiffness), _of(q.damping)),
    ("stiffness", "restitution"): lambda q, m, end: (
        _of(q.stiffness),
        float(damping_from_stiffness(m, _of(q.restitution), _of(q.stiffness), end)),
    ),
    ("stiffness", "contact_time"): _by_stiffness_and_time,
    ("stiffness", "overlap_time"): _by_stiffness_and_overlap,
    ("damping", "restitution"): _by_damping_and_restitution,
    ("damping", "contact_time"): _by_damping_and_time,
    ("damping", "overlap_time"): _by_damping_and_overlap,
    ("restitution", "contact_time"): lambda q, m, end: contact_parameters(
        m, _of(q.restitution), _of(q.contact_time), end
    ),
    ("restitution", "overlap_time"): lambda q, m, end: stiffness_from_overlap(
        m, _of(q.restitution), _of(q.overlap_time), 1.0, end
    ),
    ("contact_time", "overlap_time"): _by_time_and_overlap,
}
