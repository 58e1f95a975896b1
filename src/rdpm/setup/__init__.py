"""From a case to a simulation: the only bridge between configuration and the rooms."""

from rdpm.setup.build import Simulation
from rdpm.setup.contact import PairKind
from rdpm.setup.plan import Plan, plan
from rdpm.setup.rows import PlanRow

__all__ = ["PairKind", "Plan", "PlanRow", "Simulation", "plan"]
