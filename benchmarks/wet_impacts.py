"""A steel sphere of 6 mm on a wall in silicone oil: what decides its rebound at St 27, and e against St.

Gondret, Lance and Petit, Phys. Fluids 14 (2002) 643-652: 7800 in 965 kg/m3, 0.519 m/s; St 27 at 0.100 Pa s. The
approach is prescribed until the gap is a radius. 12 cells a diameter; a quarter of a minute a run.

    python benchmarks/wet_impacts.py            # St 27: roughness, lubrication, forcings, steps, box
    python benchmarks/wet_impacts.py stokes     # St 5 to 1000, at the roughness that fits St 27
"""

from __future__ import annotations

import sys
from dataclasses import replace
from typing import Any

import numpy as np

import rdpm.coupling.step
from rdpm.config.load import load_case
from rdpm.particles.calibration import CALIBRATION
from rdpm.setup import Simulation

D, SPEED, DENSITY, OIL, E_DRY, VISCOSITY = 6e-3, 0.519, 7800.0, 965.0, 0.97, 0.100
CELLS, STEP, START, WIDTH = 12, 1e-4, 4.5, 16.0 / 3.0
ROUGH = 2e-3  # of the radius

#: Changes of the contact table or of the numerics.
VARIED: dict[str, dict[str, Any]] = {
    "roughness 0.001 a (default)": {},
    "roughness 0.002 a": {"contact": {"lubrication_roughness": 2e-3}},
    "roughness 0.003 a": {"contact": {"lubrication_roughness": 3e-3}},
    "roughness 0.01 a": {"contact": {"lubrication_roughness": 1e-2}},
    "no lubrication in separation": {"contact": {"lubrication_in_separation": False}},
    "no lubrication": {"contact": {"lubrication": False}},
    "one forcing in the impact": {"rounds": 1},
    "four forcings in the impact": {"rounds": 4},
    "no entrained fluid in contact": {"calibration": {"contact_fluid_fraction": 0.0}},
    "half the step, half the contact time": {"step": 0.5 * STEP},
    "half the step": {"step": 0.5 * STEP, "contact": {"contact_steps": 16}},
    "box of 8 diameters": {"width": 8.0},
}
VISCOSITIES = {5: 0.54, 10: 0.2697, 27: 0.100, 46: 0.0587, 84: 0.0321, 153: 0.01765, 1000: 0.0027}


def impact(
    viscosity: float = VISCOSITY,
    contact: dict[str, Any] | None = None,
    calibration: dict[str, float] | None = None,
    rounds: int | None = None,
    step: float = STEP,
    width: float = WIDTH,
) -> tuple[float, float, float]:
    """Peak of the first rebound [m], its time after the impact [s], speed 1 ms after the impact [m/s]."""
    size = [width * D, width * D, (START + 2.5) * D]
    case = {
        "domain": {"size": size},
        "fluid": {"density": OIL, "viscosity": viscosity},
        "bodies": [{
            "diameter": D, "density": DENSITY, "centers": [[0.5 * size[0], 0.5 * size[1], START * D]],
            "motion": {"until": {"gap": 0.5 * D},
                       "velocity": {"times": [0.0, 2e-3], "values": [[0, 0, 0], [0, 0, -SPEED]]}},
        }],
        "contact": {"restitution": E_DRY, "contact_steps": 8, **(contact or {})},
        "resolution": {"cells_per_diameter": CELLS},
        "time": {"end": 1.0, "step": step},
    }  # fmt: skip
    usual = rdpm.coupling.step.outer_iterations
    if rounds is not None:
        rdpm.coupling.step.outer_iterations = lambda c, *rest: rounds if c.contact_impulse.any() else 1
    try:
        sim = Simulation(load_case(case), calibration=replace(CALIBRATION, **(calibration or {})))
        turned, rows = np.inf, []
        while sim.time < min(turned, 0.2) + 0.024:
            sim.advance()
            speed = float(sim.bodies.velocity[0, 2])
            if turned == np.inf and speed > 0.0:
                turned = sim.time
            rows.append((sim.time - turned, float(sim.bodies.position[0, 2]) - 0.5 * D, speed))
    finally:
        rdpm.coupling.step.outer_iterations = usual
    time, gap, speed = np.array([row for row in rows if row[0] >= 0.0]).T
    top = int(np.argmax(gap))
    return float(gap[top]), float(time[top]), float(np.interp(1e-3, time, speed))


def main() -> None:
    """Print a table."""
    if sys.argv[1:] == ["stokes"]:
        print("| St | speed 1 ms after over before | Legendre |\n|---|---|---|")
        for stokes, viscosity in VISCOSITIES.items():
            after = impact(viscosity, {"lubrication_roughness": ROUGH})[2] / SPEED
            curve = E_DRY * np.exp(-35.0 / (stokes * (1.0 + 0.5 * OIL / DENSITY)))
            print(f"| {stokes} | {max(after, 0.0):.3f} | {curve:.3f} |", flush=True)
        return
    print("| run | peak gap [mm] | at [ms] | speed after 1 ms [m/s] |\n|---|---|---|---|")
    for name, changes in VARIED.items():
        peak, at, after = impact(**changes)
        print(f"| {name} | {1e3 * peak:.3f} | {1e3 * at:.1f} | {after:.4f} |", flush=True)


if __name__ == "__main__":
    main()
