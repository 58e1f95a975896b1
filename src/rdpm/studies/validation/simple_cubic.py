r"""Stokes drag of a simple-cubic array of spheres.

Eight fixed spheres, 2 x 2 x 2 unit cells, in a fully periodic box, the fluid driven by a body force g so weak that
Re < 1e-3. With the superficial velocity U and the unit cell's length L the drag factor is
:math:`K = g L^3 / (6\pi\nu a U)`, against Zick and Homsy, J. Fluid Mech. 115 (1982) 13-26, table 2.

The box has an odd number of cells: neighbours are half a cell apart on the grid, so that the eight spheres of one run
take eight positions within a cell and K is their mean. The depth of the markers was fitted on the two dilute arrays;
the third is predicted.
"""

from __future__ import annotations

import itertools

import numpy as np

from rdpm.config.load import load_case
from rdpm.particles.calibration import CALIBRATION, Calibration
from rdpm.setup import Simulation
from rdpm.studies.validation.result import Chart, Curve, Found, Row, Tell

__all__ = ["drag_factor", "simple_cubic"]

SOURCE = "Zick & Homsy 1982, table 2"

#: Solid fraction -> drag factor, cells along two unit cells at about 12 cells a diameter, band.
ARRAYS = {0.064: (2.810, 49, 0.015), 0.125: (4.292, 39, 0.015), 0.343: (15.4, 27, 0.04)}

#: Of the densest array, for the order; the last has about 24 cells a diameter and a band.
FINER = (19, 37, 55)
FINE_BAND = 0.015

#: Viscous number nu dt / h^2 of a step, and others, for what the drag owes to the step.
STEP, OTHER_STEPS = 0.6, (0.15, 1.8)

#: Steps of that size over which the mean velocity must not change by more to be steady, and the most that are made.
SAMPLE, SETTLED, MOST_STEPS = 400, 2e-4, 4000

#: Of a sphere from a corner of a cell [cells]; its neighbours are at this and 0.5 more, which mirrors to 0.375.
OFFSET = 0.125


def drag_factor(
    solid_fraction: float, cells: int, step: float = STEP, calibration: Calibration = CALIBRATION
) -> float:
    """Drag factor K, mean over eight positions within a cell.

    Parameters
    ----------
    solid_fraction : float, [-]
        Below pi/6, where spheres touch.
    cells : int
        Along two unit cells; odd.
    step : float, [-]
        Viscous number nu dt / h^2.
    calibration : Calibration

    Returns
    -------
    float, [-]
        From the mean velocity of the steady flow.
    """
    d, h, drive = float((6.0 * solid_fraction / np.pi) ** (1 / 3)), 2.0 / cells, 0.01
    guess = 0.9 * float(np.interp(solid_fraction, list(ARRAYS), [K for K, _, _ in ARRAYS.values()]))
    unit = drive / (3.0 * np.pi * d)  # mean velocity at K = 1
    centers = [[n + 0.5 + OFFSET * h for n in corner] for corner in itertools.product((0, 1), repeat=3)]
    case = {
        "domain": {"size": [2.0] * 3, "boundary": dict.fromkeys("xyz", "periodic"), "gravity": [0, 0, 0]},
        "fluid": {
            "density": 1.0,
            "kinematic_viscosity": 1.0,
            "body_force": [drive, 0, 0],
            "initial_velocity": [unit / guess, 0, 0],
        },
        "bodies": [{"diameter": d, "density": 1.0, "motion": "fixed", "centers": centers}],
        "resolution": {"cells": [cells] * 3},
        "time": {"end": 10.0, "step": step * h * h, "diffusion": "stabilised"},
    }
    simulation = Simulation(load_case(case), calibration=calibration)
    assert simulation.fluid is not None
    mean, longer = np.inf, STEP / step
    while simulation.steps < MOST_STEPS * longer:
        for _ in range(round(SAMPLE * longer)):
            simulation.advance()
        before, mean = mean, float(simulation.fluid.u[1:-1, 1:-1, 1:-1].mean())
        if abs(mean - before) < SETTLED * abs(mean):
            break
    return unit / mean


def simple_cubic(quick: bool, tell: Tell) -> Found:
    """Rows for three solid fractions at 12 cells a diameter, the densest on finer grids too."""
    for fraction, (reference, cells, band) in ARRAYS.items():
        across = 0.5 * cells * (6.0 * fraction / np.pi) ** (1 / 3)
        tell(f"solid fraction {fraction}, {across:.1f} cells a diameter")
        found = drag_factor(fraction, cells)
        if fraction == max(ARRAYS):
            grids = [(across, found)]
        yield Row(f"K, solid fraction {fraction}, {across:.1f} cells/d", found, reference, band, source=SOURCE)
    if quick:
        return
    fraction = sorted(ARRAYS)[1]
    reference, cells, _ = ARRAYS[fraction]
    for step in OTHER_STEPS:
        tell(f"solid fraction {fraction}, nu dt / h^2 = {step:g}")
        found = drag_factor(fraction, cells, step)
        yield Row(f"K, solid fraction {fraction}, nu dt / h^2 = {step:g}", found, reference, source=SOURCE)
    fraction = max(ARRAYS)
    reference = ARRAYS[fraction][0]
    for cells in FINER:
        across = 0.5 * cells * (6.0 * fraction / np.pi) ** (1 / 3)
        tell(f"solid fraction {fraction}, {across:.1f} cells a diameter")
        grids.append((across, drag_factor(fraction, cells)))
        fine = FINE_BAND if cells == max(FINER) else None
        yield Row(f"K, solid fraction {fraction}, {across:.1f} cells/d", grids[-1][1], reference, fine, source=SOURCE)
    x, y = np.array(sorted(grids)).T
    yield Chart(
        "simple_cubic",
        "Drag of the densest array against the grid",
        "cells a diameter",
        "K / K (Zick and Homsy) - 1 [%]",
        f"Simple-cubic array, solid fraction {fraction}, Stokes flow; mean over 8 positions within a cell",
        [Curve("rdpm", x, 100.0 * (y / reference - 1.0), True)],
    )
