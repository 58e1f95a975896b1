"""Tangential spring and dashpot of a soft-sphere contact, and what a sticking impact gives back."""

from __future__ import annotations

import numpy as np

from rdpm.design._checks import Ending, Values, as_given, check_ending, not_negative, positive, within
from rdpm.design.oscillator import dimensionless_contact_time

__all__ = ["ratio_from_poisson", "sliding_ratio", "tangential_parameters", "tangential_restitution"]

SPHERE_FACTOR = 2.0 / 7.0
"""Tangential over normal reduced mass of solid spheres: 1/(1 + m a^2/I) with I = 2/5 m a^2."""


def ratio_from_poisson(poisson_ratio: Values) -> Values:
    r"""Stiffness ratio of an elastic contact before it slips (Mindlin).

    Parameters
    ----------
    poisson_ratio : float or array, [-]
        :math:`\sigma` of both bodies, -1 <= sigma <= 0.5.

    Returns
    -------
    float or array, [-]
        :math:`k_t/k_n = 2(1-\sigma)/(2-\sigma)`: 1 at 0, 2/3 at 0.5.

    Raises
    ------
    CaseError
        ``poisson_ratio`` outside its range.

    References
    ----------
    .. [1] Mindlin, J. Appl. Mech. 16 (1949) 259-268; Johnson, Contact Mechanics (1985), sec. 7.3.

    Examples
    --------
    >>> round(ratio_from_poisson(0.22), 4)
    0.8764
    """
    s = np.asarray(poisson_ratio, dtype=np.float64)
    ok = (s >= -1.0) & (s <= 0.5)
    within("poisson_ratio", s, ok, "must be in -1 <= sigma <= 0.5", "an elastic solid's range")
    return as_given(2.0 * (1.0 - s) / (2.0 - s))


def tangential_parameters(stiffness: Values, damping: Values, ratio: Values) -> tuple[Values, Values]:
    r"""Tangential stiffness and damping with the damping ratio of the normal spring.

    Parameters
    ----------
    stiffness : float or array, [N/m]
        Normal stiffness :math:`k_n` > 0.
    damping : float or array, [N s/m]
        Normal damping :math:`\eta_n` >= 0.
    ratio : float or array, [-]
        :math:`k_t/k_n` >= 0; at 2/7 both springs have the same period.

    Returns
    -------
    tangential_stiffness : float or array, [N/m]
    tangential_damping : float or array, [N s/m]
        :math:`\eta_t=\eta_n\sqrt{\tfrac27k_t/k_n}`, from the tangential reduced mass of solid spheres,
        :math:`\tfrac27m_{ij}`.

    Raises
    ------
    CaseError
        An argument outside its range.

    References
    ----------
    .. [1] van der Hoef et al., Adv. Chem. Eng. 31 (2006) 65-149, doi:10.1016/S0065-2377(06)31002-2.

    Examples
    --------
    >>> k_t, eta_t = tangential_parameters(100.0, 0.07, 2 / 7)
    >>> round(k_t, 4), round(eta_t, 4)
    (28.5714, 0.02)
    """
    r = not_negative("ratio", ratio)
    eta_t = not_negative("damping", damping) * np.sqrt(r * SPHERE_FACTOR)
    return as_given(positive("stiffness", stiffness) * r), as_given(eta_t)


def tangential_restitution(damping_ratio: Values, ratio: Values, ending: Ending = "zero-force") -> Values:
    r"""Tangential restitution of an impact that sticks from touch to end.

    Parameters
    ----------
    damping_ratio : float or array, [-]
        :math:`\zeta\ge0`, the same in both directions.
    ratio : float or array, [-]
        :math:`k_t/k_n` >= 0.
    ending : {"zero-force", "zero-overlap"}
        When the normal contact ends; the tangential spring is let go then, whatever it still holds.

    Returns
    -------
    float or array, [-]
        :math:`e_t=-u_t(t_c)/u_t(0)` of the surfaces, -1 (frictionless) to 1; nan where contact never ends.

    Raises
    ------
    CaseError
        An argument outside its range.

    Notes
    -----
    Sliding (Coulomb's limit) is not covered; :func:`sliding_ratio` says where it takes over.

    References
    ----------
    .. [1] van der Hoef et al., Adv. Chem. Eng. 31 (2006) 65-149, doi:10.1016/S0065-2377(06)31002-2.

    Examples
    --------
    >>> round(tangential_restitution(0.0, 2 / 7), 12), tangential_restitution(0.0, 0.0)
    (1.0, -1.0)
    """
    check_ending(ending)
    zeta = np.asarray(damping_ratio, dtype=np.float64)
    stretch = np.sqrt(not_negative("ratio", ratio) / SPHERE_FACTOR)
    tau = stretch * np.asarray(dimensionless_contact_time(zeta, ending))
    w = np.sqrt(np.abs((1.0 - zeta) * (1.0 + zeta)))
    with np.errstate(invalid="ignore", over="ignore"):
        # sin(w tau)/w and its hyperbolic twin tend to tau at critical damping
        sine = np.where(w * tau > 1e-6, np.where(zeta < 1, np.sin(w * tau), np.sinh(w * tau)), w * tau)
        cosine = np.where(zeta < 1, np.cos(w * tau), np.cosh(w * tau))
        slope = np.where(w > 0, sine / np.where(w > 0, w, 1.0), tau)
        return as_given(np.exp(-zeta * tau) * (zeta * slope - cosine))


def sliding_ratio(friction: Values, restitution: Values, tangential_restitution: Values) -> Values:
    r"""Tangential over normal approach speed from which an impact slides to its end.

    Parameters
    ----------
    friction : float or array, [-]
        Coulomb's coefficient >= 0.
    restitution : float or array, [-]
        Normal restitution, 0 to 1.
    tangential_restitution : float or array, [-]
        :math:`e_t` of a sticking impact, above -1.

    Returns
    -------
    float or array, [-]
        :math:`\tfrac72\mu(1+e_n)/(1+e_t)`.

    Raises
    ------
    CaseError
        An argument outside its range.

    References
    ----------
    .. [1] Walton (1993), in Roco (ed.), Particulate Two-Phase Flow; Foerster et al., Phys. Fluids 6 (1994)
       1108-1115, doi:10.1063/1.868282.

    Examples
    --------
    >>> round(sliding_ratio(0.1, 1.0, 0.4), 6)
    0.5
    """
    e_t = np.asarray(tangential_restitution, dtype=np.float64)
    reason = "a frictionless contact never sticks"
    within("tangential_restitution", e_t, e_t > -1.0, "must be above -1", reason)
    mu, e = not_negative("friction", friction), not_negative("restitution", restitution)
    return as_given(mu * (1.0 + e) / (SPHERE_FACTOR * (1.0 + e_t)))
