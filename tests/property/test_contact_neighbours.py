"""Cell lists find exactly what a comparison of all with all finds."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from rdpm.contacts import nearest_gaps
from rdpm.contacts.neighbours import Neighbours
from rdpm.conventions import NO_NEIGHBOUR
from rdpm.grid import Box
from rdpm.particles.state import Bodies


def all_gaps(bodies, box):
    r = bodies.position[None, :, :] - bodies.position[:, None, :]
    size = np.asarray(box.size)
    r = np.where(box.is_periodic, (r + 0.5 * size) % size - 0.5 * size, r)
    radius = 0.5 * bodies.diameter
    return np.sqrt((r**2).sum(-1)) - radius[:, None] - radius[None, :]


def face_gaps(bodies, box):
    low = bodies.position - 0.5 * bodies.diameter[:, None]
    high = np.asarray(box.size) - bodies.position - 0.5 * bodies.diameter[:, None]
    gaps = np.stack([low, high], -1).reshape(len(bodies), 6)
    return np.where(np.repeat(box.is_periodic, 2), np.inf, gaps)


@st.composite
def crowds(draw):
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    size = tuple(float(x) for x in rng.uniform(1.0, 12.0, 3))
    periodic = draw(st.tuples(*[st.booleans()] * 3))
    count = draw(st.integers(1, 120))
    d = rng.uniform(0.05, draw(st.sampled_from([0.1, 0.49])), count)
    bodies = Bodies(d, np.ones(count), rng.uniform(0.0, size, (count, 3)))
    return bodies, Box(size, tuple("periodic" if p else "wall" for p in periodic))


@settings(max_examples=60, deadline=None, derandomize=True)
@given(crowd=crowds(), reach=st.floats(0.0, 0.4), fixed=st.booleans())
def test_pairs_are_those_of_brute_force(crowd, reach, fixed):
    bodies, box = crowd
    n = len(bodies)
    inverse_mass = np.where((np.arange(n) % 3 == 0) & fixed, 0.0, 1.0)
    pairs = Neighbours(bodies, box).pairs(np.zeros((n, 3)), inverse_mass, 1.0, reach)
    moves = inverse_mass > 0.0
    i, j = np.nonzero(np.triu(all_gaps(bodies, box) <= reach, 1) & (moves[:, None] | moves[None, :]))
    body, face = np.nonzero((face_gaps(bodies, box) <= reach) & moves[:, None])
    expected = sorted([*zip(i, j, strict=True), *zip(body, -1 - face, strict=True)])
    assert [tuple(p) for p in pairs.tolist()] == expected


@settings(max_examples=60, deadline=None, derandomize=True)
@given(crowd=crowds())
def test_nearest_surface_is_that_of_brute_force(crowd):
    bodies, box = crowd
    gap, neighbour = nearest_gaps(bodies, box)
    spheres = all_gaps(bodies, box)
    np.fill_diagonal(spheres, np.inf)
    every = np.concatenate([spheres, face_gaps(bodies, box)], axis=1)
    np.testing.assert_allclose(gap, every.min(1), rtol=1e-12, atol=1e-12)
    ids = np.concatenate([np.arange(len(bodies)), -1 - np.arange(6)])
    expected = np.where(np.isinf(gap), NO_NEIGHBOUR, ids[every.argmin(1)])
    np.testing.assert_array_equal(neighbour, expected)
