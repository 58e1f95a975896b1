"""Bodies across slabs move as in a whole box."""

import numpy as np
import pytest

import rdpm
from builders import D, in_oil, oil_case
from rdpm.errors import CaseError
from rdpm.parallel.decomposition import cut
from rdpm.parallel.ranks import ALONE
from rdpm.particles import sharing
from thread_ranks import on_ranks

STEPS = 30

BIG = {"diameter": 0.03, "density": 1120.0, "centers": [[0.03, 0.03, 0.045]], "velocity": [0.0, 0.05, 0.1]}
SMALL = {"diameter": 0.012, "density": 2000.0, "centers": [[0.02, 0.045, 0.009], [0.02, 0.015, 0.083]],
         "velocity": [0.0, 0.02, -0.3]}  # fmt: skip
HELD = {"diameter": 0.01, "density": 2000.0, "centers": [[0.05, 0.01, 0.07]], "motion": "fixed"}
PERIODIC = {"x": "wall", "y": "periodic", "z": "periodic"}
MOVING = {"x_lower": [0.0, 0.0, 0.2]}


def advanced(case, ranks, steps: int = STEPS):
    sim = rdpm.Simulation(case, threads=1, ranks=ranks)
    for _ in range(steps):
        sim.advance()
    return sim


CASES = {
    "through the seam, larger than a slab": dict(bodies=[BIG, SMALL, HELD], domain__boundary=PERIODIC),
    "moving wall, any step": dict(bodies=[BIG, SMALL], domain__wall_velocity=MOVING, time__step="adaptive"),
    "within walls": dict(
        bodies=[BIG, SMALL],
        domain__boundary=PERIODIC,
        walls=[
            {"shape": "cylinder", "point": [0.03, 0.03, 0.0], "axis": [0.0, 0.0, 1.0], "diameter": 0.054},
        ],
    ),
    "by stages": dict(bodies=[BIG, SMALL], domain__boundary=PERIODIC, time__diffusion="stabilised"),
}


@pytest.mark.parametrize("changes", CASES.values(), ids=CASES.keys())
def test_spheres_on_slabs_move_as_on_one_rank(changes) -> None:
    case = rdpm.load_case(oil_case(resolution__cells_per_diameter=4, **changes))
    one = advanced(case, ALONE)
    speed = np.abs(one.bodies.velocity).max()
    for count in (2, 3):
        parts = on_ranks(count, lambda ranks: advanced(case, ranks))
        holders = sum(0 in sim.system.immersed.here for sim in parts)
        assert holders == count, "the big sphere touches every slab"
        for sim in parts:
            assert sim.time == one.time
            np.testing.assert_array_equal(sim.bodies.velocity, parts[0].bodies.velocity)
            np.testing.assert_allclose(sim.bodies.position, one.bodies.position, rtol=0.0, atol=1e-12 * D)
            np.testing.assert_allclose(sim.bodies.velocity, one.bodies.velocity, rtol=0.0, atol=1e-11 * speed)
            slip = sim.bodies.angular_velocity - one.bodies.angular_velocity
            assert np.abs(slip).max() * D < 1e-11 * speed
            force, expected = (s.system.immersed.hydrodynamic_force for s in (sim, one))
            np.testing.assert_allclose(force, expected, rtol=0.0, atol=1e-10 * np.abs(expected).max())
            take = sim.fluid.grid.slab.take
            for name in ("u", "v", "w"):
                mine, whole = getattr(sim.fluid, name)[1:-1], getattr(one.fluid, name)[take][1:-1]
                np.testing.assert_allclose(
                    mine[:, 1:-1, 1:-1], whole[:, 1:-1, 1:-1], rtol=0.0, atol=1e-11 * np.abs(whole).max()
                )


def test_a_sphere_takes_its_lagged_forces_to_the_next_slab() -> None:
    """It falls from the upper slab through the interface into the lower one."""
    fast = {"diameter": D, "density": 8000.0, "centers": [[0.03, 0.03, 0.12]], "velocity": [0.0, 0.0, -1.2]}
    made = oil_case(bodies=[fast], domain__size=[0.06, 0.06, 0.15], resolution__cells_per_diameter=4, time__step=1.5e-3)
    case = rdpm.load_case(made)
    one = advanced(case, ALONE, 60)

    def fall(ranks):
        sim = rdpm.Simulation(case, threads=1, ranks=ranks)
        begin = len(sim.system.immersed.here)
        for _ in range(60):
            sim.advance()
        return sim, begin

    (lower, begin_lower), (upper, begin_upper) = on_ranks(2, fall)
    assert (begin_lower, begin_upper) == (0, 1)
    assert (len(lower.system.immersed.here), len(upper.system.immersed.here)) == (1, 0)
    np.testing.assert_allclose(lower.bodies.velocity, one.bodies.velocity, rtol=0.0, atol=1e-12)


def test_results_do_not_depend_on_which_other_markers_a_rank_holds(monkeypatch) -> None:
    """As after a resumption: who holds the markers was then found at another step."""
    spun = BIG | {"velocity": [0.0, 0.1, 0.6], "angular_velocity": [5.0, 30.0, 9.0]}
    case = rdpm.load_case(oil_case(resolution__cells_per_diameter=8, bodies=[spun], domain__boundary=PERIODIC))
    found = []
    for skin in (0.2, 1.0):
        monkeypatch.setattr(sharing, "SKIN", skin)
        monkeypatch.setattr(sharing.held_markers, "__defaults__", (skin,))
        renewed = []
        renew = sharing.Sharing.renew
        with monkeypatch.context() as patch:
            patch.setattr(sharing.Sharing, "renew", lambda *a, of=renewed, do=renew: of.append(1) or do(*a))
            found.append((on_ranks(3, lambda ranks: advanced(case, ranks)), len(renewed)))
    (often, more), (seldom, fewer) = found
    assert more > fewer
    for one, other in zip(often, seldom, strict=True):
        for name in ("position", "velocity", "angular_velocity"):
            np.testing.assert_array_equal(getattr(one.bodies, name), getattr(other.bodies, name))
        assert one.system.immersed.slip == other.system.immersed.slip
        np.testing.assert_array_equal(one.fluid.u[1:-1], other.fluid.u[1:-1])


def test_more_ranks_than_slabs_are_refused() -> None:
    with pytest.raises(CaseError, match=r"8 MPI ranks: must be at most 3 \(the box has 24 planes"):
        on_ranks(8, lambda ranks: in_oil(ranks=ranks, resolution__cells_per_diameter=4))


def test_planes_are_cut_by_the_cost_of_cells_and_markers() -> None:
    """A bed at the bottom: the lowest slab is the thinnest, and the costs are even."""
    case = oil_case(bodies=[BIG | {"centers": [[0.03, 0.03, 0.016]]}], resolution__cells_per_diameter=8)
    parts = on_ranks(2, lambda ranks: rdpm.Simulation(rdpm.load_case(case), threads=1, ranks=ranks))
    lower, upper = (sim.fluid.grid.slab.planes for sim in parts)
    assert lower < upper
    cost = np.ones(100)
    cost[:20] = 9.0
    found = cut(cost, 4)
    loads = np.add.reduceat(cost, np.cumsum([0, *found[:-1]]))
    assert sum(found) == 100
    assert found[0] == 8  # the thinnest there may be
    assert loads.max() < 1.2 * loads.mean()


def test_a_sphere_in_a_stream_across_slabs() -> None:
    case = rdpm.load_case("stream", {"resolution.cells_per_diameter": 4})
    one = advanced(case, ALONE)
    expected = one.system.immersed.hydrodynamic_force
    for sim in on_ranks(2, lambda ranks: advanced(case, ranks)):
        assert len(sim.system.immersed.here) == 1
        force = sim.system.immersed.hydrodynamic_force
        np.testing.assert_allclose(force, expected, rtol=0.0, atol=1e-10 * np.abs(expected).max())
        np.testing.assert_allclose(sim.fluid.u[1:-1], one.fluid.u[sim.fluid.grid.slab.take][1:-1], atol=1e-12)


def test_flow_past_walls_alone_and_the_force_of_a_ramp() -> None:
    """No bodies; a plane that slides and crosses all slabs."""
    ramp = {"shape": "plane", "point": [0.03, 0.03, 0.02], "normal": [-0.5, 0.0, 1.0], "velocity": [0.05, 0.02, 0.025]}
    case = rdpm.load_case(
        oil_case(bodies=[], contact=None, walls=[ramp], resolution={"cells": [24, 24, 36]}, time__step=1e-3)
    )
    one = advanced(case, ALONE, 10)
    for count in (2, 3):
        for sim in on_ranks(count, lambda ranks: advanced(case, ranks, 10)):
            take, w = sim.fluid.grid.slab.take, one.fluid.w
            np.testing.assert_allclose(sim.fluid.w[1:-1], w[take][1:-1], rtol=0.0, atol=1e-11 * np.abs(w).max())
            force = one.system.force_on_fluid
            np.testing.assert_allclose(sim.system.force_on_fluid, force, rtol=1e-10)
