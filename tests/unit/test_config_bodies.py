"""Bodies one by one: lists, lattices, packings, files, and whether they fit."""

import numpy as np
import pytest

from rdpm.config.cells import Placed
from rdpm.config.load import load_case
from rdpm.config.overlaps import first_overlap
from rdpm.config.packing import place_at_random
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


def test_equal_spheres_keep_the_places_of_their_seed():
    """Numbers of the first version: a seed stands in published cases."""
    given = {"diameter": 0.02, "density": 1, "packing": {"count": 300, "seed": 4}}
    found = case(given, boundary="periodic").expanded_bodies().position
    assert found[[0, 150, 299]].tolist() == [
        [0.18861122111447354, 0.10226551056287232, 0.19524874114154084],
        [0.13407140086316133, 0.02405840263407426, 0.13345095152971623],
        [0.10310555408532696, 0.06545008057053313, 0.16983348980415766],
    ]


@pytest.mark.parametrize("periodic", [True, False])
def test_packing_of_a_decade_of_sizes_keeps_its_gaps(periodic):
    rng, count = np.random.default_rng(2), 600
    diameter = np.exp(rng.uniform(np.log(0.002), np.log(0.02), count))
    box, walls = np.array([0.12, 0.13, 0.11]), np.array([periodic] * 3)
    balls = rng.random((20, 3)) * box, np.full(20, 0.001)
    places = place_at_random(diameter, box, walls, 1e-5, 3, balls)
    found = gaps(np.concatenate([places, balls[0]]), np.concatenate([diameter, balls[1]]), box, walls)
    between = count * (count - 1) // 2  # the given ones may lie as they like
    to_balls = [found[between + n * count + n * (n - 1) // 2 :][:count] for n in range(20)]
    assert np.concatenate([found[:between], *to_balls]).min() > 1e-5 * (1 - 1e-9)


def test_a_slightly_larger_sphere_is_seen_two_cells_away():
    """Sizes side by side may lie in two octaves; cells are made for the larger."""
    box, walls, d = np.full(3, 12 * 2.0**-6), np.zeros(3, bool), 2.0**-6
    placed = Placed(box, walls, 0.0, np.append(np.full(300, d), 1.05 * d), (np.empty((0, 3)), np.empty(0)))
    placed.add(np.array([[0.999 * d, 3.5 * d, 3.5 * d]]), np.array([d]))
    tried = np.array([[2.001 * d, 3.5 * d, 3.5 * d], [2.025 * d, 3.5 * d, 3.5 * d]])
    assert placed.is_free(tried, np.full(2, 1.05 * d)).tolist() == [False, True]


def test_work_of_a_packing_grows_as_its_bodies(monkeypatch):
    """Pairs looked at a body, of different sizes: as many in a box of eight times the volume."""
    looked = []

    def counted(self, position, diameter, others, sizes, was=Placed._meets):
        looked.append(len(position))
        return was(self, position, diameter, others, sizes)

    monkeypatch.setattr(Placed, "_meets", counted)
    work = []
    for count, side in ((1000, 0.1), (8000, 0.2)):
        looked.clear()
        diameter = np.random.default_rng(5).uniform(0.003, 0.01, count)
        place_at_random(
            diameter, np.full(3, side), np.ones(3, bool), 0.0, 1, (np.empty((0, 3)), np.empty(0))
        )
        work.append(sum(looked) / count)
    assert work[1] < 1.5 * work[0]


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


def test_a_touch_among_many_hides_no_overlap():
    """Spheres that touch to round-off, and two larger ones that overlap by a fifth with others nearer: 411 in all."""
    grid = np.stack(np.meshgrid(*[np.arange(8)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    small = (0.1 + 0.02 * grid)[:409]
    small[1] = small[0] + [0.0, 0.0, 0.01 * (1 - 1e-12)]
    small[2:4] = [[0.444, 0.5, 0.5], [0.636, 0.5, 0.5]]
    large = np.array([[0.5, 0.5, 0.5], [0.58, 0.5, 0.5]])
    position, diameter = np.concatenate([small, large]), np.repeat([0.01, 0.1], [409, 2])
    found = first_overlap(position, diameter, np.ones(3), np.zeros(3, bool), 1e-9)
    assert found is not None
    assert found[:2] == (409, 410)
    assert found[2] == pytest.approx(-0.02)


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
