r"""Linear spring-dashpot (soft-sphere) contact: stiffness, damping, duration, restitution, overlap.

The overlap of one normal impact is a damped oscillator; ``oscillator.py`` solves it without units,
this module gives it masses, springs and times. Derivation: docs/theory/soft_sphere.md.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from rdpm.design._checks import Ending, Values, as_given, not_negative, positive, within
from rdpm.design.oscillator import (
    damping_ratio,
    dimensionless_contact_time,
    log_restitution,
    peak_overlap_factor,
    peak_time,
    peak_time_of,
    restitution,
)
from rdpm.design.tangential import ratio_from_poisson, tangential_parameters, tangential_restitution

__all__ = [
    "achieved_restitution",
    "contact_parameters",
    "contact_time",
    "damping_from_stiffness",
    "damping_ratio",
    "dimensionless_contact_time",
    "peak_overlap",
    "peak_overlap_factor",
    "peak_time",
    "ratio_from_poisson",
    "restitution",
    "stiffness_from_overlap",
    "tangential_parameters",
    "tangential_restitution",
]


def contact_parameters(
    reduced_mass: Values, restitution: Values, contact_time: Values, ending: Ending = "zero-force"
) -> tuple[Values, Values]:
    r"""Stiffness and damping of a contact of given duration and restitution.

    Parameters
    ----------
    reduced_mass : float or array, [kg]
        :math:`m_{ij}=(1/m_i+1/m_j)^{-1}`; the body's own mass against a wall. > 0.
    restitution : float or array, [-]
        Dry normal restitution, 0 < e_n <= 1.
    contact_time : float or array, [s]
        :math:`t_c=N_c\,\delta t`, from touch to the end that ``ending`` names. > 0.
    ending : {"zero-force", "zero-overlap"}
        See :func:`damping_ratio`.

    Returns
    -------
    normal_stiffness : float or array, [N/m]
        :math:`k_n=m_{ij}(\omega_0t_c)^2/t_c^2`.
    normal_damping : float or array, [N s/m]
        :math:`\eta_n=-2m_{ij}\ln(e_n)/t_c`, for both endings.

    Raises
    ------
    CaseError
        An argument outside its range; restitution 0, whose contact never ends.

    References
    ----------
    .. [1] Hoomans et al., Chem. Eng. Sci. 51 (1996) 99-118, doi:10.1016/0009-2509(95)00271-5.

    Examples
    --------
    >>> k_n, eta_n = contact_parameters(0.9902467e-3, 0.5, 8e-3, "zero-overlap")
    >>> round(k_n, 4), round(eta_n, 5)
    (160.1423, 0.1716)
    """
    m, t_c = positive("reduced_mass", reduced_mass), positive("contact_time", contact_time)
    e = np.asarray(restitution, dtype=np.float64)
    zeta = np.asarray(damping_ratio(e, ending))
    within(
        "restitution", e, e > 0, "must be above 0 when a contact time is given",
        "a critically damped contact never ends", "Give the stiffness instead, or a restitution above 0.",
    )  # fmt: skip
    rate, log_e = 1.0 / t_c, log_restitution(e)
    tau = 2.0 * peak_time_of(zeta) if ending == "zero-force" else np.hypot(np.pi, log_e)
    return as_given(m * (tau * rate) ** 2), as_given(2.0 * m * rate * log_e)


def damping_from_stiffness(
    reduced_mass: Values, restitution: Values, stiffness: Values, ending: Ending = "zero-force"
) -> Values:
    r"""Damping that gives a restitution with a spring of given stiffness.

    Parameters
    ----------
    reduced_mass : float or array, [kg]
        > 0.
    restitution : float or array, [-]
        Range as in :func:`damping_ratio`.
    stiffness : float or array, [N/m]
        :math:`k_n` > 0.
    ending : {"zero-force", "zero-overlap"}
        See :func:`damping_ratio`.

    Returns
    -------
    float or array, [N s/m]
        :math:`\eta_n=2\zeta\sqrt{m_{ij}k_n}`.

    Raises
    ------
    CaseError
        An argument outside its range.

    References
    ----------
    .. [1] Hoomans et al., Chem. Eng. Sci. 51 (1996) 99-118, doi:10.1016/0009-2509(95)00271-5.

    Examples
    --------
    >>> round(damping_from_stiffness(0.9902467e-3, 0.0, 0.1, "zero-overlap"), 5)   # critical: 19.90 dyn s/cm
    0.0199
    """
    m, k = positive("reduced_mass", reduced_mass), positive("stiffness", stiffness)
    return as_given(2.0 * np.asarray(damping_ratio(restitution, ending)) * np.sqrt(m * k))


def _frequency_and_ratio(reduced_mass: Any, stiffness: Any, damping: Any) -> tuple[Any, Any]:
    """Give omega_0 [1/s] and zeta of a mass, spring and dashpot."""
    m, k = positive("reduced_mass", reduced_mass), positive("stiffness", stiffness)
    omega = np.sqrt(k / m)
    return omega, not_negative("damping", damping) / (2.0 * m * omega)


def contact_time(
    reduced_mass: Values, stiffness: Values, damping: Values, ending: Ending = "zero-force"
) -> Values:
    r"""Duration of a contact.

    Parameters
    ----------
    reduced_mass : float or array, [kg]
        > 0.
    stiffness : float or array, [N/m]
        > 0.
    damping : float or array, [N s/m]
        >= 0.
    ending : {"zero-force", "zero-overlap"}
        See :func:`damping_ratio`.

    Returns
    -------
    float or array, [s]
        :math:`t_c`; inf at zero overlap from critical damping on.

    Raises
    ------
    CaseError
        An argument outside its range.

    References
    ----------
    .. [1] Schwager, Poeschel, Granular Matter 9 (2007) 465-469, doi:10.1007/s10035-007-0065-z.

    Examples
    --------
    >>> round(contact_time(0.9902467e-3, 160.14235, 0.17160, "zero-overlap"), 6)
    0.008
    """
    omega, zeta = _frequency_and_ratio(reduced_mass, stiffness, damping)
    return as_given(np.asarray(dimensionless_contact_time(zeta, ending)) / omega)


def achieved_restitution(
    reduced_mass: Values, stiffness: Values, damping: Values, ending: Ending = "zero-force"
) -> Values:
    r"""Restitution that a spring and dashpot give.

    Parameters
    ----------
    reduced_mass : float or array, [kg]
        > 0.
    stiffness : float or array, [N/m]
        > 0.
    damping : float or array, [N s/m]
        >= 0.
    ending : {"zero-force", "zero-overlap"}
        See :func:`damping_ratio`.

    Returns
    -------
    float or array, [-]
        0 at zero overlap from critical damping on.

    Raises
    ------
    CaseError
        An argument outside its range.

    References
    ----------
    .. [1] Schwager, Poeschel, Granular Matter 9 (2007) 465-469, doi:10.1007/s10035-007-0065-z.

    Examples
    --------
    >>> round(achieved_restitution(0.9902467e-3, 160.14235, 0.17160), 4)   # zero overlap would give 0.5
    0.5503
    """
    return restitution(_frequency_and_ratio(reduced_mass, stiffness, damping)[1], ending)


def peak_overlap(reduced_mass: Values, stiffness: Values, damping: Values, impact_speed: Values) -> Values:
    r"""Largest overlap of a contact, the same for both endings, exact in every regime.

    Parameters
    ----------
    reduced_mass : float or array, [kg]
        > 0.
    stiffness : float or array, [N/m]
        > 0.
    damping : float or array, [N s/m]
        >= 0.
    impact_speed : float or array, [m/s]
        Normal approach speed at touch, >= 0. Gravity and fluid forces during the contact are not covered.

    Returns
    -------
    float or array, [m]
        :math:`\delta_m=(v/\omega_0)\,e^{-\zeta h(\zeta)}`.

    Raises
    ------
    CaseError
        An argument outside its range.

    References
    ----------
    .. [1] Schwager, Poeschel, Granular Matter 9 (2007) 465-469, doi:10.1007/s10035-007-0065-z.

    Examples
    --------
    >>> round(peak_overlap(0.9902467e-3, 160.14235, 0.17160, 0.0407) / 0.015, 5)   # of the diameter
    0.00501
    """
    omega, zeta = _frequency_and_ratio(reduced_mass, stiffness, damping)
    return as_given(not_negative("impact_speed", impact_speed) / omega * np.exp(-zeta * peak_time_of(zeta)))


def stiffness_from_overlap(
    reduced_mass: Values,
    restitution: Values,
    max_overlap: Values,
    impact_speed: Values,
    ending: Ending = "zero-force",
) -> tuple[Values, Values]:
    r"""Softest spring, and its damping, that keeps the overlap within a limit at an impact speed.

    Parameters
    ----------
    reduced_mass : float or array, [kg]
        > 0.
    restitution : float or array, [-]
        Range as in :func:`damping_ratio`.
    max_overlap : float or array, [m]
        > 0.
    impact_speed : float or array, [m/s]
        > 0.
    ending : {"zero-force", "zero-overlap"}
        See :func:`damping_ratio`.

    Returns
    -------
    normal_stiffness : float or array, [N/m]
    normal_damping : float or array, [N s/m]

    Raises
    ------
    CaseError
        An argument outside its range.

    References
    ----------
    .. [1] Schwager, Poeschel, Granular Matter 9 (2007) 465-469, doi:10.1007/s10035-007-0065-z.

    Examples
    --------
    >>> k_n, eta_n = stiffness_from_overlap(0.9902467e-3, 0.5, 0.005 * 0.015, 0.04066, "zero-overlap")
    >>> round(k_n, 1)
    160.2
    """
    m, zeta = positive("reduced_mass", reduced_mass), np.asarray(damping_ratio(restitution, ending))
    speed, limit = positive("impact_speed", impact_speed), positive("max_overlap", max_overlap)
    omega = speed / limit * np.exp(-zeta * peak_time_of(zeta))
    return as_given(m * omega**2), as_given(2.0 * zeta * m * omega)
