"""Adaptive collision time model; its numbers are those of :mod:`rdpm.design.adaptive`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rdpm import _core, design
from rdpm.design._checks import Ending, not_negative, positive

from .rows import Rows
from .substeps import SubstepDriver

__all__ = ["AdaptiveCollisionTime"]

Floats = NDArray[np.float64]

# The structs of contacts/adaptive.hpp.
_PARAMETERS = np.dtype(
    [(name, np.float64) for name in ("mass", "time", "d", "least_speed", "ratio", "eta_t", "mu", "k")]
    + [("may_attract", np.int64)]
)
_HISTORY = np.dtype([("k", np.float64), ("xi", np.float64, (3,)), ("stiffness", np.float64)])
_DRIVER = SubstepDriver(_core.adaptive_kernel(), _PARAMETERS, _HISTORY)


@dataclass(frozen=True)
class AdaptiveCollisionTime:
    r"""Normal force :math:`k\delta^{3/2}+d\dot\delta` with the stiffness of each impact: one duration, one restitution.

    Tangential spring and dashpot under Coulomb's limit.

    Parameters
    ----------
    restitution : float, [-]
        Dry normal restitution, 0.05 <= e_n <= 1.
    contact_time : float, [s]
        From touch to end, at every impact speed. > 0.
    least_speed : float, [m/s]
        Slower touches get the stiffness of an impact at this speed, > 0.
    ending : {"zero-force", "zero-overlap"}
        Whether a contact ends when its force has vanished (no attraction) or when its overlap has.
    friction : float, [-]
        Coulomb's coefficient, >= 0.
    tangential_ratio : float, [-]
        Tangential over normal stiffness, >= 0.

    Raises
    ------
    CaseError
        An argument outside its range.

    References
    ----------
    .. [1] Kempe, Froehlich, J. Fluid Mech. 709 (2012) 445-489, doi:10.1017/jfm.2012.343.

    Examples
    --------
    >>> law = AdaptiveCollisionTime(restitution=0.9, contact_time=1e-3, least_speed=1e-3)
    >>> law.driver.history.names
    ('k', 'xi', 'stiffness')
    """

    restitution: float
    contact_time: float
    least_speed: float
    ending: Ending = "zero-force"
    friction: float = 0.0
    tangential_ratio: float = 2.0 / 7.0

    def __post_init__(self) -> None:
        for name in ("friction", "tangential_ratio"):
            not_negative(f"contact.{name}", getattr(self, name))
        positive("contact.contact_time", self.contact_time)
        positive("contact.least_speed", self.least_speed)
        design.adaptive_collision(self.restitution, self.ending)

    @property
    def interaction_range(self) -> float:
        """The force acts between surfaces that overlap alone."""
        return 0.0

    @property
    def driver(self) -> SubstepDriver:
        """The sub-steps, compiled over the law."""
        return _DRIVER

    def parameters(self, pairs: Rows) -> Rows:
        """Parameters of each pair; see :class:`rdpm.contacts.law.ContactLaw`."""
        result = np.zeros(len(pairs), _PARAMETERS)
        rubs = ~pairs["is_frictionless"]
        damping, duration = design.adaptive_collision(self.restitution, self.ending)
        result["mass"], result["time"] = pairs["reduced_mass"], self.contact_time / duration
        result["d"] = 2.0 * damping * result["mass"] / result["time"]
        result["least_speed"] = self.least_speed
        result["ratio"] = np.where(rubs, self.tangential_ratio, 0.0)
        result["eta_t"] = np.sqrt(2.0 / 7.0 * result["ratio"]) * result["d"]
        result["mu"] = np.where(rubs, self.friction, 0.0)
        result["may_attract"] = self.ending == "zero-overlap"
        return result

    def time_scale(self, pairs: Rows) -> Floats:
        """Time that the sub-steps must resolve, (K,) [s]: the duration of every contact."""
        return np.full(len(pairs), self.contact_time)
