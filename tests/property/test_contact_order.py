"""The order in which pairs act follows from where the bodies are: neither their numbers nor threads matter."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rdpm.contacts import (
    Contacts,
    HardSphere,
    Hertz,
    Lubrication,
    Repulsive,
    SoftSphere,
    TangentialLubrication,
    substeps,
)
from rdpm.contacts.neighbour_list import NeighbourList
from rdpm.contacts.rows import STATE
from rdpm.grid import Box
from rdpm.particles.state import Bodies

CONTACT_TIME = 8e-4
DT = CONTACT_TIME / 8
D = 5e-3
LAWS = {
    "soft sphere": SoftSphere.from_contact_time(0.8, CONTACT_TIME, friction=0.4),
    "soft sphere, wet": SoftSphere.from_contact_time(0.8, CONTACT_TIME, friction=0.4),
    "hertz": Hertz(1e6, 0.3, 0.8, 0.2, friction=0.4),
    "repulsive": Repulsive(stiffness=0.05, range=5e-5),
    "hard sphere": HardSphere(0.8, friction=0.4, rest_speed=1e-3),
}
NAMES = ("position", "velocity", "angular_velocity", "orientation", "crossings")
ALL_THREADS = pytest.mark.parametrize("threads", [1, 2, 3])


def bed(numbers: np.ndarray, sizes: tuple[float, float] = (0.8, 1.0), seed: int = 5) -> tuple[Bodies, np.ndarray]:
    """Spheres close to each other in disorder, in the order of `numbers`, and their spacing."""
    rng = np.random.default_rng(seed)
    count = len(numbers)
    n = round(count ** (1 / 3))
    spacing = 1.08 * D
    place = (np.stack(np.meshgrid(*[np.arange(n)] * 3), -1).reshape(-1, 3) + 0.5) * spacing
    place += rng.uniform(-0.03, 0.03, place.shape) * D
    size, density = rng.uniform(*sizes, count) * D, rng.uniform(1000.0, 3000.0, count)
    velocity, spin = rng.normal(0.0, 0.15, place.shape), rng.normal(0.0, 10.0, place.shape)
    length = np.full(3, n * spacing)
    return Bodies(size[numbers], density[numbers], place[numbers], velocity[numbers], spin[numbers]), length


def moved(law: str, numbers: np.ndarray, periodic: bool, steps: int, threads: int = 1) -> tuple[Bodies, Contacts]:
    bodies, length = bed(numbers)
    box = Box(tuple(length), ("periodic" if periodic else "wall",) * 3)
    gaps = (0.05 * D, 0.02 * D)
    tangential = TangentialLubrication(gaps, gaps, gaps, 0.5 * D)
    lubrication = Lubrication(1e-3, 0.05 * D, tangential=tangential) if "wet" in law else None
    contacts = Contacts(bodies, box, LAWS[law], lubrication, overlap_limit=0.5, threads=threads)
    weight, none = bodies.mass[:, None] * [0.0, 0.0, -9.81], np.zeros_like(bodies.position)
    for step in range(steps):
        contacts.advance(step * DT, DT, weight, none)
    return bodies, contacts


@pytest.mark.parametrize("periodic", [True, False])
@pytest.mark.parametrize("law", LAWS)
def test_bodies_of_other_numbers_move_the_same_to_the_last_bit(law, periodic):
    count, steps = 216, 60
    numbers = np.random.default_rng(1).permutation(count)
    one, contacts = moved(law, np.arange(count), periodic, steps)
    other, _ = moved(law, numbers, periodic, steps)
    assert law == "repulsive" or len(contacts.take_episodes()) > 100
    for name in NAMES:
        np.testing.assert_array_equal(getattr(other, name), getattr(one, name)[numbers], err_msg=name)


@ALL_THREADS
def test_any_number_of_threads_gives_the_same_bits(threads, monkeypatch):
    monkeypatch.setattr(substeps, "PARALLEL_PAIRS", 0)
    numbers = np.arange(1000)
    one, alone = moved("soft sphere", numbers, True, 10, 1)
    other, contacts = moved("soft sphere", numbers, True, 10, threads)
    for name in NAMES:
        np.testing.assert_array_equal(getattr(other, name), getattr(one, name), err_msg=name)
    np.testing.assert_array_equal(contacts.take_episodes(), alone.take_episodes())


def test_a_bed_resumed_between_two_lists_is_bit_identical():
    """The order of the pairs is that of the places at the last listing: it goes on where it was saved."""
    numbers = np.arange(216)
    saved, half = None, None
    bodies, length = bed(numbers)
    box, none = Box(tuple(length), ("periodic",) * 3), np.zeros_like(bodies.position)
    contacts = Contacts(bodies, box, LAWS["soft sphere"], overlap_limit=0.5)
    for step in range(40):
        if step == 17:
            saved, half = contacts.state(), {name: values.copy() for name, values in bodies.state().items()}
            assert np.any(saved["neighbours/position"] != bodies.position)
        contacts.advance(step * DT, DT, none, none)
    again, _ = bed(numbers)
    again.restore(half)
    resumed = Contacts(again, box, LAWS["soft sphere"], overlap_limit=0.5)
    resumed.restore(saved)
    for step in range(17, 40):
        resumed.advance(step * DT, DT, none, none)
    for name in NAMES:
        np.testing.assert_array_equal(getattr(again, name), getattr(bodies, name), err_msg=name)
    for name, values in contacts.state().items():
        np.testing.assert_array_equal(resumed.state()[name], values, err_msg=name)


def brute_force(bodies: Bodies, box: Box, reach: float) -> set[tuple[int, int]]:
    r = bodies.position[None] - bodies.position[:, None]
    size = np.asarray(box.size)
    r = np.where(box.is_periodic, (r + 0.5 * size) % size - 0.5 * size, r)
    a = 0.5 * bodies.diameter
    i, j = np.nonzero(np.triu(np.sqrt((r**2).sum(-1)) - a[:, None] - a <= reach, 1))
    low, high = bodies.position - a[:, None], size - bodies.position - a[:, None]
    faces = np.where(np.repeat(box.is_periodic, 2), np.inf, np.stack([low, high], -1).reshape(len(a), 6))
    body, face = np.nonzero(faces <= reach)
    return {*zip(i.tolist(), j.tolist(), strict=True), *zip(body.tolist(), (-1 - face).tolist(), strict=True)}


@settings(max_examples=40, deadline=None, derandomize=True)
@given(seed=st.integers(0, 2**32 - 1), periodic=st.tuples(*[st.booleans()] * 3), speed=st.sampled_from([0.01, 0.3]))
def test_a_list_of_spheres_of_ten_sizes_loses_no_pair(seed, periodic, speed):
    """Each body its own size, the largest ten times the smallest; the list is kept while they move."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 150))
    size = tuple(rng.uniform(2.1, 6.0, 3))
    diameter = 10.0 ** rng.uniform(-1.0, 0.0, count)
    velocity = speed * rng.standard_normal((count, 3))
    bodies = Bodies(diameter, np.ones(count), rng.uniform(0.0, size, (count, 3)), velocity)
    box = Box(size, tuple("periodic" if p else "wall" for p in periodic))
    pairs, force, inverse_mass, dt = NeighbourList(bodies, box), np.zeros((count, 3)), np.ones(count), 0.02
    lists = 0
    for _ in range(8):
        reach, is_new = pairs.update(force, inverse_mass, dt, 0.0)
        lists += is_new
        chosen = pairs.select(reach, np.ones(len(pairs.ids)), np.zeros(len(pairs.ids), STATE))
        found = [tuple(pair) for pair in pairs.ids[chosen.rows].tolist()]
        assert set(found) == brute_force(bodies, box, reach)
        assert len(set(found)) == len(found)
        _check_bands(chosen)
        bodies.position += dt * bodies.velocity
        bodies.position[:, periodic] %= np.asarray(size)[list(periodic)]
    assert lists < 8 or speed > 0.1


def _check_bands(chosen) -> None:
    """Every pair once; bands of one colour share no body; bodies are named as in the list."""
    covered = [n for first, end in chosen.bands.tolist() for n in range(first, end)]
    assert sorted(covered) == list(range(len(chosen)))
    for colour in (chosen.bands[: chosen.even_bands], chosen.bands[chosen.even_bands :]):
        owners: dict[int, int] = {}
        for band, (first, end) in enumerate(colour.tolist()):
            for body in chosen.local[first:end].ravel().tolist():
                assert body < 0 or owners.setdefault(body, band) == band


def test_pairs_are_listed_anew_only_when_a_body_has_moved_far():
    bodies, length = bed(np.arange(64))
    box, none, ones = Box(tuple(length)), np.zeros((64, 3)), np.ones(64)
    bodies.velocity[:] = 0.0
    pairs = NeighbourList(bodies, box)
    assert pairs.update(none, ones, DT, 0.0)[1]
    assert not pairs.update(none, ones, DT, 0.0)[1]
    bodies.position[3, 0] += 0.02 * bodies.diameter.min() / 2.1  # two of them together just within what it allows for
    assert not pairs.update(none, ones, DT, 0.0)[1]
    bodies.position[3, 0] += 0.001 * D
    assert pairs.update(none, ones, DT, 0.0)[1]
    bodies.motion[5] = 1
    assert pairs.update(none, ones, DT, 0.0)[1]
