"""The box and the fixed Cartesian grid in it."""

from rdpm.grid.box import Box
from rdpm.grid.grid import Grid, choose_cells
from rdpm.grid.inflow import Inflow

__all__ = ["Box", "Grid", "Inflow", "choose_cells"]
