"""Names and numbers that a case, the rooms and their results agree on."""

from __future__ import annotations

from typing import Literal

__all__ = ["BOUNDARY_KINDS", "FACES", "NO_NEIGHBOUR", "OVERLAP_WARNING", "BoundaryKind"]

BoundaryKind = Literal["periodic", "wall", "free-slip", "inflow-outflow"]

#: What bounds the box along x, y or z, in the order of the kernels' numbers.
BOUNDARY_KINDS: tuple[BoundaryKind, ...] = ("periodic", "wall", "free-slip", "inflow-outflow")

#: Faces of the box. Face f is partner -1 - f of a body: ids -1 to -6.
FACES = ("x_lower", "x_upper", "y_lower", "y_upper", "z_lower", "z_upper")

#: Neighbour of a body that is alone in a box without faces.
NO_NEIGHBOUR = -7

#: Overlap over the smaller diameter above which a contact is softer than a design should be.
OVERLAP_WARNING = 0.005
