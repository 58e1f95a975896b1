"""Inverse questions: which time step, contact steps, spring or speed keeps to a limit."""

from __future__ import annotations

import math

import numpy as np

from rdpm.design._checks import Ending, Values, as_given, not_negative, positive
from rdpm.design.oscillator import damping_ratio, dimensionless_contact_time, peak_overlap_factor

__all__ = [
    "contact_steps_for_stiffness",
    "impact_speed_for_overlap",
    "largest_contact_time",
    "largest_time_step",
    "softest_stiffness",
    "static_overlap",
    "submerged_weight",
]


def submerged_weight(
    diameter: Values, density: Values, fluid_density: Values = 0.0, gravity: Values = 9.81
) -> Values:
    r"""Weight of a sphere less its buoyancy, as a magnitude.

    Parameters
    ----------
    diameter : float or array, [m]
        > 0.
    density : float or array, [kg/m^3]
        > 0.
    fluid_density : float or array, [kg/m^3]
        >= 0; 0 is dry.
    gravity : float or array, [m/s^2]
        >= 0.

    Returns
    -------
    float or array, [N]
        :math:`|\rho_p-\rho_f|\,g\,\pi d^3/6`.

    Raises
    ------
    CaseError
        An argument outside its range.

    Examples
    --------
    >>> round(submerged_weight(0.015, 1120.0, 962.0) * 1e3, 3)   # [mN]
    2.739
    """
    excess = np.abs(positive("density", density) - not_negative("fluid_density", fluid_density))
    volume = math.pi / 6.0 * positive("diameter", diameter) ** 3
    return as_given(excess * not_negative("gravity", gravity) * volume)


def static_overlap(stiffness: Values, load: Values) -> Values:
    r"""Overlap under a steady load, :math:`W/k_n`.

    Parameters
    ----------
    stiffness : float or array, [N/m]
        > 0.
    load : float or array, [N]
        >= 0, e.g. :func:`submerged_weight`.

    Returns
    -------
    float or array, [m]

    Raises
    ------
    CaseError
        An argument outside its range.

    Examples
    --------
    >>> round(static_overlap(5.0, submerged_weight(0.015, 1120.0, 962.0)) / 0.015, 3)   # 5000 dyn/cm, of d
    0.037
    """
    return as_given(not_negative("load", load) / positive("stiffness", stiffness))


def softest_stiffness(load: Values, overlap_limit: Values) -> Values:
    """Softest spring that holds a steady load within an overlap.

    Parameters
    ----------
    load : float or array, [N]
        >= 0.
    overlap_limit : float or array, [m]
        > 0.

    Returns
    -------
    float or array, [N/m]

    Raises
    ------
    CaseError
        An argument outside its range.

    Examples
    --------
    >>> round(softest_stiffness(2.739e-3, 0.005 * 0.015), 2)
    36.52
    """
    return as_given(not_negative("load", load) / positive("overlap_limit", overlap_limit))


def largest_contact_time(
    restitution: Values, overlap_limit: Values, impact_speed: Values, ending: Ending = "zero-force"
) -> Values:
    r"""Longest contact whose overlap keeps within a limit at an impact speed, whatever the mass.

    Parameters
    ----------
    restitution : float or array, [-]
        0 < e_n <= 1; 0 at zero overlap gives inf.
    overlap_limit : float or array, [m]
        > 0.
    impact_speed : float or array, [m/s]
        > 0.
    ending : {"zero-force", "zero-overlap"}
        When the contact is over.

    Returns
    -------
    float or array, [s]
        :math:`t_c=(\delta/v)\,\omega_0t_c\,e^{\zeta h}`.

    Raises
    ------
    CaseError
        An argument outside its range.

    Examples
    --------
    >>> round(largest_contact_time(0.5, 0.005 * 0.015, 0.04066, "zero-overlap"), 5)
    0.008
    """
    zeta = np.asarray(damping_ratio(restitution, ending))
    time = positive("overlap_limit", overlap_limit) / positive("impact_speed", impact_speed)
    tau = np.asarray(dimensionless_contact_time(zeta, ending))
    return as_given(time * tau / np.asarray(peak_overlap_factor(zeta)))


def largest_time_step(
    restitution: Values,
    contact_steps: Values,
    overlap_limit: Values,
    impact_speed: Values,
    ending: Ending = "zero-force",
) -> Values:
    r"""Largest time step for an overlap limit at given contact steps.

    Parameters
    ----------
    restitution : float or array, [-]
        0 < e_n <= 1.
    contact_steps : float or array, [-]
        :math:`N_c` > 0.
    overlap_limit : float or array, [m]
        > 0.
    impact_speed : float or array, [m/s]
        > 0.
    ending : {"zero-force", "zero-overlap"}
        When the contact is over.

    Returns
    -------
    float or array, [s]

    Raises
    ------
    CaseError
        An argument outside its range.

    Examples
    --------
    >>> round(largest_time_step(0.5, 8, 0.005 * 0.015, 0.04066, "zero-overlap"), 5)
    0.001
    """
    longest = np.asarray(largest_contact_time(restitution, overlap_limit, impact_speed, ending))
    return as_given(longest / positive("contact_steps", contact_steps))


def contact_steps_for_stiffness(
    reduced_mass: Values,
    restitution: Values,
    stiffness: Values,
    time_step: Values,
    ending: Ending = "zero-force",
) -> Values:
    r"""Contact steps :math:`N_c` at which the designed spring has a given stiffness.

    Parameters
    ----------
    reduced_mass : float or array, [kg]
        > 0.
    restitution : float or array, [-]
        0 < e_n <= 1.
    stiffness : float or array, [N/m]
        > 0.
    time_step : float or array, [s]
        > 0.
    ending : {"zero-force", "zero-overlap"}
        When the contact is over.

    Returns
    -------
    float or array, [-]
        Not rounded; inf where the contact never ends.

    Raises
    ------
    CaseError
        An argument outside its range.

    Examples
    --------
    >>> round(contact_steps_for_stiffness(0.9902467e-3, 0.5, 100.0, 1e-3, "zero-overlap"), 2)   # 1e5 dyn/cm
    10.12
    """
    tau = np.asarray(dimensionless_contact_time(damping_ratio(restitution, ending), ending))
    period = np.sqrt(positive("reduced_mass", reduced_mass) / positive("stiffness", stiffness))
    return as_given(tau * period / positive("time_step", time_step))


def impact_speed_for_overlap(
    restitution: Values, contact_time: Values, overlap_limit: Values, ending: Ending = "zero-force"
) -> Values:
    r"""Impact speed at which a contact of given duration reaches an overlap limit, whatever the mass.

    Parameters
    ----------
    restitution : float or array, [-]
        0 < e_n <= 1.
    contact_time : float or array, [s]
        > 0.
    overlap_limit : float or array, [m]
        > 0.
    ending : {"zero-force", "zero-overlap"}
        When the contact is over.

    Returns
    -------
    float or array, [m/s]

    Raises
    ------
    CaseError
        An argument outside its range.

    Examples
    --------
    >>> round(100 * impact_speed_for_overlap(0.5, 8e-3, 0.005 * 0.015, "zero-overlap"), 2)   # [cm/s]
    4.07
    """
    longest_at_unit_speed = np.asarray(largest_contact_time(restitution, overlap_limit, 1.0, ending))
    return as_given(longest_at_unit_speed / positive("contact_time", contact_time))
