"""What the real, elastic material would do: Hertz contact time and overlap, Rayleigh time."""

from __future__ import annotations

import math

import numpy as np

from rdpm.design._checks import Values, as_given, positive, within

__all__ = ["effective_modulus", "hertz_contact_time", "hertz_overlap", "rayleigh_time", "reduced_radius"]

# 2 * integral_0^1 dx / sqrt(1 - x^(5/2)): contact time over (peak overlap / speed)
HERTZ_FACTOR = 0.8 * math.sqrt(math.pi) * math.gamma(0.4) / math.gamma(0.9)


def reduced_radius(radius: Values, other_radius: Values = np.inf) -> Values:
    r"""Radius :math:`R_iR_j/(R_i+R_j)` of the equivalent sphere on a flat wall.

    Parameters
    ----------
    radius : float or array, [m]
        > 0.
    other_radius : float or array, [m]
        > 0; inf is a flat wall.

    Returns
    -------
    float or array, [m]

    Raises
    ------
    CaseError
        An argument outside its range.

    Examples
    --------
    >>> reduced_radius(0.01, 0.01), reduced_radius(0.01)
    (0.005, 0.01)
    """
    other = np.asarray(other_radius, dtype=np.float64)
    within("other_radius", other, other > 0.0, "must be above 0, or inf for a wall")
    return as_given(1.0 / (1.0 / positive("radius", radius) + 1.0 / other))


def effective_modulus(
    youngs_modulus: Values,
    poisson_ratio: Values,
    other_modulus: Values | None = None,
    other_poisson_ratio: Values = 0.3,
) -> Values:
    r"""Effective modulus of two elastic bodies.

    Parameters
    ----------
    youngs_modulus : float or array, [Pa]
        :math:`E` > 0.
    poisson_ratio : float or array, [-]
        :math:`\sigma`, -1 < sigma <= 0.5.
    other_modulus : float or array, [Pa], optional
        > 0, inf for a rigid wall. Default: both bodies of the first material.
    other_poisson_ratio : float or array, [-]
        Used with ``other_modulus``.

    Returns
    -------
    float or array, [Pa]
        :math:`1/E^*=(1-\sigma_1^2)/E_1+(1-\sigma_2^2)/E_2`.

    Raises
    ------
    CaseError
        An argument outside its range.

    References
    ----------
    .. [1] Johnson, Contact Mechanics (1985), eq. (4.24).

    Examples
    --------
    >>> round(effective_modulus(1e7, 0.3) / 1e6, 4)
    5.4945
    """
    e, s = positive("youngs_modulus", youngs_modulus), np.asarray(poisson_ratio, dtype=np.float64)
    rule, why = "must be in -1 < sigma <= 0.5", "an elastic solid's range"
    within("poisson_ratio", s, (s > -1.0) & (s <= 0.5), rule, why)
    compliance = (1.0 - s * s) / e
    if other_modulus is None:
        return as_given(0.5 / compliance)
    e2, s2 = (np.asarray(q, dtype=np.float64) for q in (other_modulus, other_poisson_ratio))
    within("other_modulus", e2, e2 > 0.0, "must be above 0, or inf for a rigid wall")
    within("other_poisson_ratio", s2, (s2 > -1.0) & (s2 <= 0.5), rule, why)
    return as_given(1.0 / (compliance + (1.0 - s2 * s2) / e2))


def hertz_overlap(
    reduced_mass: Values, reduced_radius: Values, effective_modulus: Values, impact_speed: Values
) -> Values:
    r"""Largest overlap of an elastic impact.

    Parameters
    ----------
    reduced_mass : float or array, [kg]
        > 0.
    reduced_radius : float or array, [m]
        :math:`R^*` > 0, see :func:`reduced_radius`.
    effective_modulus : float or array, [Pa]
        :math:`E^*` > 0, see :func:`effective_modulus`.
    impact_speed : float or array, [m/s]
        > 0.

    Returns
    -------
    float or array, [m]
        :math:`\delta_m=[15mv^2/(16E^*\sqrt{R^*})]^{2/5}`.

    Raises
    ------
    CaseError
        An argument outside its range.

    References
    ----------
    .. [1] Johnson, Contact Mechanics (1985), eq. (11.21).

    Examples
    --------
    >>> round(hertz_overlap(0.0058643, 0.005, 2.5e10, 20.0) * 1e6)   # glass spheres, 20 m/s [um]
    274
    """
    stiffness = 16.0 / 15.0 * positive("effective_modulus", effective_modulus)
    stiffness = stiffness * np.sqrt(positive("reduced_radius", reduced_radius))
    energy = positive("reduced_mass", reduced_mass) * positive("impact_speed", impact_speed) ** 2
    return as_given((energy / stiffness) ** 0.4)


def hertz_contact_time(
    reduced_mass: Values, reduced_radius: Values, effective_modulus: Values, impact_speed: Values
) -> Values:
    r"""Duration of an elastic impact: the lower limit of a designed contact time.

    Parameters
    ----------
    reduced_mass : float or array, [kg]
        > 0.
    reduced_radius : float or array, [m]
        > 0, see :func:`reduced_radius`.
    effective_modulus : float or array, [Pa]
        > 0, see :func:`effective_modulus`.
    impact_speed : float or array, [m/s]
        > 0.

    Returns
    -------
    float or array, [s]
        :math:`2.943\,[m_{ij}^2/(K^2v)]^{1/5}` with :math:`K=\tfrac{16}{15}E^*\sqrt{R^*}`,
        for equal materials :math:`8E/(15(1-\sigma^2))\sqrt{R^*}`.

    Raises
    ------
    CaseError
        An argument outside its range.

    Notes
    -----
    The mass is squared; a printed version with its first power is not a time.

    References
    ----------
    .. [1] Johnson, Contact Mechanics (1985), eq. (11.24); Landau, Lifshitz, Theory of Elasticity, sec. 9.

    Examples
    --------
    >>> round(hertz_contact_time(0.0058643, 0.005, 2.5e10, 20.0) * 1e6, 1)   # [us]
    40.3
    """
    overlap = hertz_overlap(reduced_mass, reduced_radius, effective_modulus, impact_speed)
    return as_given(HERTZ_FACTOR * np.asarray(overlap) / np.asarray(impact_speed, dtype=np.float64))


def rayleigh_time(radius: Values, density: Values, youngs_modulus: Values, poisson_ratio: Values) -> Values:
    r"""Time a surface wave takes over half a sphere: a contact shorter than this is not quasi-static.

    Parameters
    ----------
    radius : float or array, [m]
        > 0.
    density : float or array, [kg/m^3]
        Of the sphere, > 0.
    youngs_modulus : float or array, [Pa]
        > 0.
    poisson_ratio : float or array, [-]
        -1 < sigma <= 0.5.

    Returns
    -------
    float or array, [s]
        :math:`\pi R\sqrt{\rho/G}/(0.1631\sigma+0.8766)`, :math:`G=E/(2(1+\sigma))`.

    Raises
    ------
    CaseError
        An argument outside its range.

    References
    ----------
    .. [1] Li, Xu, Thornton, Powder Technol. 160 (2005) 219-228, doi:10.1016/j.powtec.2005.09.002.

    Examples
    --------
    >>> round(rayleigh_time(0.5e-3, 2500.0, 7e10, 0.22) * 1e6, 3)   # a 1 mm glass bead [us]
    0.508
    """
    s = np.asarray(poisson_ratio, dtype=np.float64)
    ok = (s > -1.0) & (s <= 0.5)
    within("poisson_ratio", s, ok, "must be in -1 < sigma <= 0.5", "an elastic solid's range")
    shear = positive("youngs_modulus", youngs_modulus) / (2.0 * (1.0 + s))
    wave = np.sqrt(positive("density", density) / shear)
    return as_given(math.pi * positive("radius", radius) * wave / (0.1631 * s + 0.8766))
