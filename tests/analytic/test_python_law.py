"""A law given as a Python function, against the compiled one of the same force."""

from __future__ import annotations

import numpy as np
import pytest

from rdpm.contacts import Contacts, Lubrication, PythonLaw, SoftSphere
from rdpm.errors import CaseError, OverlapError
from rdpm.grid import Box
from rdpm.particles.state import Bodies
from rdpm.surfaces import Plane

K, ETA, K_T, MU = 2e3, 0.15, 2e3 * 2 / 7, 0.3
#: Explicit sub-steps, a hundred a contact, of a force with damping.
CLOSE = 1e-2


def spring(pair):
    """Cundall and Strack's springs and normal dashpot, as SoftSphere at zero overlap has them."""
    if pair.overlap <= 0.0:
        return 0.0
    push = K * pair.overlap + ETA * pair.rate
    pair.memory += pair.duration * pair.slip
    along = -K_T * pair.memory - ETA * 2 / 7 * pair.slip
    size, most = np.linalg.norm(along), MU * max(push, 0.0)
    if size > most:
        along *= most / size
        pair.memory[:] = -along / K_T
    return push, along


def _pair():
    size = np.array([0.01, 0.008])
    normal = np.array([0.6, 0.0, 0.8])
    place = np.array([0.5, 0.5, 0.5]) + np.array([[0, 0, 0], (0.5 * size.sum() + 1e-6) * normal])
    velocity = np.array([0.05 * normal + [0, 0.03, 0], -0.05 * normal])
    return Bodies(size, np.array([2500.0, 1500.0]), place, velocity, np.array([[0, 4.0, 0], [0, 0, 3.0]]))


def _energy(b):
    return 0.5 * (b.mass @ b.velocity**2).sum() + 0.5 * (b.moment_of_inertia @ b.angular_velocity**2).sum()


def _run(bodies, law, steps, box=None, load=None, limit=0.2):
    contacts = Contacts(bodies, box or Box((1.0, 1.0, 1.0)), law, overlap_limit=limit)
    none = np.zeros((len(bodies), 3))
    given = [contacts.advance(n * 1e-4, 1e-4, none if load is None else load, none) for n in range(steps)]
    return contacts.take_episodes(), given


def test_it_does_what_the_compiled_law_does() -> None:
    """Oblique impact of two spheres: velocities, spins and the record; momentum and the count of work to round-off."""
    ours, theirs = _pair(), _pair()
    before = ours.mass @ ours.velocity
    energy = _energy(ours)
    found, given = _run(ours, PythonLaw(spring, contact_time=1e-3), 20)
    law = SoftSphere.from_stiffness(K, ETA, None, "zero-overlap", MU, K_T / K)
    wanted, _ = _run(theirs, law, 20)
    assert np.allclose(ours.velocity, theirs.velocity, atol=CLOSE * 0.1)
    assert np.allclose(ours.angular_velocity, theirs.angular_velocity, atol=CLOSE * 10.0)
    for name in ("duration_s", "max_overlap_fraction", "impact_speed_m_s", "restitution"):
        assert found[name][0] == pytest.approx(wanted[name][0], rel=CLOSE)
    assert np.allclose(ours.mass @ ours.velocity, before, atol=1e-15)
    assert np.allclose(sum(step.impulse for step in given).sum(axis=0), 0.0, atol=1e-18)
    assert found["work_J"][0] == pytest.approx(_energy(ours) - energy, rel=1e-9)


def test_it_acts_at_walls_and_at_a_distance() -> None:
    """A force that decays over a millimetre carries a sphere above a slope, where 2 N (1 - g/1 mm) = m g cos(theta)."""
    normal = np.array([0.6, 0.0, 0.8])
    point = np.array([0.5, 0.5, 0.5])
    ball = Bodies(np.array([0.01]), np.array([2500.0]), np.array([point + 0.0058 * normal]))
    law = PythonLaw(lambda pair: 0.02 * (1.0 + pair.overlap / 1e-3) + 0.2 * pair.rate, 5e-3, interaction_range=1e-3)
    slope = Box((1.0, 1.0, 1.0), walls=(Plane(tuple(point), tuple(normal)),))
    pull = -ball.mass[0] * 9.81 * 0.8 * normal
    found, given = _run(ball, law, 800, slope, pull[None])
    gap = (ball.position[0] - point) @ normal - 0.005
    # The damping sees half of a fall in a sub-step, 0.2 g h / 2, which is 0.4 % of the force at touch.
    assert gap == pytest.approx(1e-3 * (1.0 - ball.mass[0] * 9.81 * 0.8 / 0.02), rel=1e-2)
    assert len(found) == 0
    assert given[-1].min_gap == pytest.approx(gap, rel=1e-3)


def test_what_it_cannot_do_is_refused() -> None:
    with pytest.raises(CaseError, match="must be a finite number above 0"):
        PythonLaw(spring, contact_time=0.0)
    wet = Contacts(_pair(), Box((1.0, 1.0, 1.0)), PythonLaw(spring, 1e-3), Lubrication(0.1, 1e-3))
    with pytest.raises(CaseError, match="must be false with a law of Python's"):
        wet.advance(0.0, 1e-4, np.zeros((2, 3)), np.zeros((2, 3)))
    with pytest.raises(OverlapError, match="does not part them"):
        _run(_pair(), PythonLaw(lambda pair: 0.0, 1e-3), 20, limit=0.01)
