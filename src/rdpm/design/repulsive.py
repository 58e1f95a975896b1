r"""A short-range repulsive force: closest gap, and the force that keeps a wanted one.

The force :math:`F=F_0(1-g/\rho)^2` of gaps :math:`g<\rho` is conservative; its work from :math:`\rho` to g is
:math:`\tfrac13F_0\rho(1-g/\rho)^3`. Derivation: docs/theory/repulsive.md.
"""

from __future__ import annotations

import numpy as np

from rdpm.design._checks import Values, as_given, not_negative, positive, within

__all__ = ["closest_gap", "repulsion_stiffness", "repulsion_time", "resting_gap", "weight_stiffness"]


def closest_gap(reduced_mass: Values, stiffness: Values, range: Values, approach_speed: Values) -> Values:
    r"""Smallest gap of a head-on approach without other forces.

    Parameters
    ----------
    reduced_mass : float or array, [kg]
        > 0.
    stiffness : float or array, [N]
        Force at touch :math:`F_0` > 0.
    range : float or array, [m]
        :math:`\rho` > 0.
    approach_speed : float or array, [m/s]
        >= 0, at the range.

    Returns
    -------
    float or array, [m]
        :math:`\rho-\rho[3mv^2/(2F_0\rho)]^{1/3}`; negative where the surfaces overlap.

    Raises
    ------
    CaseError
        An argument outside its range.

    Examples
    --------
    >>> closest_gap(1e-3, 1.5, 1e-3, 1.0) == 0.0   # just touching
    True
    """
    m, f, rho = _positive(reduced_mass=reduced_mass, stiffness=stiffness, range=range)
    v = not_negative("approach_speed", approach_speed)
    return as_given(rho - rho * np.cbrt(1.5 * m * v**2 / (f * rho)))


def repulsion_stiffness(reduced_mass: Values, range: Values, approach_speed: Values, gap: Values = 0.0) -> Values:
    r"""Force at touch that stops a head-on approach at a gap.

    Parameters
    ----------
    reduced_mass : float or array, [kg]
        > 0.
    range : float or array, [m]
        :math:`\rho` > 0.
    approach_speed : float or array, [m/s]
        > 0.
    gap : float or array, [m]
        Closest wanted, 0 <= gap < range.

    Returns
    -------
    float or array, [N]
        :math:`F_0=3mv^2/(2\rho(1-g/\rho)^3)`.

    Raises
    ------
    CaseError
        An argument outside its range.

    Examples
    --------
    >>> round(closest_gap(1e-3, repulsion_stiffness(1e-3, 1e-3, 1.0, 4e-4), 1e-3, 1.0), 9)
    0.0004
    """
    m, rho, v = _positive(reduced_mass=reduced_mass, range=range, approach_speed=approach_speed)
    return as_given(1.5 * m * v**2 / (rho * _depth(gap, rho) ** 3))


def weight_stiffness(weight: Values, range: Values, gap: Values = 0.0) -> Values:
    r"""Force at touch that carries a weight at a gap.

    Parameters
    ----------
    weight : float or array, [N]
        Submerged, > 0.
    range : float or array, [m]
        :math:`\rho` > 0.
    gap : float or array, [m]
        0 <= gap < range.

    Returns
    -------
    float or array, [N]
        :math:`F_0=W/(1-g/\rho)^2`.

    Raises
    ------
    CaseError
        An argument outside its range.

    Examples
    --------
    >>> weight_stiffness(1.0, 1e-3, 5e-4)
    4.0
    """
    w, rho = _positive(weight=weight, range=range)
    return as_given(w / _depth(gap, rho) ** 2)


def resting_gap(weight: Values, stiffness: Values, range: Values) -> Values:
    r"""Gap at which the force carries a weight.

    Parameters
    ----------
    weight : float or array, [N]
        >= 0.
    stiffness : float or array, [N]
        > 0.
    range : float or array, [m]
        > 0.

    Returns
    -------
    float or array, [m]
        :math:`\rho(1-\sqrt{W/F_0})`; negative where the surfaces overlap.

    Raises
    ------
    CaseError
        An argument outside its range.

    Examples
    --------
    >>> resting_gap(1.0, 4.0, 1e-3)
    0.0005
    """
    f, rho = _positive(stiffness=stiffness, range=range)
    return as_given(rho * (1.0 - np.sqrt(not_negative("weight", weight) / f)))


def repulsion_time(reduced_mass: Values, stiffness: Values, range: Values) -> Values:
    r"""Time that steps must resolve: half a period at the slope of the force at touch.

    Parameters
    ----------
    reduced_mass : float or array, [kg]
        > 0.
    stiffness : float or array, [N]
        > 0.
    range : float or array, [m]
        > 0.

    Returns
    -------
    float or array, [s]
        :math:`\pi\sqrt{m\rho/(2F_0)}`.

    Raises
    ------
    CaseError
        An argument outside its range.

    Examples
    --------
    >>> round(repulsion_time(2.0, 1.0, 1.0), 4)
    3.1416
    """
    m, f, rho = _positive(reduced_mass=reduced_mass, stiffness=stiffness, range=range)
    return as_given(np.pi * np.sqrt(0.5 * m * rho / f))


def _positive(**values: Values) -> tuple[Values, ...]:
    return tuple(positive(name, value) for name, value in values.items())


def _depth(gap: Values, rho: Values) -> Values:
    g = not_negative("gap", gap)
    within("gap", g, g < rho, "must be below the range", "the force acts within its range alone")
    return 1.0 - g / rho
