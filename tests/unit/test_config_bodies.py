"""Bodies one by one: lists, lattices, packings, files, and whether they fit."""

import numpy as np
import pytest

from rdpm.config.load import load_case
from rdpm.config.overlaps import first_overlap
from rdpm.errors import CaseError

BOX = 0.2


def case(*groups, boundary="wall", overrides=()):
    return load_case(
        {
            "domain": {"size": [BOX] * 3, "boundary": dict.fromkeys("xyz", boundary)},
            "bodies": list(groups),
            "contact": {"stiffness": 1000, "restitution": 0.9},
            "time": {"end": 1},
        },
        overrides,
    )


def gaps(position, diameter, box, periodic):
    """All gaps between surfaces, without a tree."""
    found = []
    for i in range(1, len(diameter)):
        d = position[i] - position[:i]
        d -= np.where(periodic, box * np.round(d / box), 0.0)
        found += list(np.sqrt((d**2).sum(axis=1)) - 0.5 * (diameter[i] + diameter[:i]))
    return np.array(found)


def test_groups_in_order_with_their_own_values():
    table = case(
        {
            "diameter": [0.01, 0.02],
            "density": 2000,
            "centers": [[0.05] * 3, [0.1] * 3],
            "velocity": [[1, 0, 0], [0, 1, 0]],
            "angular_velocity": [0, 0, "10 rad/s"],
        },
        {"diameter": 0.01, "density": 3000, "centers": [[0.15] * 3], "motion": "fixed"},
        {
            "diameter": 0.01,
            "density": 3000,
            "centers": [[0.15, 0.15, 0.05]],
            "motion": {"velocity": [0, 0, 0.5], "until": "1 s"},
        },
    ).expanded_bodies()
    assert len(table) == 4
    assert table.diameter.tolist() == [0.01, 0.02, 0.01, 0.01]
    assert table.density.tolist() == [2000, 2000, 3000, 3000]
    assert table.group.tolist() == [0, 0, 1, 2]
    assert table.velocity.tolist() == [[1, 0, 0], [0, 1, 0], [0, 0, 0], [0, 0, 0.5]]
    assert table.angular_velocity[:2].tolist() == [[0, 0, 10]] * 2
    assert table.motion[:3] == ("free", "free", "fixed")
    assert table.motion[3].until == 1.0
    with pytest.raises(ValueError, match="read-only"):
        table.position[0] = 0.0


def test_lattice_x_fastest():
    table = case(
        {"diameter": 0.01, "density": 1, "lattice": {"counts": [3, 2, 1], "spacing": [0.02, 0.03, 0.04]}}
    )
    expected = [[0.01, 0.015, 0.02], [0.03, 0.015, 0.02], [0.05, 0.015, 0.02]]
    assert np.allclose(table.expanded_bodies().position[:3], expected, rtol=1e-14)


def test_jitter_stays_within_its_bound_and_repeats_with_its_seed():
    def lattice(seed, jitter):
        given = {"counts": [4, 4, 4], "spacing": ["4 cm"] * 3, "jitter": jitter, "seed": seed}
        return case({"diameter": 0.02, "density": 1, "lattice": given}).expanded_bodies().position

    moved = lattice(1, "5 mm") - lattice(1, 0)
    assert 0.004 < np.abs(moved).max() <= 0.005
    assert (lattice(1, "5 mm") == lattice(1, "5 mm")).all()
    assert (lattice(1, "5 mm") != lattice(2, "5 mm")).any()


@pytest.mark.parametrize("boundary", ["wall", "periodic"])
def test_packing_keeps_its_gaps(boundary):
    gap = 1e-3
    given = {
        "diameter": [0.05] + [0.02] * 30 + [0.012] * 60,
        "density": 1,
        "packing": {"count": 91, "seed": 4, "min_gap": gap},
    }
    ball = {"diameter": 0.08, "density": 1, "centers": [[0.1] * 3]}
    table = case(given, ball, boundary=boundary).expanded_bodies()
    assert gaps(table.position, table.diameter, BOX, boundary == "periodic").min() > gap * (1 - 1e-9)
    if boundary == "wall":
        reach = 0.5 * table.diameter[:, None] + gap
        packed = table.group == 0
        assert (table.position >= reach - 1e-12)[packed].all()
        assert (table.position <= BOX - reach + 1e-12)[packed].all()
    assert (case(given, ball, boundary=boundary).expanded_bodies().position == table.position).all()


def test_solid_fraction_gives_the_count():
    table = case({"diameter": 0.02, "density": 1, "packing": {"solid_fraction": 0.1}}).expanded_bodies()
    assert len(table) == round(0.1 * BOX**3 / (np.pi / 6 * 0.02**3))


def test_packing_that_cannot_fit():
    with pytest.raises(CaseError, match=r"must fill at most 0\.38 of the box, not 0\.5"):
        case({"diameter": 0.02, "density": 1, "packing": {"solid_fraction": 0.5}})
    with pytest.raises(CaseError, match="tries in a row failed"):
        case({"diameter": 0.05, "density": 1, "packing": {"solid_fraction": 0.3, "min_gap": "10 mm"}})


def test_overlap_is_found_through_a_periodic_side():
    pair = {"diameter": 0.02, "density": 1, "centers": [[0.005, 0.1, 0.1], [0.19, 0.1, 0.1]]}
    with pytest.raises(
        CaseError, match=r"bodies\[0\]\.centers\[1\]: must not overlap: bodies 0 and 1 .* -0\.005 m"
    ):
        case(pair, boundary="periodic")


def test_touching_is_no_overlap():
    case({"diameter": 0.02, "density": 1, "centers": [[0.05, 0.1, 0.1], [0.07, 0.1, 0.1], [0.01, 0.1, 0.01]]})


@pytest.mark.parametrize("equal", [True, False])
def test_the_tree_finds_what_all_pairs_find(equal):
    rng = np.random.default_rng(7)
    box, periodic = np.array([1.0, 0.8, 0.6]), np.array([True, False, True])
    for _ in range(20):
        position = rng.random((300, 3)) * box
        diameter = np.full(300, 0.012) if equal else rng.uniform(0.002, 0.03, 300)
        slow = gaps(position, diameter, box, periodic)
        found = first_overlap(position, diameter, box, periodic, 0.0)
        assert (found is None) == bool(slow.min() >= 0.0)
        if found is not None:
            i, j, gap = found
            assert i < j
            assert np.isclose(gap, gaps(position[[i, j]], diameter[[i, j]], box, periodic)[0], rtol=1e-12)


def test_bodies_from_a_file(tmp_path):
    (tmp_path / "b.csv").write_text(
        "# made by hand\nx_m,y_m,z_m,diameter_m,u_m_s,v_m_s,w_m_s\n"
        "0.05,0.05,0.05,0.01,0,0,-1\n\n0.1,0.1,0.1,0.02,0,0,-2\n"
    )
    text = """
[domain]
size = [0.2, 0.2, 0.2]
[[bodies]]
file = "b.csv"
density = 2500
[contact]
stiffness = 100
restitution = 0.9
[time]
end = 1
"""
    path = tmp_path / "case.toml"
    path.write_text(text)
    table = load_case(path).expanded_bodies()
    assert table.diameter.tolist() == [0.01, 0.02]
    assert table.position[1].tolist() == [0.1, 0.1, 0.1]
    assert table.velocity[:, 2].tolist() == [-1, -2]
    (tmp_path / "b.csv").write_text("x_m,y_m,z_m,diameter_m\n0.05,0.05,0.05,0.01\n0.05,0.05,0.05,0.01\n")
    with pytest.raises(CaseError, match=r"b\.csv:3: bodies\[0\]\.centers\[1\]: must not overlap"):
        load_case(path)
