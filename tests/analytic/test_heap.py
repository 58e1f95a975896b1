"""A heap at rest: it does not heat, and creeps by no more than the second order of its sub-steps."""

import numpy as np
import pytest

from rdpm.contacts import Contacts, ExtendedContact, HardSphere, Hertz, SoftSphere
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


#: Restitution, sub-steps a contact: creep [m/s]; the table of docs/theory/contacts.md.
CREEP = {(0.5, 50): 4.3e-7, (0.5, 100): 1.4e-7, (0.5, 200): 4.1e-8, (0.9, 100): 2.1e-8, (0.1, 100): 4.7e-7}


@pytest.mark.parametrize(("restitution", "substeps"), CREEP)
def test_a_heap_creeps_as_the_table_says(restitution, substeps):
    """Of second order in the sub-step, and due to the dashpot."""
    law = SoftSphere.from_contact_time(restitution, CONTACT_TIME, friction=FRICTION)
    _, way, _ = rest(law, 2400, substeps_per_contact=substeps)
    assert way * D / (2400 * DT) == pytest.approx(CREEP[restitution, substeps], rel=0.05)


def test_a_heap_of_hard_spheres_is_at_rest_to_round_off():
    energies, way, _ = rest(HardSphere(0.5, friction=FRICTION, rest_speed=1e-3), 400)
    assert energies.max() < 1e-20
    assert way < 1e-10


def pyramid_of_14():
    """Nine, four and one, touching."""
    place = [
        [0.5 + (i + 0.5 * layer - 1.0) * D, 0.5 + (j + 0.5 * layer - 1.0) * D, (0.5 + layer * np.sqrt(0.5)) * D]
        for layer in range(3)
        for i in range(3 - layer)
        for j in range(3 - layer)
    ]
    return Bodies(np.full(14, D), np.full(14, 2500.0), np.array(place))


def spread(law):
    """Way of the fastest of 14 spheres in 0.1 s [d]."""
    heap = pyramid_of_14()
    contacts, first = Contacts(heap, Box((1.0, 1.0, 1.0)), law), heap.position.copy()
    weight, none = -GRAVITY * heap.mass[:, None] * [[0.0, 0.0, 1.0]], np.zeros((14, 3))
    for k in range(800):
        contacts.advance(k * DT, DT, weight, none)
    return float(np.abs(heap.position - first).max()) / D


def test_a_steep_heap_rolls_apart_whatever_the_model_and_rolling_friction_holds_it():
    soft = SoftSphere.from_contact_time(0.5, CONTACT_TIME, friction=0.5)
    ways = spread(soft), spread(HardSphere(0.5, friction=0.5, rest_speed=1e-3))
    assert min(ways) > 0.4
    assert ways[0] == pytest.approx(ways[1], rel=0.02)
    assert spread(ExtendedContact(soft, rolling_friction=0.1)) < 1e-3  # the static overlaps
