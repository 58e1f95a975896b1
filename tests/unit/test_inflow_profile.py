"""What enters: profiles on the grid, the start-up, and what a box and its contacts make of open faces."""

import numpy as np
import pytest

from rdpm.contacts import nearest_gaps
from rdpm.conventions import NO_NEIGHBOUR
from rdpm.errors import CaseError
from rdpm.fluid import Fluid
from rdpm.grid import Box, Grid, Inflow
from rdpm.particles.state import Bodies

NO_WALLS, WALLS = (False,) * 3, (True,) * 3


def test_profiles_have_mean_one_and_their_shape() -> None:
    cells = (4, 6, 8)
    assert np.all(Inflow(1, 0.5).shape(cells, WALLS) == np.ones((8, 4)))
    x, z = (np.arange(4) + 0.5) / 4, (np.arange(8) + 0.5) / 8
    parabola = Inflow(1, 0.5, "parabolic").shape(cells, (True, False, True))
    expected = (x * (1 - x)) * (z * (1 - z))[:, None]
    np.testing.assert_allclose(parabola, expected / expected.mean(), rtol=1e-14)
    sheet = Inflow(1, 0.5, "parabolic").shape(cells, (False, False, True))
    assert np.ptp(sheet, axis=1).max() == 0.0


def test_a_given_profile_is_linear_between_its_points() -> None:
    """A list varies along the first of the other two directions; rows follow the second."""
    hat = Inflow(2, 1.0, np.array([[0.0, 2.0, 0.0]])).shape((4, 2, 9), NO_WALLS)
    np.testing.assert_allclose(hat, [[0.5, 1.5, 1.5, 0.5]] * 2, rtol=1e-14)
    ramp = Inflow(2, 1.0, np.array([[0.0], [1.0]])).shape((3, 4, 9), NO_WALLS)
    np.testing.assert_allclose(ramp, np.array([[0.25], [0.75], [1.25], [1.75]]) * np.ones(3), rtol=1e-14)
    corner = Inflow(2, 1.0, np.array([[0.0, 0.0], [0.0, 1.0]])).shape((2, 2, 9), NO_WALLS)
    np.testing.assert_allclose(corner, [[0.25, 0.75], [0.75, 2.25]], rtol=1e-14)


def test_peaks() -> None:
    assert Inflow(0, -2.0).peak(WALLS) == 1.0
    assert Inflow(0, -2.0, "parabolic").peak((False, True, False)) == 1.5
    assert Inflow(0, -2.0, "parabolic").peak(WALLS) == 2.25
    assert Inflow(0, -2.0, np.array([[0.0, 3.0, 0.0]])).peak(WALLS) == pytest.approx(2.0)


def test_start_up_is_smooth_at_both_ends() -> None:
    inflow = Inflow(0, -0.4, start_up=0.2)
    assert [inflow.speed_at(t) for t in (0.0, 0.1, 0.2, 5.0)] == [0.0, pytest.approx(-0.2), -0.4, -0.4]
    assert abs(inflow.speed_at(1e-4)) < 1e-6
    assert abs(inflow.speed_at(0.2 - 1e-4) + 0.4) < 1e-6


def test_open_faces_and_an_inflow_belong_together() -> None:
    kinds = ("wall", "inflow-outflow", "wall")
    for box in (
        lambda: Box((1.0, 1.0, 1.0), kinds),
        lambda: Box((1.0, 1.0, 1.0), inflow=Inflow(1, 1.0)),
        lambda: Box((1.0, 1.0, 1.0), kinds, inflow=Inflow(0, 1.0)),
        lambda: Box((1.0, 1.0, 1.0), ("inflow-outflow",) * 2 + ("wall",), inflow=Inflow(0, 1.0)),
    ):
        with pytest.raises(CaseError, match="along the inflow, and nowhere else"):
            box()


def test_open_faces_are_no_walls_for_bodies() -> None:
    bodies = Bodies(np.array([1.0]), np.ones(1), np.array([[0.6, 2.0, 2.0]]))
    box = Box((4.0, 4.0, 4.0), ("inflow-outflow", "periodic", "periodic"), inflow=Inflow(0, 1.0))
    gap, neighbour = nearest_gaps(bodies, box)
    assert (gap[0], neighbour[0]) == (np.inf, NO_NEIGHBOUR)
    walled = Box((4.0, 4.0, 4.0), ("inflow-outflow", "wall", "periodic"), inflow=Inflow(0, 1.0))
    assert nearest_gaps(bodies, walled)[0][0] == 1.5


@pytest.mark.parametrize("is_explicit", [True, False])
@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("speed", [1.0, -1.0])
def test_steps_are_bit_identical_on_any_number_of_threads(axis: int, speed: float, is_explicit: bool) -> None:
    """A disturbed stream; the same in a box turned to another direction, and mirrored, to round-off."""
    flows = []
    for threads, along, sign in ((1, axis, speed), (2, axis, speed), (3, axis, speed), (1, 2, 1.0)):
        kinds, cells, size = ["wall", "free-slip"], [8, 10], [0.8, 1.0]
        kinds.insert(along, "inflow-outflow"), cells.insert(along, 12), size.insert(along, 1.2)
        grid = Grid(Box(tuple(size), tuple(kinds), inflow=Inflow(along, sign)), tuple(cells), threads)
        fluid = Fluid(grid, 1.0, 0.01, is_explicit)
        noise = np.random.default_rng(4).normal(size=(3, 14, 12, 10))  # along, second, first
        noise[0, -1] = 0.0  # beyond the outflow
        fields = [None] * 3
        for component, place in zip(noise, (along, *(d for d in range(3) if d != along)), strict=True):
            fields[place] = np.moveaxis(component, 0, 2 - along)
        if sign < 0.0:
            fields[along] = -np.roll(np.flip(fields[along], 2 - along), -1, 2 - along)
            for place in range(3):
                if place != along:
                    fields[place] = np.flip(fields[place], 2 - along)
        fluid.set_velocity(*fields)
        for step in range(4):
            fluid.predict(0.01, (0.0, 0.0, 0.0), time=0.01 * step)
            fluid.project(0.01)
        assert fluid.largest_divergence() < 1e-11
        flows.append(fluid)
    for other in flows[1:3]:
        for a, b in zip((*flows[0].velocity, flows[0].p), (*other.velocity, other.p), strict=True):
            np.testing.assert_array_equal(a, b)
    turned = np.moveaxis(flows[0].velocity[axis], 2 - axis, 0)[:-1, 1:-1, 1:-1]
    turned = turned if speed > 0.0 else -turned[::-1]
    np.testing.assert_allclose(turned, flows[3].w[:-1, 1:-1, 1:-1], atol=1e-12)
