"""What a finite contact time changes: a soft sphere against the hard one, both dry."""

from __future__ import annotations

from typing import NamedTuple

from rdpm.design._checks import Ending
from rdpm.design.soft_sphere import contact_parameters, peak_overlap

__all__ = ["FiniteContact", "finite_contact_error"]


class FiniteContact(NamedTuple):
    """How far a soft sphere is from the hard one.

    Parameters
    ----------
    time_ratio : float, [-]
        Contact time over the time d / v in which the sphere crosses its diameter.
    overlap : float, [-]
        Peak overlap over the diameter; that of a hard sphere is zero.
    lag : float, [-]
        Distance over the diameter by which the soft sphere is behind after the rebound.
    """

    time_ratio: float
    overlap: float
    lag: float


def finite_contact_error(
    contact_time: float, restitution: float, diameter: float, impact_speed: float, ending: Ending = "zero-force"
) -> FiniteContact:
    r"""Error of a soft sphere's rebound against that of a hard sphere of the same restitution.

    A hard sphere is :math:`e_n v t_c` from the place of touch when the soft one lets go; that distance remains, and
    with it the overlap at which a contact without attraction ends.

    Parameters
    ----------
    contact_time : float, [s]
        :math:`t_c=N_c\,\delta t`. > 0.
    restitution : float, [-]
        Dry, 0 < e_n <= 1.
    diameter : float, [m]
        The smaller one. > 0.
    impact_speed : float, [m/s]
        Normal, at touch. > 0.
    ending : {"zero-force", "zero-overlap"}

    Returns
    -------
    FiniteContact

    Raises
    ------
    CaseError
        An argument outside its range.

    Notes
    -----
    All three are proportional to the contact time. Load and lubrication are left out.

    Examples
    --------
    >>> error = finite_contact_error(contact_time=1e-3, restitution=1.0, diameter=0.01, impact_speed=0.1)
    >>> round(error.time_ratio, 4), round(error.overlap, 5), round(error.lag, 4)
    (0.01, 0.00318, 0.01)
    """
    k_n, eta_n = contact_parameters(1.0, restitution, contact_time, ending)
    deepest = float(peak_overlap(1.0, k_n, eta_n, impact_speed))
    rebound = restitution * impact_speed
    left = float(eta_n) * rebound / float(k_n) if ending == "zero-force" else 0.0
    ratio = contact_time * impact_speed / diameter
    return FiniteContact(ratio, deepest / diameter, (rebound * contact_time + left) / diameter)
