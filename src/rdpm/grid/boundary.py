"""What bounds the box: a kind for each pair of opposite sides, a velocity for each side."""

from __future__ import annotations

from typing import Literal

__all__ = ["BOUNDARIES", "SIDES", "Boundary"]

Boundary = Literal["periodic", "wall", "free-slip"]

#: Kinds in the order of the kernels' numbers.
BOUNDARIES: tuple[Boundary, ...] = ("periodic", "wall", "free-slip")

#: Sides in the order of their ids -1 to -6.
SIDES = ("x_lower", "x_upper", "y_lower", "y_upper", "z_lower", "z_upper")
