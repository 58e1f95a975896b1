"""Order in time with a moving body, as it is.

The first 0.12 s of ten Cate's E3 at 8 cells a diameter, in a smaller tank, with steps halved three times: the order
from the differences of the speed at the end between successive steps. No reference, no band.
"""

from __future__ import annotations

import numpy as np

from rdpm.config.load import load_case
from rdpm.setup import Simulation
from rdpm.studies.validation.result import Found, Row, Tell

__all__ = ["time_order"]

END = 0.12
STEPS = (4e-3, 2e-3, 1e-3, 0.5e-3)


def _speed(step: float) -> float:
    case = load_case(
        "settling",
        [
            "domain.size=['60 mm', '60 mm', '60 mm']",
            "bodies[0].centers=[['30 mm', '30 mm', '37 mm']]",
            f"time.end={END}",
            f"time.step={step}",
            "time.diffusion='stabilised'",
        ],
    )
    simulation = Simulation(case)
    simulation.run(until=END)
    return float(-simulation.bodies.velocity[0, 2])


def time_order(quick: bool, tell: Tell) -> Found:
    """Observed order of a settling sphere's speed, and the error of the longest step by extrapolation."""
    speeds = []
    for step in STEPS[:3] if quick else STEPS:
        tell(f"dt = {1e3 * step:g} ms")
        speeds.append(_speed(step))
    change = np.abs(np.diff(speeds))
    for n, order in enumerate(np.log2(change[:-1] / change[1:])):
        steps = " / ".join(f"{1e3 * step:g}" for step in STEPS[n : n + 3])
        yield Row(f"order of the speed in time, dt {steps} ms", float(order))
    yield Row(f"change of the speed, dt {1e3 * STEPS[0]:g} to {1e3 * STEPS[1]:g} ms", float(change[0] / speeds[1]))
