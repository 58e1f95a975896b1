"""A sphere settles in a closed tank and comes to rest on the floor, E1 (Re 1.5) and E3 (Re 11.6).

Measured by ten Cate, Nieuwstad, Derksen and van den Akker, Phys. Fluids 14 (2002) 4012: nylon sphere of 15 mm, 1120
kg/m3, in a tank of 10 x 10 x 16 cm, its lowest point 120 mm above the floor. The times from h/d = 7 to 1 follow from
the digitised curves of figure 5a; they do not depend on the digitising offset. E1's published peak is reached by no
code, and is not judged.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rdpm.config.load import load_case
from rdpm.setup import Simulation
from rdpm.studies.validation.points import crossing, points
from rdpm.studies.validation.result import Chart, Curve, Found, Row, Tell

__all__ = ["ten_cate"]

SOURCE = "ten Cate et al. 2002"

Floats = NDArray[np.float64]

#: Root mean square distance from the measured points below h/d = 1, in diameters: twice the scatter of two digitisers.
APPROACH_BAND = 0.10


@dataclass(frozen=True)
class Tank:
    """One of the published cases; densities [kg/m^3], viscosity [Pa s], times [s], speed [m/s]."""

    name: str
    density: float
    viscosity: float
    fall_time: float
    fall_band: float
    peak: float
    peak_band: float | None
    end: float
    steps: tuple[float, float]  # of time: one, and four times it


E1 = Tank("E1", 970.0, 0.373, 2.64, 0.04, 0.0360, None, 4.2, (0.5e-3, 2e-3))
E3 = Tank("E3", 962.0, 0.113, 1.083, 0.02, 0.0873, 0.02, 1.75, (0.75e-3, 3e-3))


def _fall(tank: Tank, across: float, step: float | str) -> tuple[Floats, Floats, Floats]:
    """Time, gap over diameter, and speed."""
    case = load_case(
        "settling",
        [
            f"fluid.density={tank.density}",
            f"fluid.viscosity={tank.viscosity}",
            f"resolution.cells_per_diameter={across}",
            f"time.end={tank.end}",
            f"time.step={step}",
        ],
    )
    simulation = Simulation(case)
    rows = []
    simulation.on_step(lambda s: rows.append((s.time, s.bodies.position[0, 2] / 0.015 - 0.5, -s.bodies.velocity[0, 2])))
    while simulation.time < tank.end and (not rows or rows[-1][1] > 0.01):
        simulation.advance()
    time, gap, speed = np.array(rows).T
    return time, gap, speed


def _fall_time(time: Floats, gap: Floats) -> float:
    return crossing(time, gap, 1.0) - crossing(time, gap, 7.0)


def ten_cate(tank: Tank, quick: bool, tell: Tell) -> Found:
    """Fall time, peak and approach on three grids, and the fall time with a fourfold step."""
    measured_time, measured_gap = points("ten_cate_2002", "time_s", "value", case=tank.name, quantity="gap")
    curves = [Curve("measured", measured_time, measured_gap, True)]
    for across in (8,) if quick else (8, 12, 16):
        tell(f"{tank.name}, {across} cells a diameter")
        time, gap, speed = _fall(tank, across, "auto")
        is_judged = across == 16 or quick
        what = f"{across} cells/d"
        yield Row(
            f"time from h/d 7 to 1, {what}", _fall_time(time, gap), tank.fall_time, tank.fall_band, "s", SOURCE + ", 5a"
        )
        yield Row(
            f"peak speed, {what}", float(speed.max()), tank.peak, tank.peak_band if is_judged else None, "m/s", SOURCE
        )
        near = measured_gap < 1.0
        late = measured_time[near] - crossing(measured_time, measured_gap, 1.0) + crossing(time, gap, 1.0)
        off = np.interp(late, time, gap) - measured_gap[near]
        yield Row(
            f"distance from the approach, {what}", float(np.sqrt(np.mean(off**2))), None, APPROACH_BAND, "d", SOURCE
        )
        curves.append(Curve(f"rdpm, {across} cells a diameter", time, gap))
    if quick:
        return
    times = []
    for step in tank.steps:
        tell(f"{tank.name}, 8 cells a diameter, dt = {1e3 * step:g} ms")
        times.append(_fall_time(*_fall(tank, 8, step)[:2]))
    yield Row("change of the fall time with a fourfold step, 8 cells/d", times[1] / times[0] - 1.0, None, 0.02)
    yield Chart(
        f"ten_cate_{tank.name}",
        f"Settling towards the floor, {tank.name}",
        "time [s]",
        "gap under the sphere / diameter",
        f"Nylon sphere of 15 mm in oil, {tank.density:g} kg/m³, {tank.viscosity:g} Pa s; tank 10 x 10 x 16 cm",
        curves,
    )
