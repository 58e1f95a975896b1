"""What marker passes without kernels of their own for periodic faces and walls would cost.

Markers beside a face could read and write halo values like any others, if the halo of the velocity were filled before
each interpolation and its adjoint, the fold of the halo into the inner values, followed each spreading. Times that
traffic (a fold moves what a fill moves) beside the forcing passes as they are. Run as
``python benchmarks/halo_passes.py``; half a minute on two cores.
"""

from __future__ import annotations

import time

import numpy as np

import rdpm
from rdpm import _core
from rdpm.parallel.threads import available_threads
from rdpm.studies.bench import CASES

REPEATS = 30
NAMES = ("suspension-200", "sphere-explicit")


def faces(fields: tuple[np.ndarray, ...]) -> None:
    """Copy each halo face from the inner values beside it."""
    for q in fields:
        q[:, :, 0], q[:, :, -1] = q[:, :, -2], q[:, :, 1]
        q[:, 0], q[:, -1] = q[:, -2], q[:, 1]
        q[0], q[-1] = q[-2], q[1]


def median(action: object, *arguments: object) -> float:
    """Of the seconds that a call takes."""
    times = []
    for _ in range(REPEATS):
        begin = time.perf_counter()
        action(*arguments)  # type: ignore[operator]
        times.append(time.perf_counter() - begin)
    return float(np.median(times))


def main() -> None:
    """Print one line a case."""
    print(f"{'case':18}{'step [ms]':>10}{'passes [ms]':>12}{'fill, fold of the passes [ms]':>30}{'of the step':>12}")
    for name in NAMES:
        make, threads = CASES[name]
        sim = rdpm.Simulation(rdpm.load_case(make()), threads or available_threads())
        fluid, immersed = sim.fluid, sim.system.immersed
        assert fluid is not None
        assert immersed is not None
        for _ in range(3):
            sim.advance()
        passes, steps = [], []
        for _ in range(REPEATS):
            immersed.pass_seconds = 0.0
            begin = time.perf_counter()
            sim.advance()
            steps.append(time.perf_counter() - begin)
            passes.append(immersed.pass_seconds)

        def fill(fields: tuple[np.ndarray, ...] = fluid.velocity, core: _core.Grid = fluid.grid.core) -> None:
            for component, q in enumerate(fields):
                _core.fill_halo(core, q, component)

        step, both = float(np.median(steps)), min(median(fill), median(faces, fluid.velocity))
        calls = 2 * immersed.calibration.forcing_passes
        print(
            f"{name:18}{1e3 * step:10.1f}{1e3 * float(np.median(passes)):12.1f}{1e3 * calls * both:30.1f}"
            f"{calls * both / step:12.1%}",
            flush=True,
        )


if __name__ == "__main__":
    main()
