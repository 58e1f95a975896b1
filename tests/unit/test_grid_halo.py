"""The staggered grid: where values sit, what its halos hold, and the counts chosen for a box."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rdpm import _core
from rdpm.grid import Box, Grid, choose_cells
from rdpm.grid.grid import SPACING_TOLERANCE, smooth_counts

CELLS = (5, 6, 7)


def filled(grid: Grid, location: int) -> np.ndarray:
    """Random inner values with the halo as the kernels fill it."""
    field = np.random.default_rng(location).normal(size=grid.shape)
    _core.fill_halo(grid.core, field, location)
    return field


def along(field: np.ndarray, direction: int) -> np.ndarray:
    """The field with one direction (0 = x) first, the inner part of the others."""
    inner = [slice(1, -1)] * 3
    inner[2 - direction] = slice(None)
    return np.moveaxis(field[tuple(inner)], 2 - direction, 0)


@pytest.mark.parametrize("direction", [0, 1, 2])
@pytest.mark.parametrize("location", [0, 1, 2, 3])
def test_periodic_halo_repeats_the_other_end(direction: int, location: int) -> None:
    q = along(filled(Grid(Box((1.0, 1.0, 1.0), ("periodic",) * 3), CELLS), location), direction)
    np.testing.assert_array_equal(q[0], q[-2])
    np.testing.assert_array_equal(q[-1], q[1])


@pytest.mark.parametrize("kind", ["wall", "free-slip"])
@pytest.mark.parametrize("direction", [0, 1, 2])
def test_normal_velocity_is_zero_on_a_side_and_odd_about_it(direction: int, kind: str) -> None:
    q = along(filled(Grid(Box((1.0, 1.0, 1.0), (kind,) * 3), CELLS), direction), direction)
    assert not q[0].any()
    assert not q[-2].any()
    np.testing.assert_array_equal(q[-1], -q[-3])


@pytest.mark.parametrize("direction", [0, 1, 2])
@pytest.mark.parametrize("component", [0, 1, 2])
def test_tangential_velocity_meets_the_side(direction: int, component: int) -> None:
    if component == direction:
        return
    speed = np.zeros((6, 3))
    speed[2 * direction, component], speed[2 * direction + 1, component] = 0.3, -0.7

    def pair(kind: str) -> list[str]:
        return [kind if d == direction else "periodic" for d in range(3)]

    wall = along(filled(Grid(Box((1.0, 1.0, 1.0), tuple(pair("wall")), speed), CELLS), component), direction)
    # The mean of halo and inner value is the wall's speed; one rounding of a sum of order one.
    np.testing.assert_allclose(0.5 * (wall[0] + wall[1]), 0.3, atol=1e-15)
    np.testing.assert_allclose(0.5 * (wall[-1] + wall[-2]), -0.7, atol=1e-15)
    slip = along(filled(Grid(Box((1.0, 1.0, 1.0), tuple(pair("free-slip"))), CELLS), component), direction)
    np.testing.assert_array_equal(slip[0], slip[1])
    np.testing.assert_array_equal(slip[-1], slip[-2])


def test_points_are_faces_and_centres() -> None:
    grid = Grid(Box((1.0, 1.2, 1.4)), CELLS)
    x, y, z = grid.points("u")
    assert x[0] == 0.0
    assert x[5] == pytest.approx(1.0)
    assert y[1] == pytest.approx(0.1)
    assert z[1] == pytest.approx(0.1)
    assert [len(a) for a in grid.points("p")] == [7, 8, 9]


@given(st.floats(0.01, 10.0), st.floats(2.0, 500.0))
def test_counts_suit_the_transforms_within_the_tolerance(length: float, ideal: float) -> None:
    n = choose_cells(length, length / ideal)
    assert n >= 4
    if ideal >= 4:
        # Below some twenty cells no product of 2, 3, 5 may be near: then the nearest whole number is taken.
        assert n in smooth_counts(n, n) or abs(n - ideal) <= 0.5 + 1e-9 * ideal
    if ideal >= 30:
        assert abs(ideal / n - 1.0) <= SPACING_TOLERANCE + 1e-12


@pytest.mark.parametrize(
    ("cells", "spacing", "boundary", "threads"),
    [
        ((3, 8, 8), (1.0, 1.0, 1.0), (0, 0, 0), 1),
        ((8, 8, 8), (0.0, 1.0, 1.0), (0, 0, 0), 1),
        ((8, 8, 8), (1.0, 1.0, float("nan")), (0, 0, 0), 1),
        ((8, 8, 8), (1.0, 1.0, 1.0), (0, 5, 0), 1),
        ((8, 8, 8), (1.0, 1.0, 1.0), (0, 0, 0), 0),
    ],
)
def test_kernels_refuse_a_grid_they_cannot_use(cells, spacing, boundary, threads) -> None:
    with pytest.raises(ValueError, match="grid: "):
        _core.Grid(list(cells), list(spacing), list(boundary), [0.0] * 18, threads, 0, 0, [False, False])


def test_kernels_name_the_array_of_a_wrong_shape() -> None:
    grid = Grid(Box((1.0, 1.0, 1.0)), CELLS)
    good, bad = grid.zeros(), np.zeros((2, 2, 2))
    with pytest.raises((ValueError, TypeError), match="v: "):
        _core.largest_divergence(grid.core, good, bad, good)
