"""Short-range repulsive force that keeps surfaces apart; its closed forms are those of :mod:`rdpm.design.repulsive`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rdpm import _core, design
from rdpm.design._checks import positive

from .rows import Rows
from .substeps import SubstepDriver

__all__ = ["Repulsive"]

Floats = NDArray[np.float64]

# The structs of contacts/repulsive.hpp.
_PARAMETERS = np.dtype([("stiffness", np.float64), ("range", np.float64)])
_DRIVER = SubstepDriver(_core.repulsive_kernel(), _PARAMETERS, np.dtype([]))


@dataclass(frozen=True)
class Repulsive:
    r"""Force :math:`F_0(1-g/\rho)^2` along the normal for gaps g below :math:`\rho`; no friction, no damping.

    A contact is recorded where surfaces overlap all the same.

    Parameters
    ----------
    stiffness : float, [N]
        :math:`F_0`, the force at touch, > 0; Glowinski's :math:`c_{ij}/\varepsilon`.
    range : float, [m]
        :math:`\rho` > 0.

    Raises
    ------
    CaseError
        An argument outside its range.

    References
    ----------
    .. [1] Glowinski, Pan, Hesla, Joseph, Periaux, J. Comput. Phys. 169 (2001) 363-426, doi:10.1006/jcph.2000.6542.

    Examples
    --------
    >>> Repulsive(stiffness=1e-3, range=2e-4).interaction_range
    0.0002
    """

    stiffness: float
    range: float

    def __post_init__(self) -> None:
        positive("contact.repulsion_stiffness", self.stiffness)
        positive("contact.repulsion_range", self.range)

    @property
    def interaction_range(self) -> float:
        """Gap below which the force acts [m]."""
        return self.range

    @property
    def driver(self) -> SubstepDriver:
        """The sub-steps, compiled over the law."""
        return _DRIVER

    def parameters(self, pairs: Rows) -> Rows:
        """Parameters of each pair; see :class:`rdpm.contacts.law.ContactLaw`."""
        result = np.zeros(len(pairs), _PARAMETERS)
        result["stiffness"], result["range"] = self.stiffness, self.range
        return result

    def time_scale(self, pairs: Rows) -> Floats:
        """Time that the sub-steps must resolve, (K,) [s]: half a period of the steepest slope before touch."""
        result: Floats = design.repulsion_time(pairs["reduced_mass"].copy(), self.stiffness, self.range)
        return result
