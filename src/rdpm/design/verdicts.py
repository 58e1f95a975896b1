"""Limits a contact must keep to, each with its reason and source."""

from __future__ import annotations

from rdpm.conventions import OVERLAP_WARNING
from rdpm.design._checks import Ending
from rdpm.design.dimensionless import CRITICAL_STOKES
from rdpm.design.result import Severity, Verdict
from rdpm.design.wording import percent_text, speed_text, time_text

__all__ = ["LEAST_CONTACT_STEPS", "MOST_CONTACT_STEPS", "USUAL_OVERLAP", "failed_names", "regime_of", "verdict_list"]

LEAST_CONTACT_STEPS = 4
"""Fewest time steps a contact may last: below, the fluid sees the rebound as a jump."""

MOST_CONTACT_STEPS = 15
"""Upper end of the window of the scheme's authors; more steps only soften the contact."""

USUAL_OVERLAP = OVERLAP_WARNING
"""Largest overlap of a soft sphere that does not disturb the flow [of the diameter]."""

_MUSONG = "Musong, Feng, Michaelides, NETL Multiphase Flow Conf. (2012)"
_REGIMES = {
    ("underdamped", "zero-force"): "the sphere rebounds",
    ("underdamped", "zero-overlap"): "the sphere rebounds; the force is attractive before the end",
    ("critical", "zero-force"): "no overshoot; e_n = exp(-2)",
    ("critical", "zero-overlap"): "e_n = 0 and the contact lasts for ever: no contact time",
    ("overdamped", "zero-force"): "no e_n or t_c at zero overlap; those given are of zero force",
    ("overdamped", "zero-overlap"): "no rebound: neither e_n nor contact time exists. Lower the damping",
}


def regime_of(damping_ratio: float) -> str:
    """Name the regime; critical means zeta = 1 to round-off.

    Examples
    --------
    >>> regime_of(0.2), regime_of(1.0), regime_of(1.6)
    ('underdamped', 'critical', 'overdamped')
    """
    if abs(damping_ratio - 1.0) < 1e-12:
        return "critical"
    return "underdamped" if damping_ratio < 1.0 else "overdamped"


def failed_names(verdicts: tuple[Verdict, ...]) -> list[str]:
    """Name the verdicts that are not ok.

    Examples
    --------
    >>> failed_names((Verdict("regime", 1.6, 1.0, False, "overdamped", "", "fail", ""),))
    ['regime']
    """
    return [v.name for v in verdicts if not v.ok]


def verdict_list(
    *,
    damping_ratio: float,
    ending: Ending,
    contact_time: float | None,
    contact_steps: float | None,
    max_overlap: float | None,
    static_overlap: float | None,
    overlap_limit: float,
    hertz_time: float | None,
    rayleigh_time: float | None,
    stokes_number: float | None,
    impact_speed: float | None = None,
) -> tuple[Verdict, ...]:
    """Judge what is known; a limit whose quantity is unknown is left out.

    Parameters
    ----------
    damping_ratio : float, [-]
    ending : {"zero-force", "zero-overlap"}
    contact_time, hertz_time, rayleigh_time : float or None, [s]
    contact_steps, stokes_number : float or None, [-]
    max_overlap, static_overlap : float or None, [-]
        Of the smaller diameter.
    overlap_limit : float, [-]
        Of the smaller diameter. Where it is above the usual 0.5 %, an overlap between the two is a note.
    impact_speed : float or None, [m/s]
        For the text alone.

    Returns
    -------
    tuple of Verdict

    Examples
    --------
    >>> for v in verdict_list(damping_ratio=1.59, ending="zero-overlap", contact_time=None, contact_steps=3.0,
    ...     max_overlap=0.0131, static_overlap=None, overlap_limit=0.005, hertz_time=None, rayleigh_time=None,
    ...     stokes_number=3.0, impact_speed=0.041):
    ...     print(v)
    FAIL damping ratio 1.59 > 1 (overdamped: no rebound: neither e_n nor contact time exists. Lower the damping)
    FAIL contact resolved by 3 steps < 4
    FAIL overlap 1.31 % d > 0.5 % (at 4.1 cm/s)
    note: viscous damping governs (St 3 < 10); e_n and k_n hardly matter
    """
    out = [_regime(damping_ratio, ending)]
    # a contact that never ends is a matter of the regime, not of its length
    if contact_steps is not None:
        severity, sign = _least(contact_steps, LEAST_CONTACT_STEPS)
        text = f"contact resolved by {contact_steps:.3g} steps {sign} {LEAST_CONTACT_STEPS}"
        out.append(_verdict("contact_steps", contact_steps, float(LEAST_CONTACT_STEPS), severity, text,
                            "with fewer the fluid sees the rebound as a jump",
                            "rdpm's bound, after van der Hoef et al., Adv. Chem. Eng. 31 (2006) 65"))  # fmt: skip
    speed = "" if impact_speed is None else f" (at {speed_text(impact_speed)})"
    if max_overlap is not None:
        severity, text = _overlap(f"overlap {percent_text(max_overlap)}", max_overlap, overlap_limit, speed)
        out.append(_verdict("max_overlap", max_overlap, overlap_limit, severity, text,
                            "of the smaller diameter: more disturbs the flow", _MUSONG))  # fmt: skip
    if static_overlap is not None:
        said, how = f"overlap at rest {percent_text(static_overlap)}", " (under the submerged weight)"
        severity, text = _overlap(said, static_overlap, overlap_limit, how)
        out.append(_verdict("static_overlap", static_overlap, overlap_limit, severity, text,
                            "of the smaller diameter: a resting sphere sinks in",
                            f"{_MUSONG}, its 0.5 % applied to rest"))  # fmt: skip
    bounds = (
        ("hertz_contact_time", hertz_time, f" (Hertz{speed and ', ' + speed[2:-1]})",
         "no contact is shorter than that of the real material", "Johnson, Contact Mechanics (1985), sec. 11.4"),
        ("rayleigh_time", rayleigh_time, " (Rayleigh)", "a shorter contact is a wave in the sphere, not a spring",
         "Li, Xu, Thornton, Powder Technol. 160 (2005) 219"),
    )  # fmt: skip
    for name, bound, how, reason, source in bounds:
        if contact_time is not None and bound is not None:
            severity, sign = _least(contact_time, bound)
            text = f"contact time {time_text(contact_time)} {sign} {time_text(bound)}{how}"
            out.append(_verdict(name, contact_time, bound, severity, text, reason, source))
    if stokes_number is not None:
        out.append(_wet(stokes_number))
    return tuple(out)


def _verdict(
    name: str, value: float, limit: float, severity: Severity, text: str, reason: str, source: str
) -> Verdict:
    return Verdict(name, value, limit, severity != "fail", reason, source, severity, text)


_SLACK = 1.0 + 1e-9  # round-off of a design that sits on the limit


def _least(value: float, bound: float) -> tuple[Severity, str]:
    """Judge a lower bound; give severity and sign."""
    return ("ok", ">=") if value * _SLACK >= bound else ("fail", "<")


def _overlap(said: str, value: float, limit: float, how: str) -> tuple[Severity, str]:
    """Judge an overlap by its limit, and by the usual one where the limit given is wider."""
    if value > limit * _SLACK:
        return "fail", f"{said} > {100.0 * limit:.3g} %{how}"
    if value > USUAL_OVERLAP * _SLACK:
        usual = f"{said} > {100.0 * USUAL_OVERLAP:g} %, the usual limit{how}"
        return "note", f"{usual}; within the {100.0 * limit:.3g} % allowed here"
    return "ok", f"{said} <= {100.0 * limit:.3g} %{how}"


def _regime(damping_ratio: float, ending: Ending) -> Verdict:
    """Judge the damping ratio: without a rebound, or beyond where the published formulas hold, it fails."""
    regime = regime_of(damping_ratio)
    bad = regime == "overdamped" or (regime == "critical" and ending == "zero-overlap")
    sign = {"underdamped": "< 1", "critical": "= 1", "overdamped": "> 1"}[regime]
    number = "1" if regime == "critical" else f"{damping_ratio:.3g}"
    reason = f"{regime}: {_REGIMES[regime, ending]}"
    return _verdict("regime", damping_ratio, 1.0, "fail" if bad else "ok",
                    f"damping ratio {number} {sign} ({reason})", reason,
                    "Schwager, Poeschel, Granular Matter 9 (2007) 465")  # fmt: skip


def _wet(stokes_number: float) -> Verdict:
    """Say whether the liquid lets the sphere rebound; that it does not breaks no limit."""
    limit = f"{CRITICAL_STOKES:g}"
    if stokes_number * _SLACK >= CRITICAL_STOKES:
        severity: Severity = "ok"
        text = f"St {stokes_number:.3g} >= {limit} (the sphere rebounds from the liquid)"
    else:
        severity = "note"
        text = f"viscous damping governs (St {stokes_number:.3g} < {limit}); e_n and k_n hardly matter"
    return _verdict("wet_rebound", stokes_number, CRITICAL_STOKES, severity, text,
                    "below this Stokes number the liquid stops the rebound",
                    "Gondret, Lance, Petit, Phys. Fluids 14 (2002) 643")  # fmt: skip
