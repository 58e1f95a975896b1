"""A run: steps, guards, what is called on the way, and what is written."""

from rdpm.simulation.simulation import Simulation

__all__ = ["Simulation"]
