"""Vortices that decay in closed form: order in space and in time, for every boundary and both ways of diffusion."""

import math

import numpy as np
import pytest

from rdpm.fluid import Fluid
from rdpm.fluid.diffusion import explicit_limit
from rdpm.grid import Box, Grid

PLANES = [(0, 1, 2), (1, 2, 0), (2, 0, 1)]  # directions of the vortex, and the one it does not depend on
KINDS = [
    ("periodic", "periodic", "periodic"),
    ("periodic", "free-slip", "free-slip"),
    ("free-slip", "periodic", "periodic"),
    ("free-slip", "free-slip", "free-slip"),
]
WAYS = [True, False]
VISCOSITY = 0.02
WAVE = 2.0 * math.pi
MEAN = 0.5  # mean advection along every periodic direction

#: Second order to within what the coarsest grid still lacks.
LEAST_SLOPE = 1.9


def advance(fluid: Fluid, dt: float, steps: int, force: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> None:
    for _ in range(steps):
        fluid.predict(dt, force)
        fluid.project(dt)


def advance_unevenly(fluid: Fluid, mean: float, steps: int) -> None:
    """An even number of steps, each twice or half as long as the one before."""
    for step in range(steps):
        dt = mean * (2.0 if step % 2 else 4.0) / 3.0
        fluid.predict(dt, (0.0, 0.0, 0.0))
        fluid.project(dt)


def slope(sizes: list[float], errors: list[float]) -> float:
    return float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])


def vortex(grid: Grid, plane: tuple[int, int, int], time: float, viscosity: float = VISCOSITY) -> list[np.ndarray]:
    """Exact u, v, w: a vortex carried along by a mean flow where a direction is periodic."""
    a, b, _ = plane
    speed = [MEAN if p else 0.0 for p in grid.is_periodic]
    decay = math.exp(-2.0 * viscosity * WAVE**2 * time)
    velocity = []
    for component, name in enumerate("uvw"):
        points = grid.points(name)
        x = [WAVE * (points[d] - speed[d] * time).reshape([-1 if n == 2 - d else 1 for n in range(3)]) for d in (a, b)]
        value = np.full(grid.shape, speed[component])
        if component == a:
            value = value + decay * np.sin(x[0]) * np.cos(x[1])
        elif component == b:
            value = value - decay * np.cos(x[0]) * np.sin(x[1])
        velocity.append(value)
    return velocity


def difference(fluid: Fluid, other: tuple[np.ndarray, ...] | list[np.ndarray]) -> float:
    """Root mean square over the inner values of all components."""
    inner = (slice(1, -1),) * 3
    return math.sqrt(np.mean([(q[inner] - r[inner]) ** 2 for q, r in zip(fluid.velocity, other, strict=True)]))


def vortex_error(plane, kinds, n: int, is_explicit: bool, end: float = 0.2) -> float:
    cells, size, boundary = [0] * 3, [0.0] * 3, [""] * 3
    for d, kind, count in zip(plane, kinds, (n, n, 4), strict=True):
        cells[d], size[d], boundary[d] = count, count / n, kind
    grid = Grid(Box(tuple(size), tuple(boundary)), tuple(cells))
    fluid = Fluid(grid, 1.0, VISCOSITY, is_explicit)
    fluid.set_velocity(*vortex(grid, plane, 0.0))
    # Steps that fall with the spacing (or its square): the order seen is that of space and time together.
    longest = explicit_limit(grid.spacing, VISCOSITY) if is_explicit else 0.2 / n
    steps = math.ceil(end / longest)
    advance(fluid, end / steps, steps)
    # A direct solve leaves round-off: some 1e-15 of the speed, over a cell.
    assert fluid.largest_divergence() < 1e-12 * n
    return difference(fluid, vortex(grid, plane, end))


@pytest.mark.parametrize("is_explicit", WAYS)
@pytest.mark.parametrize("kinds", KINDS)
@pytest.mark.parametrize("plane", PLANES)
def test_vortex_is_met_with_second_order(plane, kinds, is_explicit: bool) -> None:
    grids = [24, 36, 64]
    errors = [vortex_error(plane, kinds, n, is_explicit) for n in grids]
    assert slope([1.0 / n for n in grids], errors) >= LEAST_SLOPE
    # (k h)^2 / 12 of the decay 2 nu k^2 t = 0.32, and (k h)^2 / 24 of the phase k U t = 0.6 along each direction.
    assert errors[-1] < 0.06 * (WAVE / grids[-1]) ** 2


@pytest.mark.parametrize("is_explicit", WAYS)
@pytest.mark.parametrize("kinds", [KINDS[0], KINDS[1]])
def test_vortex_is_second_order_in_time(kinds, is_explicit: bool) -> None:
    end, n = 0.4, 16
    cells = (n, n, 4)
    grid = Grid(Box((1.0, 1.0, 4.0 / n), kinds), cells)
    viscosity = 0.005  # so that explicit diffusion allows the longest of the steps

    def run(steps: int) -> Fluid:
        fluid = Fluid(grid, 1.0, viscosity, is_explicit)
        fluid.set_velocity(*vortex(grid, PLANES[0], 0.0))
        advance(fluid, end / steps, steps)
        return fluid

    reference = run(1280)
    counts = [20, 40, 80, 160]
    errors = [difference(run(steps), reference.velocity) for steps in counts]
    assert slope([1.0 / s for s in counts], errors) >= LEAST_SLOPE


@pytest.mark.parametrize("is_explicit", WAYS)
def test_steps_that_change_are_second_order_in_time(is_explicit: bool) -> None:
    end, n = 0.4, 16
    grid = Grid(Box((1.0, 1.0, 4.0 / n), KINDS[1]), (n, n, 4))

    def run(steps: int) -> Fluid:
        fluid = Fluid(grid, 1.0, 0.005, is_explicit)
        fluid.set_velocity(*vortex(grid, PLANES[0], 0.0))
        advance_unevenly(fluid, end / steps, steps)
        return fluid

    reference = run(1280)
    counts = [40, 80, 160]
    errors = [difference(run(steps), reference.velocity) for steps in counts]
    assert slope([1.0 / s for s in counts], errors) >= LEAST_SLOPE


def enclosed_vortex(grid: Grid, plane) -> list[np.ndarray]:
    """Of the stream function sin^2(pi a) sin^2(pi b): at rest on all four walls, discretely divergence-free."""
    a, b, _ = plane
    points = [np.arange(n + 2) * h for n, h in zip(grid.cells, grid.spacing, strict=True)]  # cell corners
    shape = {d: [-1 if n == 2 - d else 1 for n in range(3)] for d in (a, b)}
    stream = np.sin(np.pi * points[a].reshape(shape[a])) ** 2 * np.sin(np.pi * points[b].reshape(shape[b])) ** 2
    velocity = [np.zeros(grid.shape) for _ in range(3)]
    velocity[a][...] = np.diff(stream, axis=2 - b, prepend=0.0) / grid.spacing[b]
    velocity[b][...] = -np.diff(stream, axis=2 - a, prepend=0.0) / grid.spacing[a]
    return velocity


def enclosed_run(plane, n: int, is_explicit: bool, steps: int, end: float) -> Fluid:
    cells, size, boundary = [0] * 3, [0.0] * 3, [""] * 3
    for d, kind, count in zip(plane, ("wall", "wall", "periodic"), (n, n, 4), strict=True):
        cells[d], size[d], boundary[d] = count, count / n, kind
    fluid = Fluid(Grid(Box(tuple(size), tuple(boundary)), tuple(cells)), 1.0, VISCOSITY, is_explicit)
    fluid.set_velocity(*enclosed_vortex(fluid.grid, plane))
    advance(fluid, end / steps, steps)
    return fluid


def at_coarse_centres(fluid: Fluid, plane, coarse: int) -> np.ndarray:
    """Velocity where a grid of `coarse` cells has its faces: an odd refinement has values in the same places."""
    ratio = fluid.grid.cells[plane[0]] // coarse
    values = []
    for component in plane[:2]:
        index = [slice(1, 2)] * 3  # the flow does not depend on the third direction
        for d in plane[:2]:
            start = ratio if d == component else (ratio + 1) // 2
            index[2 - d] = slice(start, coarse * ratio + 1, ratio)
        values.append(fluid.velocity[component][tuple(index)].ravel())
    return np.concatenate(values)


@pytest.mark.parametrize("is_explicit", WAYS)
@pytest.mark.parametrize("plane", PLANES)
def test_flow_between_walls_converges_with_second_order(plane, is_explicit: bool) -> None:
    end, grids = 0.5, [9, 27, 81]
    found = []
    for n in grids:
        longest = explicit_limit((1.0 / n,) * 3, VISCOSITY) if is_explicit else 0.1 / n
        fluid = enclosed_run(plane, n, is_explicit, math.ceil(end / longest), end)
        found.append(at_coarse_centres(fluid, plane, grids[0]))
    coarse, fine = (np.linalg.norm(found[i] - found[i + 1]) for i in (0, 1))
    assert math.log(coarse / fine) / math.log(3.0) >= LEAST_SLOPE


@pytest.mark.parametrize("is_explicit", WAYS)
def test_flow_between_walls_is_second_order_in_time(is_explicit: bool) -> None:
    end, n, counts = 0.4, 16, [32, 64, 128]
    reference = enclosed_run(PLANES[0], n, is_explicit, 768, end)
    errors = [difference(enclosed_run(PLANES[0], n, is_explicit, s, end), reference.velocity) for s in counts]
    assert slope([1.0 / s for s in counts], errors) >= LEAST_SLOPE
