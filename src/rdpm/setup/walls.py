"""Walls within the box of a case: whether the fluid behind them can move with them."""

from __future__ import annotations

import math

import numpy as np

from rdpm.config.case import Case
from rdpm.errors import CaseError

__all__ = ["ROOM_BEHIND", "check_room_behind"]

#: Cells behind a moving wall that move with it, markers and their deltas included.
ROOM_BEHIND = 4.0


def check_room_behind(case: Case, h: float) -> None:
    """Refuse a moving tube in a fluid that is closer to the faces of the box than the layer that moves with it.

    Parameters
    ----------
    case : Case
    h : float, [m]
        Mean spacing of the grid; inf in a dry case, which is not checked.

    Raises
    ------
    CaseError
    """
    for n, wall in enumerate(case.walls if math.isfinite(h) else ()):
        if wall.side != "inside" or not (wall.angular_velocity or any(wall.velocity)):
            continue
        axis = np.array(wall.direction) / np.linalg.norm(wall.direction)
        across = np.sqrt(np.maximum(1.0 - axis**2, 0.0))  # how far a circle about the axis extends
        point, size = np.array(wall.point), np.array(case.domain.size)
        reach = (0.5 * (wall.diameter or 0.0) + ROOM_BEHIND * h) * across
        is_crossed = np.abs(axis) > 1e-9  # the tube leaves through these faces
        bare = ((point - reach < 0.0) | (point + reach > size)) & ~is_crossed & ~np.array(case.domain.is_periodic)
        if bare.any():
            name = "xyz"[int(np.argmax(bare))]
            raise CaseError(
                f"walls[{n}].diameter", wall.diameter,
                f"must leave {ROOM_BEHIND:g} cells, {ROOM_BEHIND * h:.3g} m, to the faces of the box along {name}",
                "the fluid behind a moving wall moves with it", "Enlarge domain.size, or refine the grid.",
            )  # fmt: skip
