"""Kernels of the fluid against slow loops and against themselves on other numbers of threads."""

import itertools

import numpy as np
import pytest

from rdpm import _core
from rdpm.conventions import BOUNDARY_KINDS
from rdpm.fluid import Fluid
from rdpm.fluid.diffusion import explicit_limit
from rdpm.grid import Box, Grid

COMBINATIONS = list(itertools.product(BOUNDARY_KINDS[:3], repeat=3))


def random_flow(grid: Grid, is_explicit: bool, viscosity: float = 0.01) -> Fluid:
    fluid = Fluid(grid, 1.0, viscosity, is_explicit)
    rng = np.random.default_rng(3)
    fluid.set_velocity(*(rng.normal(size=grid.shape) for _ in range(3)))
    fluid.project(0.01)
    fluid.p[...] = 0.0
    return fluid


def legendre(velocity: np.ndarray, grid: Grid, component: int, dt: float, nu: float, stages: int) -> np.ndarray:
    """The stages over whole fields, as published: Meyer, Balsara, Aslam (2014), eqs 16 and 17."""

    def laplacian(q: np.ndarray) -> np.ndarray:
        q = q.copy()
        _core.fill_halo(grid.core, q, component)
        out = np.zeros_like(q)
        inner = (slice(1, -1),) * 3
        for axis, h in zip((2, 1, 0), grid.spacing, strict=True):
            up, down = list(inner), list(inner)
            up[axis], down[axis] = slice(2, None), slice(0, -2)
            out[inner] += nu * (q[tuple(up)] - 2.0 * q[inner] + q[tuple(down)]) / h**2
        return out

    def b(j: int) -> float:
        return 1.0 / 3.0 if j < 2 else (j**2 + j - 2.0) / (2.0 * j * (j + 1.0))

    w1 = 4.0 / (stages**2 + stages - 2.0)
    y0, m0 = velocity, laplacian(velocity)
    before, last = y0, y0 + b(1) * w1 * dt * m0
    for j in range(2, stages + 1):
        mu, nu_j = (2.0 * j - 1.0) / j * b(j) / b(j - 1), -(j - 1.0) / j * b(j) / b(j - 2)
        mu_t = mu * w1
        gamma_t = -(1.0 - b(j - 1)) * mu_t
        kept = mu * last + nu_j * before + (1.0 - mu - nu_j) * y0
        before, last = last, kept + dt * (mu_t * laplacian(last) + gamma_t * m0)
    _core.fill_halo(grid.core, last, component)
    return last


@pytest.mark.parametrize("boundary", COMBINATIONS)
@pytest.mark.parametrize("stages", [2, 5])
def test_wavefront_of_stages_is_the_scheme(boundary, stages: int) -> None:
    speed = np.zeros((6, 3))
    for side in range(6):
        for component in range(3):
            speed[side, component] = 1e-9 * (side + component) if component != side // 2 else 0.0
    grid = Grid(Box((0.5, 0.6, 0.7), boundary, speed), (5, 6, 7), threads=2)
    # Velocities of order 1e-9: advection is some 1e-18, far below round-off of what is compared.
    fluid = random_flow(grid, False)
    fluid.set_velocity(*(1e-9 * q for q in fluid.velocity))
    start = [q.copy() for q in fluid.velocity]
    dt = 0.08
    fluid.predict(dt, (0.0, 0.0, 0.0), stages)
    for component, (q, before) in enumerate(zip(fluid.velocity, start, strict=True)):
        _core.fill_halo(grid.core, q, component)
        expected = legendre(before, grid, component, dt, fluid.kinematic_viscosity, stages)
        np.testing.assert_allclose(q, expected, rtol=0.0, atol=1e-8 * np.abs(before).max())


def test_more_stages_than_planes_wrap_around() -> None:
    grid = Grid(Box((1.0, 1.0, 0.5), ("wall", "periodic", "periodic")), (8, 8, 4))
    q, rate = grid.zeros(), grid.zeros()
    rate[1:-1, 1:-1, 1:-1] = np.sin(np.arange(8.0))
    scratch = np.zeros(3 * 13 * q[0].size)
    none = np.zeros((0, *grid.shape[1:]))
    _core.diffuse_stabilised(grid.core, q, rate, 1, 0.5, 0.1, 14, scratch, none, none)
    assert np.abs(q[1:-1, 1:-1, 1:-1]).max() > 0.0
    np.testing.assert_array_equal(np.ptp(q[1:-1, 1:-1, 1:-1], axis=(0, 1)), 0.0)


@pytest.mark.parametrize("is_explicit", [True, False])
@pytest.mark.parametrize("boundary", COMBINATIONS)
def test_steps_are_bit_identical_on_one_two_and_three_threads(boundary, is_explicit: bool) -> None:
    found = []
    for threads in (1, 2, 3):
        fluid = random_flow(Grid(Box((1.0, 1.1, 0.9), boundary), (8, 10, 9), threads), is_explicit)
        dt = 0.01 if is_explicit else 0.3
        for _ in range(3):
            fluid.predict(dt, (0.1, 0.2, 0.3))
            fluid.project(dt)
        found.append((fluid.cfl_rate, fluid.square_sum, fluid.p, *fluid.velocity))
    for other in found[1:]:
        for one, two in zip(found[0], other, strict=True):
            np.testing.assert_array_equal(one, two)


@pytest.mark.parametrize("is_explicit", [True, False])
@pytest.mark.parametrize("boundary", COMBINATIONS)
def test_divergence_is_round_off_and_measures_are_those_of_the_flow(boundary, is_explicit: bool) -> None:
    fluid = random_flow(Grid(Box((1.0, 1.1, 0.9), boundary), (8, 10, 9)), is_explicit)
    for _ in range(3):
        fluid.predict(0.01, (0.1, 0.2, 0.3))
        fluid.project(0.01)
    u, v, w = fluid.velocity
    dx, dy, dz = fluid.grid.spacing
    inner = (slice(1, -1),) * 3
    divergence = (
        (u[inner] - u[1:-1, 1:-1, :-2]) / dx
        + (v[inner] - v[1:-1, :-2, 1:-1]) / dy
        + (w[inner] - w[:-2, 1:-1, 1:-1]) / dz
    )
    # Velocities of order 1 over spacings of 0.1, sums in transforms of some ten values.
    assert np.abs(divergence).max() < 1e-12
    assert fluid.largest_divergence() == pytest.approx(np.abs(divergence).max(), rel=1e-12)
    # The rate of a cell takes one of its two faces in z.
    across = np.abs(u[inner]) / dx + np.abs(v[inner]) / dy
    above, below = np.abs(w[inner]) / dz, np.abs(w[:-2, 1:-1, 1:-1]) / dz
    assert (across + np.minimum(above, below)).max() <= fluid.cfl_rate * (1.0 + 1e-14)
    assert fluid.cfl_rate <= (across + np.maximum(above, below)).max() * (1.0 + 1e-14)
    square = sum(float((q[inner] ** 2).sum()) for q in fluid.velocity)
    assert fluid.square_sum == pytest.approx(square, rel=1e-13)


def test_prediction_is_that_of_a_slow_loop() -> None:
    """One explicit step of a periodic box, advection in conservative form, written with rolled arrays."""
    grid = Grid(Box((1.0, 1.2, 0.8), ("periodic",) * 3), (6, 7, 8))
    fluid = random_flow(grid, True, viscosity=0.02)
    rng = np.random.default_rng(5)
    fluid.p[...] = rng.normal(size=grid.shape)
    _core.fill_halo(grid.core, fluid.p, 3)
    inner = (slice(1, -1),) * 3
    q = [field[inner].copy() for field in fluid.velocity]
    p = fluid.p[inner].copy()
    h = grid.spacing

    def up(a: np.ndarray, d: int) -> np.ndarray:
        return np.roll(a, -1, axis=2 - d)

    def down(a: np.ndarray, d: int) -> np.ndarray:
        return np.roll(a, 1, axis=2 - d)

    dt, force = 0.003, (0.3, -0.2, 0.1)
    expected = []
    for c in range(3):
        change = force[c] - (up(p, c) - p) / h[c]
        for d in range(3):
            change += 0.02 * (up(q[c], d) - 2.0 * q[c] + down(q[c], d)) / h[d] ** 2
            if c == d:
                middle = 0.25 * (q[c] + up(q[c], c)) ** 2  # at the centre of the cell above the face
                change -= (middle - down(middle, c)) / h[c]
            else:
                edge = 0.25 * (q[c] + up(q[c], d)) * (q[d] + up(q[d], c))
                change -= (edge - down(edge, d)) / h[d]
        expected.append(q[c] + dt * change)
    fluid.predict(dt, force)
    for field, value in zip(fluid.velocity, expected, strict=True):
        np.testing.assert_allclose(field[inner], value, rtol=0.0, atol=1e-13)


@pytest.mark.parametrize("is_explicit", [True, False])
def test_energy_never_grows_without_forcing(is_explicit: bool) -> None:
    for boundary in (("periodic",) * 3, ("wall",) * 3, ("free-slip",) * 3, ("wall", "periodic", "free-slip")):
        fluid = random_flow(Grid(Box((1.0, 1.0, 1.0), boundary), (10, 10, 10)), is_explicit, viscosity=0.02)
        dt = 0.4 / fluid.cfl_rate
        if is_explicit:
            dt = min(dt, explicit_limit(fluid.grid.spacing, 0.02))
        energy = [fluid.kinetic_energy()]
        for _ in range(60):
            fluid.predict(dt, (0.0, 0.0, 0.0))
            fluid.project(dt)
            energy.append(fluid.kinetic_energy())
        assert (np.diff(energy) < 0.0).all()


@pytest.mark.parametrize("is_explicit", [True, False])
def test_momentum_is_kept_in_a_periodic_box_and_driven_by_a_force(is_explicit: bool) -> None:
    fluid = random_flow(Grid(Box((1.0, 1.0, 1.0), ("periodic",) * 3), (8, 9, 10)), is_explicit)
    inner = (slice(1, -1),) * 3
    start = np.array([q[inner].mean() for q in fluid.velocity])
    force, dt, steps = (0.4, -0.3, 0.2), 0.005, 40
    for _ in range(steps):
        fluid.predict(dt, force)
        fluid.project(dt)
    end = np.array([q[inner].mean() for q in fluid.velocity])
    # Advection and diffusion are differences of fluxes: their sums cancel to round-off.
    np.testing.assert_allclose(end - start, dt * steps * np.array(force), rtol=0.0, atol=1e-14)
