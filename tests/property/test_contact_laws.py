"""What every contact law must keep: energy against work, action against reaction, the symmetries of space, its target.

A new law joins by a line in LAWS.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from contact_laws.constant_force import ConstantForce
from rdpm.contacts import AdaptiveCollisionTime, Contacts, ExtendedContact, HardSphere, Hertz, Repulsive, SoftSphere
from rdpm.grid import Box
from rdpm.particles.state import Bodies

# Name: law, and the restitution it is to achieve.
LAWS = {
    "soft sphere, zero force": (SoftSphere.from_contact_time(0.6, 1e-3, "zero-force", friction=0.3), 0.6),
    "soft sphere, zero overlap": (SoftSphere.from_contact_time(0.6, 1e-3, "zero-overlap", friction=0.3), 0.6),
    "hertz, zero force": (Hertz(1e7, 0.3, 0.6, 0.15, "zero-force", friction=0.3), 0.6),
    "hertz, zero overlap": (Hertz(1e7, 0.3, 0.6, 0.15, "zero-overlap", friction=0.3), 0.6),
    "adaptive collision time": (AdaptiveCollisionTime(0.6, 1e-3, 1e-4, friction=0.3), 0.6),
    "repulsive": (Repulsive(stiffness=10.0, range=1e-5), 1.0),  # the surfaces stay apart
    "hard sphere": (HardSphere(0.6, friction=0.3, tangential_restitution=0.4), 0.6),
    "soft sphere, rolling and twisting friction": (
        ExtendedContact(SoftSphere.from_contact_time(0.6, 1e-3, friction=0.3), 0.1, 0.1), 0.6,
    ),
    "hertz, rolling and twisting friction": (
        ExtendedContact(Hertz(1e7, 0.3, 0.6, 0.15, friction=0.3), 0.1, 0.1), 0.6,
    ),
    "constant force": (ConstantForce(acceleration=200.0, speed=0.1), 1.0),
}
APART = {"repulsive"}  # laws that act before the surfaces touch: no contact to record
ENDLESS = Box((1.0, 1.0, 1.0), ("periodic",) * 3)
DT, STEPS = 1e-4, 80

every_law = pytest.mark.parametrize("name", LAWS)
seeds = st.integers(0, 2**32 - 1)
examples = settings(max_examples=20, deadline=None, derandomize=True)


def collision(seed: int, is_head_on: bool = False) -> Bodies:
    """Two spheres of different size and density about to meet in any direction, sliding and spinning unless head-on."""
    rng = np.random.default_rng(seed)
    size, density = rng.uniform(0.005, 0.01, 2), rng.uniform(800.0, 3000.0, 2)
    normal = rng.standard_normal(3)
    normal /= np.linalg.norm(normal)
    place = 0.5 + np.array([[0.0, 0.0, 0.0], (0.5 * size.sum() + 1e-5) * normal])
    relative = rng.uniform(0.05, 0.15) * normal
    spin = np.zeros((2, 3))
    if not is_head_on:
        relative = relative + 0.05 * np.cross(normal, rng.standard_normal(3))
        spin = rng.uniform(-5.0, 5.0, (2, 3))
    velocity = rng.uniform(-0.1, 0.1, 3) + np.array([0.5, -0.5])[:, None] * relative
    return Bodies(size, density, place, velocity, spin)


def run(name: str, bodies: Bodies):
    """Let them meet and part; the contacts and what each step gave."""
    contacts, none = Contacts(bodies, ENDLESS, LAWS[name][0]), np.zeros((2, 3))
    steps = [contacts.advance(k * DT, DT, none, none) for k in range(STEPS)]
    assert steps[-1].touching == 0
    return contacts.take_episodes(), steps


def kinetic_energy(b: Bodies) -> float:
    turning = b.moment_of_inertia[:, None] * b.angular_velocity**2
    return float(0.5 * np.sum(b.mass[:, None] * b.velocity**2) + 0.5 * np.sum(turning))


@every_law
@examples
@given(seed=seeds)
def test_work_of_the_contact_is_the_change_of_energy(name, seed):
    bodies = collision(seed)
    before = kinetic_energy(bodies)
    episodes, steps = run(name, bodies)
    if name in APART:
        assert len(episodes) == 0
        assert min(step.min_gap for step in steps) > 0.0
        # Conservative: what the sub-steps leave is of second order.
        assert kinetic_energy(bodies) == pytest.approx(before, rel=1e-3)
        return
    assert len(episodes) == 1
    # Round-off of the impulses alone: each is applied as its work is counted.
    assert episodes["work_J"].sum() == pytest.approx(kinetic_energy(bodies) - before, abs=1e-12 * before)
    # The located begin and end of the force, 1 % of a contact each, cost second order.
    assert episodes["work_J"].sum() <= 2e-3 * before


@every_law
@examples
@given(seed=seeds)
def test_action_is_reaction(name, seed):
    bodies = collision(seed)

    def momenta():
        p, spin = bodies.mass[:, None] * bodies.velocity, bodies.moment_of_inertia[:, None] * bodies.angular_velocity
        return p.sum(0), (np.cross(bodies.position - 0.5, p) + spin).sum(0)

    before = momenta()
    _, steps = run(name, bodies)
    scale = np.sum(bodies.mass) * 0.1
    given = sum(step.impulse for step in steps)
    assert np.abs(given[0]).max() > 1e-3 * scale
    np.testing.assert_allclose(given[0], -given[1], rtol=0, atol=1e-13 * scale)
    for one, other in zip(before, momenta(), strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-12 * scale)


@every_law
@examples
@given(
    seed=seeds, axes=st.permutations(range(3)), mirrors=st.tuples(*[st.booleans()] * 3),
    frame=st.tuples(*[st.floats(-1.0, 1.0)] * 3),
)  # fmt: skip
def test_another_frame_sees_the_same_collision(name, seed, axes, mirrors, frame):
    """Mirrored, turned, and from a frame in motion: with it the bodies cross the periodic seam."""
    view = np.zeros((3, 3))
    view[range(3), axes] = np.where(mirrors, -1.0, 1.0)
    one, other = collision(seed), collision(seed)
    other.position = 0.5 + (other.position - 0.5) @ view.T
    other.velocity = other.velocity @ view.T + 100.0 * np.array(frame)
    other.angular_velocity = np.linalg.det(view) * other.angular_velocity @ view.T   # a pseudo-vector
    for bodies in (one, other):
        run(name, bodies)
    # Round-off of positions at a hundred m/s.
    np.testing.assert_allclose((other.velocity - 100.0 * np.array(frame)) @ view, one.velocity, rtol=0, atol=1e-8)
    spin = np.linalg.det(view) * other.angular_velocity @ view
    np.testing.assert_allclose(spin, one.angular_velocity, rtol=0, atol=1e-5)


@every_law
@examples
@given(seed=seeds)
def test_achieved_restitution_is_the_target(name, seed):
    bodies, target = collision(seed, is_head_on=True), LAWS[name][1]
    approach = np.linalg.norm(bodies.velocity[0] - bodies.velocity[1])
    episodes, _ = run(name, bodies)
    # A tenth of the promised 1 %.
    assert np.linalg.norm(bodies.velocity[0] - bodies.velocity[1]) / approach == pytest.approx(target, rel=1e-3)
    if name not in APART:
        assert episodes["restitution"] == pytest.approx(target, rel=1e-3)
