"""What ParaView's own reader finds in the files."""

from __future__ import annotations

import numpy as np
import pytest

from rdpm.errors import CaseError, OutputError
from rdpm.io.sphere_surface import sphere_surface
from rdpm.io.vtkhdf import FieldWriter, field_grid, field_times, read_fields, read_plane
from rdpm.io.vtkhdf_bodies import BodyWriter

CELLS, SPACING = (20, 5, 18), (0.1, 0.2, 0.3)   # more than one chunk along x and z


def made_fields(step):
    k, j, i = np.meshgrid(np.arange(18.0), np.arange(5.0), np.arange(20.0), indexing="ij")
    return np.stack([i + 100 * step, j, k], axis=-1), i + 20 * j + 100 * k + 10000 * step


@pytest.fixture
def fields(tmp_path):
    writer = FieldWriter(tmp_path / "fields.vtkhdf", CELLS, SPACING)
    for step in range(3):
        writer.write(0.5 * step, *made_fields(step))
    return tmp_path / "fields.vtkhdf"


def opened_by_vtk(path):
    vtk = pytest.importorskip("vtk")
    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    key = vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS()
    information = reader.GetOutputInformation(0)
    return reader, [information.Get(key, n) for n in range(information.Length(key))]


def array_of(attributes, name):
    from vtk.util.numpy_support import vtk_to_numpy

    return vtk_to_numpy(attributes.GetArray(name))


def test_vtk_reads_the_fields(fields):
    reader, times = opened_by_vtk(fields)
    assert times == [0.0, 0.5, 1.0]
    for step, time in enumerate(times):
        reader.UpdateTimeStep(time)
        image = reader.GetOutput()
        assert image.GetDimensions() == (21, 6, 19)
        assert image.GetSpacing() == SPACING
        velocity, pressure = made_fields(step)
        assert np.array_equal(array_of(image.GetCellData(), "velocity"), velocity.reshape(-1, 3))
        assert np.array_equal(array_of(image.GetCellData(), "pressure"), pressure.ravel())


def test_fields_read_back(fields):
    assert field_times(fields).tolist() == [0.0, 0.5, 1.0]
    assert field_grid(fields) == (CELLS, SPACING)
    time, velocity, pressure = read_fields(fields, -1)
    assert time == 1.0
    assert velocity.dtype == pressure.dtype == np.float32
    assert np.array_equal(velocity, made_fields(2)[0])
    assert np.array_equal(pressure, made_fields(2)[1])
    with pytest.raises(IndexError):
        read_fields(fields, 3)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6])
def test_rounded_fields_keep_to_their_tolerance(tmp_path, tolerance):
    path = tmp_path / "fields.vtkhdf"
    writer = FieldWriter(path, CELLS, SPACING, tolerance=tolerance)
    noise = np.random.default_rng(3).normal(size=(2, 18, 5, 20, 4)).astype(np.float32)
    for step, values in enumerate(noise):
        writer.write(0.5 * step, values[..., :3], values[..., 3])
    reader, times = opened_by_vtk(path)
    for step, time in enumerate(times):
        reader.UpdateTimeStep(time)
        data = reader.GetOutput().GetCellData()
        for name, part in (("velocity", noise[step, ..., :3]), ("pressure", noise[step, ..., 3])):
            error = np.abs(array_of(data, name).reshape(part.shape) - part).max()
            # not below a twentieth of it: the bits are spent on what the tolerance leaves
            assert 0.05 * tolerance < error / np.abs(part).max() <= tolerance
    writer = FieldWriter(path, CELLS, SPACING, keep_until=0.2, tolerance=tolerance)
    writer.write(0.7, *made_fields(1))
    assert field_times(path).tolist() == [0.0, 0.7]
    assert np.abs(read_fields(path, 1)[1] - made_fields(1)[0]).max() <= tolerance * 119.0   # its largest


def test_fluid_at_rest_and_broken_values_are_stored_as_they_are(tmp_path):
    path = tmp_path / "fields.vtkhdf"
    writer = FieldWriter(path, CELLS, SPACING, tolerance=1e-3)
    still = np.zeros((18, 5, 20, 3)), np.full((18, 5, 20), np.nan)
    writer.write(0.0, *still)
    assert np.array_equal(read_fields(path, 0)[1], still[0])
    assert np.isnan(read_fields(path, 0)[2]).all()


@pytest.mark.parametrize(("normal", "position", "index"), [("x", 1.05, 10), ("y", 99.0, 4), ("z", -1.0, 0)])
def test_plane_is_the_layer_of_cells_it_cuts(fields, normal, position, index):
    expected = np.take(made_fields(1)[0], index, axis="zyx".index(normal))
    assert np.array_equal(read_plane(fields, 1, normal, position), expected)


def test_file_is_readable_after_every_write(tmp_path):
    path = tmp_path / "fields.vtkhdf"
    writer = FieldWriter(path, CELLS, SPACING)
    assert len(field_times(path)) == 0
    writer.write(0.25, *made_fields(0))
    assert field_times(path).tolist() == [0.25]


def test_continued_fields_drop_later_steps(fields):
    writer = FieldWriter(fields, CELLS, SPACING, keep_until=0.5)
    writer.write(0.75, *made_fields(7))
    _, times = opened_by_vtk(fields)
    assert times == [0.0, 0.5, 0.75]
    assert np.array_equal(read_fields(fields, 2)[1], made_fields(7)[0])


def test_a_step_broken_off_on_the_way_is_not_counted(tmp_path):
    import h5py

    path = tmp_path / "fields.vtkhdf"
    FieldWriter(path, (4, 3, 2), (1.0, 1.0, 1.0)).write(0.0, np.ones((2, 3, 4, 3)), np.zeros((2, 3, 4)))
    with h5py.File(path, "r+") as file:   # rows made, not filled, not counted: what a kill leaves
        for name in ("CellData/velocity", "CellData/pressure", "Steps/Values"):
            file["VTKHDF"][name].resize(2, axis=0)
    assert field_times(path).tolist() == [0.0]
    FieldWriter(path, (4, 3, 2), (1.0, 1.0, 1.0), keep_until=0.5).write(1.0, np.ones((2, 3, 4, 3)), np.zeros((2, 3, 4)))
    assert field_times(path).tolist() == [0.0, 1.0]


def test_wrong_shape_and_lost_folder(tmp_path):
    writer = FieldWriter(tmp_path / "fields.vtkhdf", CELLS, SPACING)
    with pytest.raises(ValueError, match="must be"):
        writer.write(0.0, np.zeros((2, 2, 2, 3)), np.zeros((2, 2, 2)))
    (tmp_path / "fields.vtkhdf").unlink()
    with pytest.raises(OutputError, match="cannot be written"):
        writer.write(0.0, *made_fields(0))
    with pytest.raises(CaseError, match="VTKHDF"):
        field_times(tmp_path / "fields.vtkhdf")


def write_bodies(writer, step):
    position = np.array([[0.0, 0.0, step], [2.0 + step, 0.0, 0.0]])
    velocity = np.array([[0.0, 0.0, 1.0], [3.0, 4.0, 0.0]]) * (step + 1)
    writer.write(0.5 * step, position, [1.0, 0.5], velocity, -velocity)


def test_vtk_reads_the_bodies(tmp_path):
    writer = BodyWriter(tmp_path / "bodies.vtkhdf")
    for step in range(3):
        write_bodies(writer, step)
    reader, times = opened_by_vtk(tmp_path / "bodies.vtkhdf")
    assert times == [0.0, 0.5, 1.0]
    for step, time in enumerate(times):
        reader.UpdateTimeStep(time)
        surface = reader.GetOutput()
        ids = array_of(surface.GetPointData(), "id")
        velocity = array_of(surface.GetPointData(), "velocity")
        assert np.bincount(ids).tolist() == [642, 642]
        assert surface.GetNumberOfCells() == 2 * 1280
        assert np.allclose(velocity[ids == 1], [3.0 * (step + 1), 4.0 * (step + 1), 0.0])
        assert np.allclose(array_of(surface.GetPointData(), "speed")[ids == 1], 5.0 * (step + 1))
        spin = array_of(surface.GetPointData(), "angular_velocity")
        assert np.allclose(spin[ids == 0], [0, 0, -(step + 1)])
        # The icosahedron's corners lie on the coordinate planes only: extremes fall short by up to 1 % of a.
        assert np.allclose(surface.GetBounds()[:2], (-0.5, 2.25 + step), atol=0.01)
        assert np.allclose(surface.GetBounds()[5], 0.5 + step, atol=0.01)


def test_continued_bodies_drop_later_steps(tmp_path):
    writer = BodyWriter(tmp_path / "bodies.vtkhdf")
    for step in range(3):
        write_bodies(writer, step)
    writer = BodyWriter(tmp_path / "bodies.vtkhdf", keep_until=0.6)
    write_bodies(writer, 4)
    reader, times = opened_by_vtk(tmp_path / "bodies.vtkhdf")
    assert times == [0.0, 0.5, 2.0]
    reader.UpdateTimeStep(2.0)
    assert np.isclose(reader.GetOutput().GetBounds()[1], 6.25, atol=0.01)
    with pytest.raises(ValueError, match="another number"):
        writer.write(3.0, np.zeros((1, 3)), [1.0], np.zeros((1, 3)), np.zeros((1, 3)))


def test_sphere_surface_closes_and_points_outward():
    points, triangles = sphere_surface(2)
    corners = points[triangles]
    volume = np.einsum("ij,ij->", np.cross(corners[:, 0], corners[:, 1]), corners[:, 2]) / 6.0
    assert np.allclose(np.linalg.norm(points, axis=1), 1.0)
    assert 0.95 < volume / (4.0 / 3.0 * np.pi) < 1.0   # inscribed: 3.4 % short with 320 triangles
    sides = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    assert np.all(np.unique(sides, axis=0, return_counts=True)[1] == 2)
