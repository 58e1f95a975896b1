"""Vorticity and Q criterion of the flow, at the cell centres."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rdpm.fluid.state import Fluid
from rdpm.grid import Grid

__all__ = ["vorticity_and_q"]

Floats = NDArray[np.float64]

#: Planes that are worked on at once: what is held besides the result stays small.
SLAB = 16


def vorticity_and_q(fluid: Fluid) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    r"""Vorticity :math:`\nabla\times u` and :math:`Q=-\tfrac12\,\partial_iu_j\,\partial_ju_i`, to second order.

    Derivatives are central differences of the velocity at the cell centres; beside a no-slip wall they are one-sided
    and take the wall's velocity; beside an inflow or outflow they are of first order. Q > 0 where rotation outweighs
    strain.

    Parameters
    ----------
    fluid : Fluid
        Its halos are current, as after a projection.

    Returns
    -------
    vorticity : ndarray, (nz, ny, nx, 3), [1/s]
        Of this rank's slab alone, where several share the box; so is q.
    q : ndarray, (nz, ny, nx), [1/s^2]

    References
    ----------
    .. [1] Hunt, Wray, Moin, Proc. Summer Program CTR (1988) 193-208.

    Examples
    --------
    >>> from rdpm.grid import Box, Grid
    >>> walls = np.zeros((6, 3))
    >>> walls[5, 0] = 2.0                                          # the lid moves along x: u = 2 z
    >>> fluid = Fluid(Grid(Box((1.0, 1.0, 1.0), ("periodic", "periodic", "wall"), walls), (4, 4, 8)), 1.0, 1.0)
    >>> fluid.set_velocity(2.0 * fluid.grid.points("u")[2][:, None, None], 0.0, 0.0)
    >>> vorticity, q = vorticity_and_q(fluid)
    >>> np.unique(vorticity[..., 1].round(6)).tolist(), float(abs(q).max())
    ([2.0], 0.0)
    """
    nx, ny, nz = fluid.grid.cells_here
    vorticity, q = np.empty((nz, ny, nx, 3), np.float32), np.empty((nz, ny, nx), np.float32)
    for first in range(1, nz + 1, SLAB):
        last = min(first + SLAB, nz + 1)
        d = [[_derivative(fluid, j, i, first, last) for j in range(3)] for i in range(3)]  # d[i][j] = d_i u_j
        part = slice(first - 1, last - 1)
        for n in range(3):
            i, j = (n + 1) % 3, (n + 2) % 3
            vorticity[part, ..., n] = d[i][j] - d[j][i]
        q[part] = -0.5 * sum(d[i][j] * d[j][i] for i in range(3) for j in range(3))
    return vorticity, q


def _derivative(fluid: Fluid, component: int, axis: int, first: int, last: int) -> Floats:
    """Of a component along an axis, in the cells of the planes first to last - 1."""
    grid, field = fluid.grid, fluid.velocity[component]
    h, kind = grid.spacing[axis], grid.boundary[axis]
    own, along = 2 - component, 2 - axis
    inner = [slice(first, last), slice(1, -1), slice(1, -1)]
    if own == along:
        return np.asarray((field[tuple(inner)] - field[_shifted(inner, own, -1)]) / h)

    def centred(shift: int) -> Floats:
        here = list(inner)
        here[along] = _moved(inner[along], shift)
        return np.asarray(0.5 * (field[tuple(here)] + field[_shifted(here, own, -1)]))

    below, above = centred(-1), centred(1)
    result = (above - below) / (2.0 * h)
    if kind == "wall":
        # Through the wall's value, which is the mean of the first cell and its halo, and two cells.
        at = centred(0)
        ends = ((0, above, below, 1.0), (-1, below, above, -1.0))
        for end, inside, halo, sign in ends:
            if along == 0 and not _is_at_wall(grid, (first, last)[end], end):
                continue
            place = tuple(slice(None) if n != along else end for n in range(3))
            result[place] = sign * (at[place] + inside[place] - 2.0 * halo[place]) / (3.0 * h)
    return result


def _is_at_wall(grid: Grid, plane: int, end: int) -> bool:
    """Whether the planes from this one on, or up to it, begin or end at a face of the box."""
    adjoins = grid.slab is not None and (grid.slab.lower, grid.slab.upper)[end] is not None
    return not adjoins and plane == (1, grid.cells_here[2] + 1)[end]


def _moved(part: slice, shift: int) -> slice:
    stop = part.stop + shift
    return slice(part.start + shift, None if stop == 0 else stop)


def _shifted(inner: list[slice], axis: int, shift: int) -> tuple[slice, ...]:
    return tuple(_moved(part, shift) if n == axis else part for n, part in enumerate(inner))
