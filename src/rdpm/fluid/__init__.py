"""The incompressible fluid: momentum, diffusion, projection, and the limits of its time step."""

from rdpm.fluid.diffusion import stages_for
from rdpm.fluid.state import Fluid

__all__ = ["Fluid", "stages_for"]
