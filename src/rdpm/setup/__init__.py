"""From a case to a simulation: the only bridge between configuration and the rooms."""

from rdpm.setup.build import Simulation
from rdpm.setup.plan import Plan, PlanRow, plan

__all__ = ["Plan", "PlanRow", "Simulation", "plan"]
