"""Time of a cell's step on this machine, measured with a few planes of a case's own grid."""

from __future__ import annotations

import time

import numpy as np

from rdpm.fluid import Fluid
from rdpm.grid import Box, Grid
from rdpm.setup.inflow import inflow_of
from rdpm.setup.plan import Plan
from rdpm.setup.rows import EXPECTED_NS

__all__ = ["measured_ns"]

#: Planes that are computed, steps, of which the fastest counts, and the most cells.
PLANES, STEPS, MOST = 16, 3, 20_000_000


def measured_ns(made: Plan, threads: int) -> float:
    """Time of a cell and step times the threads [ns].

    Parameters
    ----------
    made : Plan
        With a fluid. Of its box `PLANES` planes are computed, without bodies, at rest.
    threads : int
        At work side by side: they share the memory's bandwidth.

    Returns
    -------
    float
        What `rdpm check` assumes of any machine, where planes are too large to try.

    Examples
    --------
    >>> from rdpm.config.load import load_case
    >>> from rdpm.setup.plan import plan
    >>> measured_ns(plan(load_case("cloud")), 1) > 1.0
    True
    """
    assert made.cells is not None
    assert made.case.fluid is not None
    (nx, ny, nz), domain = made.cells, made.case.domain
    planes = max(PLANES, made.step.stages + 2)
    if nx * ny * planes > MOST:
        return EXPECTED_NS
    size = domain.size[0], domain.size[1], domain.size[2] * planes / nz
    box = Box(size, domain.kinds, np.array(domain.wall_velocities), (), inflow_of(made.case))
    fluid = Fluid(Grid(box, (nx, ny, planes), threads), 1.0, made.case.fluid.nu, made.step.is_explicit)
    fluid.set_velocity(0.0, 0.0, 0.0)
    seconds = []
    for step in range(STEPS + 1):
        begin = time.perf_counter()
        fluid.predict(made.step.dt, (0.0, 0.0, 0.0), time=step * made.step.dt)
        fluid.project(made.step.dt)
        seconds.append(time.perf_counter() - begin)
    return 1e9 * min(seconds[1:]) * threads / (nx * ny * planes)
