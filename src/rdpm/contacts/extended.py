"""What may be added to a law of overlapping surfaces: rolling friction, twisting friction, cohesion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rdpm import _core, design
from rdpm.design._checks import not_negative, positive
from rdpm.errors import CaseError

from .hertz import Hertz
from .rows import Rows
from .soft_sphere import SoftSphere
from .substeps import SubstepDriver

__all__ = ["ExtendedContact"]

Floats = NDArray[np.float64]


def _driver(is_hertz: bool, is_cohesive: bool) -> SubstepDriver:
    """Compiled over a struct of contacts/extended.hpp."""
    law = (Hertz(1.0, 0.0, 1.0, 1.0) if is_hertz else SoftSphere.from_stiffness(1.0, 0.0)).driver
    fields = [(name, law.parameters[name]) for name in law.parameters.names or ()]
    fields += [(name, np.dtype(np.float64)) for name in ("rolling", "twisting")]
    if is_cohesive:
        fields += [(name, np.dtype(np.float64)) for name in ("pull_off", "range", "from", "to", "overlap")]
    return SubstepDriver(_core.extended_kernel(is_hertz, is_cohesive), np.dtype(fields), law.history)


_DRIVERS = {(h, c): _driver(h, c) for h in (False, True) for c in (False, True)}


@dataclass(frozen=True)
class ExtendedContact:
    r"""A soft sphere or a Hertz contact with rolling friction, twisting friction and cohesion.

    Parameters
    ----------
    law : SoftSphere or Hertz
    rolling_friction, twisting_friction : float, [-]
        Limits of the torques against relative rotation, about axes in the tangent plane and about the normal, over
        normal force times reduced radius. >= 0.
    cohesion : float, [J/m^2]
        Work of adhesion w >= 0; the surfaces attract each other with :math:`\tfrac32\pi wR_{ij}`, the pull-off
        force of Johnson, Kendall and Roberts.
    cohesion_range : float, [m]
        Gap below which they do: a square well. > 0 with cohesion.

    Raises
    ------
    CaseError
        An argument outside its range.

    Notes
    -----
    The torques are Coulomb's: they stop a rotation, and do not spring back. The limits count the attraction as a load.
    Free-slip faces have neither torques nor cohesion.

    References
    ----------
    .. [1] Ai, Chen, Rotter, Ooi, Powder Technol. 206 (2011) 269-282 (type A rolling friction); Johnson, Kendall,
       Roberts, Proc. R. Soc. A 324 (1971) 301-313.

    Examples
    --------
    >>> law = ExtendedContact(SoftSphere.from_stiffness(100.0, 0.1), cohesion=0.05, cohesion_range=1e-5)
    >>> round(float(law.pull_off(np.array([1e-3]))[0]), 9)
    0.000235619
    """

    law: SoftSphere | Hertz
    rolling_friction: float = 0.0
    twisting_friction: float = 0.0
    cohesion: float = 0.0
    cohesion_range: float = 0.0

    def __post_init__(self) -> None:
        for name in ("rolling_friction", "twisting_friction", "cohesion", "cohesion_range"):
            not_negative(f"contact.{name}", getattr(self, name))
        if self.cohesion > 0.0:
            positive("contact.cohesion_range", self.cohesion_range)
        if self.rolling_friction + self.twisting_friction + self.cohesion == 0.0:
            raise CaseError(
                "contact", None, "must have rolling_friction, twisting_friction or cohesion",
                "nothing is added to the law", "Use the law itself.",
            )  # fmt: skip

    @property
    def interaction_range(self) -> float:
        """That of the cohesion [m]."""
        return self.cohesion_range if self.cohesion > 0.0 else 0.0

    @property
    def driver(self) -> SubstepDriver:
        """The sub-steps, compiled over the law and what is added to it."""
        return _DRIVERS[isinstance(self.law, Hertz), self.cohesion > 0.0]

    def pull_off(self, reduced_radius: Floats) -> Floats:
        """Force that parts two surfaces slowly, (K,) [N]."""
        return np.asarray(design.pull_off_force(reduced_radius, self.cohesion))

    def parameters(self, pairs: Rows) -> Rows:
        """Parameters of each pair; see :class:`rdpm.contacts.law.ContactLaw`."""
        own, radius = self.law.parameters(pairs), pairs["reduced_radius"].copy()
        rough = np.where(pairs["is_frictionless"], 0.0, radius)
        result = np.zeros(len(pairs), self.driver.parameters)
        for name in own.dtype.names or ():
            result[name] = own[name]
        result["rolling"], result["twisting"] = self.rolling_friction * rough, self.twisting_friction * rough
        if self.cohesion > 0.0:
            result["pull_off"], result["range"] = self.pull_off(rough), self.cohesion_range
        return result

    def time_scale(self, pairs: Rows) -> Floats:
        """Time that the sub-steps must resolve, (K,) [s]: that of the law."""
        return self.law.time_scale(pairs)
