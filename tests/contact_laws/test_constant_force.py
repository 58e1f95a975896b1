"""Adding a law takes a struct and a class: this one runs through the package's own driver, compiled here."""

import numpy as np
import pytest

from contact_laws.constant_force import HISTORY, ConstantForce, compiled_kernel
from rdpm import _core
from rdpm.contacts import Contacts, Lubrication, SubstepDriver
from rdpm.grid import Box
from rdpm.particles.state import Bodies

ROOM = Box((1.0, 1.0, 1.0))
DIAMETER, SPEED, ACCELERATION = 0.01, 0.1, 50.0
LAW = ConstantForce(ACCELERATION, SPEED)
DURATION = 2.0 * SPEED / ACCELERATION
DT = DURATION / 8.0

# The sub-step in which the force begins or ends misplaces the body by up to a h^2/8, with a h = speed/50: of the
# energy, (1/50)^2/4 at either end.
TOLERANCE = 2e-4


def approaching(kind: str, phase: float) -> Bodies:
    gap = SPEED * DT * (1.5 + phase)
    if kind == "wall":
        return Bodies(
            np.array([DIAMETER]), np.array([2500.0]), np.array([[0.5, 0.5, 0.5 * DIAMETER + gap]]),
            np.array([[0.02, 0.0, -SPEED]]),
        )  # fmt: skip
    size = np.array([DIAMETER, 2.3 * DIAMETER])
    place = np.array([[0.5, 0.5, 0.5], [0.5, 0.5 + 0.5 * size.sum() + gap, 0.5]])
    velocity = np.array([[0.0, 0.3 * SPEED, 0.0], [0.0, -0.7 * SPEED, 0.0]])
    return Bodies(size, np.array([2500.0, 1000.0]), place, velocity)


@pytest.mark.parametrize("kind", ["wall", "pair"])
@pytest.mark.parametrize("phase", np.linspace(0.0, 1.0, 5, endpoint=False))
def test_duration_and_peak_overlap_are_those_of_constant_deceleration(kind, phase):
    bodies = approaching(kind, phase)
    contacts, none = Contacts(bodies, ROOM, LAW), np.zeros_like(bodies.position)
    energy = 0.5 * np.sum(bodies.mass[:, None] * bodies.velocity**2)
    touch = DT * (1.5 + phase)
    for step in range(12):
        contacts.advance(step * DT, DT, none, none)
    (episode,) = contacts.take_episodes()
    assert episode["start_s"] == pytest.approx(touch, rel=TOLERANCE)
    assert episode["duration_s"] == pytest.approx(DURATION, rel=TOLERANCE)
    assert episode["max_overlap_fraction"] == pytest.approx(0.5 * SPEED**2 / ACCELERATION / DIAMETER, rel=TOLERANCE)
    assert episode["restitution"] == pytest.approx(1.0, rel=TOLERANCE)
    assert 0.5 * np.sum(bodies.mass[:, None] * bodies.velocity**2) == pytest.approx(energy, rel=TOLERANCE)


def test_lubrication_is_the_drivers_not_the_laws():
    bodies = approaching("wall", 0.0)
    none = np.zeros((1, 3))
    contacts = Contacts(bodies, ROOM, LAW, Lubrication(viscosity=0.01, cutoff_gap=1e-3))
    steps = [contacts.advance(step * DT, DT, none, none) for step in range(14)]
    (episode,) = contacts.take_episodes()
    assert episode["impact_speed_m_s"] < 0.99 * SPEED
    assert 0.0 < bodies.velocity[0, 2] < 0.99 * episode["rebound_speed_m_s"]
    assert any(np.any(step.impulse != step.contact_impulse) for step in steps)


def test_rows_that_are_not_the_structs_are_refused():
    kernel = _core.ContactKernel.at(compiled_kernel())
    with pytest.raises(ImportError, match=r"contact parameters.*'push'.*'force'"):
        SubstepDriver(kernel, np.dtype([("push", np.float64)]), HISTORY)
    with pytest.raises(ImportError, match="contact history"):
        SubstepDriver(kernel, np.dtype([("force", np.float64)]), np.dtype([("xi", np.float64)]))
    with pytest.raises(ImportError, match="8 bytes"):
        SubstepDriver(kernel, np.dtype([("force", np.float32)]), HISTORY)


def test_a_driver_compiled_against_other_headers_is_refused():
    alien = np.zeros(16, np.int64)
    with pytest.raises(ValueError, match="other headers"):
        _core.ContactKernel.at(alien.ctypes.data)
