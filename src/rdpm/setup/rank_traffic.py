"""What a rank sends in a step: counted in advance, as the calls of a step make it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rdpm.particles.calibration import CALIBRATION
from rdpm.particles.shared import ROW_COLUMNS

__all__ = ["Traffic", "shared_with", "step_traffic"]

#: Numbers of 8 bytes of a body in common: before the passes interior, lagged force and moments of its markers; in each
#: pass its sums; at the end interior and slip.
BEFORE, SUMS, AFTER = 28, 6, 13

#: Of a marker in each pass, of a step's measures, of its vote on errors.
MARKER, MEASURES, VOTE = 3, 3, 1


@dataclass(frozen=True)
class Traffic:
    """Sent by one rank in one step.

    Attributes
    ----------
    messages : int
    sent_bytes : int
    """

    messages: int
    sent_bytes: int


def step_traffic(
    cells: tuple[int, int, int],
    ranks: int,
    rank: int,
    is_periodic: bool,
    stages: int,
    shared: Mapping[int, tuple[int, int]],
    owned: int | None,
    of_walls: Mapping[int, int] | None = None,
    is_stream: bool = False,
    passes: int = CALIBRATION.forcing_passes,
) -> Traffic:
    """Count what a rank sends in a step in which no body comes to another slab, and none hits another.

    Parameters
    ----------
    cells : tuple of int
        Of the box.
    ranks, rank : int
    is_periodic : bool
        Along z.
    stages : int
        Of stabilised diffusion; 0 where it is explicit.
    shared : mapping of int to (int, int)
        By other rank, the bodies and the markers that both hold.
    owned : int or None
        Bodies whose centres are in this slab; None where the box has neither bodies nor walls within it.
    of_walls : mapping of int to int, optional
        By other rank, the markers of walls within the box that both have; None without walls.
    is_stream : bool
        Fluid enters and leaves along x or y: the ranks agree on how much leaves.
    passes : int
        Of direct forcing.

    Examples
    --------
    An inner rank of four sends 13 planes: 9 with halo, and the quarter of each mode's numbers that is its own stays.

    >>> sent = step_traffic((16, 16, 32), 4, 1, True, 0, {}, None)
    >>> sent.sent_bytes - 3 * 4 * 8 == 9 * 8 * 18**2 + 4 * 8 * 16**2 * 3 // 4
    True
    """
    nx, ny, _ = cells
    others, plane = ranks - 1, (nx + 2) * (ny + 2)
    up = 1 if is_periodic or rank < ranks - 1 else 0
    down = 1 if is_periodic or rank > 0 else 0
    both = min(up + down, others)  # neighbours: two slabs of a periodic box are so above and below
    # w up, the increment down, then together u, v, w up and u, v, w, p down.
    messages, numbers = up + down + both, (4 * up + 5 * down) * plane
    # Two numbers of each mode to the rank that solves it, and back.
    mine = nx * ny * (rank + 1) // ranks - nx * ny * rank // ranks
    messages, numbers = messages + 2 * others, numbers + 2 * (nx * ny - mine) + 2 * mine * others
    if stages:  # the rates of the components together, as deep as the stages reach
        messages, numbers = messages + both, numbers + 3 * (up + down) * (stages - 1) * plane
    tables, columns = 2 + is_stream, MEASURES + VOTE + is_stream
    messages, numbers = messages + tables * others, numbers + columns * others
    if owned is not None:
        for bodies, markers in shared.values():
            messages, numbers = messages + 2 + passes, numbers + (BEFORE + passes * SUMS + AFTER) * bodies
            numbers += passes * MARKER * markers
        messages, numbers = messages + others, numbers + ROW_COLUMNS * owned * others
    if of_walls is not None:  # their velocities in each pass, and the force on the fluid
        messages, numbers = messages + passes * len(of_walls), numbers + passes * MARKER * sum(of_walls.values())
        messages, numbers = messages + others, numbers + 3 * others
    return Traffic(messages, 8 * numbers)


def shared_with(bodies: NDArray[np.bool_], markers: NDArray[np.bool_], rank: int) -> dict[int, tuple[int, int]]:
    """By other rank, how many bodies and markers both hold.

    Parameters
    ----------
    bodies, markers : ndarray of bool, (ranks, N), (ranks, M)
        Which ranks hold which.
    rank : int

    Examples
    --------
    >>> shared_with(np.array([[True, True], [False, True]]), np.array([[True, True], [True, True]]), 0)
    {1: (1, 2)}
    """
    of_bodies, of_markers = ((held & held[rank]).sum(axis=1) for held in (bodies, markers))
    return {
        other: (int(of_bodies[other]), int(of_markers[other]))
        for other in range(len(bodies))
        if other != rank and (of_bodies[other] or of_markers[other])
    }
