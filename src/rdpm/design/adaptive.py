r"""Adaptive collision time model: a Hertz-type contact whose duration and restitution are the same at every speed.

.. math:: m\ddot\delta + d\dot\delta + k\delta^{3/2} = 0,\quad \delta(0)=0,\ \dot\delta(0)=v.

With the time :math:`t_*=(m^2/(k^2v))^{1/5}` and the length :math:`vt_*` it is
:math:`x''+2\lambda x'+x^{3/2}=0`, x'(0) = 1; restitution and :math:`T_c/t_*` depend on :math:`\lambda` alone.
"""

from __future__ import annotations

import math
from functools import lru_cache

from rdpm.design._checks import Ending, check_ending, positive
from rdpm.errors import CaseError

__all__ = ["adaptive_collision", "adaptive_overlap", "adaptive_stiffness"]

_STEP = 0.01  # of the dimensionless time, whose contact lasts 3.2 and more; with RK4 7 digits
_STRONG = 1.5  # damping without a rebound
_LONG = 30.0  # contacts that last longer do not rebound


@lru_cache(maxsize=64)
def _impact(damping: float, ending: str) -> tuple[float, float, float]:
    """Restitution, duration and peak of x'' + 2 lambda x' + x^(3/2) = 0, by the classical Runge-Kutta method."""
    x, v, t, h, peak = 0.0, 1.0, 0.0, _STEP, 0.0

    def rate(position: float, speed: float) -> float:
        return -2.0 * damping * speed - float(max(position, 0.0) ** 1.5)

    def left(position: float, speed: float) -> float:
        """Positive while the contact lasts."""
        return position if ending == "zero-overlap" or speed > 0.0 else -rate(position, speed)

    while True:
        a1, v1 = rate(x, v), v
        a2, v2 = rate(x + 0.5 * h * v1, v + 0.5 * h * a1), v + 0.5 * h * a1
        a3, v3 = rate(x + 0.5 * h * v2, v + 0.5 * h * a2), v + 0.5 * h * a2
        a4, v4 = rate(x + h * v3, v + h * a3), v + h * a3
        after = x + h / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4), v + h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)
        if left(*after) > 0.0:
            (x, v), t = after, t + h
            peak = max(peak, x)
        elif h > 1e-9:
            h *= 0.25  # the end lies within
        else:
            return -v, t, peak
        if t > _LONG:
            return 0.0, math.inf, peak


@lru_cache(maxsize=64)
def adaptive_collision(restitution: float, ending: Ending = "zero-force") -> tuple[float, float]:
    r"""Damping and duration, without dimensions, of an impact with this restitution.

    Parameters
    ----------
    restitution : float, [-]
        0.05 <= e_n <= 1.
    ending : {"zero-force", "zero-overlap"}

    Returns
    -------
    damping : float, [-]
        :math:`\lambda=d\,t_*/(2m)`.
    duration : float, [-]
        :math:`T_c/t_*`.

    Raises
    ------
    CaseError
        An argument outside its range.

    References
    ----------
    .. [1] Kempe, Froehlich, J. Fluid Mech. 709 (2012) 445-489, doi:10.1017/jfm.2012.343.
    .. [2] Biegert, Vowinckel, Meiburg, J. Comput. Phys. 340 (2017) 105-127, doi:10.1016/j.jcp.2017.03.035 (closed
       form, fitted, of the same at zero overlap).

    Examples
    --------
    >>> damping, duration = adaptive_collision(0.97, "zero-overlap")
    >>> round(damping, 4), round(duration, 3)
    (0.0085, 3.228)
    """
    check_ending(ending)
    if not 0.05 <= restitution <= 1.0:
        raise CaseError("restitution", restitution, "must be at least 0.05 and at most 1", cure="Correct this value.")
    if restitution == 1.0:
        return 0.0, _impact(0.0, ending)[1]
    from scipy.optimize import brentq

    damping = float(brentq(lambda value: _impact(value, ending)[0] - restitution, 0.0, _STRONG, xtol=1e-10))
    return damping, _impact(damping, ending)[1]


def adaptive_overlap(restitution: float, ending: Ending = "zero-force") -> float:
    r"""Peak overlap of an impact over :math:`vt_*`.

    Parameters
    ----------
    restitution : float, [-]
        0.05 <= e_n <= 1.
    ending : {"zero-force", "zero-overlap"}

    Returns
    -------
    float, [-]

    Examples
    --------
    >>> round(adaptive_overlap(1.0), 4), round(1.25**0.4, 4)   # elastic: (5/4)^(2/5)
    (1.0934, 1.0934)
    """
    return _impact(adaptive_collision(restitution, ending)[0], ending)[2]


def adaptive_stiffness(
    reduced_mass: float, restitution: float, contact_time: float, impact_speed: float, ending: Ending = "zero-force"
) -> tuple[float, float]:
    r"""Stiffness and damping with which one impact lasts the contact time and has the restitution.

    Parameters
    ----------
    reduced_mass : float, [kg]
        > 0.
    restitution : float, [-]
        0.05 <= e_n <= 1.
    contact_time : float, [s]
        > 0.
    impact_speed : float, [m/s]
        > 0.
    ending : {"zero-force", "zero-overlap"}

    Returns
    -------
    stiffness : float, [N/m^1.5]
        :math:`k=m/\sqrt{v\,t_*^5}` with :math:`t_*=T_c/(T_c/t_*)`.
    damping : float, [N s/m]
        :math:`d=2\lambda m/t_*`.

    Examples
    --------
    >>> k, d = adaptive_stiffness(1e-3, 0.9, 1e-3, 0.5)
    >>> round(k), round(d, 4)
    (752718, 0.1904)
    """
    mass, speed = float(positive("reduced_mass", reduced_mass)), float(positive("impact_speed", impact_speed))
    damping, duration = adaptive_collision(restitution, ending)
    time = float(positive("contact_time", contact_time)) / duration
    return mass / math.sqrt(speed * time**5), 2.0 * damping * mass / time
