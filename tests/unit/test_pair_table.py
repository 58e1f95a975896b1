"""The table of pairs: what a law knows of each, its parameters, and what the pairs remember."""

import numpy as np

from rdpm.contacts import Lubrication, SoftSphere
from rdpm.contacts.history import History
from rdpm.contacts.pair_table import KindParameters, PairTable, pairs_of
from rdpm.contacts.rows import APART, TOUCHING
from rdpm.grid import Box
from rdpm.particles.state import PRESCRIBED, Bodies

BOX = Box((1.0, 1.0, 1.0), ("periodic", "wall", "free-slip"))
LAW = SoftSphere.from_contact_time(0.7, 1e-3, "zero-overlap", friction=0.3)


def spheres(diameter, density=1000.0, **more) -> Bodies:
    diameter = np.asarray(diameter, float)
    return Bodies(diameter, np.full(diameter.size, density), np.full((diameter.size, 3), 0.5), **more)


def table_of(bodies, ids, law=LAW, kinds=None, lubrication=None) -> PairTable:
    return PairTable(np.array(ids, np.int32), bodies, BOX, law, kinds or KindParameters(bodies, law), lubrication)


class Counting:
    """The soft sphere; remembers of how many pairs it was asked."""

    driver = LAW.driver
    time_scale = LAW.time_scale

    def __init__(self):
        self.asked = []

    def parameters(self, pairs):
        self.asked.append(len(pairs))
        return LAW.parameters(pairs)


def test_reduced_mass_and_radius_by_hand():
    bodies = spheres([0.1, 0.2, 0.2], motion=np.array([0, 0, PRESCRIBED]))
    pairs = pairs_of(bodies, BOX, np.array([[0, -3], [0, -5], [0, 1], [1, 2]], np.int32))
    m, heavy = bodies.mass[:2]
    np.testing.assert_allclose(pairs["reduced_mass"], [m, m, m * heavy / (m + heavy), heavy], rtol=1e-14)
    np.testing.assert_allclose(pairs["reduced_radius"], [0.05, 0.05, 0.05 * 0.1 / 0.15, 0.05], rtol=1e-14)
    assert pairs["smaller_diameter"].tolist() == [0.1, 0.1, 0.1, 0.2]
    assert pairs["is_frictionless"].tolist() == [False, True, False, False]


def test_a_free_slip_face_has_neither_friction_nor_lubrication():
    bodies = spheres([0.1])
    table = table_of(bodies, [[0, -3], [0, -5]], lubrication=Lubrication(1e-3, 0.01))
    assert table.parameters["mu"].tolist() == [0.3, 0.0]
    assert table.parameters["k_t"][0] > 0.0 == table.parameters["k_t"][1]
    assert table.parameters["k_n"][0] == table.parameters["k_n"][1]
    assert table.lubrication["cutoff_gap"].tolist() == [0.01, 0.0]


def test_the_law_is_asked_once_a_kind():
    bodies, law = spheres([0.1] * 20 + [0.2] * 20), Counting()
    kinds = KindParameters(bodies, law)
    ids = [[i, j] for i in range(40) for j in (-3, *range(i + 1, 40))]
    table = table_of(bodies, ids, law, kinds)
    assert law.asked == [5]
    np.testing.assert_array_equal(table.parameters, LAW.parameters(table.pairs))
    np.testing.assert_array_equal(table.times, LAW.time_scale(table.pairs))
    table_of(bodies, ids[::7], law, kinds)
    assert law.asked == [5]
    bodies.motion[0] = PRESCRIBED  # two kinds more: it with a light, with a heavy sphere
    np.testing.assert_array_equal(
        table_of(bodies, ids[1:], law, kinds).parameters, LAW.parameters(pairs_of(bodies, BOX, np.array(ids[1:])))
    )
    assert law.asked == [5, 2]


def test_kinds_without_end_are_forgotten_and_still_right():
    bodies = spheres(np.linspace(0.01, 0.02, 80))
    kinds = KindParameters(bodies, LAW)
    for i in range(79):
        table = table_of(bodies, [[i, j] for j in range(i + 1, 80)], kinds=kinds)
        np.testing.assert_array_equal(table.parameters, LAW.parameters(table.pairs))
        assert len(kinds._keys) <= 1000 + 5 * 80


def test_history_follows_its_pair_into_another_table():
    bodies = spheres([0.1] * 4)
    one = table_of(bodies, [[0, -3], [0, 1], [2, 3]])
    one.state["phase"][1:], one.state["overlap"][1:] = TOUCHING, [1e-3, 2e-3]
    one.history["xi"][1:] = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]
    history = History(4, LAW.driver.history)
    history.restore(one.ids[[1, 2]], one.state[1:], one.history[1:])
    assert len(history) == 2
    assert history.largest_overlap == 2e-3
    other = table_of(bodies, [[0, 2], [0, 1]])  # in any order
    lost, states = history.carry_to(other)
    assert lost.tolist() == [[2, 3]]
    assert states["overlap"].tolist() == [2e-3]
    assert history.rows()[0].tolist() == [[0, 1]]
    assert other.state["phase"].tolist() == [APART, TOUCHING]
    assert other.history["xi"].tolist() == [[0.0, 0.0, 0.0], [1.0, 2.0, 3.0]]
