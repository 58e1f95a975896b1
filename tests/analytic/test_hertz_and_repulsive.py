"""Hertz contacts and the repulsive force against closed forms and exact integration."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rdpm import design
from rdpm.contacts import Contacts, Hertz, Repulsive
from rdpm.grid import Box
from rdpm.particles.state import Bodies


def head_on(law, diameter, density, speed, gap, steps, dt, is_wall=False):
    """Two equal spheres, or one and the floor, meet at a relative speed."""
    where = [[0.5, 0.5, 0.5 * diameter + gap]] if is_wall else [[0.5, 0.5, 0.4], [0.5, 0.5, 0.4 + diameter + gap]]
    velocity = [[0.0, 0.0, -speed]] if is_wall else [[0.0, 0.0, 0.5 * speed], [0.0, 0.0, -0.5 * speed]]
    n = len(where)
    bodies = Bodies(np.full(n, diameter), np.full(n, density), np.array(where), np.array(velocity))
    contacts, none = Contacts(bodies, Box((1.0, 1.0, 1.0)), law), np.zeros((n, 3))
    done = [contacts.advance(k * dt, dt, none, none) for k in range(steps)]
    relative = bodies.velocity[-1, 2] - (0.0 if is_wall else bodies.velocity[0, 2])
    return contacts.take_episodes(), relative, done


@pytest.mark.parametrize("ending", ["zero-force", "zero-overlap"])
@pytest.mark.parametrize("restitution", [0.1, 0.4, 0.9, 1.0])
def test_damping_duration_and_overlap_are_those_of_exact_integration(ending, restitution):
    eta = design.hertz_damping(1.0, 1.0, restitution, ending)

    def motion(_, y):
        overlap = max(y[0], 0.0)
        return [y[1], -(overlap**1.5) - eta * overlap**0.25 * y[1]]

    def end(t, y):
        is_force = ending == "zero-force" and restitution < 1.0
        return 1.0 if t < 0.01 else (max(y[0], 0.0) ** 1.25 + eta * y[1] if is_force else y[0])

    end.terminal, end.direction = True, -1
    found = solve_ivp(motion, (0.0, 50.0), [0.0, 1.0], events=end, rtol=1e-11, atol=1e-13, method="DOP853",
                      max_step=0.01)  # fmt: skip
    assert -found.y[1, -1] == pytest.approx(restitution, rel=1e-8)
    assert design.hertz_duration(1.0, 1.0, 1.0, restitution, ending) == pytest.approx(found.t[-1], rel=1e-8)
    # The steps of 0.01 miss the top by their square.
    assert design.hertz_peak_overlap(1.0, 1.0, 1.0, eta) == pytest.approx(found.y[0].max(), rel=1e-4)


@pytest.mark.parametrize("ending", ["zero-force", "zero-overlap"])
@pytest.mark.parametrize("restitution", [0.1, 0.3, 0.6, 0.9, 1.0])
@pytest.mark.parametrize("speed", [0.01, 1.0])
def test_restitution_is_achieved_at_every_speed(ending, restitution, speed):
    law = Hertz(1e7, 0.3, restitution, speed, ending)
    mass, radius = design.sphere_mass(0.01, 2500.0) / 2.0, 0.0025
    k, eta = law.normal(np.array([mass]), np.array([radius]))
    dt = law.resolved_time(np.array([mass]), np.array([radius]))[0] / 8.0
    gap = 0.4 * speed * dt
    (episode,), rebound, _ = head_on(law, 0.01, 2500.0, speed, gap, 25, dt)
    assert rebound / speed == pytest.approx(restitution, abs=1e-3)
    assert episode["restitution"] == pytest.approx(restitution, abs=1e-3)
    duration = design.hertz_duration(mass, k[0], speed, restitution, ending)
    assert episode["duration_s"] == pytest.approx(duration, rel=1e-3)
    peak = design.hertz_peak_overlap(mass, k[0], speed, eta[0])
    assert episode["max_overlap_fraction"] * 0.01 == pytest.approx(peak, rel=1e-3)


def test_elastic_duration_is_that_of_the_closed_form():
    m, r, modulus, v = 1e-3, 2e-3, 5e6, 0.3
    elastic = design.hertz_duration(m, design.hertz_stiffness(r, modulus), v)
    assert elastic == pytest.approx(design.hertz_contact_time(m, r, modulus, v), rel=1e-12)
    k = 16.0 / 15.0 * modulus * np.sqrt(r)
    assert elastic == pytest.approx(2.9432 * (m**2 / (k**2 * v)) ** 0.2, rel=1e-4)


@pytest.mark.parametrize("is_wall", [False, True])
def test_repulsive_force_turns_a_pair_at_the_designed_gap(is_wall):
    mass = design.sphere_mass(0.01, 2500.0) / (1.0 if is_wall else 2.0)
    law = Repulsive(design.repulsion_stiffness(mass, 1e-3, 0.1, 2e-4), 1e-3)
    dt = design.repulsion_time(mass, law.stiffness, law.range) / 8.0
    episodes, rebound, steps = head_on(law, 0.01, 2500.0, 0.1, 1.2e-3, 60, dt, is_wall)
    assert len(episodes) == 0
    assert rebound == pytest.approx(0.1, rel=1e-4)
    assert min(step.min_gap for step in steps) == pytest.approx(2e-4, rel=1e-2)


def test_too_weak_a_repulsion_is_recorded_as_a_contact():
    mass = design.sphere_mass(0.01, 2500.0) / 2.0
    law = Repulsive(design.repulsion_stiffness(mass, 1e-3, 0.1), 1e-3)
    dt = design.repulsion_time(mass, law.stiffness, law.range) / 8.0
    (episode,), rebound, _ = head_on(law, 0.01, 2500.0, 0.2, 1.2e-3, 60, dt)
    assert rebound == pytest.approx(0.2, rel=1e-4)
    overlap = -design.closest_gap(mass, law.stiffness, law.range, 0.2)
    assert overlap > 0.0
    assert episode["max_overlap_fraction"] * 0.01 == pytest.approx(overlap, rel=1e-2)


def test_repulsive_force_carries_a_weight_at_the_designed_gap():
    weight = 9.81 * design.sphere_mass(0.01, 2500.0)
    law = Repulsive(design.weight_stiffness(weight, 1e-3, 3e-4), 1e-3)
    ball = Bodies(np.array([0.01]), np.array([2500.0]), np.array([[0.5, 0.5, 0.005 + 3e-4]]))
    contacts = Contacts(ball, Box((1.0, 1.0, 1.0)), law)
    for k in range(50):
        contacts.advance(k * 1e-3, 1e-3, np.array([[0.0, 0.0, -weight]]), np.zeros((1, 3)))
    assert ball.position[0, 2] - 0.005 == pytest.approx(3e-4, rel=1e-9)
