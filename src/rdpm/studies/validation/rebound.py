"""A steel sphere falls onto the floor of a tank of silicone oil and rebounds, St 152.

Measured by Gondret, Lance and Petit, Phys. Fluids 14 (2002) 643-652: d = 3 mm, 7800 in 935 kg/m3, 0.010 Pa s. The
approach is prescribed until the gap is one radius, as in the shipped case `rebound`, but at the impact speed of
0.585 m/s from 12 diameters above the floor: the wake of the last diameters is there, at half of the time.
"""

from __future__ import annotations

from collections.abc import Iterator

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

#: Horizontal edges of the box, and start of the centre above the floor [diameters].
ACROSS, START = (16.0 / 3.0, 16.0 / 3.0), 12.5

#: Time after impact that holds three rebounds, and the top of the first [s].
AFTER, AFTER_FIRST = 0.15, 0.05

PEAK_BANDS = (0.05, 0.10)

#: Cells a diameter, step [s], contact steps and start [diameters] of the runs that are varied; their bands.
VARIED = (12, 0.025e-3, 12, 5.5)
PLACE_BAND, STEP_BAND, CONTACT_BAND = 0.05, 0.03, 0.05


def bounces(
    across: float,
    step: float,
    contact_steps: float,
    offset: float = 0.0,
    after: float = AFTER,
    start: float = START,
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
    start : float, [diameters]
        Height of the centre at first; the box ends 2.5 diameters above.
    """
    h = DIAMETER / across
    size = [edge * DIAMETER for edge in (*ACROSS, start + 2.5)]
    center = [0.5 * size[0] + offset * h, 0.5 * size[1] + offset * h, start * DIAMETER + offset * h]
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


def _first_peak(across: float, step: float, contact_steps: float, offset: float, wake: float) -> float:
    """Height of the first rebound [m] after a fall from so many diameters."""
    return peaks(*bounces(across, step, contact_steps, offset, AFTER_FIRST, wake)[:2])[0]


def _dependence(tell: Tell) -> Iterator[Row]:
    """What step, contact time and place within a cell change in the first rebound, after a shorter fall."""
    across, step, steps, wake = VARIED

    def row(what: str, found: float, band: float | None) -> Row:
        return Row(f"rebound 1, {across} cells/d, {what}", 1e3 * found, 1e3 * base, band, "mm", "the row above")

    tell(f"{across} cells a diameter, from {wake:g} diameters, offset 0")
    places = [base := _first_peak(across, step, steps, 0.0, wake)]
    label = f"dt {1e3 * step:g} ms, {steps} contact steps"
    yield Row(f"rebound 1, {across} cells/d, from {wake:g} d, {label}", 1e3 * base, unit="mm")
    for offset in (0.2, 0.4, 0.6, 0.8):
        tell(f"offset {offset:g} cells")
        places.append(_first_peak(across, step, steps, offset, wake))
    yield row("five places in a cell, lowest", min(places), PLACE_BAND)
    yield row("five places in a cell, highest", max(places), PLACE_BAND)
    tell("half the step")
    yield row("half the step, the same contact time", _first_peak(across, 0.5 * step, 2 * steps, 0.0, wake), STEP_BAND)
    for other, dt in ((8, step), (30, 12 / 30 * step)):
        tell(f"{other} contact steps")
        what = f"{other} contact steps of {1e3 * dt:.3g} ms"
        yield row(what, _first_peak(across, dt, other, 0.0, wake), CONTACT_BAND)


def rebound(quick: bool, tell: Tell) -> Found:
    """Heights of three rebounds at 16 cells a diameter; what place, step and contact time change in the first at 12."""
    time, gap = points("gondret_2002", "time_s", "gap_m")
    measured = peaks(time, gap)
    across, step, steps = (10, 0.05e-3, 8) if quick else (16, 0.02e-3, 16)
    tell(f"{across} cells a diameter")
    t, g, overlap = bounces(across, step, steps)
    for n, (height, reference) in enumerate(zip(peaks(t, g), measured, strict=False)):
        what = f"rebound {n + 1}, {across} cells/d, dt {1e3 * step:g} ms, {steps} contact steps"
        band = None if quick or n >= len(PEAK_BANDS) else PEAK_BANDS[n]
        yield Row(what, 1e3 * height, 1e3 * reference, band, "mm", SOURCE)
    yield Row(f"largest overlap, {across} cells/d, dt {1e3 * step:g} ms", 100.0 * overlap, unit="% d")
    if quick:
        return
    yield from _dependence(tell)
    yield Chart(
        "rebound",
        "Rebound of a steel sphere in oil, St 152",
        "time from impact [ms]",
        "gap [mm]",
        f"d = 3 mm, 7800 in 935 kg/m³, 0.010 Pa s; {across} cells a diameter, dt = {1e3 * step:g} ms",
        [Curve("measured", 1e3 * time, 1e3 * gap, True), Curve("rdpm", 1e3 * t[t > -0.012], 1e3 * g[t > -0.012])],
    )
