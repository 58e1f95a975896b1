"""The restitution an integrator really produces when a contact lasts a few steps."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from rdpm.design._checks import Ending, check_ending, positive, restitution_in_range
from rdpm.design.oscillator import damping_ratio, dimensionless_contact_time
from rdpm.errors import CaseError

__all__ = ["INTEGRATORS", "ProducedRestitution", "fewest_steps", "produced_restitution"]

Force = Callable[[Any, Any], Any]
Step = Callable[[Any, Any, float, Force], tuple[Any, Any]]


class ProducedRestitution(NamedTuple):
    """Mean, least and greatest restitution over the phases of the first step [-]."""

    mean: float
    least: float
    greatest: float


def _explicit_euler(x: Any, v: Any, dt: float, force: Force) -> tuple[Any, Any]:
    return x + dt * v, v + dt * force(x, v)


def _semi_implicit_euler(x: Any, v: Any, dt: float, force: Force) -> tuple[Any, Any]:
    v = v + dt * force(x, v)
    return x + dt * v, v


def _velocity_verlet(x: Any, v: Any, dt: float, force: Force) -> tuple[Any, Any]:
    half = v + 0.5 * dt * force(x, v)
    x = x + dt * half
    return x, half + 0.5 * dt * force(x, half)


_STEPS: dict[str, Step] = {
    "explicit-euler": _explicit_euler,
    "semi-implicit-euler": _semi_implicit_euler,
    "velocity-verlet": _velocity_verlet,
}
INTEGRATORS = (*_STEPS, "exact")
"""Names :func:`produced_restitution` knows."""


def produced_restitution(
    restitution: float,
    contact_steps: float,
    integrator: str,
    ending: Ending = "zero-overlap",
    phases: int = 40,
) -> ProducedRestitution:
    r"""Restitution that comes out of a time-stepped contact designed for another.

    Parameters
    ----------
    restitution : float, [-]
        Restitution designed; 0 < e_n <= 1.
    contact_steps : float, [-]
        :math:`N_c=t_c/\delta t`, need not be whole. > 1.
    integrator : {"explicit-euler", "semi-implicit-euler", "velocity-verlet", "exact"}
        Without sub-steps. Velocity Verlet takes the damping force at the start of a step and at its
        half-step velocity; codes that keep the latter for the next step (LAMMPS) are semi-implicit Euler.
        ``"exact"`` is the oscillator itself, entry and end located inside the step.
    ending : {"zero-force", "zero-overlap"}
        At ``"zero-force"`` an attractive force is cut off at every evaluation.
    phases : int, [-]
        Touch falls on this many evenly spread moments of the first step. >= 1.

    Returns
    -------
    ProducedRestitution
        ``mean``, ``least`` and ``greatest`` [-]; inf where the spheres never part (unstable).

    Raises
    ------
    CaseError
        An argument outside its range.

    Notes
    -----
    One dry pair without gravity; a fluid or a third body is not covered.

    References
    ----------
    .. [1] The schemes: Hairer, Lubich, Wanner, Geometric Numerical Integration (2006), ch. I.

    Examples
    --------
    >>> round(produced_restitution(0.5, 8, "explicit-euler").mean, 3)
    0.936
    """
    check_ending(ending)
    e = restitution_in_range(restitution, ending)
    n_c = float(positive("contact_steps", contact_steps))
    if not n_c > 1.0 or not e > 0.0:
        name, value = ("contact_steps", n_c) if e > 0.0 else ("restitution", 0.0)
        rule = f"must be above {int(e > 0.0)}"
        raise CaseError(name, f"{value:g}", rule, "there is no contact to step through", "Raise it.")
    if integrator == "exact":
        return ProducedRestitution(float(e), float(e), float(e))
    if integrator not in _STEPS:
        names = ", ".join(INTEGRATORS)
        raise CaseError("integrator", repr(integrator), f"must be one of {names}", cure="Name one of these.")
    zeta = float(damping_ratio(e, ending))
    out = _rebounds(_STEPS[integrator], n_c, zeta, ending, (np.arange(phases) + 0.5) / phases)
    return ProducedRestitution(float(out.mean()), float(out.min()), float(out.max()))


_LADDER = (20, 25, 30, 40, 50, 60, 80, 100, 125, 150, 200, 250, 300, 400, 500, 600, 800, 1000)
_CLOSE = 0.01  # of the approach speed
_CLOSE_RELATIVE = 0.1  # of a small restitution


@lru_cache(maxsize=256)
def fewest_steps(restitution: float, integrator: str, ending: Ending = "zero-overlap") -> int:
    r"""Fewest contact steps with which an integrator keeps to a restitution, wherever in a step the touch falls.

    Parameters
    ----------
    restitution : float, [-]
        0 < e_n <= 1.
    integrator : str
        As for :func:`produced_restitution`.
    ending : {"zero-force", "zero-overlap"}

    Returns
    -------
    int, [-]
        From 20 to 1000: the restitution achieved is within 0.01, and within 10 % of itself.

    Raises
    ------
    CaseError
        An argument outside its range.

    Examples
    --------
    >>> fewest_steps(0.5, "semi-implicit-euler"), fewest_steps(0.97, "semi-implicit-euler")
    (40, 20)
    """
    allowed = min(_CLOSE, _CLOSE_RELATIVE * restitution)
    for steps in _LADDER:
        found = produced_restitution(restitution, steps, integrator, ending)
        if max(found.greatest - restitution, restitution - found.least) <= allowed:
            return steps
    return _LADDER[-1]


def _rebounds(step: Step, n_c: float, zeta: float, ending: Ending, phase: Any) -> Any:
    """Step contacts (time in 1/omega_0, approach speed 1) touching ``phase`` steps on; give -v at the end."""
    cut = ending == "zero-force"
    dt = float(dimensionless_contact_time(zeta, ending)) / n_c

    def force(x: Any, v: Any) -> Any:
        pull = x + 2.0 * zeta * v
        return np.where(x > 0.0, -(np.maximum(pull, 0.0) if cut else pull), 0.0)

    x, v = -phase * dt, np.ones_like(phase)
    rebound = np.full_like(phase, np.inf)
    touched = np.zeros(phase.shape, dtype=bool)
    for _ in range(math.ceil(20.0 * n_c) + 100):
        x, v = step(x, v, dt, force)
        touched |= x > 0.0
        gone = touched & ((x <= 0.0) | ((v < 0.0) & (force(x, v) == 0.0)))
        rebound[gone & np.isinf(rebound)] = -v[gone & np.isinf(rebound)]
        if np.all(np.isfinite(rebound)):
            break
    return rebound
