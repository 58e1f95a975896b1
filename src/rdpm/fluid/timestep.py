"""The time step: every limit with its name, the way of diffusion, and the choice between them."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

from rdpm.fluid.diffusion import STAGE_COST, explicit_limit, stages_for

__all__ = ["Choice", "advective_limit", "choose_step"]

#: Stages beyond which a longer step no longer pays: its error grows faster than its cost falls.
MOST_STAGES = 7

#: Cost of a stabilised step beside an explicit one, without its stages (measured).
STABILISED_COST = 1.1


@dataclass(frozen=True)
class Choice:
    """A time step and why it was taken.

    Parameters
    ----------
    dt : float, [s]
    limit : str
        Name of the limit that set it: "advective", "viscous", "contact", "user" or "output".
    is_explicit : bool
        How diffusion is advanced.
    stages : int
        Of the stabilised scheme; 0 when explicit.
    limits : dict of str to float, [s]
        All that were considered.
    longest : float or None, [s]
        Where steps are adaptive, of which `dt` is then the shortest.
    """

    dt: float
    limit: str
    is_explicit: bool
    stages: int = 0
    limits: dict[str, float] = field(default_factory=dict)
    longest: float | None = None


def advective_limit(spacing: tuple[float, float, float], speed: tuple[float, float, float], cfl: float) -> float:
    """Longest step in which the flow crosses at most `cfl` of a cell: eq. (1) of docs/theory/time_step.md.

    Parameters
    ----------
    spacing : tuple of float, (3,), [m]
    speed : tuple of float, (3,), [m/s]
        Largest along each direction.
    cfl : float, [-]

    Returns
    -------
    float, [s]
        inf at rest.

    Examples
    --------
    >>> advective_limit((0.1, 0.1, 0.1), (0.0, 0.0, 0.5), 0.5)
    0.1
    """
    rate = sum(abs(u) / h for u, h in zip(speed, spacing, strict=True))
    return cfl / rate if rate > 0.0 else math.inf


def choose_step(
    spacing: tuple[float, float, float],
    viscosity: float,
    diffusion: Literal["auto", "explicit", "stabilised"],
    limits: dict[str, float],
) -> Choice:
    """Way of diffusion and time step of least cost a simulated second.

    Parameters
    ----------
    spacing : tuple of float, (3,), [m]
    viscosity : float, [m^2/s]
        Kinematic.
    diffusion : str
        "explicit" and "stabilised" force the way.
    limits : dict of str to float, [s]
        From all but viscosity; the least of them holds either way.

    Returns
    -------
    Choice

    Examples
    --------
    >>> choice = choose_step((1e-3, 1e-3, 1e-3), 1e-6, "auto", {"advective": 0.01})
    >>> choice.limit, choice.is_explicit
    ('advective', True)
    """
    name, other = min(limits.items(), key=lambda item: item[1])
    viscous = explicit_limit(spacing, viscosity)
    longest = 0.5 * viscous * (MOST_STAGES**2 + MOST_STAGES - 2)
    explicit = Choice(
        min(other, viscous), name if other <= viscous else "viscous", True, 0, {**limits, "viscous": viscous}
    )
    dt = min(other, longest)
    stabilised = Choice(
        dt,
        name if other <= longest else "viscous",
        False,
        stages_for(dt, spacing, viscosity),
        {**limits, "viscous": longest},
    )
    if diffusion == "explicit" or not math.isfinite(viscous):
        return explicit
    if diffusion == "stabilised":
        return stabilised
    cost = (STABILISED_COST + STAGE_COST * stabilised.stages) / stabilised.dt
    return stabilised if cost < 1.0 / explicit.dt else explicit
