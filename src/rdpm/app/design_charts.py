"""The charts of the design page: one spring among its neighbours."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np

from rdpm.app.curves import chart_of, line, mark, points
from rdpm.design import Design, largest_contact_time, produced_restitution
from rdpm.design._checks import Ending
from rdpm.design.approaches import graphical

__all__ = ["CHARTS", "draw"]

_K = "stiffness k_n [N/m]"
_SCHEMES = {
    "explicit-euler": "explicit Euler",
    "semi-implicit-euler": "semi-implicit Euler",
    "velocity-verlet": "velocity Verlet",
}
_STEPS = (4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 15.0, 20.0, 30.0, 50.0)


def _stiffness(design: Design) -> Any:
    return _decades(design.stiffness_N_m, 3)


def _decades(middle: float, around: int) -> Any:
    """Whole decades around a value."""
    power = round(math.log10(middle))
    return np.logspace(power - around, power + around, 25)


def damping(design: Design) -> dict[str, Any]:
    """Damping that gives a restitution."""
    k, lines = _stiffness(design), []
    for n, e in enumerate((0.1, 0.3, 0.5, 0.7, 0.9)):
        found = graphical(design.reduced_mass_kg, e, k, [1.0], design.ending)
        lines.append(line(f"e_n = {e:g}", found.stiffness, found.damping, n))
    lines.append(line("critical", found.stiffness, found.critical_damping, 5, color="#7a7a7a", width=3, type="solid"))
    own = mark(design.stiffness_N_m, design.damping_N_s_m or None)
    return chart_of("Damping that gives a restitution", _K, "damping eta_n [N s/m]", [*lines, own], "xy", (k[0], k[-1]))


def contact_time(design: Design) -> dict[str, Any]:
    """Contact time of a spring, and the limits that its materials set."""
    k, lines = _stiffness(design), []
    for n, e in enumerate((0.1, 0.5, 0.9)):
        found = graphical(design.reduced_mass_kg, e, k, [1.0], design.ending)
        lines.append(line(f"e_n = {e:g}", found.stiffness, found.contact_time, n))
    if design.hertz_contact_time_s is not None:
        lines.append(line("Hertz: no shorter", k[[0, -1]], [design.hertz_contact_time_s] * 2, 5))
    longest = design.advice.longest_contact_time_s
    if longest is not None:
        lines.append(line("overlap: no longer", k[[0, -1]], [longest] * 2, 3))
    own = mark(design.stiffness_N_m, design.contact_time_s)
    return chart_of("Contact time of a spring", _K, "contact time t_c [s]", [*lines, own], "xy", (k[0], k[-1]))


def time_step(design: Design) -> dict[str, Any]:
    """Time step that resolves a spring."""
    k = _stiffness(design)
    found = graphical(design.reduced_mass_kg, design.restitution or 0.9, k, [1.0], design.ending)
    lines = [line(f"N_c = {n:g}", k, found.contact_time / n, i) for i, n in enumerate((4, 8, 15, 50))]
    own = mark(design.stiffness_N_m, design.time_step_s)
    title = f"Time step that resolves a spring (e_n = {design.restitution or 0.9:.3g})"
    return chart_of(title, _K, "time step dt [s]", [*lines, own], "xy", (k[0], k[-1]))


def limits(design: Design) -> dict[str, Any]:
    """Contact steps that keep to the limits, over the impact speed."""
    step, d, e = design.time_step_s, design.diameter_m, design.restitution
    if step is None or d is None or not e:
        return chart_of("Contact steps that keep to the limits: needs a diameter, a time step, a restitution",
                        "impact speed [m/s]", "contact steps N_c", [])  # fmt: skip
    speed = design.impact_speed_m_s or 0.1
    v = _decades(speed, 2)
    most = largest_contact_time(e, design.overlap_limit_fraction * d, v, design.ending) / step
    lines = [line(f"no more: overlap {100 * design.overlap_limit_fraction:g} % d", v, most, 0),
             line("no fewer: resolution", v[[0, -1]], [4.0, 4.0], 2)]  # fmt: skip
    if design.hertz_contact_time_s is not None and design.impact_speed_m_s is not None:
        lines.append(line("no fewer: Hertz", v, design.hertz_contact_time_s * (v / speed) ** -0.2 / step, 6))
    own = mark(design.impact_speed_m_s, design.contact_steps)
    title = f"Contact steps that keep to the limits (dt = {1e3 * step:.3g} ms)"
    return chart_of(title, "impact speed [m/s]", "contact steps N_c", [*lines, own], "xy", (v[0], v[-1]))


def produced(design: Design) -> dict[str, Any]:
    """What the integrators of other codes make of the restitution."""
    title, y = "Restitution that other integrators produce", "restitution produced [-]"
    if not design.restitution:
        return chart_of(f"{title}: needs a restitution above 0", "contact steps N_c", y, [])
    lines: list[dict[str, Any]] = []
    for n, (scheme, name) in enumerate(_SCHEMES.items()):
        found = _produced(round(design.restitution, 6), scheme, design.ending)
        lines.append(line(name, _STEPS, [one[0] for one in found], n))
        band = ([one[at] for one in found] for at in (1, 2))
        lines += [line("least and greatest", _STEPS, edge, n, width=0.8, type="dotted") for edge in band]
    lines.append(line("target, and exact (rdpm)", (_STEPS[0], _STEPS[-1]), [design.restitution] * 2, 6))
    steps = design.contact_steps
    inside = steps is not None and _STEPS[0] <= steps <= _STEPS[-1]
    return chart_of(title, "contact steps N_c", y, [*lines, mark(steps if inside else None, design.restitution)], "x",
                    (_STEPS[0], _STEPS[-1]), (0.0, 1.5))  # fmt: skip


@lru_cache(maxsize=512)
def _produced(restitution: float, scheme: str, ending: Ending) -> tuple[tuple[float, float, float], ...]:
    found = (produced_restitution(restitution, n, scheme, ending, phases=20) for n in _STEPS)
    return tuple((p.mean, p.least, p.greatest) if math.isfinite(p.mean) else (math.nan,) * 3 for p in found)


#: Name on the tab, and what draws it.
CHARTS: dict[str, tuple[str, Callable[[Design], dict[str, Any]]]] = {
    "damping": ("Damping", damping),
    "contact-time": ("Contact time", contact_time),
    "time-step": ("Time step", time_step),
    "limits": ("Limits", limits),
    "produced": ("Other integrators", produced),
}


def draw(name: str, design: Design | None) -> dict[str, Any]:
    """Draw one of `CHARTS`; an empty one where there is no design.

    Examples
    --------
    >>> from rdpm.design import soft_sphere
    >>> len(draw("damping", soft_sphere(mass=1e-3, restitution=0.8, stiffness=1e2))["series"])
    7
    """
    title, make = CHARTS[name]
    if design is None:
        return chart_of(f"{title}: no design", "", "", [points("", [], [])])
    return make(design)
