"""A design as a table people read: quantity, value, unit, and how it came about.

Written from the plain form of a design (:meth:`rdpm.design.Design.to_dict`, the JSON output), so that a
stored one reads the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, Protocol, TypeAlias

from rdpm.design.wording import said

__all__ = ["Row", "Units", "render", "render_rows", "rows"]

Row: TypeAlias = tuple[str, float | None, str, str]
"""Quantity, value (None where unknown), unit, note."""

Units: TypeAlias = Literal["si", "cgs"]

# kind: (unit, factor from SI) in each system
_KINDS = {
    "stiffness": {"si": ("N/m", 1.0), "cgs": ("dyn/cm", 1e3)},
    "damping": {"si": ("N s/m", 1.0), "cgs": ("dyn s/cm", 1e3)},
    "mass": {"si": ("kg", 1.0), "cgs": ("g", 1e3)},
    "length": {"si": ("m", 1.0), "cgs": ("cm", 1e2)},
    "speed": {"si": ("m/s", 1.0), "cgs": ("cm/s", 1e2)},
    "time": {"si": ("s", 1.0), "cgs": ("s", 1.0)},
    "number": {"si": ("", 1.0), "cgs": ("", 1.0)},
    "percent": {"si": ("% d", 100.0), "cgs": ("% d", 100.0)},
}

_TABLE = (
    ("reduced mass", "reduced_mass_kg", "mass", "m_ij = (1/m_i + 1/m_j)^-1"),
    ("normal stiffness", "stiffness_N_m", "stiffness", "k_n"),
    ("normal damping", "damping_N_s_m", "damping", "eta_n"),
    ("damping ratio", "damping_ratio", "number", "zeta = eta_n/(2 sqrt(m_ij k_n))"),
    ("restitution, dry", "restitution", "number", "e_n, in exact time"),
    ("contact time", "contact_time_s", "time", "t_c, touch to end"),
    ("contact steps", "contact_steps", "number", "N_c = t_c/dt"),
    ("time step", "time_step_s", "time", "dt"),
    ("impact speed", "impact_speed_m_s", "speed", "v"),
    ("peak overlap", "max_overlap_m", "length", "at the impact speed"),
    ("peak overlap", "max_overlap_fraction", "percent", "of the smaller diameter"),
    ("static overlap", "static_overlap_fraction", "percent", "under the submerged weight"),
    ("Hertz contact time", "hertz_contact_time_s", "time", "of the real material at v"),
    ("Rayleigh time", "rayleigh_time_s", "time", "of its surface waves"),
    ("terminal velocity", "terminal_velocity_m_s", "speed", "Brown, Lawler 2003"),
    ("terminal Reynolds number", "terminal_reynolds_number", "number", "Brown, Lawler 2003"),
    ("Stokes number", "stokes_number", "number", "m_ij v/(6 pi mu a_ij^2)"),
    ("restitution, wet", "wet_restitution", "number", "Legendre et al. 2005, a correlation"),
)
_TANGENTIAL = (
    ("tangential stiffness", "stiffness_N_m", "stiffness", "k_t"),
    ("tangential damping", "damping_N_s_m", "damping", "eta_t, same damping ratio"),
    ("tangential restitution", "restitution", "number", "e_t of a sticking impact"),
    ("sliding from v_t/v_n", "sliding_ratio", "number", "7/2 mu (1 + e_n)/(1 + e_t)"),
)


def rows(design: dict[str, Any], units: Units = "si") -> list[tuple[str, float | None, str, str]]:
    """List quantity, value (None where undefined), unit and note.

    Parameters
    ----------
    design : dict
        From :meth:`rdpm.design.Design.to_dict`.
    units : {"si", "cgs"}

    Returns
    -------
    list of (str, float or None, str, str)
        Essentials always, the rest only where known.

    Examples
    --------
    >>> from rdpm.design import soft_sphere
    >>> rows(soft_sphere(mass=1e-3, stiffness=100.0, damping=0.1).to_dict(), "cgs")[1][:3]
    ('normal stiffness', 100000.0, 'dyn/cm')
    """
    out = []
    for record, table in ((design, _TABLE), (design["tangential"], _TANGENTIAL)):
        for word, name, kind, note in table:
            value = record[name]
            if value is None and name not in ("restitution", "contact_time_s"):
                continue
            unit, factor = _KINDS[kind][units]
            how = design["impact_speed_source"] or note if name == "impact_speed_m_s" else note
            out.append((word, None if value is None else value * factor, unit, how))
    return out


def render(design: dict[str, Any], units: Units = "si") -> str:
    """Write a design as text.

    Parameters
    ----------
    design : dict
        From :meth:`rdpm.design.Design.to_dict`.
    units : {"si", "cgs"}

    Returns
    -------
    str
        Quantities, verdicts with reasons and sources, what integrators produce, advice.

    Examples
    --------
    >>> from rdpm.design import soft_sphere
    >>> print(render(soft_sphere(mass=1e-3, stiffness=100.0, damping=0.1).to_dict()).splitlines()[0])
    Soft-sphere contact, underdamped, ending at zero-force
    """
    out = [f"Soft-sphere contact, {design['regime']}, ending at {design['ending']}", ""]
    for word, value, unit, note in rows(design, units):
        number = "undefined" if value is None else f"{value:.6g}"
        out.append(f"  {word:<26}{number:>12} {unit:<9} {note}")
    out += ["", "Verdicts"]
    for v in design["verdicts"]:
        out.append("  " + said(v["severity"], v["text"]))
        if v["severity"] != "ok":
            why = "" if v["reason"] in v["text"] else f"{v['reason']}; "
            out.append(f"       {why}{v['source']}")
    if design["predictions"]:
        out += ["", "Restitution achieved without sub-steps (mean, least to greatest over the phase)"]
        for p in design["predictions"]:
            least, greatest = p["least"], p["greatest"]
            shown = [f"{q:.4f}" if q is not None else "never parts" for q in (p["mean"], least, greatest)]
            out.append(f"  {p['integrator']:<22}{shown[0]:>8}   {shown[1]} to {shown[2]}")
    return "\n".join([*out, "", f"Advice: {design['advice']['text']}"])


class _Verdict(Protocol):
    @property
    def severity(self) -> str: ...

    @property
    def reason(self) -> str: ...

    @property
    def source(self) -> str: ...


def render_rows(title: str, lines: Sequence[Row], verdicts: Sequence[_Verdict]) -> str:
    """Write rows and verdicts as text; what is unknown is left out.

    Parameters
    ----------
    title : str
    lines : sequence of Row
    verdicts : sequence of Verdict
        ``str`` gives a line each.

    Returns
    -------
    str

    Examples
    --------
    >>> print(render_rows("Contact", [("contact time", 1e-3, "s", "t_c")], []).splitlines()[2])
      contact time                    0.001 s          t_c
    """
    known = [row for row in lines if row[1] is not None]
    out = [title, "", *(f"  {word:<26}{value:>12.6g} {unit:<10} {note}" for word, value, unit, note in known)]
    out += ["", "Verdicts"]
    for verdict in verdicts:
        out.append(f"  {verdict}")
        if verdict.severity != "ok":
            out.append(f"       {verdict.reason}; {verdict.source}")
    return "\n".join(out)
