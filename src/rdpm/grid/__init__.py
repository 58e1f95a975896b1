"""The box and the fixed Cartesian grid in it."""

from rdpm.grid.box import Box
from rdpm.grid.grid import Grid, choose_cells

__all__ = ["Box", "Grid", "choose_cells"]
