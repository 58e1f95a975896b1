"""What enters the box through one face; as much leaves through the opposite one."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

__all__ = ["CLEAR_CELLS", "Inflow"]

#: Between a body's surface and an open end [cells]: nearer, its markers would reach beyond the end.
CLEAR_CELLS = 3.0

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Inflow:
    """A stream through the faces across one direction: eqs (1) and (2) of docs/theory/inflow.md.

    Parameters
    ----------
    axis : int
        0, 1, 2: the direction of the stream.
    velocity : float, [m/s]
        Mean over the section, not 0: positive enters through the lower face, negative through the upper one.
    profile : str or ndarray, (M, N)
        Over the section: "uniform"; "parabolic" (between walls); or velocities at points that are evenly spaced from
        edge to edge, linear between them, N along the first of the other two directions and M along the second; 1 where
        it does not vary. Only their ratios count.
    start_up : float, [s]
        Time in which it rises from nothing; 0: it is there from the start.

    Examples
    --------
    >>> inflow = Inflow(2, 0.1, start_up=2.0)
    >>> inflow.across, inflow.speed_at(0.0), round(inflow.speed_at(1.0), 3), inflow.speed_at(3.0)
    ((0, 1), 0.0, 0.05, 0.1)
    """

    axis: int
    velocity: float
    profile: Literal["uniform", "parabolic"] | Floats = "uniform"
    start_up: float = 0.0

    @property
    def across(self) -> tuple[int, int]:
        """The other two directions."""
        one, other = (axis for axis in range(3) if axis != self.axis)
        return one, other

    def speed_at(self, time: float) -> float:
        """Mean velocity, with its sign [m/s]."""
        if time >= self.start_up:
            return self.velocity
        return self.velocity * math.sin(0.5 * math.pi * max(time, 0.0) / self.start_up) ** 2

    def shape(self, cells: tuple[int, int, int], is_walled: tuple[bool, bool, bool]) -> Floats:
        """Velocity on the faces of the grid over the mean one.

        Parameters
        ----------
        cells : tuple of int, (3,)
            Of the grid.
        is_walled : tuple of bool, (3,)
            Directions bounded by no-slip walls, along which a parabolic profile varies.

        Returns
        -------
        ndarray, (n_second, n_first), [-]
            Mean 1; n_first along the first of `across`.

        Examples
        --------
        >>> Inflow(0, 1.0, "parabolic").shape((8, 4, 4), (False, True, False))[0].round(3).tolist()
        [0.636, 1.364, 1.364, 0.636]
        """
        first, second = ((np.arange(cells[axis]) + 0.5) / cells[axis] for axis in self.across)
        if isinstance(self.profile, str):
            is_parabolic = self.profile == "parabolic"
            along = [
                6.0 * s * (1.0 - s) if is_parabolic and is_walled[axis] else np.ones_like(s)
                for s, axis in zip((first, second), self.across, strict=True)
            ]
            found = along[1][:, None] * along[0]
        else:
            found = _between(_between(self.profile, first, 1), second, 0)
        return np.asarray(found / found.mean())

    def peak(self, is_walled: tuple[bool, bool, bool]) -> float:
        """Largest velocity over the mean one, in the limit of a fine grid [-]."""
        if isinstance(self.profile, str):
            return 1.5 ** sum(is_walled[axis] for axis in self.across) if self.profile == "parabolic" else 1.0
        return float(np.max(self.profile) / self._mean())

    def _mean(self) -> float:
        """Mean of a given profile, linear between its points."""
        weights = [np.convolve(np.ones(max(n - 1, 1)), np.ones(2 if n > 1 else 1)) for n in np.shape(self.profile)]
        second, first = (w / w.sum() for w in weights)
        return float(second @ np.asarray(self.profile) @ first)


def _between(values: Floats, at: Floats, axis: int) -> Floats:
    """Linear between evenly spaced points from 0 to 1 along one axis; constant where there is one point."""
    count = values.shape[axis]
    if count == 1:
        return np.repeat(values, at.size, axis=axis)
    left = np.minimum((at * (count - 1)).astype(int), count - 2)
    weight = at * (count - 1) - left
    weight = weight if axis == 1 else weight[:, None]
    return np.asarray((1.0 - weight) * values.take(left, axis) + weight * values.take(left + 1, axis))
