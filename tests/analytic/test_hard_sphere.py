"""Hard spheres against closed forms: bounces, oblique impacts, cradles, contacts at rest."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest

from rdpm.contacts import Contacts, HardSphere, SoftSphere, nearest_gaps
from rdpm.errors import OverlapError
from rdpm.grid import Box
from rdpm.particles.state import FREE, PRESCRIBED, Bodies

DATA = Path(__file__).parents[1] / "data"
D, RHO, G = 0.01, 2500.0, 9.81
BOX = Box((0.1, 0.1, 0.4))
ENDLESS = Box((0.4, 0.4, 0.4), ("periodic",) * 3)


def spheres(*places, velocity=None, spin=None, diameter=D, density=RHO) -> Bodies:
    n = len(places)
    sizes, densities = np.broadcast_to(diameter, n).copy(), np.broadcast_to(density, n).copy()
    speed = np.zeros((n, 3)) if velocity is None else np.array(velocity, float)
    turning = np.zeros((n, 3)) if spin is None else np.array(spin, float)
    return Bodies(sizes, densities, np.array(places, float), speed, turning)


def run(contacts: Contacts, end: float, dt: float, gravity=(0.0, 0.0, 0.0), each=None, start: float = 0.0):
    b, none = contacts.bodies, np.zeros((len(contacts.bodies), 3))
    weight = b.mass[:, None] * np.array(gravity)
    results = []
    for k in range(round((end - start) / dt)):
        results.append(contacts.advance(start + k * dt, dt, weight, none))
        if each:
            each(start + (k + 1) * dt)
    return results


def energy(b: Bodies, gravity: float = 0.0) -> float:
    turning = b.moment_of_inertia[:, None] * b.angular_velocity**2
    return float(0.5 * np.sum(b.mass[:, None] * b.velocity**2) + 0.5 * np.sum(turning)
                 + gravity * np.sum(b.mass * b.position[:, 2]))  # fmt: skip


def bouncing(t: float, height: float, e: float) -> float:
    """Gap of a ball that was dropped from `height`."""
    fall = math.sqrt(2.0 * height / G)
    if t < fall:
        return height - 0.5 * G * t**2
    t, speed = t - fall, e * G * fall
    while t > 2.0 * speed / G:
        t -= 2.0 * speed / G
        speed *= e
    return speed * t - 0.5 * G * t**2


@pytest.mark.parametrize("dt", [1e-4, 1.7e-3, 2e-2])
def test_a_ball_bounces_as_the_closed_form_says_for_any_step(dt):
    e, height = 0.8, 0.1
    ball = spheres([0.05, 0.05, 0.5 * D + height])
    contacts = Contacts(ball, BOX, HardSphere(e))
    errors = []
    run(contacts, 0.6, dt, (0, 0, -G), lambda t: errors.append(ball.position[0, 2] - 0.5 * D - bouncing(t, height, e)))
    assert np.abs(errors).max() < 1e-11 * height
    episodes = contacts.take_episodes()
    fall = math.sqrt(2.0 * height / G)
    touches = fall * np.cumsum([1.0, 2.0 * e, 2.0 * e**2])[: len(episodes)]
    np.testing.assert_allclose(episodes["start_s"], touches, rtol=1e-12)
    np.testing.assert_allclose(episodes["restitution"], e, rtol=1e-12)
    assert (episodes["duration_s"] == 0.0).all()
    assert (episodes["max_overlap_fraction"] == 0.0).all()


def sliding_rows():
    with open(DATA / "contact_gross_sliding.csv") as file:
        return [[float(x) for x in row] for row in csv.reader(file) if row[0][0].isdigit()]


@pytest.mark.parametrize("row", sliding_rows())
def test_gross_sliding_is_exact(row):
    e, angle, e_t, spin = row[:4]
    d, v, mu, theta = 0.005, 3.9, 0.092, math.radians(angle)
    ball = spheres([0.05, 0.05, 0.5 * d + 1e-4], velocity=[[v * math.sin(theta), 0, -v * math.cos(theta)]], diameter=d)
    run(Contacts(ball, BOX, HardSphere(e, mu)), 2e-3, 2e-3)
    # Six digits are printed: half a unit of the last.
    assert ball.velocity[0, 0] / (v * math.sin(theta)) == pytest.approx(e_t, rel=5e-6)
    assert abs(ball.angular_velocity[0, 1]) == pytest.approx(spin, rel=5e-6)
    assert ball.velocity[0, 2] == pytest.approx(e * v * math.cos(theta), rel=1e-12)


@pytest.mark.parametrize(("e", "mu", "beta"), [(0.97, 0.092, 0.44), (0.87, 0.25, 0.43), (0.831, 0.125, 0.31)])
def test_an_impact_sticks_or_slides_after_walton(e, mu, beta):
    """Soda-lime glass and cellulose acetate (Foerster et al. 1994): Psi_2 = -beta Psi_1, or Psi_1 - 7/2 mu (1 + e)."""
    for psi in (0.05, 0.2, 0.5, 0.8, 1.2, 2.0, 4.0):
        normal, sideways = 0.3, 0.3 * psi
        pair = spheres([0.2, 0.2, 0.2], [0.2, 0.2, 0.2 + D],
                       velocity=[[0.5 * sideways, 0, 0.5 * normal], [-0.5 * sideways, 0, -0.5 * normal]])  # fmt: skip
        run(Contacts(pair, ENDLESS, HardSphere(e, mu, beta)), 1e-3, 1e-3)
        lever = 0.5 * D * (pair.angular_velocity[0, 1] + pair.angular_velocity[1, 1])
        after = (pair.velocity[0, 0] - pair.velocity[1, 0] + lever) / normal
        assert after == pytest.approx(max(-beta * psi, psi - 3.5 * mu * (1.0 + e)), abs=1e-12)
        assert pair.velocity[1, 2] - pair.velocity[0, 2] == pytest.approx(e * normal, rel=1e-12)


@pytest.mark.parametrize("gap", [0.0, 1e-9, 1e-5])
def test_a_cradle_hands_the_motion_on(gap):
    step = D + gap
    row = spheres(*[[0.05 + k * step, 0.05, 0.05] for k in range(3)], velocity=[[0.2, 0, 0], [0, 0, 0], [0, 0, 0]])
    (result, *_) = run(Contacts(row, ENDLESS, HardSphere(1.0, 0.3)), 0.01, 0.01)
    np.testing.assert_allclose(row.velocity[:, 0], [0.0, 0.0, 0.2], atol=1e-15)
    assert result.collisions == 2


def test_three_spheres_meet_in_the_order_of_time():
    """Against free flight in small steps, in which pairs that overlap and approach rebound at once."""
    e, places = 0.7, np.array([[0.2, 0.2, 0.2], [0.2133, 0.203, 0.2], [0.204, 0.2141, 0.2], [0.188, 0.194, 0.201]])
    velocity = np.array([[0.5, 0.3, 0.0], [-0.6, 0.0, 0.02], [0.1, -0.7, 0.0], [1.5, 0.8, 0.0]])
    one = spheres(*places, velocity=velocity)
    contacts = Contacts(one, ENDLESS, HardSphere(e))
    run(contacts, 0.02, 0.02)
    x, v, h = places.copy(), velocity.copy(), 2e-6
    met = []
    for _ in range(round(0.02 / h)):
        x += h * v
        for i in range(4):
            for j in range(i + 1, 4):
                r = x[j] - x[i]
                u = (v[i] - v[j]) @ r
                if u > 0 and r @ r < D * D:
                    impulse = 0.5 * (1.0 + e) * u * r / (r @ r)
                    v[i] -= impulse
                    v[j] += impulse
                    met.append((i, j))
    episodes = contacts.take_episodes()
    assert len(met) >= 4
    assert list(zip(episodes["i"], episodes["j"], strict=True)) == met
    np.testing.assert_allclose(one.velocity, v, atol=5e-3)   # of the first order in h: the normal is met late
    np.testing.assert_allclose(one.position, x, atol=5e-5)


def test_momentum_is_kept_energy_never_grows_and_nothing_overlaps():
    rng = np.random.default_rng(3)
    places = 0.02 + 0.0125 * np.stack(np.meshgrid(*[np.arange(4)] * 3), -1).reshape(-1, 3)
    box = Box((0.055, 0.055, 0.055), ("periodic",) * 3)
    gas = spheres(*(places - 0.015), velocity=rng.normal(0.0, 0.3, (64, 3)), spin=rng.normal(0, 30, (64, 3)),
                  diameter=rng.uniform(0.008, 0.012, 64))  # fmt: skip
    contacts = Contacts(gas, box, HardSphere(0.9, 0.3, 0.4))
    before, energies = gas.mass @ gas.velocity, [energy(gas)]

    def watch(t):
        energies.append(energy(gas))
        assert nearest_gaps(gas, box)[0].min() > -1e-12 * D

    results = run(contacts, 0.3, 3e-3, each=watch)
    assert sum(r.collisions for r in results) > 500
    scale = np.sum(gas.mass) * 0.3
    np.testing.assert_allclose(gas.mass @ gas.velocity, before, atol=1e-13 * scale)
    assert np.diff(energies).max() <= 1e-14 * energies[0]
    assert energies[-1] < 0.5 * energies[0]


def test_a_bouncing_ball_comes_to_rest_and_stays():
    e, height = 0.5, 0.02
    ball = spheres([0.05, 0.05, 0.5 * D + height])
    contacts = Contacts(ball, BOX, HardSphere(e, rest_speed=1e-3))
    results = run(contacts, 0.5, 1e-3, (0, 0, -G))
    speed = math.sqrt(2.0 * G * height)
    bounces = math.floor(math.log(1e-3 / speed) / math.log(e)) + 1
    assert sum(r.collisions for r in results) == bounces
    assert sum(r.rested for r in results) == 1
    assert sum(r.capped for r in results) == 0
    assert results[-1].touching == 1
    assert ball.velocity[0, 2] == pytest.approx(0.0, abs=1e-12)
    assert ball.position[0, 2] - 0.5 * D == pytest.approx(0.0, abs=1e-12 * D)
    # The floor carries the weight, as an impulse.
    assert results[-1].contact_impulse[0, 2] == pytest.approx(ball.mass[0] * G * 1e-3, rel=1e-9)


def test_without_a_rest_speed_the_most_events_end_the_collapse():
    ball = spheres([0.05, 0.05, 0.5 * D + 1e-3])
    contacts = Contacts(ball, BOX, HardSphere(0.5, most_events=20))
    results = run(contacts, 0.1, 0.1, (0, 0, -G))
    assert [r.collisions for r in results] == [20]
    assert results[0].capped == 1
    assert abs(ball.position[0, 2] - 0.5 * D) < 1e-12 * D
    assert abs(ball.velocity[0, 2]) < 1e-9


def heap() -> Bodies:
    """Layers of a close packing, thrown into a box."""
    rng = np.random.default_rng(8)
    places = [[0.006 + 0.0115 * i, 0.006 + 0.0115 * j, 0.006 + 0.012 * k]
              for k in range(4) for j in range(3) for i in range(3)]  # fmt: skip
    return spheres(*(np.array(places) + rng.uniform(0, 4e-4, (36, 3))))


def test_a_heap_at_rest_stays_at_rest():
    """30 spheres, a pyramid of layers 4 x 4, 3 x 3, 2 x 2 and 1 within walls: no creep and no heating."""
    places = [[D * (0.5 + 0.5 * k + i), D * (0.5 + 0.5 * k + j), D * (0.5 + k / math.sqrt(2.0))]
              for k in range(4) for j in range(4 - k) for i in range(4 - k)]  # fmt: skip
    bodies = spheres(*places)
    box = Box((4 * D, 4 * D, 0.1))
    contacts = Contacts(bodies, box, HardSphere(0.4, 0.4, rest_speed=2e-3))
    speeds = []
    run(contacts, 10.0, 1e-3, (0, 0, -G), lambda t: speeds.append(np.abs(bodies.velocity).max()))
    assert np.max(speeds) < 1e-8
    assert np.abs(bodies.position - places).max() < 1e-9 * D
    assert nearest_gaps(bodies, box)[0].min() > -1e-12 * D


def test_bodies_meet_across_the_periodic_seam_and_in_any_frame():
    def pair(shift, mirror):
        place = np.array([[0.19, 0.2, 0.2], [0.2068, 0.204, 0.201]])
        speed = np.array([[0.3, 0.0, 0.1], [-0.4, 0.05, 0.0]])
        spin = np.array([[0.0, 3.0, 9.0], [-4.0, 0.0, 2.0]])
        sign = np.array([-1.0 if mirror else 1.0, 1.0, 1.0])
        place = np.mod(0.2 + sign * (place - 0.2) + shift, 0.4)
        return spheres(*place, velocity=sign * speed, spin=np.prod(sign) * sign * spin)

    seen = []
    for shift, mirror in ((0.0, False), (0.2, False), (0.13, True), (np.array([0.0, 0.197, -0.2]), True)):
        bodies = pair(shift, mirror)
        contacts = Contacts(bodies, ENDLESS, HardSphere(0.8, 0.2, 0.3))
        run(contacts, 0.05, 0.01)
        assert len(contacts.take_episodes()) == 1
        sign = np.array([-1.0 if mirror else 1.0, 1.0, 1.0])
        seen.append(np.hstack([sign * bodies.velocity, np.prod(sign) * sign * bodies.angular_velocity]))
    for other in seen[1:]:
        np.testing.assert_allclose(other, seen[0], rtol=0, atol=1e-11)


def test_a_restored_run_is_bit_identical():
    def made():
        bodies = heap()
        return bodies, Contacts(bodies, Box((0.0365, 0.0365, 0.3)), HardSphere(0.6, 0.4, rest_speed=2e-3))

    whole, contacts = made()
    run(contacts, 0.1, 1e-3, (0, 0, -G))
    again, others = made()
    run(others, 0.08, 1e-3, (0, 0, -G))
    assert len(others.state()["pairs"]) > 5
    third = Bodies(again.diameter, again.density, again.position, again.velocity, again.angular_velocity)
    third.orientation[:] = again.orientation
    resumed = Contacts(third, others.box, others.law)
    resumed.restore(others.state())
    run(resumed, 0.1, 1e-3, (0, 0, -G), start=0.08)
    np.testing.assert_array_equal(third.position, whole.position)
    np.testing.assert_array_equal(third.velocity, whole.velocity)
    one, other = resumed.take_episodes(), contacts.take_episodes()
    for name in one.dtype.names:
        np.testing.assert_array_equal(one[name], other[name])


def test_a_prescribed_body_pushes_and_takes_the_reaction():
    bodies = spheres([0.05, 0.05, 0.1], [0.05, 0.05, 0.12], velocity=[[0, 0, 0.3], [0, 0, 0]])
    bodies.motion[0] = PRESCRIBED
    contacts = Contacts(bodies, BOX, HardSphere(1.0))
    results = run(contacts, 0.04, 0.02)
    assert bodies.velocity[:, 2].tolist() == [0.3, pytest.approx(0.6, rel=1e-14)]
    total = sum(r.contact_impulse for r in results)
    assert total[0, 2] == -total[1, 2] == pytest.approx(-0.6 * bodies.mass[1], rel=1e-14)
    assert bodies.motion[1] == FREE


def test_a_body_that_cannot_give_way_stops_the_run():
    bodies = spheres([0.05, 0.05, 0.02], [0.05, 0.05, 0.5 * D], velocity=[[0, 0, -0.3], [0, 0, 0]])
    bodies.motion[0] = PRESCRIBED
    with pytest.raises(OverlapError, match="squeezed between bodies that cannot give way"):
        run(Contacts(bodies, BOX, HardSphere(0.5, rest_speed=1e-3)), 0.1, 1e-3)


def test_a_free_slip_face_does_not_rub_and_a_moving_wall_drags():
    for kind, _expected in (("free-slip", 0.2), ("wall", 0.2 - 0.3 * 1.5 * 0.4)):
        box = Box((0.1, 0.1, 0.4), (("wall",) * 2 + (kind,)), np.zeros((6, 3)))
        ball = spheres([0.05, 0.05, 0.5 * D + 1e-4], velocity=[[1.0, 0, -0.4]])
        run(Contacts(ball, box, HardSphere(0.5, 0.3)), 5e-3, 5e-3)
        assert ball.velocity[0, 0] == pytest.approx(1.0 if kind == "free-slip" else 1.0 - 0.3 * 1.5 * 0.4, rel=1e-13)
    speeds = np.zeros((6, 3))
    speeds[4, 0] = 0.05
    ball = spheres([0.05, 0.05, 0.5 * D + 1e-4], velocity=[[0, 0, -0.4]])
    run(Contacts(ball, Box((0.1, 0.1, 0.4), ("wall",) * 3, speeds), HardSphere(0.5, 0.3)), 5e-3, 5e-3)
    assert ball.velocity[0, 0] == pytest.approx(0.05 * 2 / 7, rel=1e-12)   # sticks: 2/7 of the slip


def test_a_soft_sphere_comes_to_the_hard_one_as_its_contact_shortens():
    """Height after two bounces: the error falls in proportion to the contact time."""
    e, height, end = 0.8, 0.05, 0.35

    def at_end(law, dt):
        ball = spheres([0.05, 0.05, 0.5 * D + height])
        run(Contacts(ball, BOX, law), end, dt, (0, 0, -G))
        return ball.position[0, 2]

    hard = at_end(HardSphere(e), 1e-3)
    times = np.array([4e-3, 2e-3, 1e-3, 5e-4])
    errors = [abs(at_end(SoftSphere.from_contact_time(e, t), 5e-4) - hard) for t in times]
    slope = np.polyfit(np.log(times), np.log(errors), 1)[0]
    assert slope == pytest.approx(1.0, abs=0.1)
    assert errors[-1] < 0.02 * height
