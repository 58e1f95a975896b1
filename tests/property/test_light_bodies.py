"""A light sphere beside a moving wall: lubrication that the fluid, coupled once a step, can follow."""

from dataclasses import replace

import numpy as np
import pytest

import rdpm
from rdpm.particles.calibration import CALIBRATION

SPEED, CELLS, STEP = 1e-2, 8, 1.5  # of the wall; a diameter; nu dt / h^2
CASE = {
    "domain": {
        "size": [4.0, 4.0, 4.0],
        "boundary": {"x": "periodic", "y": "periodic", "z": "wall"},
        "gravity": [0, 0, 0],
        "wall_velocity": {"z_lower": [SPEED, 0, 0]},
    },
    "fluid": {"density": 1.0, "kinematic_viscosity": 1.0},
    "bodies": [{"diameter": 1.0, "density": 0.5, "centers": [[2.06, 2.0, 0.5005]]}],
    "resolution": {"cells": [4 * CELLS] * 3},
    "time": {"end": 10.0, "step": STEP / CELLS**2, "diffusion": "stabilised"},
    "contact": {"stiffness": 1.0, "restitution": 0.9},
}


@pytest.mark.parametrize(("rate", "settles"), [(CALIBRATION.tangential_rate, True), (1e9, False)])
def test_a_light_sphere_that_a_wall_drags_along_turns_steadily(rate, settles):
    """Without the bound on the rate, torque by lubrication and by the fluid take turns, and grow."""
    sim = rdpm.Simulation(rdpm.load_case(CASE), threads=1, calibration=replace(CALIBRATION, tangential_rate=rate))
    turning = []
    for _ in range(24):
        sim.advance()
        turning.append(sim.bodies.angular_velocity[0, 1])
    jumps = np.abs(np.diff(turning, 2)) / (2.0 * SPEED)
    assert (jumps[-6:].max() < 0.05 * jumps[:6].max()) == settles
    assert (jumps[-6:].max() > jumps[:6].max()) != settles
    if settles:
        assert 0.5 * SPEED < sim.bodies.velocity[0, 0] < SPEED
