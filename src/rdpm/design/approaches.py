"""Three ways to choose a contact: graphical, trial and error, contact steps; each gives a table."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from rdpm.design._checks import Ending, Values, positive
from rdpm.design.overlap import largest_contact_time
from rdpm.design.soft_sphere import (
    achieved_restitution,
    contact_parameters,
    contact_time,
    damping_from_stiffness,
    peak_overlap,
)
from rdpm.design.verdicts import LEAST_CONTACT_STEPS
from rdpm.errors import CaseError

__all__ = [
    "StepsTable",
    "StiffnessTable",
    "TrialTable",
    "approach_rows",
    "by_contact_steps",
    "graphical",
    "trial_and_error",
]


class StiffnessTable(NamedTuple):
    """Result of :func:`graphical`; n stiffnesses, t time steps."""

    stiffness: Any
    """(n,) [N/m]."""
    critical_damping: Any
    """(n,) [N s/m], restitution 0 at zero overlap."""
    damping: Any
    """(n,) [N s/m]."""
    contact_time: Any
    """(n,) [s]."""
    contact_steps: Any
    """(n, t) [-]."""


class TrialTable(NamedTuple):
    """Result of :func:`trial_and_error`; n stiffnesses."""

    stiffness: Any
    """(n,) [N/m]."""
    damping_ratio: Any
    """(n,) [-]."""
    restitution: Any
    """(n,) [-], nan where the spheres never part."""
    contact_time: Any
    """(n,) [s], inf where the spheres never part."""
    contact_steps: Any
    """(n,) [-]."""
    overlap: Any
    """(n,) [m] at the impact speed."""
    accepted: Any
    """(n,) bool: underdamped, enough steps, overlap within its limit."""


class StepsTable(NamedTuple):
    """Result of :func:`by_contact_steps`; n contact steps."""

    contact_steps: Any
    """(n,) [-]."""
    stiffness: Any
    """(n,) [N/m]."""
    damping: Any
    """(n,) [N s/m]."""
    contact_time: Any
    """(n,) [s]."""
    overlap: Any
    """(n,) [m] at the impact speed."""
    accepted: Any
    """(n,) bool: between the two limits."""
    least_steps: float
    """Lower limit [-]: Hertz, and no fewer than 4."""
    most_steps: float
    """Upper limit [-]: overlap."""


def graphical(
    reduced_mass: float,
    restitution: float,
    stiffness: Values,
    time_steps: Values,
    ending: Ending = "zero-force",
) -> StiffnessTable:
    """Damping, contact time and contact steps of springs of given stiffness: the graphical approach.

    Parameters
    ----------
    reduced_mass : float, [kg]
        > 0.
    restitution : float, [-]
        Range as in :func:`rdpm.design.damping_ratio`.
    stiffness : (n,) array, [N/m]
        > 0.
    time_steps : (t,) array, [s]
        > 0.
    ending : {"zero-force", "zero-overlap"}
        When the contact is over.

    Returns
    -------
    StiffnessTable

    Raises
    ------
    CaseError
        An argument outside its range.

    References
    ----------
    .. [1] Musong, Feng, Michaelides, NETL Multiphase Flow Conf. (2012).
    .. [2] Mullier et al., Powder Technol. 65 (1991) 61-74, for measured stiffness.

    Examples
    --------
    >>> t = graphical(0.9902467e-3, 0.8, [0.1, 1.0], [0.25e-3, 1e-3], "zero-overlap")
    >>> t.contact_steps.round(0).tolist()
    [[1254.0, 313.0], [396.0, 99.0]]
    """
    k = np.atleast_1d(positive("stiffness", stiffness))
    eta = damping_from_stiffness(reduced_mass, restitution, k, ending)
    t_c = contact_time(reduced_mass, k, eta, ending)
    critical = damping_from_stiffness(reduced_mass, 0.0, k, "zero-overlap")
    return StiffnessTable(k, critical, eta, t_c, t_c[:, None] / positive("time_steps", time_steps))


def trial_and_error(
    reduced_mass: float,
    damping: float,
    stiffness: Values,
    time_step: float,
    overlap_limit: float,
    impact_speed: float,
    ending: Ending = "zero-force",
) -> TrialTable:
    """Which springs pass beside a fixed dashpot: the trial-and-error approach, without the trials.

    Parameters
    ----------
    reduced_mass : float, [kg]
        > 0.
    damping : float, [N s/m]
        >= 0, the same for all springs, so that the restitution changes from one to the next.
    stiffness : (n,) array, [N/m]
        > 0.
    time_step : float, [s]
        > 0.
    overlap_limit : float, [m]
        > 0.
    impact_speed : float, [m/s]
        > 0.
    ending : {"zero-force", "zero-overlap"}
        When the contact is over.

    Returns
    -------
    TrialTable

    Raises
    ------
    CaseError
        An argument outside its range.

    References
    ----------
    .. [1] Xu, Yu, Chem. Eng. Sci. 52 (1997) 2785-2809, doi:10.1016/S0009-2509(97)00081-X.

    Examples
    --------
    >>> t = trial_and_error(0.9902467e-3, 0.15, [5.0, 50.0, 100.0], 1e-3, 0.005 * 0.015, 0.02)
    >>> t.damping_ratio.round(2).tolist(), t.accepted.tolist()
    ([1.07, 0.34, 0.24], [False, True, True])
    """
    k = np.atleast_1d(positive("stiffness", stiffness))
    zeta = damping / (2.0 * np.sqrt(k * positive("reduced_mass", reduced_mass)))
    e = achieved_restitution(reduced_mass, k, damping, ending)
    t_c = contact_time(reduced_mass, k, damping, ending)
    if ending == "zero-overlap":
        e = np.where(zeta < 1.0, e, np.nan)
    steps = t_c / positive("time_step", time_step)
    overlap = peak_overlap(reduced_mass, k, damping, positive("impact_speed", impact_speed))
    good = (
        (zeta < 1.0) & (steps >= LEAST_CONTACT_STEPS) & (overlap <= positive("overlap_limit", overlap_limit))
    )
    return TrialTable(k, zeta, e, t_c, steps, overlap, good)


def by_contact_steps(
    reduced_mass: float,
    restitution: float,
    contact_steps: Values,
    time_step: float,
    overlap_limit: float,
    impact_speed: float,
    hertz_time: float = 0.0,
    ending: Ending = "zero-force",
) -> StepsTable:
    """Stiffness and damping from contact steps and time step, between two limits: the third approach.

    Parameters
    ----------
    reduced_mass : float, [kg]
        > 0.
    restitution : float, [-]
        0 < e_n <= 1.
    contact_steps : (n,) array, [-]
        > 0.
    time_step : float, [s]
        > 0.
    overlap_limit : float, [m]
        > 0: the upper limit.
    impact_speed : float, [m/s]
        > 0.
    hertz_time : float, [s]
        >= 0: the lower limit, from :func:`rdpm.design.hertz_contact_time`.
    ending : {"zero-force", "zero-overlap"}
        When the contact is over.

    Returns
    -------
    StepsTable

    Raises
    ------
    CaseError
        An argument outside its range.

    References
    ----------
    .. [1] Musong, Feng, Michaelides, NETL Multiphase Flow Conf. (2012).
    .. [2] van der Hoef et al., Adv. Chem. Eng. 31 (2006) 65-149, doi:10.1016/S0065-2377(06)31002-2.

    Examples
    --------
    >>> t = by_contact_steps(0.9902467e-3, 0.5, [8, 10, 12], 1e-3, 0.005 * 0.015, 0.033, 0.0, "zero-overlap")
    >>> t.stiffness.round(2).tolist(), t.accepted.tolist()
    ([160.14, 102.49, 71.17], [True, False, False])
    """
    n_c, dt = np.atleast_1d(positive("contact_steps", contact_steps)), float(positive("time_step", time_step))
    k, eta = contact_parameters(reduced_mass, restitution, n_c * dt, ending)
    overlap = peak_overlap(reduced_mass, k, eta, impact_speed)
    least = max(float(LEAST_CONTACT_STEPS), hertz_time / dt)
    most = float(largest_contact_time(restitution, overlap_limit, impact_speed, ending)) / dt
    return StepsTable(n_c, k, eta, n_c * dt, overlap, (n_c >= least) & (n_c <= most), least, most)


def approach_rows(
    approach: str,
    values: list[float],
    known: dict[str, float],
    *,
    wall: bool = False,
    ending: Ending = "zero-force",
) -> list[dict[str, Any]]:
    """Rows of one approach for bodies given as to :func:`rdpm.design.soft_sphere`, SI units in the names.

    Parameters
    ----------
    approach : {"graphical", "trial", "contact-steps"}
    values : list of float
        Stiffness [N/m], or contact steps [-] for ``"contact-steps"``. > 0.
    known : dict of str and float
        mass, or diameter with density; time_step (graphical: its half and quarter as
        well); restitution (damping for ``"trial"``); for the latter two
        approaches diameter, and impact_speed or a fluid; optionally overlap_limit and a material.
    wall : bool
        The partner is a wall.
    ending : {"zero-force", "zero-overlap"}
        When the contact is over.

    Returns
    -------
    list of dict

    Raises
    ------
    CaseError
        Something missing, superfluous or out of range.

    Examples
    --------
    >>> row = approach_rows("graphical", [1.0], {"mass": 1e-3, "restitution": 0.8, "time_step": 1e-3})[0]
    >>> round(row["damping_N_s_m"], 5), round(row["contact_steps"], 1)
    (0.0047, 94.9)
    """
    from rdpm.design.front_door import soft_sphere

    swept = "contact_steps" if approach == "contact-steps" else "stiffness"
    needs = ("time_step", "damping" if approach == "trial" else "restitution")
    for name in needs:
        if name not in known:
            raise CaseError(
                name, None, "must be given", f"the {approach} approach starts from it", f"Add {name}."
            )
    # one design tells bodies, impact and material apart, and refuses what does not belong
    one = soft_sphere(**{**known, swept: values[0]}, wall=wall, ending=ending)
    m, dt = one.reduced_mass_kg, known["time_step"]
    columns: tuple[str, ...]
    if approach == "graphical":
        t = graphical(m, known["restitution"], values, [dt, 0.5 * dt, 0.25 * dt], ending)
        steps = ("contact_steps", "contact_steps_half_step", "contact_steps_quarter_step")
        columns = ("stiffness_N_m", "critical_damping_N_s_m", "damping_N_s_m", "contact_time_s", *steps)
        return _rows(columns, (*t[:4], *t.contact_steps.T))
    d, v = one.diameter_m, one.impact_speed_m_s
    if d is None or v is None:
        name = "diameter" if d is None else "impact_speed"
        raise CaseError(name, None, "must be given", "the overlap is judged by it", f"Add {name}.")
    limit = known.get("overlap_limit", 0.005) * d
    if approach == "trial":
        s = trial_and_error(m, known["damping"], values, dt, limit, v, ending)
        columns = ("stiffness_N_m", "damping_ratio", "restitution", "contact_time_s", "contact_steps")
        return _rows((*columns, "max_overlap_fraction", "accepted"), (*s[:5], s.overlap / d, s.accepted))
    hertz = max(one.hertz_contact_time_s or 0.0, one.rayleigh_time_s or 0.0)
    n = by_contact_steps(m, known["restitution"], values, dt, limit, v, hertz, ending)
    columns = ("contact_steps", "stiffness_N_m", "damping_N_s_m", "contact_time_s", "max_overlap_fraction")
    return _rows((*columns, "accepted"), (*n[:4], n.overlap / d, n.accepted))


def _rows(columns: tuple[str, ...], values: tuple[Any, ...]) -> list[dict[str, Any]]:
    """Turn columns of arrays into rows of plain values, None where not finite."""
    plain = [[v if np.isfinite(v) else None for v in np.asarray(column).tolist()] for column in values]
    return [dict(zip(columns, row, strict=True)) for row in zip(*plain, strict=True)]
