"""Linear spring-dashpot (soft-sphere) law; its closed forms are those of :mod:`rdpm.design.soft_sphere`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rdpm import _core, design
from rdpm.design._checks import Ending, check_ending
from rdpm.errors import CaseError

from .rows import Rows
from .substeps import SubstepDriver

__all__ = ["SoftSphere"]

Floats = NDArray[np.float64]
Normal = Callable[[Floats, Floats], tuple[Floats, Floats]]

# The structs of contacts/soft_sphere.hpp.
_PARAMETERS = np.dtype(
    [(name, np.float64) for name in ("k_n", "eta_n", "k_t", "eta_t", "mu")] + [("may_attract", np.int64)]
)
_HISTORY = np.dtype([("xi", np.float64, (3,))])  # elongation of the tangential spring [m]
_DRIVER = SubstepDriver(_core.soft_sphere_kernel(), _PARAMETERS, _HISTORY)


@dataclass(frozen=True)
class SoftSphere:
    r"""Normal force :math:`k_n\delta+\eta_n\dot\delta`; tangential spring and dashpot under Coulomb's limit.

    Made by :meth:`from_contact_time`, :meth:`from_stiffness` or :meth:`from_overlap`.

    Parameters
    ----------
    normal : callable
        Reduced masses and smaller diameters, (M,) each, to :math:`k_n` and :math:`\eta_n`, (M,) each.
    ending : {"zero-force", "zero-overlap"}
        Whether a contact ends when its force has vanished (no attraction) or when its overlap has.
    friction : float, [-]
        Coulomb's coefficient, >= 0.
    tangential_ratio : float, [-]
        :math:`k_t/k_n`, >= 0; 2/7 gives both springs the same period.

    Raises
    ------
    CaseError
        An argument outside its range.

    References
    ----------
    .. [1] Cundall, Strack, Geotechnique 29 (1979) 47-65, doi:10.1680/geot.1979.29.1.47.

    Examples
    --------
    >>> law = SoftSphere.from_contact_time(restitution=0.5, contact_time=8e-3)
    >>> stiffness, damping = law.normal(np.array([1e-3, 2e-3]), np.array([0.015, 0.015]))
    >>> float(stiffness[1] / stiffness[0])   # the same duration for every pair
    2.0
    """

    normal: Normal
    ending: Ending = "zero-force"
    friction: float = 0.0
    tangential_ratio: float = 2.0 / 7.0

    def __post_init__(self) -> None:
        check_ending(self.ending)
        for name in ("friction", "tangential_ratio"):
            value = getattr(self, name)
            if not (0.0 <= value < np.inf):
                rule = "must be a finite number of at least 0"
                raise CaseError(f"contact.{name}", value, rule, cure="Correct this value.")
        self.normal(np.ones(1), np.ones(1))  # what is out of range is refused here, not at the first contact

    @classmethod
    def from_contact_time(
        cls,
        restitution: float,
        contact_time: float,
        ending: Ending = "zero-force",
        friction: float = 0.0,
        tangential_ratio: float = 2.0 / 7.0,
    ) -> SoftSphere:
        r"""Every pair has the same contact duration and restitution.

        Parameters
        ----------
        restitution : float, [-]
            Dry normal restitution, 0 < e_n <= 1.
        contact_time : float, [s]
            :math:`t_c=N_c\,\delta t` from touch to end. > 0.
        ending, friction, tangential_ratio
            See the class.

        Returns
        -------
        SoftSphere

        Raises
        ------
        CaseError
            An argument outside its range.
        """

        def normal(mass: Floats, diameter: Floats) -> tuple[Floats, Floats]:
            return design.contact_parameters(mass, restitution, contact_time, ending)

        return cls(normal, ending, friction, tangential_ratio)

    @classmethod
    def from_stiffness(
        cls,
        stiffness: float,
        damping: float | None = None,
        restitution: float | None = None,
        ending: Ending = "zero-force",
        friction: float = 0.0,
        tangential_ratio: float = 2.0 / 7.0,
    ) -> SoftSphere:
        """One stiffness for all pairs, with one damping, or the damping that gives each pair the restitution.

        Parameters
        ----------
        stiffness : float, [N/m]
            > 0.
        damping : float, [N s/m], optional
            >= 0; critical and overdamped values are allowed. Either this or ``restitution``.
        restitution : float, [-], optional
            Dry normal restitution.
        ending, friction, tangential_ratio
            See the class.

        Returns
        -------
        SoftSphere

        Raises
        ------
        CaseError
            Both or neither of damping and restitution; an argument outside its range.
        """
        if (damping is None) == (restitution is None):
            raise CaseError(
                "contact", None, "give either damping or restitution beside stiffness",
                "each follows from the other", "Leave one out.",
            )  # fmt: skip

        def normal(mass: Floats, diameter: Floats) -> tuple[Floats, Floats]:
            if damping is not None:
                design.contact_time(mass, stiffness, damping, ending)  # refuses what is out of range
                return np.full(mass.shape, float(stiffness)), np.full(mass.shape, float(damping))
            eta_n = design.damping_from_stiffness(mass, restitution, stiffness, ending)
            return np.full(mass.shape, float(stiffness)), eta_n

        return cls(normal, ending, friction, tangential_ratio)

    @classmethod
    def from_overlap(
        cls,
        max_overlap_fraction: float,
        impact_speed: float,
        restitution: float,
        ending: Ending = "zero-force",
        friction: float = 0.0,
        tangential_ratio: float = 2.0 / 7.0,
    ) -> SoftSphere:
        """The softest spring whose peak overlap stays within a limit at an impact speed.

        Parameters
        ----------
        max_overlap_fraction : float, [-]
            Of the smaller diameter. > 0.
        impact_speed : float, [m/s]
            Normal approach speed at touch. > 0.
        restitution : float, [-]
            Dry normal restitution.
        ending, friction, tangential_ratio
            See the class.

        Returns
        -------
        SoftSphere

        Raises
        ------
        CaseError
            An argument outside its range.
        """

        def normal(mass: Floats, diameter: Floats) -> tuple[Floats, Floats]:
            limit = max_overlap_fraction * diameter
            return design.stiffness_from_overlap(mass, restitution, limit, impact_speed, ending)

        return cls(normal, ending, friction, tangential_ratio)

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
        k_n, eta_n = self.normal(pairs["reduced_mass"].copy(), pairs["smaller_diameter"].copy())
        rubs = ~pairs["is_frictionless"]
        k_t, eta_t = design.tangential_parameters(k_n, eta_n, self.tangential_ratio)
        result["k_n"], result["eta_n"] = k_n, eta_n
        result["k_t"], result["eta_t"] = np.where(rubs, k_t, 0.0), np.where(rubs, eta_t, 0.0)
        result["mu"] = np.where(rubs, self.friction, 0.0)
        result["may_attract"] = self.ending == "zero-overlap"
        return result

    def time_scale(self, pairs: Rows) -> Floats:
        """Time that the sub-steps must resolve, (K,) [s]; see :meth:`resolved_time`."""
        return self.resolved_time(pairs["reduced_mass"].copy(), pairs["smaller_diameter"].copy())

    def resolved_time(self, reduced_mass: Floats, smaller_diameter: Floats) -> Floats:
        r"""Contact duration; where it is long or undefined, the spring's half period and the decay count.

        The decay time of strong damping, :math:`2\pi m_{ij}/\eta_n`, is the half period at :math:`\zeta=1`.

        Parameters
        ----------
        reduced_mass, smaller_diameter : ndarray, (K,), [kg], [m]
            > 0.

        Returns
        -------
        ndarray, (K,), [s]
        """
        k_n, eta_n = self.normal(reduced_mass, smaller_diameter)
        scale = np.minimum(
            design.contact_time(reduced_mass, k_n, eta_n, self.ending), np.pi * np.sqrt(reduced_mass / k_n)
        )
        with np.errstate(divide="ignore"):
            decay = 2.0 * np.pi * reduced_mass / eta_n
        result: Floats = np.minimum(scale, decay)
        return result
