r"""The damped oscillator behind a linear contact, in the units of :math:`\omega_0=\sqrt{k/m}`.

:math:`m\ddot\delta + \eta\dot\delta + k\delta = 0` with :math:`\delta(0)=0,\ \dot\delta(0)=v` depends on
:math:`\zeta=\eta/(2\sqrt{km})` alone. One function carries everything,

.. math:: h(\zeta) = \arccos(\zeta)/\sqrt{1-\zeta^2}
          \quad(\text{its continuation}\ \operatorname{arcosh}(\zeta)/\sqrt{\zeta^2-1}\ \text{past}\ \zeta=1):

the overlap peaks at :math:`\omega_0t=h`, the force vanishes at :math:`\omega_0t_c=2h`, the peak is
:math:`\omega_0\delta_m/v=e^{-\zeta h}` and the restitution at zero force is its square. Derivation:
docs/theory/soft_sphere.md.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from rdpm.design._checks import Ending, Values, as_given, check_ending, not_negative, restitution_in_range

__all__ = [
    "damping_ratio",
    "dimensionless_contact_time",
    "peak_overlap_factor",
    "peak_time",
    "restitution",
]

# First guess of zeta*sqrt(e)/(1 - sqrt(e)) as a polynomial in sqrt(e), within 1.3e-3; Newton does the rest.
_GUESS = (0.500092, 0.424474, -0.976068, 1.585485, -1.330888, 0.433574)


def peak_time_of(zeta: Any) -> Any:
    """Give h(zeta) to a few units in the last place; neither quotient cancels at zeta = 1."""
    s = np.sqrt(np.abs((1.0 - zeta) * (1.0 + zeta)))
    over = zeta > 1.0
    angle = np.arctan2(s, zeta)
    if np.any(over):
        angle = np.where(over, np.arcsinh(s), angle)
    flat = s == 0.0
    return np.where(flat, 1.0, angle / np.where(flat, 1.0, s)) if np.any(flat) else angle / s


def _peak_time_slope(zeta: Any, h: Any) -> Any:
    """Give dh/dzeta; a two-term series where the quotient would cancel."""
    gap = 1.0 - zeta
    near = np.abs(gap) < 1e-5
    quotient = (zeta * h - 1.0) / np.where(near, 1.0, gap * (1.0 + zeta))
    return np.where(near, -1.0 / 3.0 - gap * (4.0 / 15.0), quotient)


def log_restitution(e: Any) -> Any:
    """Give -ln(e), +inf at zero, never -0."""
    with np.errstate(divide="ignore"):
        return np.abs(np.log(e))


def damping_ratio(restitution: Values, ending: Ending = "zero-force") -> Values:
    r"""Damping ratio that gives a normal coefficient of restitution.

    Parameters
    ----------
    restitution : float or array, [-]
        Dry normal restitution :math:`e_n`, 0 < e_n <= 1; 0 as well at ``"zero-overlap"`` (critical).
    ending : {"zero-force", "zero-overlap"}
        Whether the contact ends when the force would turn attractive, or when the overlap is gone.

    Returns
    -------
    float or array, [-]
        :math:`\zeta = \eta_n/(2\sqrt{m_{ij}k_n})`, relative error below 1e-13.

    Raises
    ------
    CaseError
        ``restitution`` outside its range; 0 at zero force, which no finite damping gives.

    References
    ----------
    .. [1] Schwager, Poeschel, Granular Matter 9 (2007) 465-469, doi:10.1007/s10035-007-0065-z (zero force).
    .. [2] Hoomans et al., Chem. Eng. Sci. 51 (1996) 99-118, doi:10.1016/0009-2509(95)00271-5 (zero overlap).

    Examples
    --------
    >>> round(damping_ratio(0.5, "zero-overlap"), 6), round(damping_ratio(0.5, "zero-force"), 6)
    (0.215454, 0.255276)
    >>> damping_ratio(0.0, "zero-overlap")
    1.0
    """
    check_ending(ending)
    e = restitution_in_range(restitution, ending)
    log_e = log_restitution(e)
    if ending == "zero-overlap":
        with np.errstate(invalid="ignore"):
            return as_given(np.where(e == 0.0, 1.0, log_e / np.hypot(np.pi, log_e)))
    q = np.sqrt(e)
    zeta = -np.expm1(-0.5 * log_e) / q * np.polynomial.polynomial.polyval(q, _GUESS)
    for _ in range(3):
        h = peak_time_of(zeta)
        zeta = zeta - (2.0 * zeta * h - log_e) / (2.0 * (h + zeta * _peak_time_slope(zeta, h)))
    return as_given(np.where(e == 1.0, 0.0, zeta))


def restitution(damping_ratio: Values, ending: Ending = "zero-force") -> Values:
    r"""Give the normal coefficient of restitution of a damping ratio.

    Parameters
    ----------
    damping_ratio : float or array, [-]
        :math:`\zeta \ge 0`.
    ending : {"zero-force", "zero-overlap"}
        See :func:`damping_ratio`.

    Returns
    -------
    float or array, [-]
        :math:`e^{-2\zeta h(\zeta)}` at zero force; :math:`e^{-\pi\zeta/\sqrt{1-\zeta^2}}` at zero overlap,
        and exactly 0 there from critical damping on, where the spheres creep apart for ever.

    Raises
    ------
    CaseError
        ``damping_ratio`` negative or not finite.

    References
    ----------
    .. [1] Schwager, Poeschel, Granular Matter 9 (2007) 465-469, doi:10.1007/s10035-007-0065-z.

    Examples
    --------
    >>> round(restitution(1.0), 6), restitution(1.0, "zero-overlap")
    (0.135335, 0.0)
    """
    check_ending(ending)
    zeta = not_negative("damping_ratio", damping_ratio)
    # zeta * omega_0 t_c is -ln(e) whichever way a contact ends
    exponent = 2.0 * zeta * peak_time_of(zeta) if ending == "zero-force" else zeta * zero_overlap_time(zeta)
    return as_given(np.exp(-exponent))


def zero_overlap_time(zeta: Any) -> Any:
    """Give omega_0 t_c at zero overlap; infinite from critical damping on."""
    under = zeta < 1.0
    return np.where(under, np.pi / np.sqrt(np.where(under, (1.0 - zeta) * (1.0 + zeta), 1.0)), np.inf)


def dimensionless_contact_time(damping_ratio: Values, ending: Ending = "zero-force") -> Values:
    r"""Contact time in units of the undamped :math:`1/\omega_0=\sqrt{m_{ij}/k_n}`.

    Parameters
    ----------
    damping_ratio : float or array, [-]
        :math:`\zeta \ge 0`.
    ending : {"zero-force", "zero-overlap"}
        See :func:`damping_ratio`.

    Returns
    -------
    float or array, [-]
        :math:`2h(\zeta)` at zero force; :math:`\pi/\sqrt{1-\zeta^2}` at zero overlap, inf from critical on.

    Raises
    ------
    CaseError
        ``damping_ratio`` negative or not finite.

    References
    ----------
    .. [1] Schwager, Poeschel, Granular Matter 9 (2007) 465-469, doi:10.1007/s10035-007-0065-z.

    Examples
    --------
    >>> dimensionless_contact_time(1.0), dimensionless_contact_time(1.0, "zero-overlap")
    (2.0, inf)
    """
    check_ending(ending)
    zeta = not_negative("damping_ratio", damping_ratio)
    return as_given(2.0 * peak_time_of(zeta) if ending == "zero-force" else zero_overlap_time(zeta))


def peak_time(damping_ratio: Values) -> Values:
    r"""Time of the largest overlap, :math:`\omega_0t=h(\zeta)`: half the zero-force contact time.

    Parameters
    ----------
    damping_ratio : float or array, [-]
        :math:`\zeta \ge 0`.

    Returns
    -------
    float or array, [-]

    Raises
    ------
    CaseError
        ``damping_ratio`` negative or not finite.

    Examples
    --------
    >>> peak_time(1.0)
    1.0
    """
    return as_given(peak_time_of(not_negative("damping_ratio", damping_ratio)))


def peak_overlap_factor(damping_ratio: Values) -> Values:
    r"""Largest overlap in units of :math:`v/\omega_0`, the same for both endings and exact in every regime.

    Parameters
    ----------
    damping_ratio : float or array, [-]
        :math:`\zeta \ge 0`.

    Returns
    -------
    float or array, [-]
        :math:`e^{-\zeta h(\zeta)}`: 1 without damping, 1/e at critical damping.

    Raises
    ------
    CaseError
        ``damping_ratio`` negative or not finite.

    Examples
    --------
    >>> peak_overlap_factor(0.0), round(peak_overlap_factor(1.0), 6)
    (1.0, 0.367879)
    """
    zeta = not_negative("damping_ratio", damping_ratio)
    return as_given(np.exp(-zeta * peak_time_of(zeta)))
