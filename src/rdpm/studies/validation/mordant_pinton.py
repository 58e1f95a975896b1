"""A glass bead released from rest in water, Re 41.

Measured by Mordant and Pinton, Eur. Phys. J. B 18 (2000) 343-352: d = 0.5 mm, density ratio 2.56. The viscosity is the
one that makes the measured final speed Re 41. The box is a column of 16 x 16 x 32 diameters with free-slip boundaries;
95 % of the final speed is reached after some 7 diameters. The drag at the final speed is compared with the one that
solvers on grids fitted to a sphere give for an unbounded flow as well, since the viscosity of the experiment is known
from its Reynolds number only.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rdpm.config.load import load_case
from rdpm.setup import Simulation
from rdpm.studies.validation.points import crossing, points
from rdpm.studies.validation.result import Chart, Curve, Found, Row, Tell

__all__ = ["mordant_pinton"]

Floats = NDArray[np.float64]

SOURCE = "Mordant & Pinton 2000"

DIAMETER, GRAVITY, RATIO, REYNOLDS = 5e-4, 9.81, 2.56, 41.0

#: Width and height of the column, and the bead's way [diameters].
WIDTH, HEIGHT, WAY = 16.0, 32.0, 25.0

SPEED_BAND, TIME_BAND = 0.02, 0.05

#: Drag coefficients computed on body-fitted grids at two Reynolds numbers, between which it is nearly a power.
FITTED, FITTED_SOURCE = ((20.0, 2.72), (50.0, 1.57)), "Johnson & Patel 1999 and others"
DRAG_BAND = 0.03  # those figures are known within 1 to 2 %


def fitted_drag(reynolds: float) -> float:
    """Drag coefficient of a sphere in an unbounded flow.

    Parameters
    ----------
    reynolds : float, [-]
        Of the diameter, 20 to 50.

    Returns
    -------
    float, [-]

    Examples
    --------
    >>> round(fitted_drag(41.0), 3)
    1.768
    """
    (low, at_low), (high, at_high) = FITTED
    slope = np.log(at_high / at_low) / np.log(high / low)
    return float(at_low * (reynolds / low) ** slope)


def measured() -> tuple[Floats, Floats, float]:
    """Times over sqrt(d/g), falling speeds over sqrt(g d), and the final one of these, as published."""
    time, speed = points("mordant_pinton_2000", "time_over_sqrt_d_g", "speed_over_sqrt_g_d")
    return time, speed, float(speed[time > 40.0].mean())


def mordant_pinton(quick: bool, tell: Tell) -> Found:
    """Final speed, the drag coefficient there, and the time to 95 % of it."""
    time, speed, final = measured()
    t95 = crossing(time, speed, 0.95 * final)
    curves = [Curve("measured", time[time < 30.0], speed[time < 30.0], True)]
    for across in (8,) if quick else (8, 12):
        tell(f"{across} cells a diameter")
        t, u = fall(across)
        end = float(u[-1])
        reynolds = REYNOLDS * end / final
        is_judged = across == 12 or quick
        at = f"{across} cells/d"
        yield Row(f"final speed / sqrt(g d), {at}", end, final, SPEED_BAND if is_judged else None, "", SOURCE)
        yield Row(
            f"time to 95 % / sqrt(d/g), {at}",
            crossing(t, u, 0.95 * end),
            t95,
            TIME_BAND if is_judged else None,
            "",
            SOURCE,
        )
        yield Row(
            f"drag coefficient, Re {reynolds:.1f}, {at}",
            4.0 / 3.0 * (RATIO - 1.0) / end**2,
            fitted_drag(reynolds),
            DRAG_BAND if is_judged else None,
            "",
            FITTED_SOURCE,
        )
        curves.append(Curve(f"rdpm, {across} cells a diameter", t, u))
    yield Row(
        f"drag coefficient, Re {REYNOLDS:.1f}, measured",
        4.0 / 3.0 * (RATIO - 1.0) / final**2,
        fitted_drag(REYNOLDS),
        None,
        "",
        FITTED_SOURCE,
    )
    yield Chart(
        "mordant_pinton",
        "A bead released from rest, Re 41",
        "time / sqrt(d/g)",
        "speed / sqrt(g d)",
        "Glass in water, d = 0.5 mm, density ratio 2.56; column of 16 x 16 x 32 diameters, free-slip boundaries",
        curves,
    )


def fall(across: int, width: float = WIDTH) -> tuple[Floats, Floats]:
    """Release the bead in a column.

    Parameters
    ----------
    across : int
        Cells a diameter.
    width : float, [diameters]
        Of the column.

    Returns
    -------
    time : ndarray, (T,), [sqrt(d/g)]
    speed : ndarray, (T,), [sqrt(g d)]
        Downwards.
    """
    unit_speed, unit_time = np.sqrt(GRAVITY * DIAMETER), np.sqrt(DIAMETER / GRAVITY)
    viscosity = float(measured()[2] * unit_speed * DIAMETER / REYNOLDS)
    size = [width * DIAMETER, width * DIAMETER, HEIGHT * DIAMETER]
    case = {
        "domain": {"size": size, "boundary": {"x": "free-slip", "y": "free-slip", "z": "free-slip"}},
        "fluid": {"density": 1000.0, "kinematic_viscosity": viscosity},
        "bodies": [
            {
                "diameter": DIAMETER,
                "density": 1000.0 * RATIO,
                "centers": [[0.5 * size[0], 0.5 * size[1], size[2] - 3.0 * DIAMETER]],
            }
        ],
        "resolution": {"cells_per_diameter": across},
        # Nothing is met on the way: the steps are as long as the flow allows.
        "time": {"end": 1.0, "step": "adaptive"},
    }
    simulation = Simulation(load_case(case))
    rows = []
    while simulation.bodies.position[0, 2] > size[2] - (3.0 + WAY) * DIAMETER:
        simulation.advance()
        rows.append((simulation.time / unit_time, -simulation.bodies.velocity[0, 2] / unit_speed))
    t, u = np.array(rows).T
    return t, u
