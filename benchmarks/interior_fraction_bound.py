"""How far the interior fraction may be overestimated before a light body's motion becomes unstable.

One sphere released from rest in the oil of the case ``dkt``, at other values of `Calibration.interior_fraction`. Run as
``python benchmarks/interior_fraction_bound.py``; half a minute on two cores.
"""

from __future__ import annotations

from dataclasses import replace

import rdpm
from rdpm.errors import GuardError
from rdpm.particles.calibration import CALIBRATION

RATIOS = (0.01, 0.5)
FRACTIONS = (0.0, 0.30, 0.43, 0.50, 0.55, 0.60, 0.65)
TAKEN = 0.21  # by the pressure, at 8 cells a diameter


def speed(ratio: float, fraction: float) -> str:
    """Speed after 80 steps of 1 ms [m/s], or the guard that stopped it."""
    calibration = replace(
        CALIBRATION, interior_fraction=(fraction, 0.0), interior_fraction_predicted=(fraction + TAKEN, 0.0)
    )
    case = {
        "domain": {"size": [0.06, 0.06, 0.12], "gravity": [0, 0, -9.81]},
        "fluid": {"density": 962.0, "viscosity": 0.113},
        "bodies": [{"diameter": 0.015, "density": 962.0 * ratio, "centers": [[0.03, 0.03, 0.03]]}],
        "resolution": {"cells_per_diameter": 8},
        "time": {"end": 0.08, "step": 1e-3},
        "contact": {"restitution": 0.9, "contact_steps": 8},
    }
    simulation = rdpm.Simulation(rdpm.load_case(case), calibration=calibration)
    try:
        simulation.run(until=0.08)
    except GuardError as error:
        return type(error).__name__
    return f"{simulation.bodies.velocity[0, 2]:.4f}"


def main() -> None:
    """Print one row a density ratio."""
    print("density ratio  " + "".join(f"{fraction:>9.2f}" for fraction in FRACTIONS))
    for ratio in RATIOS:
        print(f"{ratio:13g}  " + "".join(f"{speed(ratio, fraction):>9}" for fraction in FRACTIONS), flush=True)


if __name__ == "__main__":
    main()
