"""Time averages of the flow."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm.fluid.state import Fluid

__all__ = ["FlowMeans"]

#: Planes that are worked on at once.
SLAB = 16


class FlowMeans:
    """Mean velocity, mean pressure and variance of the velocity at the cell centres.

    A sample counts for the time since the one before; the first only begins the average. Cells that a body covers
    count with the velocity of its interior fluid.

    Parameters
    ----------
    cells : tuple of int, (3,)
        nx, ny, nz; of this rank's slab, where several share the box.

    Attributes
    ----------
    velocity : ndarray, (nz, ny, nx, 3), [m/s]
    pressure : ndarray, (nz, ny, nx), [Pa]
    square : ndarray, (nz, ny, nx, 3), [m^2/s]
        Sum of the squared departures from the mean, times the time they count for.
    span : float, [s]
        Time averaged over.
    last : float, [s]
        Of the last sample; nan before the first.
    """

    def __init__(self, cells: tuple[int, int, int]) -> None:
        shape = cells[::-1]
        self.velocity, self.pressure, self.square = np.zeros((*shape, 3)), np.zeros(shape), np.zeros((*shape, 3))
        self.span, self.last = 0.0, float("nan")

    @property
    def variance(self) -> NDArray[np.float64]:
        """Of each component of the velocity, (nz, ny, nx, 3) [m^2/s^2]."""
        return self.square / self.span if self.span > 0.0 else self.square.copy()

    def add(self, fluid: Fluid, time: float) -> None:
        """Take a sample, at a time [s]."""
        weight = time - self.last if self.last == self.last else 0.0
        self.last = time
        if weight <= 0.0:
            return
        self.span += weight
        share = weight / self.span
        for first in range(1, fluid.grid.cells_here[2] + 1, SLAB):
            last = min(first + SLAB, fluid.grid.cells_here[2] + 1)
            part, inner = slice(first - 1, last - 1), (slice(first, last), slice(1, -1), slice(1, -1))
            for n, field in enumerate(fluid.velocity):
                before = list(inner)
                own = inner[2 - n]
                before[2 - n] = slice(own.start - 1, own.stop - 1)
                value = 0.5 * (field[inner] + field[tuple(before)])
                mean = self.velocity[part, ..., n]
                away = value - mean
                mean += share * away
                self.square[part, ..., n] += weight * away * (value - mean)
            pressure = fluid.density * (fluid.p[inner] - fluid.pressure_offset)
            self.pressure[part] += share * (pressure - self.pressure[part])

    def state(self) -> dict[str, NDArray[Any]]:
        """All that the next sample needs."""
        arrays = {name: getattr(self, name) for name in ("velocity", "pressure", "square")}
        return arrays | {"span": np.array(self.span), "last": np.array(self.last)}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Take over what `state` gave."""
        for name in ("velocity", "pressure", "square"):
            np.copyto(getattr(self, name), state[name])
        self.span, self.last = float(state["span"]), float(state["last"])
