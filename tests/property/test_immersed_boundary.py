"""Markers and grid: adjoint, partition of unity, linear fields, and marker sets without a preferred direction."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rdpm import _core
from rdpm.conventions import BOUNDARY_KINDS
from rdpm.grid import Box, Grid
from rdpm.particles.calibration import CALIBRATION
from rdpm.particles.markers import MarkerSet
from rdpm.particles.seeding import marker_count, sphere_points
from rdpm.particles.state import Bodies

CELLS, SIZE = (7, 8, 9), (0.7, 0.96, 0.99)
COMBINATIONS = list(itertools.product(BOUNDARY_KINDS[:3], repeat=3))
kinds = st.tuples(*[st.sampled_from(BOUNDARY_KINDS[:3])] * 3)
seeds = st.integers(0, 2**32 - 1)


def points_in(grid: Grid, rng: np.random.Generator, count: int) -> np.ndarray:
    """Anywhere in the box, and as many at its very sides and corners."""
    x = rng.uniform(size=(count, 3))
    x[::2] = np.where(rng.uniform(size=x[::2].shape) < 0.5, np.round(x[::2]), x[::2])
    return np.ascontiguousarray(x * grid.size)


def markers_at(grid: Grid, position: np.ndarray) -> _core.Markers:
    markers = _core.Markers(grid.core, np.array([0, len(position)], np.int32))
    markers.place(grid.core, position)
    return markers


def interpolate(grid: Grid, markers: _core.Markers, field: list[np.ndarray]) -> np.ndarray:
    out = np.empty((markers.count, 3))
    markers.interpolate(grid.core, *field, out)
    return out


def current(grid: Grid, field: list[np.ndarray]) -> list[np.ndarray]:
    for component, q in enumerate(field):
        _core.fill_halo(grid.core, q, component)
    return field


@settings(max_examples=150, deadline=None)
@given(kinds, seeds, st.integers(1, 3))
def test_spread_is_the_adjoint_of_interpolate(boundary, seed: int, threads: int) -> None:
    """<J u, f> dV_m = <u, S f> dV_cell for any velocity that meets the boundaries, markers at walls included."""
    rng = np.random.default_rng(seed)
    grid = Grid(Box(SIZE, boundary), CELLS, threads)
    position = points_in(grid, rng, 40)
    markers = markers_at(grid, position)
    u = current(grid, [rng.normal(size=grid.shape) for _ in range(3)])
    f, volume = rng.normal(size=(40, 3)), rng.uniform(0.1, 1.0, 40)
    spread = [grid.zeros() for _ in range(3)]
    markers.spread(grid.core, *spread, f, volume, 1.0)
    at_markers = float((volume[:, None] * interpolate(grid, markers, u) * f).sum())
    inner = (slice(1, -1),) * 3
    on_grid = sum(float((q[inner] * s[inner]).sum()) for q, s in zip(u, spread, strict=True)) * np.prod(grid.spacing)
    # Sums of some 1e3 products of order one.
    assert at_markers == pytest.approx(on_grid, abs=1e-12)


@settings(max_examples=30, deadline=None)
@given(kinds, seeds)
def test_spreading_does_not_depend_on_threads(boundary, seed: int) -> None:
    rng = np.random.default_rng(seed)
    position = points_in(Grid(Box(SIZE), CELLS), rng, 3000)  # enough for several threads to take part
    f, volume = rng.normal(size=(3000, 3)), rng.uniform(0.1, 1.0, 3000)
    found = []
    for threads in (1, 2, 3):
        grid = Grid(Box(SIZE, boundary), CELLS, threads)
        spread = [grid.zeros() for _ in range(3)]
        markers_at(grid, position).spread(grid.core, *spread, f, volume, 1.0)
        found.append(np.stack(spread))
    np.testing.assert_array_equal(found[1], found[0])
    np.testing.assert_array_equal(found[2], found[0])


@settings(max_examples=40, deadline=None)
@given(seeds, st.tuples(*[st.floats(-1.0, 1.0)] * 3), st.tuples(*[st.floats(-3.0, 3.0)] * 9))
def test_linear_fields_are_interpolated_exactly_in_the_bulk(seed: int, constant, slopes) -> None:
    """Partition of unity and zero first moment of the delta."""
    rng = np.random.default_rng(seed)
    grid = Grid(Box(SIZE), CELLS)
    # Away from sides by the reach of the delta, whose halos a linear field does not meet.
    margin = 2.0 * np.array(grid.spacing)
    position = margin + rng.uniform(size=(20, 3)) * (np.array(SIZE) - 2.0 * margin)
    gradient = np.array(slopes).reshape(3, 3)
    field = []
    for component, name in enumerate("uvw"):
        x, y, z = grid.points(name)
        value = constant[component] + gradient[component, 0] * x + gradient[component, 1] * y[:, None]
        field.append(np.ascontiguousarray(value + gradient[component, 2] * z[:, None, None]))
    found = interpolate(grid, markers_at(grid, position), field)
    np.testing.assert_allclose(found, constant + position @ gradient.T, rtol=0.0, atol=1e-13)


@pytest.mark.parametrize("direction", [0, 1, 2])
@pytest.mark.parametrize("side", [0, 1])
def test_shear_beside_a_moving_wall_is_interpolated_exactly(direction: int, side: int) -> None:
    """The halo continues a linear profile through the wall's speed, so the fold does."""
    speed, rate = np.zeros((6, 3)), 2.5
    along = (direction + 1) % 3
    speed[2 * direction + side, along] = 0.6
    boundary = ["periodic"] * 3
    boundary[direction] = "wall"
    grid = Grid(Box(SIZE, tuple(boundary), speed), CELLS)
    wall = side * SIZE[direction]
    coordinate = grid.points("uvw"[along])[direction]
    shape = [1, 1, 1]
    shape[2 - direction] = -1
    field = [grid.zeros() for _ in range(3)]
    field[along] += (0.6 + rate * (coordinate - wall)).reshape(shape)
    field = current(grid, field)
    distance = np.linspace(0.0, 1.5, 16) * grid.spacing[direction]
    position = np.tile(0.5 * np.array(SIZE), (16, 1))
    position[:, direction] = wall + (distance if side == 0 else -distance)
    found = interpolate(grid, markers_at(grid, position), field)
    np.testing.assert_allclose(found[:, along], 0.6 + rate * (position[:, direction] - wall), atol=1e-13)


@pytest.mark.parametrize("boundary", COMBINATIONS)
def test_uniform_flow_that_the_sides_allow_is_interpolated_exactly_up_to_them(boundary) -> None:
    speed = np.array([0.3, -0.2, 0.5])
    allowed = [  # a wall stops all, free slip its normal component only
        all(kind == "periodic" or (kind == "free-slip" and d != c) for d, kind in enumerate(boundary)) for c in range(3)
    ]
    grid = Grid(Box(SIZE, boundary), CELLS)
    field = current(grid, [np.full(grid.shape, s if ok else 0.0) for s, ok in zip(speed, allowed, strict=True)])
    position = points_in(grid, np.random.default_rng(2), 50)
    found = interpolate(grid, markers_at(grid, position), field)
    np.testing.assert_allclose(found, np.broadcast_to(np.where(allowed, speed, 0.0), found.shape), atol=1e-14)


@settings(max_examples=30, deadline=None)
@given(seeds, st.tuples(*[st.floats(-2.0, 2.0)] * 3))
def test_a_shift_over_a_periodic_side_changes_nothing(seed: int, shift) -> None:
    rng = np.random.default_rng(seed)
    grid = Grid(Box(SIZE, ("periodic",) * 3), CELLS)
    u = current(grid, [rng.normal(size=grid.shape) for _ in range(3)])
    position = points_in(grid, rng, 20)
    there = position + np.round(shift) * np.array(SIZE)
    found = interpolate(grid, markers_at(grid, np.ascontiguousarray(there)), u)
    # The delta's square root turns a rounding of the position, 1e-16, into its root at the edge of the support.
    np.testing.assert_allclose(found, interpolate(grid, markers_at(grid, position), u), atol=1e-6)
    f, volume = rng.normal(size=(20, 3)), rng.uniform(0.1, 1.0, 20) * grid.volume
    spread = [[grid.zeros() for _ in range(3)] for _ in range(2)]
    for at, target in zip((there, position), spread, strict=True):
        markers_at(grid, np.ascontiguousarray(at)).spread(grid.core, *target, f, volume, 1.0)
    np.testing.assert_allclose(spread[0], spread[1], atol=1e-3 * np.abs(spread[1]).max())


@settings(max_examples=15, deadline=None)
@given(st.integers(1, 60))
def test_marker_sets_have_no_preferred_direction(patches: int) -> None:
    count = 24 * patches
    points = sphere_points(count)
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), 1.0, atol=1e-14)
    np.testing.assert_allclose(points.sum(axis=0), 0.0, atol=1e-12)
    np.testing.assert_allclose(points.T @ points / count, np.eye(3) / 3.0, atol=1e-12)
    order = np.lexsort(points.round(9).T)
    for image in (points * [-1, 1, 1], points * [1, 1, -1], np.roll(points, 1, axis=1)):
        np.testing.assert_allclose(image[np.lexsort(image.round(9).T)], points[order], atol=1e-8)


@pytest.mark.parametrize("cells_per_diameter", [4, 6, 8, 12, 16, 20])
def test_markers_are_even(cells_per_diameter: int) -> None:
    count = marker_count(0.5 * cells_per_diameter, 1.0)
    points = sphere_points(count)
    square = 2.0 - 2.0 * points @ points.T
    np.fill_diagonal(square, np.inf)
    nearest = np.sqrt(square.min(axis=1))
    # A triangular lattice has sqrt(2 / sqrt(3)) = 1.07 of the square root of the area a marker; 0.7 leaves no clusters.
    assert nearest.min() > 0.7 * np.sqrt(4.0 * np.pi / count)


@pytest.mark.parametrize("count", [0, 12, 25])
def test_a_count_without_symmetry_is_refused(count: int) -> None:
    with pytest.raises(ValueError, match=f"count = {count}: must be a positive multiple of 24"):
        sphere_points(count)


def test_marker_layer_is_one_cell_thick_and_turns_with_the_body() -> None:
    grid = Grid(Box((1.0, 1.0, 1.0)), (20, 20, 20))
    bodies = Bodies([0.4], [1000.0], [[0.5, 0.5, 0.5]])
    markers = MarkerSet(bodies, grid)
    bodies.orientation[0] = np.array([1.0, 0.0, 0.0, 1.0]) / np.sqrt(2.0)  # a quarter turn about z
    markers.force[:] = [1.0, 0.0, 0.0]
    markers.store_force(bodies.orientation, 0.5)
    bodies.orientation[0] = [1.0, 0.0, 0.0, 0.0]
    markers.place(bodies.position, bodies.orientation)
    np.testing.assert_allclose(markers.force, np.tile([0.0, -0.5, 0.0], (len(markers), 1)), atol=1e-15)
    depth = 0.2 - CALIBRATION.marker_retraction * 0.05
    np.testing.assert_allclose(np.linalg.norm(markers.position - 0.5, axis=1), depth, atol=1e-15)
    shell = 4.0 / 3.0 * np.pi * ((depth + 0.025) ** 3 - (depth - 0.025) ** 3)
    assert markers.volume.sum() == pytest.approx(shell, rel=1e-13)


@settings(max_examples=12, deadline=None)
@given(kinds, seeds)
def test_many_bodies_give_what_each_gives_alone(boundary, seed: int) -> None:
    """Bodies across sides included, in any order of heights, on one to three threads."""
    rng = np.random.default_rng(seed)
    size, cells, count = (1.0, 1.1, 1.2), (30, 33, 36), 12
    diameter = rng.uniform(0.26, 0.36, count)
    inside = 0.5 * diameter[:, None] + rng.uniform(size=(count, 3)) * (np.array(size) - diameter[:, None])
    anywhere = rng.uniform(size=(count, 3)) * size
    centres = np.where([kind == "periodic" for kind in boundary], anywhere, inside)
    found = []
    for threads in (1, 2, 3):
        grid = Grid(Box(size, boundary), cells, threads)
        bodies = Bodies(diameter, np.full(count, 1000.0), centres)
        markers = MarkerSet(bodies, grid)
        assert len(markers) > 2048  # or one thread would do it all
        markers.place(bodies.position, bodies.orientation)
        if threads == 1:
            u = current(grid, [rng.normal(size=grid.shape) for _ in range(3)])
            f = rng.normal(size=(len(markers), 3))
        target = (grid.zeros(), grid.zeros(), grid.zeros())
        markers.spread(target, f, 2.0)
        inner = markers.interior_motion((u[0], u[1], u[2]), bodies)
        found.append((markers.interpolate((u[0], u[1], u[2])).copy(), np.stack(target), inner))
    for other in found[1:]:
        for ours, theirs in zip(found[0], other, strict=True):
            np.testing.assert_array_equal(ours, theirs)
    alone, total = [], np.zeros_like(found[0][1])
    for b in range(count):
        body = Bodies(diameter[b : b + 1], np.array([1000.0]), centres[b : b + 1])
        one = MarkerSet(body, grid)
        one.place(body.position, body.orientation)
        target = (grid.zeros(), grid.zeros(), grid.zeros())
        one.spread(target, f[markers.body == b], 2.0)
        total += np.stack(target)
        alone.append(one.interpolate((u[0], u[1], u[2])).copy())
        np.testing.assert_array_equal(one.interior_motion((u[0], u[1], u[2]), body)[0], inner[b])
    np.testing.assert_array_equal(np.concatenate(alone), found[0][0])
    # Cells that several bodies give to: sums of some ten terms of at most order ten, in another order.
    np.testing.assert_allclose(total, found[0][1], rtol=0.0, atol=1e-13)


def test_markers_close_to_another_surface_are_excluded() -> None:
    h = 0.05
    grid = Grid(Box((1.0, 1.0, 1.0), ("wall", "periodic", "wall")), (20, 20, 20))
    bodies = Bodies([0.3, 0.3], [1000.0] * 2, [[0.12, 0.02, 0.5], [0.36, 0.98, 0.5]])  # neighbours across the seam
    markers = MarkerSet(bodies, grid)
    markers.place(bodies.position, bodies.orientation)
    markers.exclude(bodies, np.array([[0, 1], [0, -1], [0, -3]], np.int32), 0.2)
    away = markers.position - bodies.position[[1, 0]][markers.body]
    away[:, 1] -= np.round(away[:, 1])
    gap = np.linalg.norm(away, axis=1) - 0.15
    gap = np.where(markers.body == 0, np.minimum(gap, markers.position[:, 0]), gap)  # y has no solid sides
    near, far = CALIBRATION.exclusion_near, CALIBRATION.exclusion_far
    share = 0.2 + 0.8 * np.clip((gap / h - near) / (far - near), 0.0, 1.0)
    expected = markers.full_volume * share * np.clip(1.0 + gap / h, 0.0, 1.0)
    np.testing.assert_allclose(markers.volume, expected, rtol=1e-12, atol=1e-15)
    assert (markers.volume < 0.2 * markers.full_volume).any()
    assert (markers.volume == markers.full_volume).any()
    markers.exclude(bodies, np.zeros((0, 2), np.int32), 0.2)
    np.testing.assert_array_equal(markers.volume, markers.full_volume)


def test_layer_matrix_is_the_sums_of_a_rigid_motion() -> None:
    grid = Grid(Box((1.0, 1.0, 1.0)), (20, 20, 20))
    bodies = Bodies([0.3, 0.4], [1000.0] * 2, [[0.16, 0.5, 0.5], [0.53, 0.5, 0.5]])
    markers = MarkerSet(bodies, grid)
    markers.place(bodies.position, bodies.orientation)
    markers.exclude(bodies, np.array([[0, 1], [0, -1]], np.int32), 0.1)
    motion = np.random.default_rng(3).normal(size=(2, 6))
    turned = np.cross(motion[markers.body, 3:], markers.arm)
    sums = markers.sums(motion[markers.body, :3] + turned)
    np.testing.assert_allclose(np.einsum("nij,nj->ni", markers.layer_matrix(), motion), sums, rtol=1e-12, atol=1e-16)



def test_marker_sets_of_all_sizes_up_to_40_cells_a_diameter_are_kept() -> None:
    """A count is a multiple of 24: each is relaxed once a process, in whatever order the sizes come."""
    from rdpm.particles import seeding

    room = seeding._points.cache_info().maxsize
    assert room is not None
    assert marker_count(20.0, 1.0) // seeding.SYMMETRY <= room
