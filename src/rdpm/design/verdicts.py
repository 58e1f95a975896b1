"""Limits a contact must keep to, each with its reason and source, and the advice that follows."""

from __future__ import annotations

import math

from rdpm.design._checks import Ending
from rdpm.design.dimensionless import CRITICAL_STOKES
from rdpm.design.result import Advice, Verdict

__all__ = ["LEAST_CONTACT_STEPS", "MOST_CONTACT_STEPS", "advise", "failed_names", "verdict_list"]

LEAST_CONTACT_STEPS = 4
"""Fewest time steps a contact may last: below, the fluid sees the rebound as a jump."""

MOST_CONTACT_STEPS = 15
"""Upper end of the window of the scheme's authors; more steps only soften the contact."""

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
    >>> failed_names((Verdict("regime", 1.6, 1.0, False, "overdamped", ""),))
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
        Of the smaller diameter.

    Returns
    -------
    tuple of Verdict

    Examples
    --------
    >>> [v.ok for v in verdict_list(damping_ratio=1.59, ending="zero-overlap", contact_time=None,
    ...     contact_steps=None, max_overlap=0.004, static_overlap=None, overlap_limit=0.005,
    ...     hertz_time=None, rayleigh_time=None, stokes_number=None)]
    [False, True]
    """
    regime = regime_of(damping_ratio)
    bad = regime == "overdamped" or (regime == "critical" and ending == "zero-overlap")
    out = [
        Verdict(
            "regime", damping_ratio, 1.0, not bad, f"{regime}: {_REGIMES[regime, ending]}",
            "Schwager, Poeschel, Granular Matter 9 (2007) 465",
        )
    ]  # fmt: skip

    def judge(
        name: str, value: float | None, limit: float | None, most: bool, reason: str, source: str
    ) -> None:
        if value is not None and limit is not None:
            slack = 1.0 + 1e-9  # round-off of a design that sits on the limit
            ok = value <= limit * slack if most else value * slack >= limit
            out.append(Verdict(name, value, limit, ok, reason, source))

    # a contact that never ends is a matter of the regime, not of its length
    judge("contact_steps", contact_steps, float(LEAST_CONTACT_STEPS), False,
          "at least: with fewer the fluid sees the rebound as a jump",
          "rdpm's bound, after van der Hoef et al., Adv. Chem. Eng. 31 (2006) 65")  # fmt: skip
    judge("max_overlap", max_overlap, overlap_limit, True,
          "at most, of the smaller diameter at the impact speed: more spoils the flow", _MUSONG)  # fmt: skip
    judge("static_overlap", static_overlap, overlap_limit, True,
          "at most, of the smaller diameter under the submerged weight: a resting sphere sinks in",
          f"{_MUSONG}, its 0.5 % applied to rest")  # fmt: skip
    judge("hertz_contact_time", contact_time, hertz_time, False,
          "at least: no contact is shorter than that of the real material",
          "Johnson, Contact Mechanics (1985), sec. 11.4")  # fmt: skip
    judge("rayleigh_time", contact_time, rayleigh_time, False,
          "at least: a shorter contact is a wave in the sphere, not a spring",
          "Li, Xu, Thornton, Powder Technol. 160 (2005) 219")  # fmt: skip
    judge("wet_rebound", stokes_number, CRITICAL_STOKES, False,
          "Stokes number, at least: below, the liquid stops the rebound and e_n, k_n are not seen",
          "Gondret, Lance, Petit, Phys. Fluids 14 (2002) 643")  # fmt: skip
    return tuple(out)


def advise(
    *,
    shortest: float | None,
    longest: float | None,
    decides: str = "the overlap",
    time_step: float | None,
    contact_steps: float | None,
) -> Advice:
    """Turn bounds on the contact time into contact steps and a time step.

    Parameters
    ----------
    shortest : float or None, [s]
        Of the real material (Hertz, Rayleigh).
    longest : float or None, [s]
        By the overlap limits; None where no impact speed or load is known.
    decides : str
        Which of them it is.
    time_step : float or None, [s]
    contact_steps : float or None, [-]
        Of the design itself.

    Returns
    -------
    Advice
        The best contact steps are the most that the limits allow, up to 15.

    Examples
    --------
    >>> advise(shortest=None, longest=8.5e-3, time_step=1e-3, contact_steps=10.0).best_contact_steps
    8
    """
    least, most = LEAST_CONTACT_STEPS, MOST_CONTACT_STEPS
    at_most = None if longest is None else longest / least
    at_design = None if longest is None or not contact_steps else longest / contact_steps
    window: tuple[int, int] | None = None
    best: int | None = None
    if longest is None:
        text = "Give a diameter and an impact speed (or a fluid): nothing bounds the overlap yet."
    elif shortest is not None and shortest > longest:
        text = f"No contact keeps to all limits: Hertz asks {shortest:.3g} s, overlap allows {longest:.3g} s."
    elif time_step is None:
        text = f"Time steps up to {at_most:.3g} s keep to all limits at {least} contact steps."
    else:
        low = max(least, math.ceil((shortest or 0.0) / time_step * (1.0 - 1e-9)))
        high = math.floor(longest / time_step * (1.0 + 1e-9))
        if high >= low:
            window, best = (low, high), max(low, min(high, most))
            text = f"N_c from {low} to {high} keeps to all limits; {best} is best: the softest allowed"
            text += f", up to {most} where more gains nothing." if high > most else ", best resolved in time."
        else:
            text = f"No N_c keeps to all limits at this time step: lower it to {at_most:.3g} s or less."
    if at_most is not None:
        text += f" Of the upper limits {decides} decides."
    return Advice(shortest, longest, window, best, at_most, at_design, text)
