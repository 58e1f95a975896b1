"""What one step changes together: bodies, contacts, fluid, time."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rdpm.contacts import Contacts, ContactStep
from rdpm.coupling.mean_flow import MeanFlow
from rdpm.coupling.timing import Stopwatch
from rdpm.fluid import Fluid
from rdpm.parallel.ranks import ALONE, Ranks
from rdpm.particles.immersed import ImmersedBodies
from rdpm.particles.prescribed import Prescription
from rdpm.particles.shared import SharedBodies
from rdpm.particles.state import Bodies

__all__ = ["System"]

Floats = NDArray[np.float64]


@dataclass
class System:
    """Everything one step changes.

    Parameters
    ----------
    bodies : Bodies
    contacts : Contacts
    prescription : Prescription
    gravity : ndarray, (3,), [m/s^2]
    fluid : Fluid or None
        None in a dry case.
    immersed : ImmersedBodies, SharedBodies or None
        None in a dry case, or without bodies; shared where several ranks have the box.
    mean_flow : MeanFlow or None
        None in a dry case.
    ranks : Ranks
        That share the box; bodies and contacts are the same on all.
    has_fluid_force_in_impact : bool
        Whether the fluid acts on bodies in an impact.
    """

    bodies: Bodies
    contacts: Contacts
    prescription: Prescription
    gravity: Floats
    fluid: Fluid | None = None
    immersed: ImmersedBodies | SharedBodies | None = None
    mean_flow: MeanFlow | None = None
    time: float = 0.0
    steps: int = 0
    last_contact: ContactStep | None = None
    watch: Stopwatch = field(default_factory=Stopwatch)
    ranks: Ranks = ALONE
    has_fluid_force_in_impact: bool = True

    @property
    def load(self) -> Floats:
        """Force and torque on each body beside those of contacts, (N, 6) [N], [N m]: in a dry case its weight."""
        if self.immersed is not None:
            return self.immersed.load
        weight = self.bodies.mass[:, None] * self.gravity
        return np.concatenate([weight, np.zeros_like(weight)], axis=1)

    @property
    def weight(self) -> Floats:
        """Of each body, less buoyancy, (N, 3) [N]."""
        displaced = 0.0 if self.fluid is None else self.fluid.density * np.pi / 6.0 * self.bodies.diameter**3
        weight: Floats = (self.bodies.mass - displaced)[:, None] * self.gravity
        return weight

    @property
    def inertia(self) -> Floats:
        """Mass and moment of inertia that contacts act on, (N, 2) [kg], [kg m^2]."""
        return self.immersed.inertia if self.immersed is not None else self.bodies.inertia

    @property
    def force_on_fluid(self) -> Floats:
        """Of all bodies and walls within the box over the last step, (3,) [N]."""
        return self.immersed.force_on_fluid if self.immersed is not None else np.zeros(3)
