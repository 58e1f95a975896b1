"""Stokes and Reynolds numbers of an impact, and the speed a sphere brings to it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from rdpm.design._checks import Values, as_given, not_negative, positive, within

__all__ = [
    "CRITICAL_STOKES",
    "added_mass",
    "legendre",
    "reduced_mass",
    "sphere_mass",
    "stokes_number",
    "terminal_velocity",
    "wet_restitution",
]

CRITICAL_STOKES = 10.0
"""Stokes number below which a sphere does not rebound from a wall in a liquid [-] (Gondret et al. 2002)."""

_ADDED_MASS = 0.5
_LEGENDRE_BETA = 35.0


def sphere_mass(diameter: Values, density: Values) -> Values:
    r"""Mass of a solid sphere, :math:`\pi\rho d^3/6`.

    Parameters
    ----------
    diameter : float or array, [m]
        > 0.
    density : float or array, [kg/m^3]
        > 0.

    Returns
    -------
    float or array, [kg]

    Raises
    ------
    CaseError
        An argument outside its range.

    Examples
    --------
    >>> round(sphere_mass(0.015, 1120.0) * 1e3, 4)   # [g]
    1.9792
    """
    return as_given(math.pi / 6.0 * positive("density", density) * positive("diameter", diameter) ** 3)


def added_mass(diameter: Values, fluid_density: Values) -> Values:
    r"""Added mass of a sphere in an unbounded fluid, :math:`\tfrac12\rho_f\pi d^3/6`.

    Parameters
    ----------
    diameter : float or array, [m]
        > 0.
    fluid_density : float or array, [kg/m^3]
        > 0.

    Returns
    -------
    float or array, [kg]

    Raises
    ------
    CaseError
        An argument outside its range.

    Examples
    --------
    >>> added_mass(0.015, 1000.0) / sphere_mass(0.015, 1000.0)
    0.5
    """
    return as_given(_ADDED_MASS * np.asarray(sphere_mass(diameter, positive("fluid_density", fluid_density))))


def reduced_mass(mass: Values, other_mass: Values = np.inf) -> Values:
    r"""Reduced mass of a pair; the body's own mass against a wall.

    Parameters
    ----------
    mass : float or array, [kg]
        > 0.
    other_mass : float or array, [kg]
        > 0; inf is a wall, or a body held fixed.

    Returns
    -------
    float or array, [kg]
        :math:`m_{ij}=(1/m_i+1/m_j)^{-1}`.

    Raises
    ------
    CaseError
        An argument outside its range.

    Examples
    --------
    >>> reduced_mass(2.0, 2.0), reduced_mass(2.0)
    (1.0, 2.0)
    """
    other = np.asarray(other_mass, dtype=np.float64)
    within("other_mass", other, other > 0.0, "must be above 0, or inf for a wall")
    return as_given(1.0 / (1.0 / positive("mass", mass) + 1.0 / other))


def stokes_number(
    reduced_mass: Values, reduced_radius: Values, impact_speed: Values, viscosity: Values
) -> Values:
    r"""Inertia of an approach over the viscous force that slows it.

    Parameters
    ----------
    reduced_mass : float or array, [kg]
        > 0.
    reduced_radius : float or array, [m]
        :math:`a_ia_j/(a_i+a_j)`; the sphere's own radius against a wall. > 0.
    impact_speed : float or array, [m/s]
        >= 0.
    viscosity : float or array, [Pa s]
        Dynamic, > 0.

    Returns
    -------
    float or array, [-]
        :math:`St=m_{ij}v/(6\pi\mu a_{ij}^2)`; against a wall :math:`\rho_pvd/(9\mu)`, for an
        equal pair twice that.

    Raises
    ------
    CaseError
        An argument outside its range.

    References
    ----------
    .. [1] Davis, Serayssol, Hinch, J. Fluid Mech. 163 (1986) 479-497, doi:10.1017/S0022112086002392.

    Examples
    --------
    >>> m = sphere_mass(0.006, 7800.0)
    >>> round(stokes_number(m, 0.003, 0.585, 0.02), 1), round(7800.0 * 0.585 * 0.006 / (9 * 0.02), 1)
    (152.1, 152.1)
    """
    drag = 6.0 * math.pi * positive("viscosity", viscosity) * positive("reduced_radius", reduced_radius) ** 2
    momentum = positive("reduced_mass", reduced_mass) * not_negative("impact_speed", impact_speed)
    return as_given(momentum / drag)


def legendre(restitution: Values, stokes_number: Values) -> Values:
    r"""Effective restitution in a liquid at a Stokes number that has the added mass in it.

    Parameters
    ----------
    restitution : float or array, [-]
        Dry restitution, 0 to 1.
    stokes_number : float or array, [-]
        :math:`St^*`, >= 0: that of :func:`stokes_number` for the reduced mass of two spheres each with its
        added mass (:func:`added_mass`).

    Returns
    -------
    float or array, [-]
        :math:`e\,\exp(-35/St^*)`.

    Raises
    ------
    CaseError
        An argument outside its range.

    Notes
    -----
    A fit to rebounds from a wall, the constant included; used for pairs as it stands. Roughness and the
    viscosity of the lubrication layer are not covered, and near the critical Stokes number it is an estimate.

    References
    ----------
    .. [1] Legendre, Daniel, Guiraud, Phys. Fluids 17 (2005) 097105, doi:10.1063/1.2010527.

    Examples
    --------
    >>> round(legendre(1.0, 100.0), 4)
    0.7047
    """
    e, st = not_negative("restitution", restitution), not_negative("stokes_number", stokes_number)
    with np.errstate(divide="ignore"):
        return as_given(e * np.exp(-_LEGENDRE_BETA / st))


def wet_restitution(restitution: Values, stokes_number: Values, density_ratio: Values) -> Values:
    r"""Effective restitution in a liquid, by Legendre's correlation.

    Parameters
    ----------
    restitution : float or array, [-]
        Dry restitution, 0 to 1.
    stokes_number : float or array, [-]
        Of the impact, >= 0; see :func:`stokes_number`.
    density_ratio : float or array, [-]
        :math:`\rho_p/\rho_f` > 0; the added mass (coefficient 0.5) joins the sphere's inertia.

    Returns
    -------
    float or array, [-]
        :math:`e\,\exp(-35/St^*)`, :math:`St^*=St\,(1+0.5\rho_f/\rho_p)`.

    Raises
    ------
    CaseError
        An argument outside its range.

    Notes
    -----
    For a sphere and a wall, or two spheres of one density; :func:`legendre` takes the Stokes number of any pair.

    References
    ----------
    .. [1] Legendre, Daniel, Guiraud, Phys. Fluids 17 (2005) 097105, doi:10.1063/1.2010527.

    Examples
    --------
    >>> round(wet_restitution(0.97, 152.0, 7.8), 3)
    0.781
    """
    st = not_negative("stokes_number", stokes_number)
    return legendre(restitution, st * (1.0 + _ADDED_MASS / positive("density_ratio", density_ratio)))


def terminal_velocity(
    diameter: Values, density: Values, fluid_density: Values, viscosity: Values, gravity: Values = 9.81
) -> tuple[Values, Values]:
    r"""Speed and Reynolds number of one sphere falling (or rising) alone, by Brown and Lawler's drag.

    Parameters
    ----------
    diameter : float or array, [m]
        > 0.
    density : float or array, [kg/m^3]
        Of the sphere, > 0.
    fluid_density : float or array, [kg/m^3]
        > 0.
    viscosity : float or array, [Pa s]
        Dynamic, > 0.
    gravity : float or array, [m/s^2]
        >= 0.

    Returns
    -------
    speed : float or array, [m/s]
    reynolds_number : float or array, [-]
        :math:`Re=\rho_fvd/\mu`.

    Raises
    ------
    CaseError
        An argument outside its range.

    Notes
    -----
    :math:`C_D=24/Re\,(1+0.15Re^{0.681})+0.407/(1+8710/Re)`, for Re < 2e5; walls and wakes are not covered.

    References
    ----------
    .. [1] Brown, Lawler, J. Environ. Eng. 129 (2003) 222-231, doi:10.1061/(ASCE)0733-9372(2003)129:3(222).

    Examples
    --------
    >>> speed, re = terminal_velocity(0.015, 1120.0, 962.0, 0.113)
    >>> round(speed, 3), round(re, 1)
    (0.094, 12.0)
    """
    d, rho_f = positive("diameter", diameter), positive("fluid_density", fluid_density)
    nu = positive("viscosity", viscosity) / rho_f
    excess = np.abs(positive("density", density) / rho_f - 1.0)
    # C_D Re^2 = 4/3 Ga^2 at terminal velocity
    re = _reynolds(4.0 / 3.0 * excess * not_negative("gravity", gravity) * d**3 / nu**2)
    return as_given(re * nu / d), as_given(re)


def _reynolds(drag_load: Any) -> Any:
    """Solve C_D Re^2 = drag_load by Newton in ln Re from Stokes' side; the left side is monotone."""
    target = np.where(drag_load > 0.0, drag_load, 1.0)
    re = target / 24.0
    for _ in range(60):
        load = 24.0 * re * (1.0 + 0.15 * re**0.681) + 0.407 * re**3 / (re + 8710.0)
        slope = 24.0 * (1.0 + 0.15 * 1.681 * re**0.681)
        slope = slope + 0.407 * re**2 * (2.0 * re + 3.0 * 8710.0) / (re + 8710.0) ** 2
        step = (load - target) / (slope * re)
        re = re * np.exp(-np.clip(step, -2.0, 2.0))
        if np.all(np.abs(step) < 1e-14):
            break
    return np.where(drag_load > 0.0, re, 0.0)
