"""How the drafting, kissing and tumbling of the shipped pair depend on choices that physics does not know.

Runs the case ``dkt`` with other time steps, diffusion, marker orientations, places on the grid and contacts, and
prints the times of kissing and tumbling. About a minute a row on two cores::

    python benchmarks/dkt_sensitivity.py            # all rows
    python benchmarks/dkt_sensitivity.py 0 1 4      # some of them
"""

from __future__ import annotations

import sys
import time

import numpy as np

import rdpm
from rdpm.results.dkt import phases

H = 0.1 / 54.0   # spacing of the shipped grid [m]


def moved(x: float, y: float, z: float) -> str:
    """Both centres moved by parts of a cell."""
    first = [0.05015 + x * H, 0.05 + y * H, 0.47 + z * H]
    second = [0.04985 + x * H, 0.05 + y * H, 0.44 + z * H]
    return f"bodies[0].centers=[{first}, {second}]"


ROWS: list[tuple[str, list[str]]] = [
    ("as shipped", []),
    ("dt 1 ms, same contact time", ["time.step=0.001", "contact.contact_steps=15.26"]),
    ("adaptive steps", ["time.step=adaptive"]),
    ("stabilised, dt 3 ms", ["time.step=0.003", "time.diffusion=stabilised", "contact.contact_steps=5.087"]),
    ("stabilised, dt 1.9 ms", ["time.diffusion=stabilised"]),
    ("markers turned, seed 1", ["bodies[0].orientation_seed=1"]),
    ("markers turned, seed 2", ["bodies[0].orientation_seed=2"]),
    ("moved by half a cell in x and y", [moved(0.5, 0.5, 0.0)]),
    ("moved by 0.3, 0.1, 0.7 cell", [moved(0.3, 0.1, 0.7)]),
    ("no lubrication", ["contact.lubrication=false"]),
    ("no friction", ["contact.friction=0"]),
    ("6 cells a diameter", ["resolution.cells_per_diameter=6"]),
    ("10 cells a diameter", ["resolution.cells_per_diameter=10"]),
]


def measure(overrides: list[str]) -> tuple[float | None, float | None, float, float]:
    """Kiss and tumble times [s], angle at 3.4 s [degrees], and wall time [s]."""
    case = rdpm.load_case("dkt", ["time.end=3.4", *overrides])
    simulation = rdpm.Simulation(case)
    rows: list[np.ndarray] = []
    times: list[float] = []

    def follow(s: rdpm.Simulation) -> None:
        times.append(s.time)
        rows.append(s.bodies.position.copy())

    simulation.on_step(follow)
    begin = time.perf_counter()
    simulation.run(until=case.time.end)
    path = np.array(rows)
    found = phases(np.array(times), path[:, 0], path[:, 1], 0.015, 0.015, case.domain.gravity, 0.015)
    return found.kiss_time_s, found.tumble_time_s, found.final_angle_deg, time.perf_counter() - begin


def main() -> None:
    """Print one line a row."""
    chosen = [int(word) for word in sys.argv[1:]] or range(len(ROWS))
    print(f"{'':34} {'kiss [s]':>9} {'45 deg [s]':>10} {'angle [deg]':>11} {'wall [s]':>8}")
    for n in chosen:
        name, overrides = ROWS[n]
        kiss, tumble, angle, wall = measure(overrides)
        shown = ["-" if value is None else f"{value:.3f}" for value in (kiss, tumble)]
        print(f"{name:34} {shown[0]:>9} {shown[1]:>10} {angle:>11.1f} {wall:>8.1f}", flush=True)


if __name__ == "__main__":
    main()
