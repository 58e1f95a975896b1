"""Adaptive steps: how long each is, what they leave alone, and when they are short."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import rdpm
from rdpm.contacts import Contacts, SoftSphere
from rdpm.errors import CaseError
from rdpm.grid import Box
from rdpm.particles.state import Bodies
from rdpm.setup import plan
from rdpm.simulation.step_control import GROWTH, PARTS, StepControl

CASE = {
    "domain": {"size": [0.03, 0.03, 0.06]},
    "fluid": {"density": 960.0, "viscosity": 0.2},
    "bodies": [
        {"diameter": 0.01, "density": 5000.0, "centers": [[0.015, 0.015, 0.045]]},
        {"diameter": 0.01, "density": 2500.0, "centers": [[0.015, 0.015, 0.015]], "motion": "fixed"},
    ],
    "contact": {"restitution": 0.7, "contact_steps": 8},
    "resolution": {"cells_per_diameter": 4},
    "time": {"end": 0.13, "step": "adaptive"},
}


@given(st.floats(0.0, 1e4), st.integers(PARTS, 40), st.floats(0.0, 0.99))
def test_a_step_keeps_within_its_limits(rate: float, last: int, time: float) -> None:
    control = StepControl(contact_step=1e-3, longest=6.6e-3, cfl=0.5, end=1.0)
    parts = control.parts(rate, last, time)
    part = 1e-3 / PARTS
    assert parts >= PARTS or parts * part >= 1.0 - time - part
    assert parts <= max(last, PARTS) + GROWTH
    assert parts * part <= 6.6e-3
    assert parts == PARTS or parts * part * rate <= 1.0 + 1e-9


@given(st.integers(3, 4000), st.integers(PARTS, 30))
def test_the_last_step_ends_at_the_end(steps: int, longest: int) -> None:
    control = StepControl(contact_step=1e-3, longest=longest * 1e-3 / PARTS, cfl=0.5, end=steps * 1e-3)
    time, parts = 0.0, PARTS
    while time < control.end - 1e-6 * control.contact_step:
        parts = control.parts(0.0, parts, time)
        time += parts * control.contact_step / PARTS
    assert time == pytest.approx(control.end, abs=1e-9)


def test_contact_is_that_of_the_fixed_step() -> None:
    """Parameters are tied to the declared contact step, never to the momentary one."""
    for name in ("dkt", "settling", "cloud"):
        fixed, adaptive = (plan(rdpm.load_case(name, [f"time.step={step}"])) for step in ("auto", "adaptive"))
        assert [pair.design for pair in adaptive.pairs] == [pair.design for pair in fixed.pairs]
        assert adaptive.step.dt == fixed.step.dt
        assert adaptive.step.longest > 2.0 * fixed.step.dt
        assert fixed.step_control is None


def test_a_dry_case_has_no_adaptive_step() -> None:
    dry = {key: value for key, value in CASE.items() if key not in ("fluid", "resolution")}
    with pytest.raises(CaseError, match=r"time\.step = \"adaptive\": must not be in a case without \[fluid\]"):
        rdpm.load_case(dry)


def test_steps_are_long_alone_and_short_before_and_in_an_impact() -> None:
    sim = rdpm.Simulation(rdpm.load_case(CASE), threads=1)
    shortest = sim.plan.step.dt
    h = 0.01 / 4
    seen = []

    def look(sim: rdpm.Simulation) -> None:
        gap = np.linalg.norm(sim.bodies.position[0] - sim.bodies.position[1]) - 0.01
        seen.append((gap / h, sim.dt / shortest))

    sim.on_step(look)
    sim.run(until=0.13)
    gap, length = np.array(seen).T
    assert gap.min() < 0.0
    assert length.min() >= 1.0 - 1e-9
    assert length[gap > 3.5].max() > 2.0
    first = int(np.argmax(gap < 2.0))
    touch = int(np.argmax(gap < 0.0))
    np.testing.assert_allclose(length[first : touch + 3], 1.0)
    assert (sim.shortest_dt, sim.longest_dt) == (shortest, pytest.approx(shortest * length.max()))


def test_a_loaded_spring_counts_as_fast() -> None:
    """At the turn of an impact nothing moves."""
    ball = Bodies(np.array([0.01]), np.array([2500.0]), np.array([[0.05, 0.05, 0.0049]]))
    box = Box((0.1, 0.1, 0.1))
    law = SoftSphere.from_contact_time(restitution=1.0, contact_time=1e-3)
    speeds = Contacts(ball, box, law).gap_speeds(0.001)
    assert speeds is not None
    # The speed that a spring gives back from its largest overlap: pi over the contact's duration times it.
    assert speeds[0] == pytest.approx(np.pi * 1e-4 / 1e-3)
    assert speeds[1] == 0.0
    ball.position[0, 2] = 0.05
    assert Contacts(ball, box, law).gap_speeds(0.001) is None


def test_a_sphere_settles_as_with_the_short_step() -> None:
    """Within the 1 % that adaptive steps promise, on a coarse grid and while the speed still grows."""
    fallen = []
    for step in ("auto", "adaptive"):
        over = [
            "resolution.cells_per_diameter=6",
            "domain.size=['6 cm', '6 cm', '10 cm']",
            "bodies[0].centers=[['3 cm', '3 cm', '8 cm']]",
            "time.end=0.4",
            f"time.step={step}",
        ]
        sim = rdpm.Simulation(rdpm.load_case("settling", over), threads=1)
        sim.run(until=0.4)
        assert sim.time == pytest.approx(0.4)
        fallen.append(0.08 - sim.bodies.position[0, 2])
    assert sim.steps < 0.5 * sim.plan.steps
    assert not sim.plan.step.is_explicit
    # Measured: 0.7 %.
    assert fallen[1] == pytest.approx(fallen[0], rel=0.01)
