"""The direct Poisson solve: every combination of boundaries, against a dense solve and scipy's transforms."""

import itertools

import numpy as np
import pytest
import scipy.fft

from rdpm import _core
from rdpm.conventions import BOUNDARY_KINDS
from rdpm.grid import Box, Grid

COMBINATIONS = list(itertools.product(BOUNDARY_KINDS[:3], repeat=3))
CELLS = (6, 5, 7)
SIZE = (1.0, 0.7, 1.3)

# Condition number of the Laplacian on these grids (some 1e2) times a few roundings.
SOLVE_TOLERANCE = 1e-12


def second_difference(n: int, h: float, is_periodic: bool) -> np.ndarray:
    """The matrix of one direction: no flux through a side, or wrapped."""
    matrix = np.diag(np.full(n, -2.0)) + np.diag(np.ones(n - 1), 1) + np.diag(np.ones(n - 1), -1)
    if is_periodic:
        matrix[0, -1] += 1.0
        matrix[-1, 0] += 1.0
    else:
        matrix[0, 0] = matrix[-1, -1] = -1.0
    return matrix / h**2


def solve(grid: Grid, rhs: np.ndarray) -> np.ndarray:
    field = grid.zeros()
    field[1:-1, 1:-1, 1:-1] = rhs
    _core.Projection(grid.core).solve(grid.core, field)
    return field[1:-1, 1:-1, 1:-1].copy()


def balanced(grid: Grid) -> np.ndarray:
    """A right-hand side with zero mean, as a divergence has."""
    rhs = np.random.default_rng(7).normal(size=tuple(n - 2 for n in grid.shape))
    return rhs - rhs.mean()


@pytest.mark.parametrize("boundary", COMBINATIONS)
def test_solution_is_that_of_a_dense_solve(boundary) -> None:
    grid = Grid(Box(SIZE, boundary), CELLS)
    rhs = balanced(grid)
    lx, ly, lz = (
        second_difference(n, h, p) for n, h, p in zip(CELLS, grid.spacing, grid.is_periodic, strict=True)
    )
    one = [np.eye(n) for n in CELLS]
    laplacian = (
        np.kron(one[2], np.kron(one[1], lx))
        + np.kron(one[2], np.kron(ly, one[0]))
        + np.kron(lz, np.kron(one[1], one[0]))
    )
    oracle = np.linalg.lstsq(laplacian, rhs.ravel(), rcond=None)[0].reshape(rhs.shape)
    found = solve(grid, rhs)
    found -= found.mean()  # any constant is a solution
    np.testing.assert_allclose(found, oracle, atol=SOLVE_TOLERANCE * np.abs(oracle).max())


def complex_dct(transform, q: np.ndarray, axis: int) -> np.ndarray:
    return transform(q.real, axis=axis) + 1j * transform(q.imag, axis=axis)


def by_scipy(grid: Grid, rhs: np.ndarray) -> np.ndarray:
    """Transforms along all three directions."""
    q, eigenvalue = rhs.astype(complex), np.zeros(rhs.shape)
    for direction, (n, h, is_periodic) in enumerate(zip(grid.cells, grid.spacing, grid.is_periodic, strict=True)):
        axis = 2 - direction
        angle = (2.0 if is_periodic else 1.0) * np.pi * np.arange(n) / n
        shape = [1, 1, 1]
        shape[axis] = n
        eigenvalue = eigenvalue + (2.0 * (np.cos(angle) - 1.0) / h**2).reshape(shape)
        q = scipy.fft.fft(q, axis=axis) if is_periodic else complex_dct(scipy.fft.dct, q, axis)
    eigenvalue[0, 0, 0] = 1.0
    q = q / eigenvalue
    q[0, 0, 0] = 0.0
    for direction, is_periodic in enumerate(grid.is_periodic):
        axis = 2 - direction
        q = scipy.fft.ifft(q, axis=axis) if is_periodic else complex_dct(scipy.fft.idct, q, axis)
    return q.real


@pytest.mark.parametrize("boundary", list(itertools.product(("periodic", "wall"), repeat=3)))
@pytest.mark.parametrize("cells", [(24, 30, 40), (32, 18, 25)])
def test_solution_is_that_of_scipy_on_a_larger_grid(boundary, cells) -> None:
    grid = Grid(Box((1.0, 2.0, 1.5), boundary), cells)
    rhs = balanced(grid)
    found, oracle = solve(grid, rhs), by_scipy(grid, rhs)
    found -= found.mean()
    # Condition number 1e3 to 1e4.
    np.testing.assert_allclose(found, oracle, atol=1e-11 * np.abs(oracle).max())


@pytest.mark.parametrize("boundary", COMBINATIONS)
def test_solution_is_bit_identical_on_one_two_and_three_threads(boundary) -> None:
    cells = (8, 9, 11)
    one, two, three = (Grid(Box(SIZE, boundary), cells, threads) for threads in (1, 2, 3))
    rhs = balanced(one)
    expected = solve(one, rhs)
    np.testing.assert_array_equal(solve(two, rhs), expected)
    np.testing.assert_array_equal(solve(three, rhs), expected)


def test_long_waves_are_solved_on_a_long_box() -> None:
    """The slowest decaying mode, whose factors never reach their limit."""
    grid = Grid(Box((1.0, 1.0, 64.0), ("wall", "wall", "periodic")), (4, 4, 256))
    z = grid.points("p")[2][1:-1]
    rhs = np.broadcast_to(np.cos(2.0 * np.pi * z / 64.0)[:, None, None], (256, 4, 4))
    h = grid.spacing[2]
    eigenvalue = 2.0 * (np.cos(2.0 * np.pi / 256) - 1.0) / h**2
    found = solve(grid, rhs)
    np.testing.assert_allclose(found - found.mean(), rhs / eigenvalue, rtol=0.0, atol=1e-9 / abs(eigenvalue))
