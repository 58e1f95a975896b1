"""A heap at rest: it does not heat, and creeps by no more than the second order of its sub-steps."""

import numpy as np
import pytest

from rdpm.contacts import Contacts, HardSphere, Hertz, SoftSphere
from rdpm.grid import Box
from rdpm.particles.state import Bodies

GRAVITY, D, CONTACT_TIME = 9.81, 0.01, 1e-3
DT = CONTACT_TIME / 8.0
#: Against rolling apart: the pyramid needs 0.41 between its spheres.
FRICTION = 5.0


def pyramid():
    """Four spheres on the floor and one on them, touching."""
    place = [[0.5 + x * D, 0.5 + y * D, 0.5 * D] for x in (-0.5, 0.5) for y in (-0.5, 0.5)]
    place.append([0.5, 0.5, 0.5 * D + np.sqrt(0.5) * D])
    return Bodies(np.full(5, D), np.full(5, 2500.0), np.array(place))


def kinetic_energy(b):
    turning = b.moment_of_inertia[:, None] * b.angular_velocity**2
    return 0.5 * float(np.sum(b.mass[:, None] * b.velocity**2) + np.sum(turning))


def rest(law, steps, of=10, substeps_per_contact=100):
    """Let it settle for `steps`, then watch it for as many: energies over m g d, and the way made [d]."""
    heap = pyramid()
    contacts = Contacts(heap, Box((1.0, 1.0, 1.0)), law, substeps_per_contact=substeps_per_contact)
    weight, none = -GRAVITY * heap.mass[:, None] * [[0.0, 0.0, 1.0]], np.zeros((5, 3))
    energies, substeps = [], 0
    for k in range(2 * steps):
        if k == steps:
            before = heap.position.copy()
        substeps += contacts.advance(k * DT, DT, weight, none).substeps
        if k >= steps and k % (steps // of) == 0:
            energies.append(kinetic_energy(heap) / (heap.mass[0] * GRAVITY * D))
    return np.array(energies), float(np.abs(heap.position - before).max()) / D, substeps


@pytest.mark.parametrize(
    ("law", "most_energy"),
    [(SoftSphere.from_contact_time(0.5, CONTACT_TIME, friction=FRICTION), 1e-11),
     (Hertz(1e7, 0.3, 0.5, 0.1, friction=FRICTION), 1e-10)],
    ids=["soft", "hertz"],
)  # fmt: skip
def test_a_heap_does_not_heat_over_1e5_substeps(law, most_energy):
    energies, way, substeps = rest(law, 5000)
    assert substeps >= 1e5
    # What the order of the pairs leaves of a sub-step's fall, (g h)^2/(2 g d) = 4e-8, times the square of eta h/m.
    assert energies.max() < most_energy
    assert energies[-1] <= energies[0] * (1.0 + 1e-3)
    assert way < 1e-4


def test_the_creep_of_a_heap_is_of_second_order_in_the_substep():
    law = SoftSphere.from_contact_time(0.5, CONTACT_TIME, friction=FRICTION)
    coarse, middle, fine = (rest(law, 1600, substeps_per_contact=n)[1] for n in (50, 100, 200))
    assert coarse / middle > 2.5
    assert middle / fine > 3.0


def test_a_heap_of_hard_spheres_is_at_rest_to_round_off():
    energies, way, _ = rest(HardSphere(0.5, friction=FRICTION, rest_speed=1e-3), 400)
    assert energies.max() < 1e-20
    assert way < 1e-10
