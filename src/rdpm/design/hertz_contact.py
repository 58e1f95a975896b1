r"""A damped Hertz contact: the damping of a restitution, duration and peak overlap, all without a fit.

With :math:`x=\delta^{5/4}` the impact :math:`m\ddot\delta+\eta\delta^{1/4}\dot\delta+k\delta^{3/2}=0` has the phase
plane of a linear oscillator of damping ratio :math:`\zeta=\eta/\sqrt{5mk}`: ``oscillator.py`` gives its restitution at
either contact end. Derivation: docs/theory/hertz.md.
"""

from __future__ import annotations

import math

import numpy as np

from rdpm.design._checks import Ending, Values, as_given, check_ending, positive, restitution_in_range, within
from rdpm.design.hertz import effective_modulus
from rdpm.design.oscillator import damping_ratio, peak_time_of, zero_overlap_time

__all__ = [
    "effective_shear_modulus",
    "hertz_damping",
    "hertz_duration",
    "hertz_peak_overlap",
    "hertz_speed",
    "hertz_stiffness",
]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(24)


def hertz_stiffness(reduced_radius: Values, effective_modulus: Values) -> Values:
    r"""Stiffness of a Hertz contact.

    Parameters
    ----------
    reduced_radius : float or array, [m]
        > 0, see :func:`reduced_radius`.
    effective_modulus : float or array, [Pa]
        > 0, see :func:`effective_modulus`.

    Returns
    -------
    float or array, [N/m^1.5]
        :math:`k=\tfrac43E^*\sqrt{R^*}`; the force is :math:`k\delta^{3/2}`.

    Raises
    ------
    CaseError
        An argument outside its range.

    References
    ----------
    .. [1] Johnson, Contact Mechanics (1985), eq. (4.23).

    Examples
    --------
    >>> round(hertz_stiffness(0.005, 2.5e10) * 274.1e-6**1.5)   # N at an overlap of 0.27 mm, glass
    10696
    """
    return as_given(4.0 / 3.0 * positive("effective_modulus", effective_modulus)
                    * np.sqrt(positive("reduced_radius", reduced_radius)))  # fmt: skip


def effective_shear_modulus(youngs_modulus: Values, poisson_ratio: Values) -> Values:
    r"""Effective shear modulus of two bodies of one material.

    Parameters
    ----------
    youngs_modulus : float or array, [Pa]
        > 0.
    poisson_ratio : float or array, [-]
        -1 < sigma <= 0.5.

    Returns
    -------
    float or array, [Pa]
        :math:`1/G^*=2(2-\sigma)/G`, :math:`G=E/(2(1+\sigma))`.

    Raises
    ------
    CaseError
        An argument outside its range.

    References
    ----------
    .. [1] Mindlin, J. Appl. Mech. 16 (1949) 259-268, doi:10.1115/1.4009973.

    Examples
    --------
    >>> round(effective_shear_modulus(1e7, 0.25) / 1e6, 4)
    1.1429
    """
    effective_modulus(youngs_modulus, poisson_ratio)  # refuses what is out of range
    s = np.asarray(poisson_ratio, dtype=np.float64)
    return as_given(np.asarray(youngs_modulus, dtype=np.float64) / (4.0 * (1.0 + s) * (2.0 - s)))


def hertz_damping(
    reduced_mass: Values, stiffness: Values, restitution: Values, ending: Ending = "zero-force"
) -> Values:
    r"""Damping that gives a restitution at every impact speed.

    Parameters
    ----------
    reduced_mass : float or array, [kg]
        > 0.
    stiffness : float or array, [N/m^1.5]
        > 0, see :func:`hertz_stiffness`.
    restitution : float or array, [-]
        Dry normal restitution, range as in :func:`damping_ratio`.
    ending : {"zero-force", "zero-overlap"}
        See :func:`damping_ratio`.

    Returns
    -------
    float or array, [N s/m^1.25]
        :math:`\eta=\sqrt{5m_{ij}k}\,\zeta(e_n)`; the force is :math:`\eta\delta^{1/4}\dot\delta`.

    Raises
    ------
    CaseError
        An argument outside its range.

    References
    ----------
    .. [1] Tsuji, Tanaka, Ishida, Powder Technol. 71 (1992) 239-250, doi:10.1016/0032-5910(92)88030-L.
    .. [2] Antypov, Elliott, EPL 94 (2011) 50004, doi:10.1209/0295-5075/94/50004.

    Examples
    --------
    >>> round(hertz_damping(1.0, 1.0, 0.5, "zero-overlap"), 4)   # alpha of Tsuji's figure
    0.4818
    """
    m, k = positive("reduced_mass", reduced_mass), positive("stiffness", stiffness)
    return as_given(np.asarray(damping_ratio(restitution, ending)) * np.sqrt(5.0 * m * k))


def hertz_peak_overlap(reduced_mass: Values, stiffness: Values, impact_speed: Values, damping: Values = 0.0) -> Values:
    r"""Largest overlap of a damped impact, the same for both contact ends.

    Parameters
    ----------
    reduced_mass : float or array, [kg]
        > 0.
    stiffness : float or array, [N/m^1.5]
        > 0.
    impact_speed : float or array, [m/s]
        > 0.
    damping : float or array, [N s/m^1.25]
        >= 0.

    Returns
    -------
    float or array, [m]
        :math:`[5mv^2/(4k)]^{2/5}e^{-\frac45\zeta h(\zeta)}`.

    Raises
    ------
    CaseError
        An argument outside its range.

    References
    ----------
    .. [1] Antypov, Elliott, EPL 94 (2011) 50004, doi:10.1209/0295-5075/94/50004.

    Examples
    --------
    >>> k = hertz_stiffness(0.005, 2.5e10)
    >>> round(hertz_peak_overlap(0.0058643, k, 20.0) * 1e6)   # glass spheres, 20 m/s [um]
    274
    """
    m, k, v = (positive(n, q) for n, q in (("reduced_mass", reduced_mass), ("stiffness", stiffness),
                                           ("impact_speed", impact_speed)))  # fmt: skip
    zeta = np.asarray(damping, dtype=np.float64) / np.sqrt(5.0 * m * k)
    return as_given((1.25 * m * v**2 / k) ** 0.4 * np.exp(-0.8 * zeta * peak_time_of(zeta)))


def hertz_speed(reduced_mass: Values, stiffness: Values, max_overlap: Values, damping: Values = 0.0) -> Values:
    r"""Impact speed that reaches an overlap, the inverse of :func:`hertz_peak_overlap`.

    Parameters
    ----------
    reduced_mass : float or array, [kg]
        > 0.
    stiffness : float or array, [N/m^1.5]
        > 0.
    max_overlap : float or array, [m]
        > 0.
    damping : float or array, [N s/m^1.25]
        >= 0.

    Returns
    -------
    float or array, [m/s]

    Raises
    ------
    CaseError
        An argument outside its range.

    Examples
    --------
    >>> round(hertz_speed(1.0, 1.0, hertz_peak_overlap(1.0, 1.0, 0.3, 0.5), 0.5), 12)
    0.3
    """
    m, k = positive("reduced_mass", reduced_mass), positive("stiffness", stiffness)
    zeta = np.asarray(damping, dtype=np.float64) / np.sqrt(5.0 * m * k)
    depth = positive("max_overlap", max_overlap) ** 1.25 * np.exp(zeta * peak_time_of(zeta))
    return as_given(depth * np.sqrt(0.8 * k / m))


def hertz_duration(
    reduced_mass: Values,
    stiffness: Values,
    impact_speed: Values,
    restitution: Values = 1.0,
    ending: Ending = "zero-force",
) -> Values:
    r"""Duration of a damped contact.

    Parameters
    ----------
    reduced_mass : float or array, [kg]
        > 0.
    stiffness : float or array, [N/m^1.5]
        > 0.
    impact_speed : float or array, [m/s]
        > 0.
    restitution : float or array, [-]
        0 < e_n <= 1; the damping is that of :func:`hertz_damping`.
    ending : {"zero-force", "zero-overlap"}
        See :func:`damping_ratio`.

    Returns
    -------
    float or array, [s]
        :math:`\tau(e_n)\,[m^2/(k^2v)]^{1/5}`; :math:`\tau(1)=3.218` (2.943 in terms of
        :math:`K=\tfrac45k`).

    Raises
    ------
    CaseError
        An argument outside its range.

    Notes
    -----
    :math:`\tau=\tfrac45\int_0^{s_c}x^{-1/5}\mathrm ds` over the linear oscillator x(s) by Gauss's rule: relative error
    below 1e-8 for restitutions of at least 0.05.

    References
    ----------
    .. [1] Antypov, Elliott, EPL 94 (2011) 50004, doi:10.1209/0295-5075/94/50004.

    Examples
    --------
    >>> k = hertz_stiffness(0.005, 2.5e10)
    >>> round(hertz_duration(0.0058643, k, 20.0) * 1e6, 1), round(hertz_duration(0.0058643, k, 20.0, 0.5) * 1e6, 1)
    (40.3, 35.4)
    """
    check_ending(ending)
    e = restitution_in_range(restitution, ending)
    within("restitution", e, e > 0.0, "must be above 0", "a contact without rebound has no duration")
    m, k, v = (positive(n, q) for n, q in (("reduced_mass", reduced_mass), ("stiffness", stiffness),
                                           ("impact_speed", impact_speed)))  # fmt: skip
    scale = (m**2 / (k**2 * v)) ** 0.2
    return as_given(_dimensionless_duration(e, ending) * scale)


def _dimensionless_duration(e: Values, ending: Ending) -> Values:
    """Give t_c / (m^2/(k^2 v))^(1/5)."""
    zeta = np.asarray(damping_ratio(e, ending))[..., None]
    end = 2.0 * peak_time_of(zeta) if ending == "zero-force" else zero_overlap_time(zeta)
    total: Values = 0.0
    # From both ends to the middle, s = c y^5: the integrand is then smooth where the overlap vanishes.
    y, w = 0.5 * (_NODES + 1.0), 0.5 * _WEIGHTS
    half = 0.5 * end
    for s in (half * y**5, end - half * y**5):
        decay = np.sqrt(np.abs((1.0 - zeta) * (1.0 + zeta)))
        angle = decay * s
        wave = np.where(zeta < 1.0, np.sin(angle), np.sinh(angle))
        x = np.exp(-zeta * s) * np.where(decay > 1e-7, wave / np.where(decay > 1e-7, decay, 1.0), s)
        total = total + np.sum(w * 5.0 * half * y**4 * x**-0.2, axis=-1)
    # In time units of the oscillator's frequency sqrt(4/5): x is in 1/sqrt(4/5), s as well.
    return 0.8 * math.sqrt(1.25) ** 0.8 * total
