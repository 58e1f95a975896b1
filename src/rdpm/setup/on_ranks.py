"""How the box is cut among several ranks."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rdpm.config.case import Case
from rdpm.parallel.decomposition import LEAST_PLANES, Slab, cut, slabs
from rdpm.parallel.ranks import Ranks
from rdpm.particles.state import Bodies
from rdpm.setup.plan import Plan

__all__ = ["bodies_of", "plane_costs", "planes_of_ranks", "slab_of"]

#: Time of a marker's step over that of a cell's (measured: 370 and 13.6 ns); only the balance of ranks depends on it.
MARKER_COST = 27.0


def bodies_of(case: Case) -> Bodies:
    """Return the bodies as a case has them at the start."""
    table = case.expanded_bodies()
    bodies = Bodies(table.diameter, table.density, table.position, table.velocity, table.angular_velocity)
    for number, group in enumerate(case.bodies):
        if group.orientation_seed is not None:
            bodies.turn_at_random(np.flatnonzero(table.group == number), group.orientation_seed)
    return bodies


def plane_costs(made: Plan, bodies: Bodies) -> NDArray[np.float64]:
    """Cost of each plane of cells across z, (nz,), in cells: those of the plane, and its share of the bodies' markers.

    Parameters
    ----------
    made : Plan
        With a fluid.
    bodies : Bodies
        Where they are at the start.
    """
    assert made.cells is not None
    nx, ny, nz = made.cells
    size = made.case.domain.size
    dz, area = size[2] / nz, size[0] * size[1] / (nx * ny)
    costs = np.full(nz, float(nx * ny))
    for z, diameter in zip(bodies.position[:, 2], bodies.diameter, strict=True):
        # A sphere's surface is spread evenly along z: about one marker a cell face.
        first = np.floor((z - 0.5 * diameter) / dz)
        planes = np.arange(int(first), int(np.floor((z + 0.5 * diameter) / dz)) + 1)
        inside = planes % nz if made.case.domain.is_periodic[2] else np.clip(planes, 0, nz - 1)
        markers = np.pi * diameter**2 / area
        np.add.at(costs, inside, MARKER_COST * markers / len(planes))
    return costs


def slab_of(made: Plan, bodies: Bodies, ranks: Ranks) -> Slab | None:
    """Return the planes of this rank, None where it has the box alone.

    Raises
    ------
    CaseError
        Too many ranks.
    """
    if ranks.size == 1 or made.cells is None:
        return None
    return slabs(planes_of_ranks(made, bodies, ranks.size)[0], made.case.domain.is_periodic[2])[ranks.rank]


def planes_of_ranks(made: Plan, bodies: Bodies, ranks: int) -> tuple[list[int], NDArray[np.float64]]:
    """Planes of each of so many ranks, and the cost of every plane [cells].

    Raises
    ------
    CaseError
        Too many ranks.
    """
    costs = plane_costs(made, bodies)
    return cut(costs, ranks, max(LEAST_PLANES, made.step.stages + 1)), costs
