"""The box: its size, what bounds it, and how its walls move."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from rdpm.conventions import BOUNDARY_KINDS, FACES, NO_NEIGHBOUR, BoundaryKind
from rdpm.errors import CaseError
from rdpm.grid.inflow import Inflow
from rdpm.surfaces import Surface

__all__ = ["Box"]


@dataclass(frozen=True, eq=False)
class Box:
    """A box from the origin to ``size``, for fluid and contacts alike.

    Parameters
    ----------
    size : tuple of float, (3,), [m]
        Lx, Ly, Lz; > 0.
    kinds : tuple of str, (3,)
        Of the x, y and z pair of faces: "periodic", "wall" (no-slip), "free-slip" or "inflow-outflow". A free-slip face
        stops bodies as a wall does, but without friction and lubrication. At most one pair lets the fluid through.
    wall_velocity : ndarray, (6, 3), [m/s]
        Tangential velocity of each face in the order of `rdpm.conventions.FACES`: x_lower, x_upper, y_lower, ...
    walls : tuple of Plane or Cylinder
        Within the box. Wall n is partner `rdpm.conventions.FIRST_WALL` - n of a body.
    inflow : Inflow, optional
        What enters; needed with "inflow-outflow".

    Raises
    ------
    CaseError
        A size that is not above zero; an unknown kind; a face moving along its normal; open faces without an inflow
        along them, or the other way round.

    Examples
    --------
    >>> box = Box((0.1, 0.1, 0.5), ("periodic", "periodic", "wall"))
    >>> box.is_periodic
    (True, True, False)
    >>> box.table[1]
    array([0.1, 0.1, 0. ])
    """

    size: tuple[float, float, float]
    kinds: tuple[BoundaryKind, BoundaryKind, BoundaryKind] = ("wall", "wall", "wall")
    wall_velocity: NDArray[np.float64] = field(default_factory=lambda: np.zeros((6, 3)))
    walls: tuple[Surface, ...] = ()
    inflow: Inflow | None = None

    def __post_init__(self) -> None:
        for axis, (length, kind) in enumerate(zip(self.size, self.kinds, strict=True)):
            if not 0.0 < length < np.inf:
                raise CaseError(f"box size[{axis}]", length, "must be above 0", cure="Correct this value.")
            if kind not in BOUNDARY_KINDS:
                rule = "must be " + " or ".join(f'"{name}"' for name in BOUNDARY_KINDS)
                raise CaseError(f"box kinds[{axis}]", kind, rule, cure="Choose one of them.")
        opened = [axis for axis, kind in enumerate(self.kinds) if kind == "inflow-outflow"]
        if opened != ([self.inflow.axis] if self.inflow else []):
            raise CaseError(
                "box kinds", list(self.kinds), 'must be "inflow-outflow" along the inflow, and nowhere else',
                cure="Give the box an inflow along that direction.",
            )  # fmt: skip
        velocity = np.array(self.wall_velocity, dtype=np.float64).reshape(6, 3)
        object.__setattr__(self, "wall_velocity", velocity)
        along = velocity[np.arange(6), np.arange(6) // 2]
        if along.any():
            face = int(np.flatnonzero(along)[0])
            raise CaseError(
                f"box wall_velocity of {FACES[face]}",
                float(along[face]),
                "must have no part along the wall's normal",
                "the box keeps its size",
                "Give the tangential components only.",
            )

    @property
    def is_periodic(self) -> tuple[bool, bool, bool]:
        """A flag a direction."""
        x, y, z = (kind == "periodic" for kind in self.kinds)
        return x, y, z

    @property
    def is_free_slip_face(self) -> NDArray[np.bool_]:
        """Faces without shear stress: (6,)."""
        return np.repeat([kind == "free-slip" for kind in self.kinds], 2)

    @property
    def volume(self) -> float:
        """Its volume [m^3]."""
        return self.size[0] * self.size[1] * self.size[2]

    @cached_property
    def table(self) -> NDArray[np.float64]:
        """Size, period (-1: open), faces' velocities, walls, as the contact kernels read them: (8 + 5 walls, 3)."""
        period = self.period.copy()
        if self.inflow is not None:
            period[self.inflow.axis] = -1.0
        return np.vstack([self.size, period, self.wall_velocity, *(wall.row for wall in self.walls)])

    @cached_property
    def period(self) -> NDArray[np.float64]:
        """Length along periodic directions, 0 along others: (3,) [m]."""
        return np.where(self.is_periodic, self.size, 0.0)

    @property
    def partners(self) -> int:
        """The lowest id of a wall is -partners."""
        return len(self.walls) - NO_NEIGHBOUR
