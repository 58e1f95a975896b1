"""Fields and bodies as VTKHDF with time steps: ParaView 5.13 or newer opens them as they are."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rdpm.errors import CaseError
from rdpm.io.appending import appending, reserve
from rdpm.io.files import replacing
from rdpm.io.sphere_surface import sphere_surface
from rdpm.parallel.gather import Planes

if TYPE_CHECKING:
    import h5py

__all__ = ["BodyWriter", "FieldWriter", "field_grid", "field_times", "read_fields", "read_plane"]

Floats = NDArray[np.float64]
_PACKED = {"compression": "gzip", "compression_opts": 1, "shuffle": True}   # VTK reads no lzf
_POINTS = 65536   # a chunk of the bodies' surfaces
_CHUNK = 32   # cells an edge: a plane in any direction reads a part of the file only


def _start(file: h5py.File, kind: str) -> h5py.Group:
    root: h5py.Group = file.create_group("VTKHDF", track_order=True)
    root.attrs["Version"] = (2, 2)
    root.attrs["Type"] = np.bytes_(kind)
    steps = root.create_group("Steps")
    steps.attrs["NSteps"] = 0
    steps.create_dataset("Values", shape=(0,), maxshape=(None,), dtype="f8", chunks=(256,))
    return root


def _append(dataset: h5py.Dataset, rows: NDArray[Any]) -> None:
    count = dataset.shape[0]
    dataset.resize(count + len(rows), axis=0)
    dataset[count:] = rows


def _append_planes(dataset: h5py.Dataset, values: NDArray[Any] | Planes) -> None:
    count, below = dataset.shape[0], 0
    dataset.resize(count + 1, axis=0)
    for part in values if isinstance(values, Planes) else (values,):
        dataset[count, below : below + len(part)] = part
        below += len(part)


def _steps_until(steps: h5py.Group, time: float) -> int:
    """Whole steps not after a time: a writer killed on the way leaves rows that NSteps does not count yet."""
    whole = steps["Values"][: int(steps.attrs["NSteps"])]
    return int(np.searchsorted(whole, time, side="right"))


class FieldWriter:
    """Velocity and pressure of the cells, one time step after the other (VTKHDF ImageData).

    Parameters
    ----------
    path : path
        The file, ``fields.vtkhdf`` in a run's folder.
    cells : tuple of int, (3,)
        nx, ny, nz.
    spacing : tuple of float, (3,), [m]
        dx, dy, dz.
    keep_until : float, optional, [s]
        Continue an existing file: steps after this time are dropped, later ones appended. Without it
        an older file is replaced.

    Raises
    ------
    OutputError
        The file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp()) / "fields.vtkhdf"
    >>> fields = FieldWriter(path, cells=(4, 3, 2), spacing=(0.1, 0.1, 0.1))
    >>> fields.write(0.5, np.ones((2, 3, 4, 3)), np.zeros((2, 3, 4)))
    >>> field_times(path).tolist()
    [0.5]
    """

    def __init__(
        self,
        path: str | Path,
        cells: tuple[int, int, int],
        spacing: tuple[float, float, float],
        keep_until: float | None = None,
    ) -> None:
        self.path = Path(path)
        self.shape = (int(cells[2]), int(cells[1]), int(cells[0]))
        if keep_until is not None and self.path.exists():
            self._rewind(keep_until)
            return
        with replacing(self.path) as temporary:
            self._create(temporary, spacing)

    def _create(self, temporary: Path, spacing: tuple[float, float, float]) -> None:
        import h5py

        nz, ny, nx = self.shape
        reserve(temporary)
        with h5py.File(temporary, "w") as file:
            root = _start(file, "ImageData")
            root.attrs["WholeExtent"] = np.array([0, nx, 0, ny, 0, nz], np.int64)
            root.attrs["Origin"] = np.zeros(3)
            root.attrs["Spacing"] = np.array(spacing, np.float64)
            root.attrs["Direction"] = np.eye(3).ravel()
            data = root.create_group("CellData")
            data.attrs["Vectors"] = np.bytes_("velocity")
            data.attrs["Scalars"] = np.bytes_("pressure")
            offsets = root["Steps"].create_group("CellDataOffsets")
            for name, tail in (("velocity", (3,)), ("pressure", ())):
                shape = (*self.shape, *tail)
                chunk = (1, *[-(-n // -(-n // _CHUNK)) for n in self.shape], *tail)   # equal pieces: no padding
                data.create_dataset(
                    # raw: packing costs more than the steps between two pictures, and saves a third
                    name, shape=(0, *shape), maxshape=(None, *shape), dtype="f4", chunks=chunk
                )
                offsets.create_dataset(name, shape=(0,), maxshape=(None,), dtype="i8", chunks=(256,))

    def _rewind(self, time: float) -> None:
        with appending(self.path) as root:
            count = _steps_until(root["Steps"], time)
            for name in ("CellData/velocity", "CellData/pressure", "Steps/Values"):
                root[name].resize(count, axis=0)
            for name in ("velocity", "pressure"):
                root["Steps/CellDataOffsets"][name].resize(count, axis=0)
            root["Steps"].attrs["NSteps"] = count

    def write(self, time: float, velocity: ArrayLike | Planes, pressure: ArrayLike | Planes) -> None:
        """Append one step; afterwards the file on disk is complete.

        Parameters
        ----------
        time : float, [s]
            Later than the step before.
        velocity : array_like, (nz, ny, nx, 3), [m/s]
            u, v, w at the cells' centres; stored in single precision. From planes of several ranks it is taken slab by
            slab, and so is the pressure.
        pressure : array_like, (nz, ny, nx), [Pa]

        Raises
        ------
        ValueError
            Another shape.
        OutputError
            The file cannot be written.
        """
        u, p = (
            values if isinstance(values, Planes) else np.asarray(values, np.float32) for values in (velocity, pressure)
        )
        if u.shape != (*self.shape, 3) or p.shape != self.shape:
            rule = f"must be {(*self.shape, 3)} and {self.shape}"
            raise ValueError(f"velocity {u.shape}, pressure {p.shape}: {rule}")
        with appending(self.path, 16 * math.prod(self.shape)) as root:
            step = int(root["Steps"].attrs["NSteps"])
            for name, values in (("velocity", u), ("pressure", p)):
                _append_planes(root["CellData"][name], values)
                _append(root["Steps/CellDataOffsets"][name], np.array([step]))
            _append(root["Steps/Values"], np.array([time]))
            root["Steps"].attrs["NSteps"] = step + 1


@contextmanager
def _reading(path: str | Path) -> Iterator[h5py.Group]:
    import h5py

    try:
        with h5py.File(path, "r") as file:
            yield file["VTKHDF"]
    except (OSError, KeyError) as error:
        reason = str(error).splitlines()[0]
        raise CaseError(str(path), None, "must be a VTKHDF file of a run", reason) from error


def field_times(path: str | Path) -> Floats:
    """Times of the stored steps: (steps,), [s]; `CaseError` when there is no such file."""
    with _reading(path) as root:
        return np.asarray(root["Steps/Values"][: int(root["Steps"].attrs["NSteps"])], np.float64)


def field_grid(path: str | Path) -> tuple[tuple[int, int, int], tuple[float, float, float]]:
    """Cells (nx, ny, nz) and spacing (dx, dy, dz) [m] of the stored fields.

    Raises
    ------
    CaseError
        The file is missing or no VTKHDF file.
    """
    with _reading(path) as root:
        nx, ny, nz = (int(n) for n in root.attrs["WholeExtent"][1::2])
        dx, dy, dz = (float(d) for d in root.attrs["Spacing"])
    return (nx, ny, nz), (dx, dy, dz)


def read_fields(path: str | Path, step: int) -> tuple[float, NDArray[np.float32], NDArray[np.float32]]:
    """One stored step.

    Parameters
    ----------
    path : path
        A file of `FieldWriter`.
    step : int
        0 is the first; negative ones count from the end.

    Returns
    -------
    time : float, [s]
    velocity : ndarray, (nz, ny, nx, 3), [m/s]
    pressure : ndarray, (nz, ny, nx), [Pa]

    Raises
    ------
    CaseError, IndexError
        The file is missing or no VTKHDF file; there is no such step.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp()) / "fields.vtkhdf"
    >>> fields = FieldWriter(path, cells=(4, 3, 2), spacing=(0.1, 0.1, 0.1))
    >>> fields.write(0.5, np.ones((2, 3, 4, 3)), np.zeros((2, 3, 4)))
    >>> time, velocity, pressure = read_fields(path, -1)
    >>> time, velocity.shape, float(velocity.max())
    (0.5, (2, 3, 4, 3), 1.0)
    """
    with _reading(path) as root:
        step = range(int(root["Steps"].attrs["NSteps"]))[step]
        data = root["CellData"]
        return float(root["Steps/Values"][step]), data["velocity"][step], data["pressure"][step]


def read_plane(path: str | Path, step: int, normal: str, position: float) -> NDArray[np.float32]:
    """Velocity in the layer of cells that a plane cuts, at one stored step.

    Parameters
    ----------
    path, step
        As for `read_fields`.
    normal : str
        ``"x"``, ``"y"`` or ``"z"``.
    position : float, [m]
        Of the plane along its normal; moved into the box.

    Returns
    -------
    ndarray, (nz, nx, 3) for ``"y"``, (nz, ny, 3) for ``"x"``, (ny, nx, 3) for ``"z"``, [m/s]
    """
    axis = "xyz".index(normal)
    with _reading(path) as root:
        step = range(int(root["Steps"].attrs["NSteps"]))[step]
        data = root["CellData/velocity"]
        cell = int(position // float(root.attrs["Spacing"][axis]))
        cell = min(max(cell, 0), data.shape[3 - axis] - 1)
        index: list[Any] = [step, slice(None), slice(None), slice(None)]
        index[3 - axis] = cell
        return np.asarray(data[tuple(index)], np.float32)


class BodyWriter:
    """Spheres as triangulated surfaces, one time step after the other (VTKHDF PolyData).

    The surface is fine for few bodies (642 points each) and coarse for many (12 beyond 2000). Point
    data: ``id``, ``velocity`` (of the centre), ``angular_velocity``, ``speed``.

    Parameters
    ----------
    path : path
        The file, ``bodies.vtkhdf`` in a run's folder.
    keep_until : float, optional, [s]
        As for `FieldWriter`.

    Raises
    ------
    OutputError
        The file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> bodies = BodyWriter(Path(tempfile.mkdtemp()) / "bodies.vtkhdf")
    >>> still = np.zeros((1, 3))
    >>> bodies.write(0.0, [[0.05, 0.05, 0.1]], [0.015], still, still)
    >>> field_times(bodies.path).tolist()
    [0.0]
    """

    _VALUES = (("velocity", 3), ("angular_velocity", 3), ("speed", 1))
    _EACH_STEP = (
        "Values", "PartOffsets", "NumberOfParts", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets",
    )

    def __init__(self, path: str | Path, keep_until: float | None = None) -> None:
        self.path = Path(path)
        if keep_until is None or not self.path.exists():
            import h5py

            with replacing(self.path) as temporary:
                reserve(temporary)
                with h5py.File(temporary, "w") as file:
                    _start(file, "PolyData")
            return
        with appending(self.path) as root:
            if "Points" in root:
                self._rewind(root, keep_until)

    def _rewind(self, root: h5py.Group, time: float) -> None:
        steps, each = root["Steps"], int(root["NumberOfPoints"][0])
        count = _steps_until(steps, time)
        for name in self._EACH_STEP:
            steps[name].resize(count, axis=0)
        for dataset in steps["PointDataOffsets"].values():
            dataset.resize(count, axis=0)
        for name in ("Points", *(f"PointData/{name}" for name, _ in self._VALUES)):
            root[name].resize(count * each, axis=0)
        steps.attrs["NSteps"] = count

    def _create(self, root: h5py.Group, count: int) -> None:
        """Everything that does not change from step to step: triangles and ids are stored once."""
        points, triangles = sphere_surface(_level(count))
        size = len(points)
        cells = (triangles[None] + size * np.arange(count)[:, None, None]).reshape(-1, 3)
        for name, used in (("Vertices", 0), ("Lines", 0), ("Polygons", len(cells)), ("Strips", 0)):
            group = root.create_group(name)
            group.create_dataset("NumberOfCells", data=np.array([used]))
            group.create_dataset("NumberOfConnectivityIds", data=np.array([3 * used]))
            group.create_dataset("Offsets", data=3 * np.arange(used + 1))
            group.create_dataset("Connectivity", data=cells[:used].ravel())
        root.create_dataset("NumberOfPoints", data=np.array([count * size]))
        chunk = (max(1, min(count * size, _POINTS)), 3)
        root.create_dataset("Points", (0, 3), maxshape=(None, 3), dtype="f4", chunks=chunk, **_PACKED)
        data, steps = root.create_group("PointData"), root["Steps"]
        offsets = steps.create_group("PointDataOffsets")
        data.create_dataset("id", data=np.repeat(np.arange(count), size))
        for name, width in self._VALUES:
            tail = (width,) if width > 1 else ()
            data.create_dataset(
                name, (0, *tail), maxshape=(None, *tail), dtype="f4", chunks=(chunk[0], *tail), **_PACKED
            )
        for name in data:
            offsets.create_dataset(name, shape=(0,), maxshape=(None,), dtype="i8", chunks=(256,))
        for name in self._EACH_STEP[1:4]:
            steps.create_dataset(name, shape=(0,), maxshape=(None,), dtype="i8", chunks=(256,))
        for name in self._EACH_STEP[4:]:
            steps.create_dataset(name, shape=(0, 4), maxshape=(None, 4), dtype="i8", chunks=(256, 4))

    def write(
        self,
        time: float,
        position: ArrayLike,
        diameter: ArrayLike,
        velocity: ArrayLike,
        angular_velocity: ArrayLike,
    ) -> None:
        """Append one step; afterwards the file on disk is complete.

        Parameters
        ----------
        time : float, [s]
            Later than the step before.
        position : array_like, (N, 3), [m]
            Centres; N is the same in every step.
        diameter : array_like, (N,), [m]
        velocity, angular_velocity : array_like, (N, 3), [m/s], [rad/s]

        Raises
        ------
        ValueError
            Another number of bodies.
        OutputError
            The file cannot be written.
        """
        centre = np.asarray(position, np.float64).reshape(-1, 3)
        count = len(centre)
        radius = 0.5 * np.asarray(diameter, np.float64).reshape(count)
        unit, _ = sphere_surface(_level(count))
        u = np.asarray(velocity, np.float64).reshape(count, 3)
        omega = np.asarray(angular_velocity, np.float64).reshape(count, 3)
        values = {"velocity": u, "angular_velocity": omega, "speed": np.linalg.norm(u, axis=1)}
        # 44 bytes a point and 64 of its triangles; a begun chunk of each dataset may move to another place.
        with appending(self.path, count * len(unit) * 108 + _POINTS * 44) as root:
            if "Points" not in root:
                self._create(root, count)
            if root["NumberOfPoints"][0] != count * len(unit):
                raise ValueError(f"{count} bodies: the steps before have another number of them")
            steps = root["Steps"]
            start = root["Points"].shape[0]
            _append(root["Points"], (centre[:, None] + radius[:, None, None] * unit).reshape(-1, 3))
            for name, each in values.items():
                _append(root["PointData"][name], np.repeat(each, len(unit), axis=0))
            for name, dataset in steps["PointDataOffsets"].items():
                _append(dataset, np.array([0 if name == "id" else start]))
            for name, value in zip(self._EACH_STEP, (time, 0, 1, start), strict=False):
                _append(steps[name], np.array([value]))
            for name in self._EACH_STEP[4:]:
                _append(steps[name], np.zeros((1, 4), np.int64))
            steps.attrs["NSteps"] = int(steps.attrs["NSteps"]) + 1


def _level(count: int) -> int:
    return 3 if count <= 20 else 2 if count <= 200 else 1 if count <= 2000 else 0
