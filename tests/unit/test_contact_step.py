"""One step of the contacts: free flight, walls, prescribed bodies, overrides, episodes, refusals."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from rdpm.contacts import Contacts, Lubrication, SoftSphere
from rdpm.errors import CaseError, OverlapError
from rdpm.grid import Box
from rdpm.particles.state import FREE, PRESCRIBED, Bodies

WALLED = Box((0.1, 0.1, 0.1))
PERIODIC = Box((0.1, 0.1, 0.1), ("periodic",) * 3)
LAW = SoftSphere.from_contact_time(0.8, 8e-3)
DT = 1e-3


def sphere(place, velocity=(0.0, 0.0, 0.0), diameter=0.01, density=2500.0, **more):
    place = np.atleast_2d(place).astype(float)
    n = len(place)
    velocity = np.broadcast_to(velocity, (n, 3)).copy()
    return Bodies(np.full(n, diameter), np.full(n, density), place, velocity, **more)


def advance(contacts, steps, force=0.0, dt=DT):
    """Run steps under a constant force, without torque; returns what each gave."""
    n = len(contacts.bodies)
    force = np.broadcast_to(force, (n, 3)).copy()
    return [contacts.advance(k * dt, dt, force, np.zeros((n, 3))) for k in range(steps)]


def test_free_flight_is_exact_and_nothing_is_given():
    b = sphere([0.05, 0.05, 0.05], [0.1, -0.2, 0.3])
    force, torque = b.mass[:, None] * [[1.0, 2.0, -3.0]], b.moment_of_inertia[:, None] * [[0.0, 0.0, 5.0]]
    step = Contacts(b, WALLED, LAW).advance(0.0, DT, force, torque)
    np.testing.assert_allclose(b.velocity, [[0.101, -0.198, 0.297]], rtol=1e-14)
    np.testing.assert_allclose(
        b.position, [[0.05 + 1e-4 + 5e-7, 0.05 - 2e-4 + 1e-6, 0.05 + 3e-4 - 1.5e-6]], rtol=1e-14
    )
    np.testing.assert_allclose(b.angular_velocity, [[0.0, 0.0, 5e-3]], rtol=1e-14)
    np.testing.assert_allclose(b.orientation, [[1.0, 0.0, 0.0, 1.25e-6]], rtol=1e-10, atol=1e-16)
    assert (step.substeps, step.pairs, step.touching) == (0, 0, 0)
    assert not step.impulse.any()


def test_flight_beside_a_wall_is_that_far_from_it():
    """Sub-stepped or not, a body that touches nothing flies the same, to round-off."""
    near, far = sphere([0.05, 0.05, 0.0052], [0.1, 0.0, 0.0]), sphere([0.05, 0.05, 0.05], [0.1, 0.0, 0.0])
    for b in (near, far):
        (step,) = advance(Contacts(b, WALLED, LAW), 1, b.mass[:, None] * [[0.5, 0.0, 0.1]])
        assert (step.substeps > 0) == (b is near)
    np.testing.assert_allclose(near.velocity, far.velocity, rtol=1e-13)
    np.testing.assert_allclose(near.position - far.position, [[0.0, 0.0, -0.0448]], rtol=0, atol=1e-15)


def test_periodic_crossings_count_and_positions_stay_inside():
    b = sphere([[0.0999, 0.05, 0.0001], [0.05, 0.05, 0.05]], [[0.5, 0.0, -0.5], [0.0, 0.0, 0.0]])
    advance(Contacts(b, PERIODIC, LAW), 1)
    np.testing.assert_allclose(b.position[0], [0.0004, 0.05, 0.0996], atol=1e-15)
    assert b.crossings.tolist() == [[1, 0, -1], [0, 0, 0]]


def test_simulations_in_threads_that_share_a_law_do_not_disturb_each_other():
    def bed(shift):
        places = np.ascontiguousarray(0.0096 * np.indices((5, 5, 5)).reshape(3, -1).T + 0.02 + shift)
        return Contacts(sphere(places, 0.2 * np.sin(np.arange(375.0)).reshape(-1, 3)), WALLED, LAW)

    alone, together = ([bed(1e-3 * n) for n in range(2)] for _ in range(2))
    for one in alone:
        advance(one, 15)
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(lambda one: advance(one, 15), together))
    for one, other in zip(alone, together, strict=True):
        np.testing.assert_array_equal(one.bodies.velocity, other.bodies.velocity)


def test_a_contact_through_the_periodic_seam():
    b = sphere([[0.003, 0.05, 0.05], [0.0925, 0.05, 0.05]], [[-0.05, 0.0, 0.0], [0.05, 0.0, 0.0]])
    contacts = Contacts(b, PERIODIC, LAW)
    advance(contacts, 20)
    np.testing.assert_allclose(b.velocity[:, 0], [0.04, -0.04], rtol=1e-3)


def test_impulse_is_the_change_of_momentum():
    b = sphere([[0.05, 0.05, 0.05], [0.05, 0.0525, 0.0586]], [[0.0, 0.0, 0.1], [0.0, 0.0, 0.0]])
    law = SoftSphere.from_contact_time(0.8, 8e-3, friction=0.3)
    contacts = Contacts(b, WALLED, law, Lubrication(1e-3, 1e-3))
    before, spin = b.velocity.copy(), b.angular_velocity.copy()
    steps = advance(contacts, 10)
    given, turned = sum(s.impulse for s in steps), sum(s.angular_impulse for s in steps)
    contact = sum(s.contact_impulse for s in steps)
    np.testing.assert_allclose(b.mass[:, None] * (b.velocity - before), given, rtol=1e-11, atol=1e-16)
    np.testing.assert_allclose(
        b.moment_of_inertia[:, None] * (b.angular_velocity - spin), turned, rtol=1e-11, atol=1e-18
    )
    assert np.abs(turned).max() > 0.0
    assert np.abs(given - contact).max() > 0.0   # the part of lubrication


def test_prescribed_body_keeps_its_velocity_and_throws_the_other_back():
    b = sphere([[0.03, 0.05, 0.05], [0.045, 0.05, 0.05]], [[0.1, 0, 0], [0, 0, 0]], motion=np.array([1, 0]))
    assert (PRESCRIBED, FREE) == (1, 0)
    contacts = Contacts(b, WALLED, LAW)
    total = sum(step.impulse for step in advance(contacts, 70, [[1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]))
    assert b.velocity[0].tolist() == [0.1, 0.0, 0.0]
    # Infinite mass: the free one leaves with (1 + e) times the speed, after t_c as against a wall.
    assert b.velocity[1, 0] == pytest.approx(0.18, rel=1e-3)
    assert contacts.take_episodes()["duration_s"] == pytest.approx(8e-3, rel=1e-3)
    np.testing.assert_allclose(total[0], -total[1], rtol=1e-12)


def test_inertia_given_instead_of_the_mass_moves_the_body():
    b = sphere([0.05, 0.05, 0.0055], [0.0, 0.0, -0.1])
    contacts = Contacts(b, WALLED, LAW)
    for k in range(40):
        contacts.advance(k * DT, DT, np.zeros((1, 3)), np.zeros((1, 3)), 1.5 * b.mass, b.moment_of_inertia)
    (episode,) = contacts.take_episodes()
    # Spring and dashpot stay, the mass grows: a longer contact, less damped.
    assert episode["duration_s"] == pytest.approx(8e-3 * np.sqrt(1.5), rel=0.05)
    assert 0.8 < episode["restitution"] < 0.9


def test_moving_wall_drags_the_sphere_that_rests_on_it():
    wall = np.zeros((6, 3))
    wall[4, 0] = 0.02
    box = Box((1.0, 0.1, 0.1), ("periodic", "wall", "wall"), wall)
    b = sphere([0.5, 0.05, 0.005])
    contacts = Contacts(b, box, SoftSphere.from_contact_time(0.5, 8e-3, friction=0.5))
    advance(contacts, 200, -9.81 * b.mass[:, None] * [[0.0, 0.0, 1.0]])
    # It rolls without slip: u + omega a = 2/7 + 5/7 of the wall's speed.
    assert b.velocity[0, 0] == pytest.approx(0.02 * 2 / 7, rel=0.02)
    assert b.angular_velocity[0, 1] * -0.005 == pytest.approx(0.02 * 5 / 7, rel=0.02)


def test_free_slip_face_acts_without_friction_or_lubrication():
    box = Box((0.1, 0.1, 0.1), ("wall", "wall", "free-slip"))
    b = sphere([0.05, 0.05, 0.0052], [0.1, 0.0, -0.1])
    law = SoftSphere.from_contact_time(0.8, 8e-3, friction=0.5)
    advance(Contacts(b, box, law, Lubrication(0.1, 1e-3)), 14)
    np.testing.assert_allclose(b.velocity, [[0.1, 0.0, 0.08]], rtol=1e-3)
    assert not b.angular_velocity.any()


def test_open_contact_is_closed_on_demand():
    b = sphere([0.05, 0.05, 0.00505], [0.0, 0.0, -0.1])
    contacts = Contacts(b, WALLED, LAW)
    assert advance(contacts, 4)[-1].touching == 1
    assert contacts.take_episodes().size == 0
    contacts.close_open(4 * DT, DT)
    (episode,) = contacts.take_episodes()
    assert (episode["i"], episode["j"], episode["kind"]) == (0, -5, "sphere-wall")
    assert episode["start_s"] == pytest.approx(5e-4, rel=1e-6)
    assert episode["steps"] == pytest.approx(3.5, rel=1e-6)
    assert np.isnan(episode["restitution"])
    assert np.isnan(episode["stokes_number"])


def test_contacts_of_different_length_come_from_literal_stiffness():
    """A short contact sets the sub-steps of all; the long one keeps its own duration."""
    place = np.array([[0.02, 0.05, 0.0021], [0.07, 0.05, 0.0101]])
    b = Bodies(np.array([0.004, 0.02]), np.full(2, 2500.0), place)
    b.velocity[:, 2] = -0.1
    law = SoftSphere.from_stiffness(100.0, restitution=0.6)
    contacts = Contacts(b, WALLED, law)
    advance(contacts, 400, dt=1e-4)
    rows = np.sort(contacts.take_episodes(), order="i")
    np.testing.assert_allclose(rows["restitution"], 0.6, rtol=1e-3)
    assert rows["duration_s"][1] / rows["duration_s"][0] == pytest.approx(np.sqrt(125.0), rel=1e-3)


def test_too_much_overlap_is_refused_by_name():
    b = sphere([[0.05, 0.05, 0.05], [0.05, 0.05, 0.0601]], [[0.0, 0.0, 2.0], [0.0, 0.0, 0.0]])
    contacts = Contacts(b, WALLED, LAW, overlap_limit=0.1)
    with pytest.raises(OverlapError) as caught:
        advance(contacts, 5)
    message = str(caught.value)
    parts = ("body 0 and body 1", "t = 0.000", "% of the diameter", "limit = 10 %", "2 m/s", "Stiffen")
    for part in parts:
        assert part in message


def test_one_long_step_records_every_bounce():
    """The loop hands over when its list of finished contacts may overflow, and goes on where it stood."""
    gap, speed, t_c, dt = 1e-4, 1.0, 1e-5, 0.02
    b = sphere([0.05, 0.05, 0.005 + 0.5 * gap], [0.0, 0.0, speed])
    box = Box((0.1, 0.1, 0.01 + gap))
    contacts = Contacts(b, box, SoftSphere.from_contact_time(1.0, t_c))
    contacts.advance(0.0, dt, np.zeros((1, 3)), np.zeros((1, 3)))
    rows = contacts.take_episodes()
    assert len(rows) == pytest.approx(dt / (gap / speed + t_c), abs=1.0)
    np.testing.assert_allclose(np.diff(rows["start_s"]), gap / speed + t_c, rtol=1e-3)
    assert set(rows["j"]) == {-5, -6}


@pytest.mark.parametrize(
    ("make", "parts"),
    [
        (lambda: Box((0.1, 0.0, 0.1)), ("box size[1] = 0.0", "above 0")),
        (lambda: Box((0.1,) * 3, ("wall", "slip", "wall")), ("box kinds[1] = slip", "free-slip")),
        (lambda: Box((0.1,) * 3, ("wall",) * 3, np.ones((6, 3))), ("wall_velocity of x_lower = 1.0",)),
        (lambda: SoftSphere.from_stiffness(1.0), ("damping or restitution",)),
        (lambda: SoftSphere.from_stiffness(1.0, 0.1, 0.5), ("damping or restitution",)),
        (lambda: SoftSphere.from_stiffness(-1.0, 0.1), ("stiffness = -1",)),
        (lambda: SoftSphere.from_contact_time(0.5, 0.0), ("contact_time = 0",)),
        (lambda: SoftSphere.from_contact_time(1.5, 1.0), ("restitution = 1.5",)),
        (lambda: SoftSphere.from_contact_time(0.5, 1.0, friction=-0.1), ("contact.friction = -0.1",)),
        (lambda: SoftSphere.from_contact_time(0.5, 1.0, ending="never"), ("ending", "never")),
        (lambda: Lubrication(0.0, 1e-3), ("lubrication.viscosity = 0.0",)),
        (lambda: Lubrication(1.0, 1e-3, 0.5), ("lubrication.roughness = 0.5", "at most 0.1")),
        (lambda: Contacts(sphere([0.05] * 3), WALLED, LAW, None, 3), ("contact.substeps = 3",)),
        (lambda: Contacts(sphere([0.05] * 3), WALLED, LAW, None, 100, 1.5), ("overlap_limit = 1.5",)),
    ],
)
def test_wrong_arguments_are_refused_with_name_value_and_rule(make, parts):
    with pytest.raises(CaseError) as caught:
        make()
    for part in parts:
        assert part in str(caught.value)


def test_laws_of_different_ways_agree():
    mass, diameter = np.array([1e-3]), np.array([0.01])
    (k_n,), (eta_n,) = (values.tolist() for values in SoftSphere.from_contact_time(0.6, 5e-3).normal(mass, diameter))
    for law in (SoftSphere.from_stiffness(k_n, eta_n), SoftSphere.from_stiffness(k_n, restitution=0.6)):
        assert law.normal(mass, diameter)[1][0] == pytest.approx(eta_n, rel=1e-9)
        assert law.resolved_time(mass, diameter)[0] == pytest.approx(5e-3, rel=1e-9)
    by_overlap = SoftSphere.from_overlap(0.01, 0.1, 0.6)
    soft_k_n, soft_eta_n = by_overlap.normal(mass, diameter)
    from rdpm.design.soft_sphere import peak_overlap

    assert peak_overlap(1e-3, soft_k_n[0], soft_eta_n[0], 0.1) == pytest.approx(1e-4)


def test_pair_taken_apart_from_outside_ends_its_contact():
    b = sphere([0.05, 0.05, 0.00505], [0.0, 0.0, -0.1])
    contacts = Contacts(b, WALLED, LAW)
    advance(contacts, 3)
    b.position[0, 2] = 0.05
    assert advance(contacts, 1)[0].touching == 0
    assert contacts.take_episodes()["duration_s"] == pytest.approx(2.5e-3, rel=1e-6)


def test_round_off_beside_a_periodic_seam_is_no_crossing():
    """A body at x = 0 with a velocity far below an ulp of the box a step; one that really leaves counts once."""
    bodies = Bodies([0.01] * 2, [1000.0] * 2, [[0.0, 0.03, 0.03], [1e-4, 0.01, 0.01]], [[-1e-15, 0, 0], [-0.1, 0, 0]])
    box = Box((0.06, 0.06, 0.06), ("periodic", "periodic", "periodic"))
    contacts = Contacts(bodies, box, SoftSphere.from_contact_time(restitution=0.9, contact_time=1e-3))
    for n in range(100):
        contacts.advance(1e-4 * n, 1e-4, np.zeros((2, 3)), np.zeros((2, 3)))
    unwrapped = bodies.position[:, 0] + 0.06 * bodies.crossings[:, 0]
    np.testing.assert_allclose(unwrapped, [0.0, 1e-4 - 0.1 * 1e-2], rtol=0.0, atol=1e-15)
    assert bodies.crossings[:, 0].tolist() == [0, -1]


def test_a_spring_under_load_meets_a_body_that_was_out_of_reach():
    """Two spheres pressed together and at rest: within one step the spring throws one of them against a third."""
    d = 0.01
    x = np.array([0.02, 0.02 + 0.95 * d, 0.02 + 1.95 * d + 0.6 * 0.05 * d])
    bodies = Bodies([d] * 3, [2500.0] * 3, np.column_stack([x, np.full(3, 0.05), np.full(3, 0.05)]))
    box = Box((0.1, 0.1, 0.1))
    law = SoftSphere.from_stiffness(1e4, restitution=1.0)
    contacts = Contacts(bodies, box, law)
    still = np.zeros((3, 3))
    contacts.advance(0.0, 1e-9, still, still)  # the first pair is remembered, nothing has moved
    assert np.abs(bodies.velocity).max() < 1e-3
    step = contacts.advance(1e-9, 2e-3, still, still)
    assert step.pairs == 2
    # Without the third in the list, the second would be inside it: it moves 5 % of a diameter in 0.3 ms.
    assert bodies.velocity[2, 0] > 0.1
    assert bodies.mass @ bodies.velocity == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)


def test_activation_distance_of_a_pair_grows_with_its_radius():
    """As the reduced radius to the 2/3; a wall's does not."""
    model = Lubrication(0.1, 1.5e-3, pair_cutoff_gap=0.3e-3, pair_touching_gap=0.2e-3, pair_radius=2e-3)
    radius = np.array([4e-3, 8e-3])
    pair, wall = model.rows(radius, radius), model.rows(radius, np.full(2, np.inf))
    np.testing.assert_allclose(pair["cutoff_gap"], [0.3e-3, 0.3e-3 * 2.0 ** (2.0 / 3.0)], rtol=1e-14)
    np.testing.assert_allclose(pair["touching_gap"], [0.2e-3, 0.2e-3 * 2.0 ** (2.0 / 3.0)], rtol=1e-14)
    np.testing.assert_allclose(wall["cutoff_gap"], 1.5e-3, rtol=1e-14)
