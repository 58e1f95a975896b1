"""Rolling friction, twisting friction and cohesion against closed forms."""

import numpy as np
import pytest

from rdpm import design
from rdpm.contacts import Contacts, ExtendedContact, Hertz, SoftSphere
from rdpm.errors import CaseError
from rdpm.grid import Box
from rdpm.particles.state import Bodies

GRAVITY, D, DENSITY = 9.81, 0.01, 2500.0
ROOM = Box((2.0, 1.0, 1.0))
SOFT = SoftSphere.from_stiffness(1e4, restitution=0.5, friction=0.5)
HERTZ = Hertz(1e8, 0.3, 0.5, 0.01, friction=0.5)
laws = pytest.mark.parametrize("law", [SOFT, HERTZ], ids=["soft", "hertz"])


def resting(law):
    """A sphere on the floor at its static overlap."""
    ball = Bodies(np.array([D]), np.array([DENSITY]), np.array([[0.2, 0.5, 0.5 * D]]))
    weight = GRAVITY * ball.mass[0]
    if isinstance(law, Hertz):
        k, _ = law.normal(ball.mass, np.array([0.5 * D]))
        ball.position[0, 2] -= (weight / k[0]) ** (2.0 / 3.0)
    else:
        ball.position[0, 2] -= weight / 1e4
    return ball


def move(bodies, law, dt, steps, weighs=True):
    contacts, none = Contacts(bodies, ROOM, law), np.zeros((len(bodies), 3))
    weight = -GRAVITY * bodies.mass[:, None] * [[0.0, 0.0, 1.0]] * weighs
    for k in range(steps):
        contacts.advance(k * dt, dt, weight, none)


@laws
def test_a_rolling_sphere_stops_after_the_distance_of_its_closed_form(law):
    """v' = -(5/7) mu_r g, as the sphere rolls without slip: 7 v^2 / (10 mu_r g)."""
    rolling, speed = 0.1, 0.1
    ball = resting(law)
    ball.velocity[0, 0], ball.angular_velocity[0, 1] = speed, speed / (0.5 * D)
    time = speed / (5.0 / 7.0 * rolling * GRAVITY)
    move(ball, ExtendedContact(law, rolling_friction=rolling), time / 100, 130)
    assert ball.position[0, 0] - 0.2 == pytest.approx(7.0 * speed**2 / (10.0 * rolling * GRAVITY), rel=2e-3)
    assert np.abs(ball.velocity).max() < 1e-6 * speed


@laws
def test_a_twisting_sphere_stops_after_the_time_of_its_closed_form(law):
    """I omega' = -mu_w a m g."""
    twisting, spin = 0.1, 20.0
    ball = resting(law)
    ball.angular_velocity[0, 2] = spin
    time = ball.moment_of_inertia[0] * spin / (twisting * 0.5 * D * ball.mass[0] * GRAVITY)
    slower = ExtendedContact(law, twisting_friction=twisting)
    move(ball, slower, time / 100, 50)
    assert ball.angular_velocity[0, 2] == pytest.approx(0.5 * spin, rel=1e-3)
    move(ball, slower, time / 100, 52)
    assert np.abs(ball.angular_velocity).max() < 1e-9 * spin


@laws
@pytest.mark.parametrize("share", [0.99, 1.01])
def test_pull_off_needs_the_force_of_johnson_kendall_and_roberts(law, share):
    w, well = 0.05, 1e-5
    sticky = ExtendedContact(law, cohesion=w, cohesion_range=well)
    ball = Bodies(np.array([D]), np.array([DENSITY]), np.array([[0.2, 0.5, 0.5 * D]]))
    force = np.zeros((1, 3))
    contacts = Contacts(ball, ROOM, sticky)
    pull = 1.5 * np.pi * w * 0.5 * D
    for k in range(1200):  # settles with nothing else at work, then is pulled
        force[0, 2] = share * pull if k >= 200 else 0.0
        contacts.advance(k * 1e-4, 1e-4, force, np.zeros((1, 3)))
    assert (ball.position[0, 2] - 0.5 * D > well) == (share > 1.0)


@laws
def test_parting_takes_the_energy_of_the_well(law):
    """A sphere leaves the surface: half m v^2 less force times range."""
    w, well, speed = 0.05, 2e-5, 0.02
    sticky = ExtendedContact(law, cohesion=w, cohesion_range=well)
    ball = Bodies(np.array([D]), np.array([DENSITY]), np.array([[0.2, 0.5, 0.5 * D]]))
    ball.velocity[0, 2] = speed
    energy = float(design.pull_off_force(0.5 * D, w)) * well
    move(ball, sticky, 1e-5, 400, weighs=False)
    assert ball.position[0, 2] - 0.5 * D > well
    left = np.sqrt(speed**2 - 2.0 * energy / ball.mass[0])
    assert ball.velocity[0, 2] == pytest.approx(left, rel=1e-3)


@pytest.mark.parametrize(("factor", "sticks"), [(0.9, True), (1.2, False)])
def test_pairs_stick_below_the_designed_speed(factor, sticks):
    """Stiff enough that the attraction does not change the contact itself."""
    w, well, e = 0.05, 2e-5, 0.6
    ball = Bodies(np.array([D]), np.array([DENSITY]), np.array([[0.2, 0.5, 0.5 * D + 2.0 * well]]))
    force = design.pull_off_force(0.5 * D, w)
    ball.velocity[0, 2] = -factor * design.sticking_speed(ball.mass[0], force, well, e)
    law = ExtendedContact(SoftSphere.from_stiffness(1e6, restitution=e), cohesion=w, cohesion_range=well)
    move(ball, law, 1e-4, 300, weighs=False)
    assert (ball.position[0, 2] - 0.5 * D < well) == sticks


@laws
def test_momentum_is_kept_and_energy_never_grows(law):
    """Two spheres that stick, roll and twist about each other, freely; the well's energy counts."""
    sticky = ExtendedContact(law, 0.1, 0.1, cohesion=1.0, cohesion_range=1e-5)
    pair = Bodies(
        np.array([D, 0.7 * D]), np.full(2, DENSITY), np.array([[1.0, 0.5, 0.5], [1.0, 0.5, 0.5 + 0.85 * D + 5e-6]]),
        np.array([[0.01, 0.0, 0.02], [0.0, 0.01, -0.02]]), np.array([[1.0, 2.0, 3.0], [-3.0, 1.0, -5.0]]),
    )  # fmt: skip
    contacts, none = Contacts(pair, ROOM, sticky), np.zeros((2, 3))
    centre = pair.position.mean(0)

    def momenta():
        p = pair.mass[:, None] * pair.velocity
        spin = pair.moment_of_inertia[:, None] * pair.angular_velocity
        return p.sum(0), (np.cross(pair.position - centre, p) + spin).sum(0)

    def energy():
        turning = pair.moment_of_inertia[:, None] * pair.angular_velocity**2
        return 0.5 * float(np.sum(pair.mass[:, None] * pair.velocity**2) + np.sum(turning))

    before, first = momenta(), energy()
    depth = float(design.pull_off_force(1.0 / (2.0 / D + 2.0 / (0.7 * D)), 1.0)) * 1e-5
    kinetic = []
    for k in range(300):
        contacts.advance(k * 1e-4, 1e-4, none, none)
        kinetic.append(energy())
    for one, other in zip(before, momenta(), strict=True):  # round-off of positions of 1 m, over many sub-steps
        np.testing.assert_allclose(other, one, rtol=0, atol=1e-10 * np.abs(one).max())
    assert contacts.close_pairs(1e-5).size > 0  # it sticks
    assert max(kinetic) < first + depth
    # The relative rotation has come to rest: they turn as one.
    np.testing.assert_allclose(pair.angular_velocity[0], pair.angular_velocity[1], atol=1e-3 * 5.0)


def test_nothing_added_is_no_extended_contact():
    with pytest.raises(CaseError, match="rolling_friction, twisting_friction or cohesion"):
        ExtendedContact(SOFT)
    with pytest.raises(CaseError, match="cohesion_range"):
        ExtendedContact(SOFT, cohesion=0.1)
