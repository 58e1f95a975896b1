"""Flow between parallel walls: start-up Couette by its series, Poiseuille by its discrete parabola."""

import math

import numpy as np
import pytest

import rdpm
from rdpm.fluid import Fluid
from rdpm.fluid.diffusion import explicit_limit
from rdpm.grid import Box, Grid

WAYS = [True, False]
DIRECTIONS = [0, 1, 2]  # normal to the walls
SPEED = 0.8
LEAST_SLOPE = 1.9


def channel(normal: int, n: int, across: str, is_explicit: bool, viscosity: float, speed: float = 0.0) -> Fluid:
    """A unit gap of n cells; the upper wall moves along the next direction; `across` bounds the third."""
    along, third = (normal + 1) % 3, (normal + 2) % 3
    boundary, cells = ["periodic"] * 3, [4] * 3
    boundary[normal], boundary[third], cells[normal] = "wall", across, n
    wall_velocity = np.zeros((6, 3))
    wall_velocity[2 * normal + 1, along] = speed
    grid = Grid(Box(tuple(c / n for c in cells), tuple(boundary), wall_velocity), tuple(cells))
    fluid = Fluid(grid, 1.0, viscosity, is_explicit)
    fluid.set_velocity(0.0, 0.0, 0.0)
    return fluid


def advance(fluid: Fluid, dt: float, steps: int, force: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> None:
    for _ in range(steps):
        fluid.predict(dt, force)
        fluid.project(dt)


def profile(fluid: Fluid, normal: int) -> tuple[np.ndarray, np.ndarray]:
    """Distance from the lower wall and velocity along the channel, after checking that it varies with no other."""
    along = (normal + 1) % 3
    name = "uvw"[along]
    q = np.moveaxis(fluid.velocity[along][1:-1, 1:-1, 1:-1], 2 - normal, 0)
    assert np.ptp(q, axis=(1, 2)).max() < 1e-14
    return fluid.grid.points(name)[normal][1:-1], q[:, 0, 0]


def couette(y: np.ndarray, time: float) -> np.ndarray:
    """Series solution for a unit gap, unit viscosity and a wall set in motion at time 0."""
    n = np.arange(1, 60)[:, None]
    wave = (-1.0) ** n / n * np.sin(n * np.pi * y) * np.exp(-((n * np.pi) ** 2) * time)
    return SPEED * (y + 2.0 / np.pi * wave.sum(axis=0))


@pytest.mark.parametrize("is_explicit", WAYS)
@pytest.mark.parametrize("across", ["periodic", "free-slip"])
@pytest.mark.parametrize("normal", DIRECTIONS)
def test_couette_start_up_is_second_order(normal: int, across: str, is_explicit: bool) -> None:
    end, grids, errors = 0.1, [16, 32, 64], []
    for n in grids:
        fluid = channel(normal, n, across, is_explicit, 1.0, SPEED)
        longest = explicit_limit(fluid.grid.spacing, 1.0) if is_explicit else 0.025 / n
        steps = math.ceil(end / longest)
        advance(fluid, end / steps, steps)
        y, u = profile(fluid, normal)
        errors.append(float(np.abs(u - couette(y, end)).max()))
    assert np.polyfit(np.log([1.0 / n for n in grids]), np.log(errors), 1)[0] >= LEAST_SLOPE
    assert errors[-1] < 2e-4 * SPEED


@pytest.mark.parametrize("is_explicit", WAYS)
def test_couette_is_second_order_in_time(is_explicit: bool) -> None:
    """From the series' profile at a later time on, since an impulsive start has no derivative to be exact in."""
    begin, end, n = 0.05, 0.15, 16
    counts = [160, 320, 640] if is_explicit else [10, 20, 40]

    def run(steps: int) -> np.ndarray:
        fluid = channel(0, n, "periodic", is_explicit, 1.0, SPEED)
        y = fluid.grid.points("v")[0]
        fluid.set_velocity(0.0, couette(y, begin)[None, None, :], 0.0)
        advance(fluid, (end - begin) / steps, steps)
        return profile(fluid, 0)[1]

    reference = run(4 * counts[-1])
    errors = [float(np.abs(run(steps) - reference).max()) for steps in counts]
    assert np.polyfit(np.log([1.0 / s for s in counts]), np.log(errors), 1)[0] >= LEAST_SLOPE


@pytest.mark.parametrize("is_explicit", WAYS)
@pytest.mark.parametrize("normal", DIRECTIONS)
def test_poiseuille_is_the_discrete_parabola(normal: int, is_explicit: bool) -> None:
    """f/(2 nu) (y (H - y) + h^2/4): the second difference of a parabola is exact, and the mirror at the wall, which
    is second order, lifts the whole profile by f h^2 / (8 nu)."""
    n, viscosity, f = 12, 0.05, 0.3
    fluid = channel(normal, n, "periodic", is_explicit, viscosity)
    along = (normal + 1) % 3
    force = [0.0, 0.0, 0.0]
    force[along] = f
    h = fluid.grid.spacing[normal]
    dt = explicit_limit(fluid.grid.spacing, viscosity) if is_explicit else 0.05
    # Slowest mode decays by exp(-nu pi^2 t) = exp(-34.5) = 1e-15.
    advance(fluid, dt, math.ceil(70.0 / dt), tuple(force))
    y, u = profile(fluid, normal)
    exact = 0.5 * f / viscosity * (y * (1.0 - y) + 0.25 * h**2)
    np.testing.assert_allclose(u, exact, rtol=0.0, atol=1e-12 * exact.max())


@pytest.mark.parametrize(
    "drive",
    [{"body_force": [0.0, 0.02, 0.0]}, {"pressure_gradient": [0.0, "-20 Pa/m", 0.0]}],
    ids=["force", "gradient"],
)
def test_body_force_and_pressure_gradient_drive_the_same_flow(drive) -> None:
    """A gradient G in a fluid of density rho is a force -G / rho a unit mass."""
    case = rdpm.load_case(
        {
            "domain": {
                "size": [0.01, 0.01, 0.02],
                "boundary": {"x": "periodic", "y": "periodic", "z": "wall"},
                "gravity": [0, 0, 0],
            },
            "fluid": {"density": 1000.0, "kinematic_viscosity": 1e-5, **drive},
            "resolution": {"cells": [4, 4, 8]},
            "time": {"end": 160.0},  # nu pi^2 t / H^2 = 39
        }
    )
    sim = rdpm.Simulation(case, threads=1)
    sim.run(until=160.0)
    z = sim.fluid.grid.points("v")[2][1:-1]
    h = sim.fluid.grid.spacing[2]
    exact = 0.5 * 0.02 / 1e-5 * (z * (0.02 - z) + 0.25 * h**2)
    np.testing.assert_allclose(sim.fluid.v[1:-1, 2, 2], exact, rtol=1e-11)


@pytest.mark.parametrize("is_explicit", WAYS)
@pytest.mark.parametrize("along", DIRECTIONS)
def test_free_slip_sides_leave_uniform_flow_alone(along: int, is_explicit: bool) -> None:
    boundary = ["free-slip"] * 3
    boundary[along] = "periodic"
    fluid = Fluid(Grid(Box((1.0, 1.0, 1.0), tuple(boundary)), (6, 7, 8)), 1.0, 0.01, is_explicit)
    speed = [0.0, 0.0, 0.0]
    speed[along] = SPEED
    fluid.set_velocity(*speed)
    advance(fluid, 0.02, 50)
    for component, q in enumerate(fluid.velocity):
        # Differences of equal numbers are exactly zero; the projection subtracts nothing.
        np.testing.assert_array_equal(q[1:-1, 1:-1, 1:-1], speed[component])
