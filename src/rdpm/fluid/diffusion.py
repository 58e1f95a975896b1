"""Diffusion in time: explicit, or by the stages of a stabilised scheme."""

from __future__ import annotations

import math

__all__ = ["STAGE_COST", "explicit_limit", "stages_for"]

#: Fraction of its stability limit at which a step is taken.
SAFETY = 0.85

#: Cost of one stage in units of a whole explicit step (measured; only the choice by cost depends on it).
STAGE_COST = 0.15


def explicit_limit(spacing: tuple[float, float, float], viscosity: float) -> float:
    """Largest time step of explicit diffusion with Adams-Bashforth 2: eq. (1) of docs/theory/diffusion.md.

    Parameters
    ----------
    spacing : tuple of float, (3,), [m]
    viscosity : float, [m^2/s]
        Kinematic.

    Returns
    -------
    float, [s]
        0.85 of the limit 1 / (4 nu sum 1/h^2) of the real axis (h^2 / (12 nu) on a cubic cell); inf without viscosity.

    Examples
    --------
    >>> explicit_limit((1.0, 1.0, 1.0), 0.85 / 12)
    1.0
    """
    if viscosity == 0.0:
        return math.inf
    return SAFETY / (4.0 * viscosity * sum(1.0 / h**2 for h in spacing))


def stages_for(dt: float, spacing: tuple[float, float, float], viscosity: float) -> int:
    """Stages of the Runge-Kutta-Legendre scheme, eq. (2) of docs/theory/diffusion.md, that make a step stable.

    Parameters
    ----------
    dt : float, [s]
    spacing : tuple of float, (3,), [m]
    viscosity : float, [m^2/s]
        Kinematic.

    Returns
    -------
    int
        The least s >= 2 with dt <= 0.85 (s^2 + s - 2)/4 times the forward Euler limit [1]_.

    References
    ----------
    .. [1] Meyer, Balsara, Aslam, J. Comput. Phys. 257 (2014) 594-626, section 3.

    Examples
    --------
    >>> stages_for(1.0, (1.0, 1.0, 1.0), 0.1)
    2
    >>> stages_for(1.0, (1.0, 1.0, 1.0), 1.0)
    6
    """
    euler = 2.0 * explicit_limit(spacing, viscosity)
    needed = 4.0 * dt / euler + 2.0 if math.isfinite(euler) else 0.0
    return max(2, math.ceil((math.sqrt(1.0 + 4.0 * needed) - 1.0) / 2.0 - 1e-9))
