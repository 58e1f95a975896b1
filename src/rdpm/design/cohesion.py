"""Cohesion of two surfaces as a square well: force, energy, and the speed below which a pair sticks."""

from __future__ import annotations

import numpy as np

from rdpm.design._checks import Values, as_given, not_negative, positive, within

__all__ = ["pull_off_force", "sticking_speed"]


def pull_off_force(reduced_radius: Values, cohesion: Values) -> Values:
    r"""Force that parts two adhering spheres (Johnson, Kendall, Roberts).

    Parameters
    ----------
    reduced_radius : float or array, [m]
        :math:`R_{ij}=a_ia_j/(a_i+a_j)`; the radius against a wall. >= 0.
    cohesion : float or array, [J/m^2]
        Work of adhesion w >= 0.

    Returns
    -------
    float or array, [N]
        :math:`\tfrac32\pi wR_{ij}`.

    Raises
    ------
    CaseError
        An argument outside its range.

    References
    ----------
    .. [1] Johnson, Kendall, Roberts, Proc. R. Soc. A 324 (1971) 301-313, doi:10.1098/rspa.1971.0141.

    Examples
    --------
    >>> round(pull_off_force(1e-3, 0.05), 9)
    0.000235619
    """
    radius, w = not_negative("reduced_radius", reduced_radius), not_negative("cohesion", cohesion)
    return as_given(1.5 * np.pi * w * radius)


def sticking_speed(reduced_mass: Values, pull_off: Values, well: Values, restitution: Values) -> Values:
    r"""Speed from afar below which two surfaces stay together.

    The well gives :math:`W=Fr` on the way in; of the speed at touch the rebound has :math:`e_n`, and needs W to leave.

    Parameters
    ----------
    reduced_mass : float or array, [kg]
        > 0.
    pull_off, well : float or array, [N], [m]
        Force F and range r of the well. >= 0.
    restitution : float or array, [-]
        0 < e_n <= 1.

    Returns
    -------
    float or array, [m/s]
        :math:`\sqrt{2Fr(1/e_n^2-1)/m_{ij}}`. What the attraction does to the contact itself, a lower restitution of
        slow impacts, is left out.

    Raises
    ------
    CaseError
        An argument outside its range.

    Examples
    --------
    >>> round(sticking_speed(1e-6, 2e-4, 1e-5, 0.8), 5)
    0.04743
    """
    e = np.asarray(restitution, dtype=np.float64)
    within("restitution", e, (e > 0.0) & (e <= 1.0), "must be in 0 < e_n <= 1")
    energy = not_negative("pull_off", pull_off) * not_negative("well", well)
    return as_given(np.sqrt(2.0 * energy * (1.0 / e**2 - 1.0) / positive("reduced_mass", reduced_mass)))
