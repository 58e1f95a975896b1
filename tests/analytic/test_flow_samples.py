"""Points, planes, vorticity and Q on fields that are known: second order, up to the walls and in their corners."""

import numpy as np
import pytest

from rdpm.fluid import Fluid
from rdpm.fluid.derived import vorticity_and_q
from rdpm.fluid.means import FlowMeans
from rdpm.fluid.sampling import PointSampler, plane_values
from rdpm.grid import Box, Grid

SIZE = (1.0, 1.5, 2.0)
#: Largest error that may be left where the spacing is halved: a quarter, and room for the next order.
QUARTER = 0.32


def velocity(x, y, z):
    """Zero on every wall of the box, and its pressure has slopes there."""
    a, b, c = (np.pi * s / length for s, length in zip((x, y, z), SIZE, strict=True))
    u = np.sin(2 * a) * np.sin(b) * np.sin(c)
    v = np.sin(a) * np.sin(2 * b) * np.sin(c) + 0.5 * np.sin(a) * np.sin(b) * np.sin(2 * c)
    w = np.sin(a) * np.sin(b) * np.sin(3 * c)
    return u, v, w


def pressure(x, y, z):
    return np.cos(x + 0.3) * np.sin(0.8 * y + 0.2) * np.exp(0.4 * z)


def gradient(x, y, z, step=1e-5):
    """d_i u_j by differences of the formula: (3, 3, ...)."""
    found = []
    for axis in range(3):
        plus, minus = ([s + sign * step * (n == axis) for n, s in enumerate((x, y, z))] for sign in (1, -1))
        found.append((np.array(velocity(*plus)) - np.array(velocity(*minus))) / (2 * step))
    return np.array(found)


def walled(cells):
    fluid = Fluid(Grid(Box(SIZE), cells), 2.0, 1.0)
    sampled = []
    for location in "uvw":
        x, y, z = fluid.grid.points(location)
        sampled.append(velocity(x[None, None, :], y[None, :, None], z[:, None, None])["uvw".index(location)])
    fluid.set_velocity(*sampled)
    x, y, z = fluid.grid.points("p")
    fluid.p[1:-1, 1:-1, 1:-1] = pressure(x[None, None, :], y[None, :, None], z[:, None, None])[1:-1, 1:-1, 1:-1]
    return fluid


def centres(fluid):
    x, y, z = (s[1:-1] for s in fluid.grid.points("p"))
    return np.broadcast_arrays(x[None, None, :], y[None, :, None], z[:, None, None])


@pytest.fixture(scope="module")
def fluids():
    return walled((12, 18, 24)), walled((24, 36, 48))


def test_points_are_of_second_order(fluids) -> None:
    points = np.random.default_rng(7).random((4000, 3)) * SIZE
    points[:27] = np.stack(np.meshgrid(*[[0.0, 0.01, 1.0]] * 3), -1).reshape(-1, 3) * SIZE  # faces, edges, corners
    errors = []
    for fluid in fluids:
        u, p = PointSampler(fluid.grid, points).values(fluid)
        errors.append([np.abs(u - np.stack(velocity(*points.T), 1)).max(), np.abs(p - 2.0 * pressure(*points.T)).max()])
    assert (np.array(errors[1]) < QUARTER * np.array(errors[0])).all()


def test_points_wrap_around_periodic_boundaries() -> None:
    box = Box((1.0, 1.0, 1.0), ("periodic", "periodic", "periodic"))
    points = np.random.default_rng(8).random((2000, 3))
    points[:2] = [[0.0, 1.0, 0.001], [1.0, 0.0, 0.999]]
    errors = []
    for n in (16, 32):
        fluid = Fluid(Grid(box, (n, n, n)), 1.0, 1.0)
        fields = []
        for location in "uvw":
            x, y, z = fluid.grid.points(location)
            wave = np.sin(2 * np.pi * (x[None, None, :] + y[None, :, None] - z[:, None, None]))
            fields.append(wave)
        fluid.set_velocity(*fields)
        x, y, z = fluid.grid.points("p")
        inner = np.sin(2 * np.pi * (x[None, None, :] + y[None, :, None] - z[:, None, None]))[1:-1, 1:-1, 1:-1]
        fluid.p[1:-1, 1:-1, 1:-1] = inner
        exact = np.sin(2 * np.pi * (points @ [1.0, 1.0, -1.0]))
        u, p = PointSampler(fluid.grid, points).values(fluid)
        errors.append(np.abs(np.column_stack([u, p]) - exact[:, None]).max())
    assert errors[1] < QUARTER * errors[0]


@pytest.mark.parametrize(("axis", "start"), [(0, 0.4), (1, 0.0), (2, 1.8)])
def test_planes_are_of_second_order(axis, start, fluids) -> None:
    errors = np.zeros((2, 2))
    for worst, fluid in zip(errors, fluids, strict=True):
        for position in start + np.linspace(0.0, 0.2, 9):  # more than two cells: on layers, and between them
            u, p = plane_values(fluid, axis, position)
            here = [c.take([0], axis=2 - axis) for c in centres(fluid)]
            here[axis] = np.full_like(here[axis], position)
            away = np.abs(u - np.stack(velocity(*here), -1)).max(), np.abs(p - 2.0 * pressure(*here)).max()
            np.maximum(worst, away, out=worst)
            assert u.shape == (*here[0].shape, 3)
    assert (np.array(errors[1]) < QUARTER * np.array(errors[0]) + 1e-6).all()


def test_vorticity_and_q_are_of_second_order_up_to_the_walls(fluids) -> None:
    errors = []
    for fluid in fluids:
        d = gradient(*centres(fluid))
        curl = np.stack([d[1][2] - d[2][1], d[2][0] - d[0][2], d[0][1] - d[1][0]], -1)
        q = -0.5 * np.einsum("ij...,ji...->...", d, d)
        found = vorticity_and_q(fluid)
        pairs = zip(found, (curl, q), strict=True)
        errors.append([np.abs(there - exact).max() / np.abs(exact).max() for there, exact in pairs])
    assert (np.array(errors[1]) < QUARTER * np.array(errors[0])).all()
    assert max(errors[1]) < 0.02


def test_means_are_those_of_the_samples(fluids) -> None:
    fluid = walled((4, 4, 20))
    means, samples = FlowMeans(fluid.grid.cells), []
    base = [field.copy() for field in fluid.velocity]
    for time, factor in ((0.5, 9.0), (0.6, 1.0), (0.9, 2.0), (1.0, -1.0)):
        fluid.set_velocity(*(factor * field for field in base))
        means.add(fluid, time)
        samples.append(fluid.cell_values()[0].astype(float))
    assert means.span == pytest.approx(0.5)
    w = np.array([0.0, 0.1, 0.3, 0.1]) / 0.5  # the first sample only begins
    mean = np.einsum("s,s...->...", w, samples)
    variance = np.einsum("s,s...->...", w, (np.array(samples) - mean) ** 2)
    # `cell_values` is of single precision.
    np.testing.assert_allclose(means.velocity, mean, atol=1e-6)
    np.testing.assert_allclose(means.variance, variance, atol=1e-6)
    np.testing.assert_allclose(means.pressure, fluid.cell_values()[1], rtol=1e-6)
