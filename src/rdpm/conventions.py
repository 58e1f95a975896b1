"""Names and numbers that a case, the rooms and their results agree on."""

from __future__ import annotations

from typing import Literal

__all__ = ["BOUNDARY_KINDS", "FACES", "FIRST_WALL", "NO_NEIGHBOUR", "OVERLAP_WARNING", "BoundaryKind", "partner_name"]

BoundaryKind = Literal["periodic", "wall", "free-slip", "inflow-outflow"]

#: What bounds the box along x, y or z, in the order of the kernels' numbers.
BOUNDARY_KINDS: tuple[BoundaryKind, ...] = ("periodic", "wall", "free-slip", "inflow-outflow")

#: Faces of the box. Face f is partner -1 - f of a body: ids -1 to -6.
FACES = ("x_lower", "x_upper", "y_lower", "y_upper", "z_lower", "z_upper")

#: Neighbour of a body that is alone in a box without faces.
NO_NEIGHBOUR = -7

#: Walls within the box: wall n is partner FIRST_WALL - n of a body, ids from -8 down.
FIRST_WALL = -8

#: Overlap over the smaller diameter above which a contact is softer than a design should be.
OVERLAP_WARNING = 0.005


def partner_name(partner: int) -> str:
    """The partner of a body in words.

    Parameters
    ----------
    partner : int
        Id of a body, -1 to -6 for a face of the box, `FIRST_WALL` and below for a wall within it.

    Examples
    --------
    >>> partner_name(3), partner_name(-5), partner_name(-8)
    ('body 3', 'the face z_lower', 'wall 0')
    """
    if partner >= 0:
        return f"body {partner}"
    return f"wall {FIRST_WALL - partner}" if partner <= FIRST_WALL else f"the face {FACES[-1 - partner]}"
