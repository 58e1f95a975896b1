"""Slip and roll of close surfaces: published logarithms, rigid motion, energy, and drivers at any stiffness."""

import numpy as np
import pytest

from rdpm.contacts import Contacts, HardSphere, Lubrication, SoftSphere, TangentialLubrication
from rdpm.errors import CaseError
from rdpm.grid import Box
from rdpm.particles.state import Bodies
from rdpm.surfaces import Cylinder

VISCOSITY, RADIUS = 0.1, 5e-3
ROOM = Box((1.0, 1.0, 1.0), ("periodic", "periodic", "wall"))
# A spring that no impulse below sees.
LAWS = {"soft sphere": SoftSphere.from_stiffness(1e-15, restitution=1.0), "hard sphere": HardSphere(0.5)}
CUT = 0.2 * RADIUS
# Resolved at the cut-off as touching: lambda is a multiple of ln(cut/gap).
GAPS = TangentialLubrication((CUT, CUT), (CUT, CUT), (CUT, CUT), RADIUS)


def model(viscosity=VISCOSITY, roughness=1e-6):
    """Along the normal nothing acts from 1e-9 m on: what is seen is tangential."""
    return Lubrication(viscosity, 1e-9, roughness, tangential=GAPS)


def pair_of(gap, ratio, density=1e9):
    """The first below the second, on an axis that is no edge of the box."""
    n = np.array([0.48, 0.6, 0.64])
    radius = RADIUS * np.array([1.0, ratio])
    apart = radius.sum() + gap
    place = 0.5 + apart * np.array([[0.0], [1.0]]) * n
    return Bodies(2.0 * radius, np.full(2, density), place), n


def resistance(bodies, box=ROOM, lubrication=None, law="soft sphere"):
    """Minus force and torque of each body per velocity and rate of turn of each, (6N, 6N): heavy bodies, one step."""
    count, dt = len(bodies), 1e-7
    contacts = Contacts(bodies, box, LAWS[law], lubrication or model())
    none, matrix = np.zeros((count, 3)), np.zeros((6 * count, 6 * count))
    place = bodies.position.copy()
    for column in range(6 * count):
        bodies.position[:] = place
        motion = np.zeros((count, 6))
        motion.flat[column] = 1e-6
        bodies.velocity[:], bodies.angular_velocity[:] = motion[:, :3], motion[:, 3:]
        step = contacts.advance(column * dt, dt, none, none)
        np.testing.assert_array_equal(step.lubrication_angular_impulse, step.angular_impulse)
        matrix[:, column] = -np.hstack([step.impulse, step.angular_impulse]).ravel() / (1e-6 * dt)
    bodies.position[:] = place
    return matrix


def per_log(matrix, gap):
    return matrix / (np.pi * VISCOSITY * np.log(CUT / gap))


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("ratio", [0.3, 1.0, 4.0])
def test_two_spheres_have_the_logarithms_of_jeffrey_and_onishi(law, ratio):
    gap = 1e-4 * RADIUS
    bodies, n = pair_of(gap, ratio)
    # All gaps of the pair belong to RADIUS: those of its reduced radius are scaled.
    scale = (ratio / (1.0 + ratio)) ** (2.0 / 3.0)
    both = per_log(resistance(bodies, law=law), gap / scale).reshape(2, 2, 3, 2, 2, 3)
    t = np.cross(n, [1.0, 0.0, 0.0])
    t /= np.linalg.norm(t)
    s = np.cross(t, n)
    a, b = RADIUS, ratio
    force, turn, coupling = both[0, 0, :, 0, 0], both[0, 1, :, 0, 1], both[0, 1, :, 0, 0]
    across, far = both[0, 1, :, 1, 1], both[1, 1, :, 1, 1]
    # Terms of order gap: the levers reach to the middle of the gap.
    expected = pytest.approx
    assert t @ force @ t == expected(6 * a * 4 * b * (2 + b + 2 * b**2) / (15 * (1 + b) ** 3), rel=2e-4)
    assert abs(s @ coupling @ t) == expected(4 * a**2 * b * (4 + b) / (5 * (1 + b) ** 2), rel=2e-4)
    assert t @ turn @ t == expected(8 * a**3 * 2 * b / (5 * (1 + b)), rel=2e-4)
    assert t @ far @ t == expected(8 * a**3 * 2 * b**3 / (5 * (1 + b)), rel=2e-4)
    assert t @ across @ t == expected(8 * a**3 * b**2 / (10 * (1 + b)), rel=2e-4)
    assert abs(n @ turn @ n) < 1e-9 * a**3  # no twist


@pytest.mark.parametrize("law", LAWS)
def test_a_wall_has_the_logarithms_of_goldman_cox_and_brenner(law):
    gap, a = 1e-4 * RADIUS, RADIUS
    bodies = Bodies([2 * a], [1e9], [[0.5, 0.5, a + gap]])
    r = per_log(resistance(bodies, law=law), gap)
    assert r[0, 0] == pytest.approx(6 * a * 8 / 15, rel=2e-4)
    assert r[4, 4] == pytest.approx(8 * a**3 * 2 / 5, rel=3e-4)
    assert r[4, 0] == pytest.approx(-8 * a**2 / 10, rel=2e-4)
    assert r[0, 4] == pytest.approx(-6 * a**2 * 2 / 15, rel=2e-4)
    assert abs(r[5, 5]) < 1e-9 * a**3


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("ratio", [0.3, 1.0, 4.0])
@pytest.mark.parametrize("gap", [-1e-3, 1e-5, 0.03])
def test_resistance_is_symmetric_positive_and_blind_to_rigid_motion(law, ratio, gap):
    if law == "hard sphere" and gap < 0.0:
        gap = 1e-9
    bodies, _ = pair_of(gap * RADIUS, ratio)
    matrix = resistance(bodies, law=law)
    length = np.tile([1.0] * 3 + [1.0 / RADIUS] * 3, 2)
    matrix *= length * length[:, None]
    size = np.abs(matrix).max()
    # One sub-step's drift moves the pair by 1e-13 of its radius; the rest is the round-off of momenta.
    np.testing.assert_allclose(matrix, matrix.T, atol=1e-7 * size)
    assert np.linalg.eigvalsh(0.5 * (matrix + matrix.T)).min() > -1e-7 * size
    rank = np.linalg.matrix_rank(matrix, tol=1e-6 * size)
    assert rank == 4  # slip and roll in two directions
    for axis in np.eye(3):
        shift = np.tile(np.concatenate([axis, np.zeros(3)]), 2)
        turn = np.concatenate([[np.cross(axis, x), axis] for x in bodies.position - bodies.position[0]]).ravel()
        for motion in (shift / length, turn / length):
            assert np.abs(matrix @ motion).max() < 1e-6 * size * np.abs(motion).max()


def test_a_sphere_that_turns_with_its_tube_feels_nothing():
    radius, gap, rate = 4.0 * RADIUS, 0.01 * RADIUS, 3.0
    wall = Cylinder((0.5, 0.5, 0.5), (0.0, 0.0, 1.0), radius, "inside", angular_velocity=rate)
    box = Box((1.0, 1.0, 1.0), ("periodic",) * 3, walls=(wall,))
    out = radius - RADIUS - gap
    bodies = Bodies([2 * RADIUS], [1e3], [[0.5 + out, 0.5, 0.5]], [[0.0, rate * out, 0.0]], [[0.0, 0.0, rate]])
    contacts = Contacts(bodies, box, LAWS["soft sphere"], model())
    none = np.zeros((1, 3))
    scale = np.pi * VISCOSITY * RADIUS**2 * rate * 1e-5
    step = contacts.advance(0.0, 1e-5, none, none)
    assert step.pairs == 1
    # It leaves the circle along a tangent, 1e-5 of its radius away from where it began.
    assert np.abs(step.impulse).max() < 1e-6 * scale
    assert np.abs(step.angular_impulse).max() < 1e-6 * scale * RADIUS
    bodies.angular_velocity[:] = 0.0
    assert contacts.advance(1e-5, 1e-5, none, none).angular_impulse[0, 2] > scale * RADIUS


def test_only_the_velocity_against_a_wall_counts():
    bodies = [Bodies([2 * RADIUS], [1e3], [[0.5, 0.5, 1.01 * RADIUS]], [[v, 0.0, 0.0]]) for v in (0.2, 0.0)]
    moving = Box((1.0, 1.0, 1.0), ("periodic", "periodic", "wall"), np.array([[0.0] * 3] * 4 + [[-0.2, 0, 0], [0] * 3]))
    none, impulses = np.zeros((1, 3)), []
    for body, box in zip(bodies, (ROOM, moving), strict=True):
        step = Contacts(body, box, LAWS["soft sphere"], model()).advance(0.0, 1e-4, none, none)
        impulses.append(np.hstack([step.impulse, step.angular_impulse]))
    assert impulses[0][0, 0] < 0.0 < impulses[0][0, 4]
    np.testing.assert_allclose(impulses[0], impulses[1], rtol=1e-12)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("viscosity", [1e-3, 1.0, 1e3, 1e9])
@pytest.mark.parametrize("ratio", [0.1, 1.0])
def test_a_free_pair_loses_energy_and_no_momentum_however_stiff(law, viscosity, ratio):
    bodies, _ = pair_of(1e-3 * RADIUS, ratio, density=2500.0)
    rng = np.random.default_rng(2)
    bodies.velocity[:] = rng.normal(0.0, 0.01, (2, 3))
    bodies.angular_velocity[:] = rng.normal(0.0, 10.0, (2, 3))
    contacts, none = Contacts(bodies, ROOM, LAWS[law], model(viscosity)), np.zeros((2, 3))

    def invariants():
        p, spin = bodies.mass[:, None] * bodies.velocity, bodies.moment_of_inertia[:, None] * bodies.angular_velocity
        energy = 0.5 * (np.sum(p * bodies.velocity) + np.sum(spin * bodies.angular_velocity))
        return energy, p.sum(0), (np.cross(bodies.position - 0.5, p) + spin).sum(0)

    def slip_and_roll():
        r, v = bodies.position[1] - bodies.position[0], bodies.velocity[1] - bodies.velocity[0]
        spin = bodies.angular_velocity - np.cross(r, v) / (r @ r)
        return np.abs(np.cross(spin, r / np.linalg.norm(r))).max()

    energy, momentum, angular = invariants()
    start, moving = energy, slip_and_roll()
    for n in range(20):
        contacts.advance(n * 1e-5, 1e-5, none, none)
        now, linear, turning = invariants()
        assert now <= energy * (1.0 + 1e-13)
        np.testing.assert_allclose(linear, momentum, atol=1e-13 * np.abs(bodies.mass @ np.abs(bodies.velocity)).max())
        np.testing.assert_allclose(turning, angular, atol=1e-12 * np.abs(angular).max())
        energy = now
    assert energy < start
    if viscosity > 1.0:  # what is left turns as one; the last sub-step's drift turns the pair by 1e-6
        assert slip_and_roll() < 1e-3 * moving


def test_sliding_down_a_wall_has_the_speed_of_its_balance():
    """Where lambda h/m is 1e3, speed and rate of turn are those of the resistances: no time step is too long."""
    gap = 1e-3 * RADIUS
    lubrication = model(1e3)
    slip, roll = (float(x[0]) for x in lubrication.tangential_resistance(np.array([gap]), RADIUS, np.inf))
    bodies = Bodies([2 * RADIUS], [2500.0], [[0.5, 0.5, RADIUS + gap]])
    force = bodies.mass[:, None] * [[9.81, 0.0, 0.0]]
    contacts = Contacts(bodies, ROOM, LAWS["soft sphere"], lubrication)
    for n in range(5):
        contacts.advance(n * 1e-3, 1e-3, force, np.zeros((1, 3)))
    speed = force[0, 0] * (1.0 / slip + 1.0 / roll) / 4.0  # half of each is slip, half is roll
    assert bodies.velocity[0, 0] == pytest.approx(speed, rel=1e-6)
    lever = RADIUS + gap
    turning = force[0, 0] * (1.0 / roll - 1.0 / slip) / (4.0 * lever)
    assert bodies.angular_velocity[0, 1] == pytest.approx(turning, rel=1e-6)
    assert turning > 0.0  # as it would roll


def test_it_is_zero_at_the_cutoff_and_constant_below_the_roughness_and_in_overlap():
    lubrication = Lubrication(
        VISCOSITY, CUT, roughness=1e-3,
        tangential=TangentialLubrication((CUT, 0.3 * CUT), (0.5 * CUT, 0.2 * CUT), (CUT, 0.5 * CUT), RADIUS),
    )  # fmt: skip
    gap = np.array([-0.01, 0.0, 1e-4, 1e-3, 1.0001e-3, 0.199999, 0.2, 0.5]) * RADIUS
    for found in lubrication.tangential_resistance(gap, RADIUS, np.inf):
        assert np.all(found[:4] == found[0])
        assert found[4] == pytest.approx(found[3], rel=1e-4)
        assert 0.0 < found[5] < 1e-5 * found[0]
        assert np.all(found[6:] == 0.0)
    assert lubrication.largest_gap(np.array([RADIUS])) == CUT


def test_gaps_that_make_no_sense_are_refused():
    with pytest.raises(CaseError, match=r"lubrication\.tangential\.roll"):
        TangentialLubrication((CUT, CUT), (CUT, CUT), (CUT, 2 * CUT), RADIUS)
    with pytest.raises(CaseError, match=r"lubrication\.tangential\.radius"):
        TangentialLubrication((CUT, CUT), (CUT, CUT), (CUT, CUT), 0.0)
