"""Forces and torques on the bodies: what they add up to, step by step."""

import numpy as np
import pytest

import rdpm

GRAVITY = np.array([0.0, 0.0, -9.81])
GLASS = {"diameter": 0.01, "density": 2500.0}
# Side by side and closing, one spinning; one near the floor: contact and lubrication within the first steps.
WET = {
    "domain": {"size": [0.03, 0.03, 0.05]},
    "fluid": {"density": 960.0, "viscosity": 0.05},
    "bodies": [
        {
            **GLASS,
            "centers": [[0.0095, 0.015, 0.0052], [0.0205, 0.0155, 0.0056]],
            "velocity": [[0.2, 0.0, 0.0], [-0.2, 0.0, -0.02]],
            "angular_velocity": [[0.0, 20.0, 5.0], [0.0, 0.0, 0.0]],
        }
    ],
    "contact": {"restitution": 0.7, "contact_steps": 20, "friction": 0.3},
    "resolution": {"cells_per_diameter": 5},
    "time": {"end": 0.04, "step": 0.0005},
}
CASES = {
    "soft": WET,
    "hard": WET | {"contact": {"model": "hard-sphere", "restitution": 0.7, "friction": 0.3}},
    "no fluid force in impacts": WET | {"contact": WET["contact"] | {"fluid_force_in_impact": False}},
    "adaptive": WET | {"time": {"end": 0.2, "step": "adaptive"}},
    "dry": {
        "domain": {"size": [0.04, 0.04, 0.02]},
        "bodies": [{**GLASS, "packing": {"count": 12, "seed": 3}, "velocity": [0.1, 0.2, -0.5]}],
        "contact": {"stiffness": 500.0, "restitution": 0.5, "friction": 0.4},
        "time": {"end": 0.3},
    },
}


@pytest.mark.parametrize("name", CASES)
def test_newton_and_euler_hold_with_the_loads_of_every_step(name: str) -> None:
    sim = rdpm.Simulation(rdpm.load_case(CASES[name]), threads=1)
    bodies, fluid = sim.bodies, sim.case.fluid
    displaced = bodies.mass * (fluid.density if fluid else 0.0) / bodies.density
    weight = (bodies.mass - displaced)[:, None] * GRAVITY
    seen = np.zeros(3)
    for _ in range(40):
        velocity, spin = bodies.velocity.copy(), bodies.angular_velocity.copy()
        sim.advance()
        force = bodies.hydrodynamic_force + bodies.lubrication_force + bodies.collision_force
        torque = bodies.hydrodynamic_torque + bodies.lubrication_torque + bodies.collision_torque
        gained = bodies.mass[:, None] * (bodies.velocity - velocity) / sim.last_dt
        turned = bodies.moment_of_inertia[:, None] * (bodies.angular_velocity - spin) / sim.last_dt
        # Differences of velocities: round-off of the largest momentum over the step.
        scale = (bodies.mass.max() * max(1.0, np.abs(bodies.velocity).max())) / sim.last_dt
        np.testing.assert_allclose(force + weight, gained, rtol=0, atol=1e-13 * scale)
        np.testing.assert_allclose(torque, turned, rtol=0, atol=1e-13 * scale * bodies.diameter.max())
        np.testing.assert_array_equal(bodies.contact_force, bodies.collision_force + bodies.lubrication_force)
        seen += [np.abs(part).max() for part in (bodies.hydrodynamic_force, bodies.collision_force, torque)]
    assert (seen[1:] > 0.0).all()
    assert (seen[0] > 0.0) == (fluid is not None)


def test_loads_are_arrays_that_stay() -> None:
    sim = rdpm.Simulation(rdpm.load_case(WET), threads=1)
    force = sim.bodies.hydrodynamic_force
    sim.run(until=0.005)
    assert force is sim.bodies.hydrodynamic_force
    assert np.abs(force).max() > 0.0
    assert np.abs(sim.bodies.lubrication_torque).max() > 0.0  # one slips along the floor


def test_lubrication_along_the_line_of_centres_alone_has_no_torque() -> None:
    case = WET | {"contact": WET["contact"] | {"lubrication_tangential": False}}
    sim = rdpm.Simulation(rdpm.load_case(case), threads=1)
    sim.run(until=0.005)
    assert np.abs(sim.bodies.lubrication_force).max() > 0.0
    assert not sim.bodies.lubrication_torque.any()
