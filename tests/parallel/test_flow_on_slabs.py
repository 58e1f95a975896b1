"""The flow on slabs is the flow of the whole box, wherever the box is cut."""

import numpy as np
import pytest

from rdpm.fluid import Fluid
from rdpm.grid import Box, Grid, Inflow
from rdpm.parallel.decomposition import slabs
from thread_ranks import on_ranks

#: Of the largest value: round-off of a few steps.
TOLERANCE = 1e-12

BOUNDARIES = [
    ("periodic", "periodic", "wall"), ("wall", "wall", "wall"), ("periodic", "wall", "periodic"),
    ("wall", "periodic", "free-slip"), ("periodic", "periodic", "periodic"),
]  # fmt: skip
CUTS = [(12, 13), (8, 9, 8), (8, 17), (8, 8, 9, 8)]


def box(boundary, planes: int) -> Box:
    speed = np.zeros((6, 3))
    if boundary[2] == "wall":
        speed[5, 0], speed[4, 1] = 0.3, -0.2
    if boundary[0] == "wall":
        speed[0, 1] = 0.2
    return Box((1.0, 1.1, 0.09 * planes), boundary, speed)


def stepped(grid: Grid, is_explicit: bool, start, **on) -> Fluid:
    """Five steps; by five stages, which need four planes of the other slabs."""
    fluid = Fluid(grid, 1.0, 0.02, is_explicit, **on)
    fluid.set_velocity(*start)
    fluid.project(0.01)
    for _ in range(5):
        fluid.predict(0.01, (0.3, 0.1, -0.2), stages=None if is_explicit else 5)
        fluid.project(0.01)
    return fluid


@pytest.mark.parametrize("is_explicit", [True, False])
@pytest.mark.parametrize("planes", CUTS)
@pytest.mark.parametrize("boundary", BOUNDARIES)
def test_slabs_compute_what_one_rank_computes(boundary, planes, is_explicit: bool) -> None:
    nz = sum(planes)
    of, cells = box(boundary, nz), (6, 10, nz)
    start = np.random.default_rng(1).standard_normal((3, nz + 2, 12, 8))
    one = stepped(Grid(of, cells), is_explicit, start)
    found = slabs(planes, boundary[2] == "periodic")

    def on_slab(ranks):
        # Two threads: the halves of a slab are then eliminated side by side.
        fluid = stepped(Grid(of, cells, 2, found[ranks.rank]), is_explicit, start, ranks=ranks)
        return fluid, fluid.largest_divergence(), fluid.state()

    parts = on_ranks(len(planes), on_slab)
    for slab, (fluid, divergence, state) in zip(found, parts, strict=True):
        for name in ("u", "v", "w", "p"):
            whole, part = getattr(one, name), getattr(fluid, name)
            if name == "p":
                part = part - state["pressure_offset"]
            np.testing.assert_allclose(
                part[1:-1, 1:-1, 1:-1],
                whole[slab.take][1:-1, 1:-1, 1:-1],
                rtol=0.0,
                atol=TOLERANCE * np.abs(whole).max(),
            )
        # All ranks know the same measures, and choose the same step.
        assert fluid.cfl_rate == pytest.approx(one.cfl_rate, rel=TOLERANCE)
        assert (fluid.cfl_rate, fluid.square_sum) == (parts[0][0].cfl_rate, parts[0][0].square_sum)
        assert fluid.kinetic_energy() == pytest.approx(one.kinetic_energy(), rel=TOLERANCE)
        assert divergence < 1e-12 * one.cfl_rate


def test_halos_between_slabs_are_current_after_a_projection() -> None:
    planes, cells = (9, 8), (6, 6, 17)
    found, of = slabs(planes, True), box(("periodic",) * 3, 17)
    start = np.random.default_rng(2).standard_normal((3, 19, 8, 8))
    parts = on_ranks(2, lambda ranks: stepped(Grid(of, cells, 1, found[ranks.rank]), True, start, ranks=ranks))
    for here, there in ((0, 1), (1, 0)):
        for mine, theirs in zip(parts[here].velocity, parts[there].velocity, strict=True):
            np.testing.assert_array_equal(mine[-1], theirs[1])
            np.testing.assert_array_equal(mine[0], theirs[-2])


def test_a_rank_sends_the_planes_of_the_design() -> None:
    """Explicit step of an inner rank: w up, interfaces 4, increment down, u, v, w both ways and p down: 13 planes.

    In four messages to neighbours, and three to each rank: two of interfaces, one of measures.
    """
    planes, n = (8, 8, 8, 8), 16
    found, of = slabs(planes, True), Box((1.0, 1.0, 2.0), ("periodic",) * 3)

    def sent(ranks):
        fluid = Fluid(Grid(of, (n, n, 32), 1, found[ranks.rank]), 1.0, 0.02, True, ranks)
        before = ranks.sent_bytes, ranks.messages
        fluid.predict(0.01, (0.0, 0.0, -0.2))
        fluid.project(0.01)
        return ranks.sent_bytes - before[0], ranks.messages - before[1]

    halos, modes = 9 * 8 * (n + 2) ** 2, 4 * 8 * n**2
    for sent_by_one, messages in on_ranks(4, sent):
        assert messages == 4 + 3 * 3
        # Of the modes a quarter stays; three numbers go to three others.
        assert sent_by_one == halos + modes * 3 // 4 + 3 * 3 * 8


@pytest.mark.parametrize("is_explicit", [True, False])
@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("speed", [0.6, -0.6])
def test_a_stream_through_slabs_is_that_through_the_box(axis: int, speed: float, is_explicit: bool) -> None:
    """Parabolic between walls along or across the slabs, disturbed, and still rising."""
    planes, kinds = (9, 8, 9), ["wall", "wall", "wall"]
    kinds[axis] = "inflow-outflow"
    of = Box((1.0, 1.1, 2.34), tuple(kinds), inflow=Inflow(axis, speed, "parabolic", start_up=0.03))
    cells, found = (6, 10, 26), slabs(planes, False)
    start = 0.3 * np.random.default_rng(3).standard_normal((3, 28, 12, 8))

    def run(grid: Grid, **on) -> Fluid:
        fluid = Fluid(grid, 1.0, 0.02, is_explicit, **on)
        fluid.set_velocity(*start)
        for n in range(6):
            fluid.predict(0.01, (0.3, 0.1, -0.2), stages=None if is_explicit else 4, time=0.01 * n)
            fluid.project(0.01)
        return fluid

    one = run(Grid(of, cells))
    for slab, fluid in zip(
        found, on_ranks(3, lambda ranks: run(Grid(of, cells, 1, found[ranks.rank]), ranks=ranks)), strict=True
    ):
        for name in ("u", "v", "w", "p"):
            whole, part = getattr(one, name), getattr(fluid, name) - (fluid.pressure_offset if name == "p" else 0.0)
            lowest = 0 if name == "w" and slab.lower is None else 1
            np.testing.assert_allclose(
                part[lowest:-1, 1:-1, 1:-1],
                whole[slab.take][lowest:-1, 1:-1, 1:-1],
                rtol=0.0,
                atol=10.0 * TOLERANCE * np.abs(whole).max(),
                err_msg=name,
            )
