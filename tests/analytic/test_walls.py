"""Spheres on inclined planes and in cylinders, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from rdpm.contacts import Contacts, HardSphere, Hertz, Lubrication, SoftSphere
from rdpm.grid import Box
from rdpm.particles.state import Bodies
from rdpm.surfaces import Cylinder, Plane

D, DENSITY, G = 0.01, 2500.0, 9.81
A = 0.5 * D
#: Springs in which a weight sinks by 1e-6 m: what the contact's own motion leaves of a path of some centimetres.
STIFFNESS = DENSITY * np.pi / 6 * D**3 * G / 1e-6
#: Friction takes a contact period, 1 ms, of a run of 100 ms to build up; half of it is lost.
EXACT = 5e-3


def _on(wall, center, law, velocity=(0.0, 0.0, 0.0), size=(2.0, 2.0, 2.0)):
    body = Bodies(np.array([D]), np.array([DENSITY]), np.array([center]), np.array([velocity]))
    return body, Contacts(body, Box(size, walls=(wall,)), law)


def _run(body, contacts, until, dt, gravity=(0.0, 0.0, -G)):
    weight = body.mass[:, None] * np.array([gravity])
    for step in range(round(until / dt)):
        contacts.advance(step * dt, dt, weight, np.zeros((1, 3)))


def _slope(angle):
    along = np.array([np.cos(angle), 0.0, -np.sin(angle)])
    normal = np.array([np.sin(angle), 0.0, np.cos(angle)])
    return along, normal


def _soft(friction):
    return SoftSphere.from_stiffness(STIFFNESS, restitution=0.5, friction=friction)


@pytest.mark.parametrize("law", [_soft(0.3), Hertz(1e7, 0.3, 0.5, 0.01, friction=0.3), HardSphere(0.5, 0.3)])
@pytest.mark.parametrize("tangent", [0.5, 0.9, 1.2, 2.0])
def test_a_sphere_rolls_down_a_slope_below_three_and_a_half_times_the_friction(law, tangent) -> None:
    """It rolls at 5/7 g sin(theta) where tan(theta) <= 3.5 mu, else slides, and mu m g cos(theta) turns it."""
    if isinstance(law, HardSphere):
        law = HardSphere(0.5, 0.3, rest_speed=1e-3)
    angle, mu, until = np.arctan(tangent), 0.3, 0.1
    along, normal = _slope(angle)
    point = np.array([0.2, 1.0, 1.5])
    sunk = 1e-6 * np.cos(angle) if isinstance(law, SoftSphere) else 0.0
    body, contacts = _on(Plane(tuple(point), tuple(3.0 * normal)), point + (A - sunk) * normal, law)
    start = body.position[0].copy()
    _run(body, contacts, until, 1e-3)
    path, speed = (body.position[0] - start) @ along, body.velocity[0] @ along
    if tangent <= 3.5 * mu:
        acceleration, turning = 5 / 7 * G * np.sin(angle), 5 / 7 * G * np.sin(angle) / A
    else:
        acceleration, turning = G * (np.sin(angle) - mu * np.cos(angle)), 2.5 * mu * G * np.cos(angle) / A
    exact = EXACT if not isinstance(law, Hertz) else 2e-2  # it falls into its softer spring first
    assert speed == pytest.approx(acceleration * until, rel=exact)
    assert path == pytest.approx(0.5 * acceleration * until**2, rel=2 * exact)
    assert np.allclose(body.angular_velocity[0], [0.0, turning * until, 0.0], rtol=exact, atol=1e-9)
    assert abs((body.position[0] - point) @ normal - A) < 1e-4 * D + (1e-2 * D if isinstance(law, Hertz) else 0.0)


def test_a_tilted_plane_is_a_face_of_the_box_seen_at_an_angle() -> None:
    """Against a face under tilted gravity, step for step, to round-off of the turned vectors."""
    angle = 0.4
    along, normal = _slope(angle)
    law = _soft(0.2)
    point = np.array([0.3, 1.0, 1.5])
    tilted, contacts = _on(Plane(tuple(point), tuple(normal)), point + 0.6 * D * normal, law)
    flat = Bodies(np.array([D]), np.array([DENSITY]), np.array([[0.3, 1.0, 0.6 * D]]))
    plain = Contacts(flat, Box((2.0, 2.0, 2.0)), law)
    _run(tilted, contacts, 0.1, 1e-3)
    _run(flat, plain, 0.1, 1e-3, (G * np.sin(angle), 0.0, -G * np.cos(angle)))
    moved = tilted.position[0] - point
    assert np.allclose([moved @ along, moved @ normal], [flat.position[0, 0] - 0.3, flat.position[0, 2]], atol=1e-9)
    assert np.allclose(tilted.angular_velocity, flat.angular_velocity, rtol=1e-7)
    ours, theirs = contacts.take_episodes(), plain.take_episodes()
    assert len(ours) == len(theirs) > 0
    assert set(ours["j"]) == {-8}
    assert set(theirs["j"]) == {-5}


@pytest.mark.parametrize(("friction", "inertia"), [(0.0, 1.0), (1.0, 1.4)])
def test_a_sphere_swings_in_a_tube_like_a_pendulum(friction, inertia) -> None:
    """Small swings: period 2 pi sqrt(I (R - a) / g), I = 1 where it slides and 7/5 where it rolls."""
    radius, amplitude = 0.05, 0.05
    arm = radius - A
    axis = np.array([1.0, 1.0, 1.0])
    tube = Cylinder(tuple(axis), (0.0, 2.0, 0.0), radius)
    sunk = 1e-6
    place = axis + (arm + sunk) * np.array([np.sin(amplitude), 0.0, -np.cos(amplitude)])
    body, contacts = _on(tube, place, _soft(friction))
    period = 2 * np.pi * np.sqrt(inertia * arm / G) * (1 + amplitude**2 / 16)
    _run(body, contacts, period, period / 1000)
    swing = np.arctan2(body.position[0, 0] - 1.0, 1.0 - body.position[0, 2])
    # cos(2 pi (1 + x)) = 1 - 2 pi^2 x^2: a period 1 % off leaves 2e-3; the speed is what tells
    assert swing == pytest.approx(amplitude, rel=EXACT)
    assert abs(body.velocity[0, 0]) < EXACT * amplitude * np.sqrt(G * arm)


def test_a_turning_drum_turns_the_sphere_that_lies_in_it() -> None:
    """Without slip a omega = R Omega; a plane that slides leaves 2/7 of its speed to a sphere that rolls on it."""
    radius, turning = 0.05, 2.0
    drum = Cylinder((1.0, 1.0, 1.0), (0.0, 1.0, 0.0), radius, angular_velocity=turning)
    body, contacts = _on(drum, [1.0, 1.0, 1.0 - radius + A - 1e-6], _soft(0.5))
    _run(body, contacts, 7e-3, 1e-4)  # slip ends at 2 R Omega / (7 mu g) = 5.8 ms
    slip_free = 5 / 7 * radius * turning / A  # the rest is the sphere's own start along the wall
    assert body.angular_velocity[0, 1] == pytest.approx(slip_free, rel=0.05)
    belt = Plane((0.0, 1.0, 1.0), (0.0, 0.0, 1.0), velocity=(0.3, 0.0, 0.0))
    body, contacts = _on(belt, [1.0, 1.0, 1.0 + A - 1e-6], _soft(0.5))
    _run(body, contacts, 0.1, 1e-3)
    assert body.velocity[0, 0] == pytest.approx(2 / 7 * 0.3, rel=EXACT)


def test_hard_spheres_rebound_from_the_outside_of_a_cylinder() -> None:
    """The mirror image at the exact point of touch."""
    post = Cylinder((1.0, 1.0, 1.0), (0.0, 0.0, 1.0), 0.1, "outside")
    aside = 0.07
    body, contacts = _on(post, [0.5, 1.0 + aside, 1.0], HardSphere(1.0), (1.0, 0.0, 0.3))
    reach = 0.1 + A
    touch = 0.5 - np.sqrt(reach**2 - aside**2)
    n = np.array([-np.sqrt(reach**2 - aside**2), aside, 0.0]) / reach
    after = np.array([1.0, 0.0, 0.3]) - 2 * n * n[0]
    expected = np.array([0.5, 1.0 + aside, 1.0]) + touch * np.array([1.0, 0.0, 0.3]) + (0.6 - touch) * after
    _run(body, contacts, 0.6, 0.1, (0.0, 0.0, 0.0))
    assert np.allclose(body.velocity[0], after, atol=1e-12)
    assert np.allclose(body.position[0], expected, atol=1e-12)


def test_a_plane_bounds_lubrication_and_gaps() -> None:
    """The nearest surface, its rate and its name are those of the wall."""
    from rdpm.contacts import nearest_gaps
    from rdpm.contacts.neighbours import gaps_and_rates

    _, normal = _slope(0.3)
    point = np.array([1.0, 1.0, 1.0])
    body, contacts = _on(Plane(tuple(point), tuple(normal)), point + 0.8 * D * normal, _soft(0.0), (0.0, 0.0, -0.1))
    gap, neighbour = nearest_gaps(body, contacts.box)
    assert gap[0] == pytest.approx(0.3 * D)
    assert neighbour[0] == -8
    gap, rate = gaps_and_rates(body, contacts.box, np.array([[0, -8]], np.int32))
    assert gap[0] == pytest.approx(0.3 * D)
    assert rate[0] == pytest.approx(-0.1 * np.cos(0.3))


def test_lubrication_to_a_cylinder_is_the_pressure_of_its_film() -> None:
    """Reynolds' equation over g + x^2/(2 R_1) + y^2/(2 R_2), the pressure summed over the film."""
    mu, a, gap = 0.1, 5e-3, 1e-6
    for curvature in (0.0, -1 / 0.012, 1 / 0.02):
        row = Lubrication(mu, 1e-3).rows_of_inner_walls(np.array([a]), np.array([curvature]))[0]
        first, second = 1 / (1 / a + curvature), a
        # In units of sqrt(2 R g) along each axis the pressure is C / (g (1 + r^2))^2, C = 6 mu / (1/R_1 + 1/R_2).
        r = np.linspace(0.0, 200.0, 200_001)
        film = np.trapezoid(2 * np.pi * r / (1 + r**2) ** 2, r) * 2 * np.sqrt(first * second) / gap
        assert row["inverse"] / gap == pytest.approx(6 * mu / (1 / first + 1 / second) * film, rel=1e-4)


def test_a_film_that_breaks_holds_back_no_sphere_that_parts() -> None:
    """Without lubrication in separation an approach is the same, and a sphere that leaves keeps its speed."""
    left = {}
    for separation in (1.0, 0.0):
        for speed in (-0.01, 0.01):
            ball = Bodies(
                np.array([D]), np.array([DENSITY]), np.array([[0.5, 0.5, A + 1e-5]]), np.array([[0, 0, speed]])
            )
            film = Lubrication(0.01, 1e-3, separation=separation)
            contacts = Contacts(ball, Box((1.0, 1.0, 1.0)), _soft(0.0), film)
            contacts.advance(0.0, 1e-4, np.zeros((1, 3)), np.zeros((1, 3)))
            left[separation, speed] = ball.velocity[0, 2]
    assert left[0.0, -0.01] == left[1.0, -0.01] > -0.01
    assert left[0.0, 0.01] == 0.01 > left[1.0, 0.01]
