"""The fixed Cartesian grid and its boundaries."""

from rdpm.grid.boundary import BOUNDARIES, SIDES, Boundary
from rdpm.grid.grid import Grid, choose_cells

__all__ = ["BOUNDARIES", "SIDES", "Boundary", "Grid", "choose_cells"]
