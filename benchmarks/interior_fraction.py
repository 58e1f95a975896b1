"""Fraction of an impulse on the markers that is found in a sphere's interior: what the body equation was fitted on.

An impulse is spread from the markers of one sphere over fluid at rest and measured inside, before and after the
projection; the last column is the least-squares line in one over the cells a diameter, as `Calibration` holds it. Run
as ``python benchmarks/interior_fraction.py``; half a minute on two cores.
"""

from __future__ import annotations

import numpy as np

import rdpm

ACROSS = (6, 8, 12, 16, 24)
OFFSETS = ((0.1, 0.2, 0.3), (0.5, 0.5, 0.5))
NAMES = ("predicted", "projected", "rotation")

BOX = 3.0  # diameters


def fractions(across: int, offset: tuple[float, float, float]) -> tuple[float, float, float]:
    """Translation before and after the projection, and rotation.

    Parameters
    ----------
    across : int
        Cells a diameter.
    offset : tuple of float, [cells]
        Of the sphere from the middle of the box.
    """
    sim = rdpm.Simulation(
        rdpm.load_case(
            {
                "domain": {"size": [BOX] * 3, "boundary": dict.fromkeys("xyz", "periodic"), "gravity": [0, 0, 0]},
                "fluid": {"density": 1.0, "kinematic_viscosity": 1.0},
                "bodies": [{"diameter": 1.0, "density": 2.0, "centers": [[0.5 * BOX + o / across for o in offset]]}],
                "contact": {"restitution": 0.9, "stiffness": 1.0},
                "resolution": {"cells": [round(BOX * across)] * 3},
                "time": {"end": 1.0, "step": 1e-4},
            }
        )
    )
    fluid, immersed = sim.fluid, sim.system.immersed
    assert fluid is not None
    assert immersed is not None
    markers = immersed.markers
    found = []
    for values, part in (
        (np.tile([1.0, 0.0, 0.0], (len(markers), 1)), 0),
        (np.cross([0.0, 0.0, 1.0], markers.arm), 5),
    ):
        fluid.set_velocity(0.0, 0.0, 0.0)
        markers.spread(fluid.velocity, values, 1.0)
        given = markers.sums(values)[0, part]
        found.append(float(immersed.interior_momentum(fluid)[0, part] / given))
        fluid.project(1e-4)
        found.append(float(immersed.interior_momentum(fluid)[0, part] / given))
    return found[0], found[1], found[3]


def main() -> None:
    """Print one row a fraction."""
    print("cells a diameter" + "".join(f"{across:>8}" for across in ACROSS) + "   a + b / cells")
    measured = np.array([[fractions(across, offset) for offset in OFFSETS] for across in ACROSS])
    for n, name in enumerate(NAMES):
        b, a = np.polyfit(1.0 / np.repeat(ACROSS, len(OFFSETS)), measured[:, :, n].ravel(), 1)
        means = "".join(f"{value:8.3f}" for value in measured[:, :, n].mean(axis=1))
        print(f"{name:16}{means}   {a:.3f} {b:+.3f}")


if __name__ == "__main__":
    main()
