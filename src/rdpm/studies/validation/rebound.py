"""A steel sphere falls onto the floor of a tank of silicone oil and rebounds, St 152.

Measured by Gondret, Lance and Petit, Phys. Fluids 14 (2002) 643-652: d = 3 mm, 7800 in 935 kg/m3, 0.010 Pa s. The
approach is prescribed until the gap is one radius, as in the shipped case `rebound`, but at the impact speed of
0.585 m/s from 12 diameters above the floor: the wake of the last diameters is there, at half of the time.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rdpm.config.load import load_case
from rdpm.setup import Simulation
from rdpm.studies.validation.points import points
from rdpm.studies.validation.result import Chart, Curve, Found, Row, Tell

__all__ = ["rebound"]

SOURCE = "Gondret et al. 2002"

Floats = NDArray[np.float64]

DIAMETER, SPEED, RESTITUTION = 3e-3, 0.585, 0.97

#: Sides of the box, and start of the centre above the floor [diameters].
BOX, START = (16.0 / 3.0, 16.0 / 3.0, 15.0), 12.5

#: Time after impact that holds two rebounds [s].
AFTER = 0.12

PEAK_BANDS = (0.05, 0.10)


def bounces(
    across: float, step: float, contact_steps: float, offset: float = 0.0, after: float = AFTER
) -> tuple[Floats, Floats, float]:
    """Time from impact [s], gap [m], and largest overlap over the diameter.

    Parameters
    ----------
    across : float
        Cells a diameter.
    step : float, [s]
    contact_steps : float
    offset : float, [cells]
        Added to the start along all directions.
    after : float, [s]
        Simulated from impact on.
    """
    h = DIAMETER / across
    size = [side * DIAMETER for side in BOX]
    center = [0.5 * size[0] + offset * h, 0.5 * size[1] + offset * h, START * DIAMETER + offset * h]
    ramp = 1e-3
    case = {
        "domain": {"size": size},
        "fluid": {"density": 935.0, "viscosity": 0.010},
        "bodies": [
            {
                "diameter": DIAMETER,
                "density": 7800.0,
                "centers": [center],
                "motion": {
                    "until": {"gap": 0.5 * DIAMETER},
                    "velocity": {"times": [0.0, ramp], "values": [[0, 0, 0], [0, 0, -SPEED]]},
                },
            }
        ],
        "contact": {"restitution": RESTITUTION, "contact_steps": contact_steps},
        "resolution": {"cells_per_diameter": across},
        "time": {"end": 1.0, "step": step},
    }
    simulation = Simulation(load_case(case))
    rows, deepest, impact = [], 0.0, np.inf
    while simulation.time < impact + after:
        simulation.advance()
        gap = float(simulation.bodies.position[0, 2] - 0.5 * DIAMETER)
        rows.append((simulation.time, gap))
        contact = simulation.system.last_contact
        deepest = max(deepest, contact.max_overlap_fraction if contact else 0.0)
        if impact == np.inf and len(rows) > 1 and simulation.bodies.velocity[0, 2] > 0.0:
            impact = simulation.time
    time, gaps = np.array(rows).T
    return time - impact, gaps, deepest


def peaks(time: Floats, gap: Floats) -> list[float]:
    """Heights of the rebounds [m]; nan where one did not end."""
    turn = np.flatnonzero((gap[1:-1] > gap[:-2]) & (gap[1:-1] >= gap[2:]) & (time[1:-1] > 0.0)) + 1
    found = [float(gap[n]) for n in turn if gap[n] > 0.01 * DIAMETER]
    return (found + [float("nan")] * 3)[:3]


def rebound(quick: bool, tell: Tell) -> Found:
    """Heights of two rebounds at 16 cells a diameter, and what offset, step and contact time change in the first."""
    time, gap = points("gondret_2002", "time_s", "gap_m")
    measured = peaks(time, gap)
    across, step = (10, 0.12e-3) if quick else (16, 0.06e-3)
    tell(f"{across} cells a diameter")
    t, g, overlap = bounces(across, step, 4)
    for n, (height, reference, band) in enumerate(zip(peaks(t, g), measured, PEAK_BANDS, strict=False)):
        what = f"rebound {n + 1}, {across} cells/d, dt {1e3 * step:g} ms"
        yield Row(what, 1e3 * height, 1e3 * reference, None if quick else band, "mm", SOURCE)
    yield Row(f"largest overlap, {across} cells/d, dt {1e3 * step:g} ms", 100.0 * overlap, unit="% d")
    if quick:
        return
    first = {}
    coarse, dt = 10, 0.1e-3
    for label, args in {
        "": (dt, 4, 0.0),
        "dt/2, same contact time": (0.5 * dt, 8, 0.0),
        "dt/2, half of it": (0.5 * dt, 4, 0.0),
        "8 contact steps": (dt, 8, 0.0),
        "offset 0.25 h": (dt, 4, 0.25),
        "offset 0.5 h": (dt, 4, 0.5),
    }.items():
        tell(f"{coarse} cells a diameter, {label or 'dt 0.1 ms, 4 contact steps'}")
        first[label] = peaks(*bounces(coarse, args[0], args[1], args[2], 0.05)[:2])[0]
        change = first[label] / first[""] - 1.0
        yield Row(
            f"rebound 1, {coarse} cells/d, {label or 'dt 0.1 ms, 4 steps'}"
            + (f" ({100 * change:+.1f} %)" if label else ""),
            1e3 * first[label],
            1e3 * measured[0],
            None,
            "mm",
            SOURCE,
        )
    yield Chart(
        "rebound",
        "Rebound of a steel sphere in oil, St 152",
        "time from impact [ms]",
        "gap [mm]",
        f"d = 3 mm, 7800 in 935 kg/m³, 0.010 Pa s; {across} cells a diameter, dt = {1e3 * step:g} ms",
        [Curve("measured", 1e3 * time, 1e3 * gap, True), Curve("rdpm", 1e3 * t[t > -0.012], 1e3 * g[t > -0.012])],
    )
