"""When runs, steps and prescribed motions end."""

import math

import numpy as np
import pytest

import rdpm
from builders import in_oil
from rdpm.particles.prescribed import Motion, Prescription
from rdpm.particles.state import FREE, Bodies

DRY = {
    "domain": {"size": [1.0, 1.0, 1.0], "gravity": [0, 0, 0]},
    "bodies": [{"diameter": 0.1, "density": 1000.0, "centers": [[0.5, 0.5, 0.5]]}],
    "contact": {"restitution": 0.9, "contact_steps": 8},
    "time": {"end": 1.0, "step": 2e-4},
}
def prescribed(motion: dict, step: float = 2e-4) -> rdpm.Simulation:
    body = {**DRY["bodies"][0], "motion": motion}
    return rdpm.Simulation(rdpm.load_case({**DRY, "bodies": [body], "time": {"end": 1.0, "step": step}}))


def test_a_motion_ends_with_the_step_that_reaches_its_time_whatever_the_sum_of_steps() -> None:
    dt = 2e-4
    late = []
    for whole in range(1, 3000):
        time = 0.0
        for _ in range(whole):
            time += dt
        bodies = Bodies([0.1], [1000.0], [[0.5] * 3])
        still = Motion(np.zeros(1), np.zeros((1, 3)), np.zeros((1, 3)), until=whole * dt)
        prescription = Prescription({0: still})
        prescription.hold(bodies, 0.0, dt)
        prescription.release(bodies, time, dt, lambda: np.full(1, math.inf))
        if bodies.motion[0] != FREE:
            late.append(whole)
    assert late == []


def test_a_kink_inside_a_step_is_followed() -> None:
    # 1 m/s until 0.9 ms, then falling to rest within 0.2 ms: 0.9 + 0.1 mm, in steps of 1 ms.
    motion = {"velocity": {"times": [0.0, 0.9e-3, 1.1e-3], "values": [[1, 0, 0], [1, 0, 0], [0, 0, 0]]}}
    sim = prescribed(motion, 1e-3)
    sim.run(until=2e-3)
    assert sim.bodies.position[0, 0] - 0.5 == pytest.approx(1.0e-3, rel=1e-12)


@pytest.mark.parametrize("step", ["auto", "adaptive", 1.3e-3])
@pytest.mark.parametrize("until", [0.0501, 0.0372])
def test_a_run_ends_at_the_time_asked(step, until: float) -> None:
    sim = in_oil(resolution__cells_per_diameter=4, time={"end": 0.1, "step": step})
    dt = []
    sim.on_step(lambda s: dt.append(s.last_dt))
    sim.run(until=until)
    assert sim.time == pytest.approx(until, abs=1e-12)
    assert sum(dt) == pytest.approx(until, abs=1e-12)
    assert min(dt) >= 0.5 * sim.plan.step.dt * (1.0 - 1e-9)  # none of a small part
    sim.run(until=0.06)
    assert sim.time == pytest.approx(0.06, abs=1e-12)
    assert np.isfinite(sim.bodies.velocity).all()


def test_steps_that_fit_are_all_of_the_same_length() -> None:
    sim = rdpm.Simulation(rdpm.load_case(DRY))
    sim.run(until=0.1)
    assert (sim.steps, sim.shortest_dt, sim.longest_dt) == (500, 2e-4, 2e-4)
