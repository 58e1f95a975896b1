"""What makes an impact: the contact itself, and nothing that rests or moves elsewhere."""

import numpy as np
import pytest

import rdpm
from rdpm.coupling import step

D = 0.01


def simulation(bodies, size=(4 * D, 4 * D, 4 * D), gravity=9.81, boundary=None, **contact) -> rdpm.Simulation:
    case = {
        "domain": {"size": list(size), "gravity": [0, 0, -gravity], "boundary": boundary or {}},
        "fluid": {"density": 1000.0, "viscosity": 0.02},
        "bodies": [{"diameter": D, "density": 2500.0, **body} for body in bodies],
        "contact": {"restitution": 0.9, "contact_steps": 8, **contact},
        "resolution": {"cells_per_diameter": 6},
        "time": {"end": 1.0, "step": 1e-3},
    }
    return rdpm.Simulation(rdpm.load_case(case), threads=1)


@pytest.fixture
def counts(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Outer iterations of each step."""
    found: list[int] = []
    own = step.outer_iterations

    def count(*state) -> int:
        found.append(own(*state))
        return found[-1]

    monkeypatch.setattr(step, "outer_iterations", count)
    return found


def test_bodies_at_rest_are_no_impact(counts: list[int]) -> None:
    places = [[1.2 * D, 2 * D, 0.5 * D], [2.8 * D, 2 * D, 0.5 * D]]
    sim = simulation([{"centers": places}])
    sim.run(until=0.3)
    assert np.abs(sim.bodies.velocity).max() < 1e-3  # they lie on the floor
    assert sim.system.last_contact.touching == 2
    assert counts[50:] == [1] * len(counts[50:])


def impact(others: list[dict], counts: list[int], **contact) -> tuple[float, int]:
    """Restitution of a sphere that meets the floor, and the steps forced twice."""
    first = len(counts)
    sim = simulation(
        [{"centers": [[2 * D, 2 * D, 0.75 * D]], "velocity": [0, 0, -0.15], "density": 8000.0}, *others],
        size=(4 * D, 4 * D, 12 * D), gravity=0.0, boundary={"x": "periodic", "y": "periodic"}, lubrication=False,
        **contact,
    )  # fmt: skip
    sim.run(until=0.06)
    episode = sim.system.contacts.take_episodes()[0]
    return float(episode["restitution"]), sum(n == 2 for n in counts[first:])


def test_a_fast_body_elsewhere_leaves_an_impact_alone(counts: list[int]) -> None:
    alone, twice = impact([], counts)
    fast = {"centers": [[2 * D, 2 * D, 10 * D]], "motion": {"velocity": [0.9, 0, 0]}}
    beside, twice_beside = impact([fast], counts)
    assert twice == twice_beside > 4
    assert beside == pytest.approx(alone, rel=2e-3)  # the wake of the fast one, nine diameters away


def test_a_moving_frame_does_not_change_the_count(counts: list[int]) -> None:
    found = []
    for frame in (0.0, 0.3):
        first = len(counts)
        sim = simulation(
            [
                {"centers": [[2 * D, 2 * D, z]], "velocity": [frame, 0, v], "density": 8000.0}
                for z, v in ((1.3 * D, 0.1), (2.7 * D, -0.1))
            ],
            gravity=0.0, boundary=dict.fromkeys("xyz", "periodic"), lubrication=False,
        )  # fmt: skip
        sim.fluid.set_velocity(frame, 0.0, 0.0)
        sim.system.immersed.motion.interior = sim.system.immersed.interior_momentum(sim.fluid)
        sim.run(until=0.06)
        found.append(counts[first:])
    assert found[0] == found[1]
    assert 2 in found[0]


def test_without_the_force_of_the_fluid_a_contact_has_its_dry_restitution(counts: list[int]) -> None:
    wet, _ = impact([], counts)
    dry, _ = impact([], counts, fluid_force_in_impact=False)
    # Of 0.9 asked. The load of the step before acts while the sphere is in its first step of contact, an eighth of it.
    assert wet < 0.85
    assert dry == pytest.approx(0.9, abs=0.01)


def test_the_fluid_acts_on_what_rests() -> None:
    """A sphere that lies on the floor is dragged along by a stream."""
    found = []
    for acts in (True, False):
        sim = simulation(
            [{"centers": [[2 * D, 2 * D, 0.5 * D]]}],
            boundary={"x": "periodic", "y": "periodic"}, fluid_force_in_impact=acts,
        )  # fmt: skip
        sim.fluid.set_velocity(0.05, 0.0, 0.0)
        sim.run(until=0.05)
        found.append(sim.bodies.velocity[0, 0])
    assert found[0] > 1e-3
    assert found[1] == pytest.approx(found[0], rel=1e-9)
