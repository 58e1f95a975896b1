"""Adaptive collision time model: one duration and one restitution at every speed, against an integration of its own."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rdpm import design
from rdpm.contacts import AdaptiveCollisionTime, Contacts
from rdpm.grid import Box
from rdpm.particles.state import Bodies

ENDINGS = ["zero-force", "zero-overlap"]
#: The Runge-Kutta steps of the design, 0.01 of t_*.
DESIGN = 1e-5
#: 100 sub-steps a contact.
DRIVER = 2e-3


def _by_solver(m, k, d, v, ending):
    """Restitution, duration and peak of m x'' + d x' + k x^1.5 = 0."""
    rest = 1e-12 * v

    def end(t, y):
        return y[0] + rest if ending == "zero-overlap" else k * max(y[0], 0.0) ** 1.5 + d * y[1] + 1e-9 * (y[1] > 0.0)

    end.terminal, end.direction = True, -1
    scale = (m**2 / (k**2 * v)) ** 0.2
    found = solve_ivp(
        lambda t, y: [y[1], -(d * y[1] + k * max(y[0], 0.0) ** 1.5) / m], (0.0, 20 * scale), [0.0, v], events=end,
        rtol=1e-10, atol=1e-14 * v * scale, max_step=0.01 * scale,
    )  # fmt: skip
    return -found.y[1, -1] / v, found.t[-1], found.y[0].max()


@pytest.mark.parametrize("ending", ENDINGS)
@pytest.mark.parametrize("restitution", [0.97, 0.6, 0.2])
def test_the_design_is_met_by_exact_integration(restitution, ending) -> None:
    m, time, speed = 2e-3, 5e-4, 0.3
    k, d = design.adaptive_stiffness(m, restitution, time, speed, ending)
    e, duration, peak = _by_solver(m, k, d, speed, ending)
    assert e == pytest.approx(restitution, rel=DESIGN)
    assert duration == pytest.approx(time, rel=DESIGN)
    t_star = time / design.adaptive_collision(restitution, ending)[1]
    assert peak == pytest.approx(design.adaptive_overlap(restitution, ending) * speed * t_star, rel=DESIGN)


def test_without_damping_it_is_hertz() -> None:
    """T_c = 3.218 t_* (Kempe and Froehlich's constant), and the Hertz contact of the same k."""
    assert design.adaptive_collision(1.0)[1] == pytest.approx(3.218, abs=5e-4)
    k, d = design.adaptive_stiffness(1e-3, 1.0, 1e-3, 0.1)
    assert d == 0.0
    assert design.hertz_duration(1e-3, k, 0.1, 1.0) == pytest.approx(1e-3, rel=DESIGN)


@pytest.mark.parametrize("ending", ENDINGS)
@pytest.mark.parametrize("restitution", [0.97, 0.5])
@pytest.mark.parametrize("steps", [4.0, 10.3])
def test_every_impact_lasts_its_steps_and_returns_its_restitution(restitution, ending, steps) -> None:
    """Over four decades of speed, on a wall and of two unequal spheres, from any phase of a step."""
    dt = 1e-4
    law = AdaptiveCollisionTime(restitution, steps * dt, least_speed=1e-5, ending=ending)
    for speed in (1e-3, 0.05, 2.0):
        size = np.array([0.01, 0.006])
        apart = 0.5 * size.sum() + 0.37 * dt * speed
        place = np.array([[0.5, 0.5, 0.3], [0.5, 0.5, 0.3 + apart]])
        bodies = Bodies(size, np.array([2500.0, 7800.0]), place, np.array([[0, 0, speed], [0, 0, 0.0]]))
        contacts = Contacts(bodies, Box((1.0, 1.0, 1.0)), law)
        none = np.zeros((2, 3))
        for n in range(int(steps) + 8):
            contacts.advance(n * dt, dt, none, none)
        episode = contacts.take_episodes()[0]
        assert episode["restitution"] == pytest.approx(restitution, rel=DRIVER)
        assert episode["duration_s"] == pytest.approx(steps * dt, rel=DRIVER)
        t_star = steps * dt / design.adaptive_collision(restitution, ending)[1]
        deepest = design.adaptive_overlap(restitution, ending) * speed * t_star
        assert episode["max_overlap_fraction"] == pytest.approx(deepest / 0.006, rel=DRIVER)


def test_a_sphere_bounces_to_rest() -> None:
    """Each bounce has the restitution, the last ones rest: no energy comes from a new stiffness."""
    dt, d = 2e-4, 0.01
    ball = Bodies(np.array([d]), np.array([2500.0]), np.array([[0.05, 0.05, 0.012]]))
    contacts = Contacts(ball, Box((0.1, 0.1, 0.1)), AdaptiveCollisionTime(0.7, 10 * dt, 1e-4))
    weight = ball.mass[:, None] * [[0.0, 0.0, -9.81]]
    for n in range(2500):
        contacts.advance(n * dt, dt, weight, np.zeros((1, 3)))
    first = contacts.take_episodes()["restitution"][:3]
    # The weight bears on a contact of 2 ms: v e - g t_c / 2 against v.
    assert np.all(first < 0.71)
    assert first[0] == pytest.approx(0.7, abs=0.05)
    assert abs(ball.velocity[0, 2]) < 1e-6
    assert 0.0 < 0.5 * d - ball.position[0, 2] < 1e-2 * d
