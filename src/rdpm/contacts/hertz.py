"""Hertz-Mindlin law; its closed forms are those of :mod:`rdpm.design.hertz_contact`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rdpm import _core, design
from rdpm.design._checks import Ending, not_negative, positive

from .rows import Rows
from .substeps import SubstepDriver

__all__ = ["Hertz"]

Floats = NDArray[np.float64]

# The structs of contacts/hertz.hpp.
_PARAMETERS = np.dtype(
    [(name, np.float64) for name in ("k", "eta", "k_t", "eta_t", "mu")] + [("may_attract", np.int64)]
)
_HISTORY = np.dtype([("xi", np.float64, (3,)), ("stiffness", np.float64)])  # tangential spring [m], [N/m]
_DRIVER = SubstepDriver(_core.hertz_kernel(), _PARAMETERS, _HISTORY)


@dataclass(frozen=True)
class Hertz:
    r"""Normal force :math:`k\delta^{3/2}+\eta\delta^{1/4}\dot\delta`, Mindlin's tangential one under Coulomb's limit.

    The damping gives the restitution at every impact speed.

    Parameters
    ----------
    youngs_modulus : float, [Pa]
        Of all bodies, > 0.
    poisson_ratio : float, [-]
        -1 < sigma <= 0.5.
    restitution : float, [-]
        Dry normal restitution, 0 < e_n <= 1.
    impact_speed : float, [m/s]
        Normal approach speed whose contact the sub-steps resolve, > 0; the duration goes with its power -1/5.
    ending : {"zero-force", "zero-overlap"}
        Whether a contact ends when its force has vanished (no attraction) or when its overlap has.
    friction : float, [-]
        Coulomb's coefficient, >= 0.

    Raises
    ------
    CaseError
        An argument outside its range.

    References
    ----------
    .. [1] Tsuji, Tanaka, Ishida, Powder Technol. 71 (1992) 239-250, doi:10.1016/0032-5910(92)88030-L.
    .. [2] Thornton, Cummins, Cleary, Powder Technol. 233 (2013) 30-46, doi:10.1016/j.powtec.2012.08.012.

    Examples
    --------
    >>> law = Hertz(youngs_modulus=1e6, poisson_ratio=0.3, restitution=0.8, impact_speed=0.1)
    >>> law.driver.history.names
    ('xi', 'stiffness')
    """

    youngs_modulus: float
    poisson_ratio: float
    restitution: float
    impact_speed: float
    ending: Ending = "zero-force"
    friction: float = 0.0

    def __post_init__(self) -> None:
        not_negative("contact.friction", self.friction)
        positive("contact.impact_speed", self.impact_speed)
        self.resolved_time(np.ones(1), np.ones(1))  # what is out of range is refused here, not at the first contact

    @property
    def interaction_range(self) -> float:
        """The force acts between surfaces that overlap alone."""
        return 0.0

    @property
    def driver(self) -> SubstepDriver:
        """The sub-steps, compiled over the law."""
        return _DRIVER

    def normal(self, reduced_mass: Floats, reduced_radius: Floats) -> tuple[Floats, Floats]:
        r"""Stiffness k and damping :math:`\eta` of pairs.

        Parameters
        ----------
        reduced_mass, reduced_radius : ndarray, (K,), [kg], [m]
            > 0.

        Returns
        -------
        k, eta : ndarray, (K,), [N/m^1.5], [N s/m^1.25]
        """
        modulus = design.effective_modulus(self.youngs_modulus, self.poisson_ratio)
        k = design.hertz_stiffness(reduced_radius, modulus)
        return k, design.hertz_damping(reduced_mass, k, self.restitution, self.ending)

    def parameters(self, pairs: Rows) -> Rows:
        """Parameters of each pair; see :class:`rdpm.contacts.law.ContactLaw`."""
        result = np.zeros(len(pairs), _PARAMETERS)
        radius, rubs = pairs["reduced_radius"].copy(), ~pairs["is_frictionless"]
        k, eta = self.normal(pairs["reduced_mass"].copy(), radius)
        k_t = 8.0 * design.effective_shear_modulus(self.youngs_modulus, self.poisson_ratio) * np.sqrt(radius)
        result["k"], result["eta"] = k, eta
        result["k_t"] = np.where(rubs, k_t, 0.0)
        # The damping ratio of the normal spring, whose stiffness is that of the tangent, 3/2 k overlap^(1/2).
        result["eta_t"] = np.where(rubs, eta * np.sqrt(k_t / (1.5 * k)), 0.0)
        result["mu"] = np.where(rubs, self.friction, 0.0)
        result["may_attract"] = self.ending == "zero-overlap"
        return result

    def time_scale(self, pairs: Rows) -> Floats:
        """Time that the sub-steps must resolve, (K,) [s]; see :meth:`resolved_time`."""
        return self.resolved_time(pairs["reduced_mass"].copy(), pairs["reduced_radius"].copy())

    def resolved_time(self, reduced_mass: Floats, reduced_radius: Floats) -> Floats:
        """Duration of the contact at the impact speed, or that without damping where it is shorter.

        Parameters
        ----------
        reduced_mass, reduced_radius : ndarray, (K,), [kg], [m]
            > 0.

        Returns
        -------
        ndarray, (K,), [s]
        """
        k, _ = self.normal(reduced_mass, reduced_radius)
        damped, elastic = (
            design.hertz_duration(reduced_mass, k, self.impact_speed, e, self.ending)
            for e in (self.restitution, 1.0)
        )
        result: Floats = np.minimum(damped, elastic)
        return result
