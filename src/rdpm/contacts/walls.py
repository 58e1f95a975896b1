"""The box that holds the bodies, as the contacts see it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rdpm.errors import CaseError

__all__ = ["SIDES", "Box"]

SIDES = ("x_lower", "x_upper", "y_lower", "y_upper", "z_lower", "z_upper")
"""Side s is partner -1 - s of a body."""


@dataclass(frozen=True)
class Box:
    """Six sides from the origin to ``size``.

    A direction that is neither periodic nor walled (free slip) holds the bodies too: its sides push like
    walls, but without friction and without a lubricating film.

    Parameters
    ----------
    size : (Lx, Ly, Lz), [m]
        > 0.
    periodic, has_wall : (bool, bool, bool)
        For each direction; not both.
    wall_velocity : ndarray, (6, 3), [m/s], optional
        Of the sides in the order of :data:`SIDES`; tangential. Zero when left out.

    Attributes
    ----------
    table : ndarray, (8, 3)
        Size, period (0: not periodic) and wall velocities, as the kernels read them.

    Raises
    ------
    CaseError
        A size that is not above zero; a direction periodic and walled; a wall moving along its normal.

    Examples
    --------
    >>> box = Box((0.1, 0.1, 0.5), (True, True, False), (False, False, True))
    >>> box.table[1]
    array([0.1, 0.1, 0. ])
    """

    size: tuple[float, float, float]
    periodic: tuple[bool, bool, bool]
    has_wall: tuple[bool, bool, bool]
    wall_velocity: NDArray[np.float64] = field(default_factory=lambda: np.zeros((6, 3)))
    table: NDArray[np.float64] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        for axis, name in enumerate("xyz"):
            if not (0.0 < self.size[axis] < np.inf):
                rule, cure = "must be above 0", "Correct this value."
                raise CaseError(f"domain.size[{axis}]", self.size[axis], rule, cure=cure)
            if self.periodic[axis] and self.has_wall[axis]:
                rule, cure = "cannot be periodic and walled", "Choose one of the two."
                raise CaseError(f"domain.boundary.{name}", None, rule, cure=cure)
        speed = np.array(self.wall_velocity, dtype=np.float64).reshape(6, 3)
        along = speed[np.arange(6), np.arange(6) // 2]
        if np.any(along != 0.0):
            side = SIDES[int(np.flatnonzero(along)[0])]
            rule = "must have no part along the wall's normal"
            cure = "Give the tangential components only."
            found = along[along != 0.0][0]
            raise CaseError(f"domain.wall_velocity.{side}", found, rule, "the box keeps its size", cure)
        period = np.where(self.periodic, self.size, 0.0)
        object.__setattr__(self, "table", np.vstack([self.size, period, speed]))

    @property
    def is_slip_side(self) -> NDArray[np.bool_]:
        """Sides that are neither walls nor periodic: (6,)."""
        return np.repeat(~(np.asarray(self.periodic, bool) | np.asarray(self.has_wall, bool)), 2)
