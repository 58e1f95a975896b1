"""Contacts against published and closed-form cases: gravity, walls, friction, several at once."""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rdpm.contacts import Contacts, SoftSphere
from rdpm.grid import Box
from rdpm.particles.state import Bodies

DATA = Path(__file__).parents[1] / "data"
GRAVITY = 9.81


def table(name):
    return np.genfromtxt(DATA / f"contact_{name}.csv", delimiter=",", names=True, skip_header=1)


def room(height, width=1.0):
    return Box((width, width, height))


@pytest.mark.parametrize("row", table("gross_sliding"), ids=lambda r: f"{r['impact_angle_deg']}-{r['e_n']}")
def test_oblique_impact_in_gross_sliding(row):
    d, speed, friction, contact_time = 5e-3, 3.9, 0.092, 1e-6
    angle = np.radians(row["impact_angle_deg"])
    v = speed * np.array([[np.sin(angle), 0.0, -np.cos(angle)]])
    ball = Bodies(np.array([d]), np.array([4000.0]), np.array([[0.5, 0.5, 0.5 * d + 1e-7]]), v)
    law = SoftSphere.from_contact_time(row["e_n"], contact_time, friction=friction)
    contacts = Contacts(ball, room(1.0), law)
    for step in range(14):
        contacts.advance(step * contact_time / 10, contact_time / 10, np.zeros((1, 3)), np.zeros((1, 3)))
    # The lever is shorter than the radius by the overlap, at most v t_c/(pi a) = 5e-4.
    assert ball.velocity[0, 0] / (speed * np.sin(angle)) == pytest.approx(row["e_t"], rel=1e-3)
    assert ball.angular_velocity[0, 1] == pytest.approx(row["omega_rad_s"], rel=1e-3)
    assert ball.velocity[0, 2] == pytest.approx(row["e_n"] * speed * np.cos(angle), rel=1e-3)


def row_of_three(gap_left, gap_right, velocity):
    d = 0.01
    x = 0.5 + np.array([-d - gap_left, 0.0, d + gap_right])
    place = np.column_stack([x, np.full(3, 0.5), np.full(3, 0.5)])
    speed = np.column_stack([velocity, np.zeros(3), np.zeros(3)])
    return Bodies(np.full(3, d), np.array([2500.0, 2500.0, 2500.0]), place, speed)


@pytest.mark.parametrize("restitution", [1.0, 0.5])
@pytest.mark.parametrize("gap_right", [0.0, 1e-5])
def test_row_of_three_follows_its_differential_equation(restitution, gap_right):
    t_c, speed = 1e-3, 0.1
    bodies = row_of_three(1e-5, gap_right, [speed, 0.0, 0.0])
    law = SoftSphere.from_contact_time(restitution, t_c)
    k_n, eta_n = law.normal(0.5 * bodies.mass[0], 0.01)
    start = np.concatenate([bodies.position[:, 0], bodies.velocity[:, 0]])

    def motion(t, state):
        x, v = state[:3], state[3:]
        overlap, rate = 0.01 - np.diff(x), -np.diff(v)
        f = np.where(overlap > 0.0, np.maximum(k_n * overlap + eta_n * rate, 0.0), 0.0)
        return np.concatenate([v, np.array([-f[0], f[0] - f[1], f[1]]) / bodies.mass])

    exact = solve_ivp(motion, (0.0, 4.0 * t_c), start, rtol=1e-10, atol=1e-14, max_step=t_c / 200)
    contacts, none, dt = Contacts(bodies, room(1.0), law), np.zeros((3, 3)), t_c / 8
    for step in range(32):
        contacts.advance(step * dt, dt, none, none)
    # The order of the two pairs costs second order of the sub-step; 0.2 % of the impact speed is held.
    np.testing.assert_allclose(bodies.velocity[:, 0], exact.y[3:, -1], atol=2e-3 * speed)
    assert bodies.velocity[:, 0].sum() == pytest.approx(speed, rel=1e-14)
    if restitution == 1.0:
        assert np.sum(bodies.velocity**2) == pytest.approx(speed**2, rel=1e-3)


@pytest.mark.parametrize("restitution", [1.0, 0.5])
def test_two_equal_impacts_on_a_sphere_leave_it_at_rest(restitution):
    t_c, speed = 1e-3, 0.1
    bodies = row_of_three(1e-5, 1e-5, [speed, 0.0, -speed])
    contacts = Contacts(bodies, room(1.0), SoftSphere.from_contact_time(restitution, t_c))
    for step in range(40):
        contacts.advance(step * t_c / 8, t_c / 8, np.zeros((3, 3)), np.zeros((3, 3)))
    # Pairs are visited one after the other; backwards in odd sub-steps, which leaves second order.
    assert abs(bodies.velocity[1, 0]) < 1e-3 * speed
    np.testing.assert_allclose(bodies.velocity[0, 0], -bodies.velocity[2, 0], atol=1e-3 * speed)


def test_body_at_rest_keeps_its_static_overlap():
    ball = Bodies(np.array([0.01]), np.array([2500.0]), np.array([[0.5, 0.5, 0.005]]))
    law = SoftSphere.from_contact_time(0.3, 1e-2)
    k_n, _ = law.normal(ball.mass, ball.diameter)
    contacts = Contacts(ball, room(1.0), law)
    weight = -GRAVITY * ball.mass[:, None] * [[0.0, 0.0, 1.0]]
    for step in range(100):
        contacts.advance(step * 1e-3, 1e-3, weight, np.zeros((1, 3)))
    # Rest is a fixed point of the scheme: only what has not yet decayed remains.
    assert 0.005 - ball.position[0, 2] == pytest.approx(ball.mass[0] * GRAVITY / k_n[0], rel=1e-6)
