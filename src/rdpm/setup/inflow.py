"""The stream through the box: for the rooms, for a reader, and how near to its ends bodies may start."""

from __future__ import annotations

import numpy as np

from rdpm.config.case import Case
from rdpm.errors import CaseError
from rdpm.grid.inflow import CLEAR_CELLS, Inflow

__all__ = ["check_ends", "inflow_of", "peak_inflow"]

Spacing = tuple[float, float, float]


def inflow_of(case: Case) -> Inflow | None:
    """The inflow of a case as the grid takes it; None without one."""
    given, axis = case.domain.inflow, case.domain.inflow_axis
    if given is None or axis is None:
        return None
    profile = given.profile if isinstance(given.profile, str) else np.array(given.profile)
    return Inflow(axis, given.velocity, profile, given.start_up)


def peak_inflow(case: Case) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Largest speed that enters along each direction, (3,) [m/s]."""
    peak, inflow = np.zeros(3), inflow_of(case)
    if inflow is not None:
        x, y, z = (kind == "wall" for kind in case.domain.kinds)
        peak[inflow.axis] = abs(inflow.velocity) * inflow.peak((x, y, z))
    return peak


def check_ends(case: Case, spacing: Spacing | None) -> None:
    """Refuse bodies that start near an open end.

    Raises
    ------
    CaseError
    """
    axis, bodies = case.domain.inflow_axis, case.expanded_bodies()
    if axis is None or spacing is None or not len(bodies):
        return
    at, length = bodies.position[:, axis], case.domain.size[axis]
    gap = np.minimum(at, length - at) - 0.5 * bodies.diameter
    least = CLEAR_CELLS * spacing[axis]
    body = int(np.argmin(gap))
    if gap[body] < least:
        raise CaseError(
            f"bodies[{int(bodies.group[body])}]", f"body {body} at {'xyz'[axis]} = {at[body]:.6g} m",
            f"must be at least {CLEAR_CELLS:g} cells, {least:.3g} m, from both ends of the stream",
            f"its surface is {gap[body]:.3g} m from one", "Move it, or lengthen the box.",
        )  # fmt: skip
