"""A run: steps, guards, what is called on the way, and what is written."""

from rdpm.simulation.time_loop import TimeLoop

__all__ = ["TimeLoop"]
