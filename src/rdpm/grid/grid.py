"""The staggered grid: the box kept exactly, its own uniform spacing in each direction."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from rdpm import _core
from rdpm.conventions import BOUNDARY_KINDS, BoundaryKind
from rdpm.grid.box import Box
from rdpm.parallel.decomposition import Slab

__all__ = ["Grid", "choose_cells", "smooth_counts"]

#: Spacings may differ by this much from the target, to reach a count that suits the transforms.
SPACING_TOLERANCE = 0.03


def smooth_counts(lower: float, upper: float) -> list[int]:
    """Products of 2, 3 and 5 within a range, rising.

    Parameters
    ----------
    lower, upper : float
        >= 1, both included.

    Examples
    --------
    >>> smooth_counts(50, 60)
    [50, 54, 60]
    """
    found = []
    five = 1
    while five <= upper:
        three = five
        while three <= upper:
            # The powers of two that lift it into the range.
            n = three * 2 ** max(0, math.ceil(math.log2(lower / three)))
            while n <= upper:
                if n >= lower:
                    found.append(n)
                n *= 2
            three *= 3
        five *= 5
    return sorted(found)


def choose_cells(length: float, spacing: float) -> int:
    """Cells along one direction: the transform-friendly count nearest to length / spacing.

    Parameters
    ----------
    length : float, [m]
        Of the box, kept exactly; > 0.
    spacing : float, [m]
        Target; > 0.

    Returns
    -------
    int
        The product of 2, 3 and 5 whose spacing is nearest the target if it is within 3 %,
        otherwise the nearest whole number; at least 4.

    Examples
    --------
    >>> choose_cells(0.1, 0.015 / 8)
    54
    """
    ideal = length / spacing
    near = smooth_counts(max(4.0, ideal / (1 + SPACING_TOLERANCE)), max(4.0, ideal / (1 - SPACING_TOLERANCE)))
    return min(near or [max(4, round(ideal))], key=lambda n: abs(ideal / n - 1))


@dataclass(frozen=True, eq=False)
class Grid:
    """A box of nx x ny x nz cells; fields are (nz+2, ny+2, nx+2) arrays with one halo cell beyond each face.

    Parameters
    ----------
    box : Box
    cells : tuple of int, (3,)
        nx, ny, nz of the box; at least 4 each.
    threads : int
        Used by every loop over the grid.
    slab : Slab, optional
        The planes that this rank has, where several share the box: its fields hold only these.

    Examples
    --------
    >>> grid = Grid(Box((1.0, 1.0, 2.0), ("periodic", "wall", "wall")), (8, 8, 16))
    >>> grid.shape, grid.spacing
    ((18, 10, 10), (0.125, 0.125, 0.125))
    """

    box: Box
    cells: tuple[int, int, int]
    threads: int = 1
    slab: Slab | None = None

    @property
    def cells_here(self) -> tuple[int, int, int]:
        """Cells of this rank: (3,)."""
        nx, ny, nz = self.cells
        return nx, ny, nz if self.slab is None else self.slab.planes

    @property
    def size(self) -> tuple[float, float, float]:
        """Of the box: Lx, Ly, Lz [m]."""
        return self.box.size

    @property
    def boundary(self) -> tuple[BoundaryKind, BoundaryKind, BoundaryKind]:
        """Of the x, y and z pair of faces."""
        return self.box.kinds

    @property
    def spacing(self) -> tuple[float, float, float]:
        """dx, dy, dz [m]."""
        x, y, z = (length / n for length, n in zip(self.size, self.cells, strict=True))
        return x, y, z

    @property
    def shape(self) -> tuple[int, int, int]:
        """Of a field with its halo: (nz+2, ny+2, nx+2)."""
        nx, ny, nz = self.cells_here
        return nz + 2, ny + 2, nx + 2

    @property
    def is_periodic(self) -> tuple[bool, bool, bool]:
        """A flag a direction."""
        return self.box.is_periodic

    @property
    def volume(self) -> float:
        """Of the box [m^3]."""
        return self.box.volume

    @cached_property
    def core(self) -> _core.Grid:
        """The same facts as the kernels read them."""
        slab = self.slab
        return _core.Grid(
            list(self.cells_here),
            list(self.spacing),
            [self._kernel_number(kind) for kind in self.boundary],
            self.box.wall_velocity.ravel().tolist(),
            self.threads,
            slab.first if slab else 0,
            slab.whole if slab else 0,
            [slab.lower is not None, slab.upper is not None] if slab else [False, False],
        )

    def _kernel_number(self, kind: BoundaryKind) -> int:
        """Kinds as the kernels number them; of two numbers the greater one, where fluid enters at the upper face."""
        is_down = self.box.inflow is not None and self.box.inflow.velocity < 0.0
        return BOUNDARY_KINDS.index(kind) + (1 if kind == "inflow-outflow" and is_down else 0)

    def zeros(self) -> NDArray[np.float64]:
        """A field of zeros with its halo."""
        return np.zeros(self.shape)

    def points(self, location: str) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Coordinates where a field sits, halo included.

        Parameters
        ----------
        location : str
            "u", "v", "w" (faces) or "p" (cell centres).

        Returns
        -------
        x, y, z : ndarray, (nx+2,), (ny+2,), (nz+2,), [m]
        """
        first = 0, 0, self.slab.first if self.slab else 0
        axes: Sequence[NDArray[np.float64]] = [
            (np.arange(n + 2.0) + below - (0.0 if location == name else 0.5)) * h
            for name, n, below, h in zip("uvw", self.cells_here, first, self.spacing, strict=True)
        ]
        return axes[0], axes[1], axes[2]
