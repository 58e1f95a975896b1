"""Bodies as surfaces in VTKHDF with time steps: ParaView 5.13 or newer opens them as they are."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from rdpm.io.appending import appending, reserve
from rdpm.io.files import replacing
from rdpm.io.packing import PACKED
from rdpm.io.sphere_surface import sphere_surface, surface_level
from rdpm.io.vtkhdf import append_rows, start_file, steps_until

if TYPE_CHECKING:
    import h5py

__all__ = ["BodyWriter"]

_POINTS = 65536   # a chunk of the bodies' surfaces


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
    >>> from rdpm.io.vtkhdf import field_times
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
                    start_file(file, "PolyData")
            return
        with appending(self.path) as root:
            if "Points" in root:
                self._rewind(root, keep_until)

    def _rewind(self, root: h5py.Group, time: float) -> None:
        steps, each = root["Steps"], int(root["NumberOfPoints"][0])
        count = steps_until(steps, time)
        for name in self._EACH_STEP:
            steps[name].resize(count, axis=0)
        for dataset in steps["PointDataOffsets"].values():
            dataset.resize(count, axis=0)
        for name in ("Points", *(f"PointData/{name}" for name, _ in self._VALUES)):
            root[name].resize(count * each, axis=0)
        steps.attrs["NSteps"] = count

    def _create(self, root: h5py.Group, count: int) -> None:
        """Everything that does not change from step to step: triangles and ids are stored once."""
        points, triangles = sphere_surface(surface_level(count))
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
        root.create_dataset("Points", (0, 3), maxshape=(None, 3), dtype="f4", chunks=chunk, **PACKED)
        data, steps = root.create_group("PointData"), root["Steps"]
        offsets = steps.create_group("PointDataOffsets")
        data.create_dataset("id", data=np.repeat(np.arange(count), size))
        for name, width in self._VALUES:
            tail = (width,) if width > 1 else ()
            data.create_dataset(
                name, (0, *tail), maxshape=(None, *tail), dtype="f4", chunks=(chunk[0], *tail), **PACKED
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
        unit, _ = sphere_surface(surface_level(count))
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
            append_rows(root["Points"], (centre[:, None] + radius[:, None, None] * unit).reshape(-1, 3))
            for name, each in values.items():
                append_rows(root["PointData"][name], np.repeat(each, len(unit), axis=0))
            for name, dataset in steps["PointDataOffsets"].items():
                append_rows(dataset, np.array([0 if name == "id" else start]))
            for name, value in zip(self._EACH_STEP, (time, 0, 1, start), strict=False):
                append_rows(steps[name], np.array([value]))
            for name in self._EACH_STEP[4:]:
                append_rows(steps[name], np.zeros((1, 4), np.int64))
            steps.attrs["NSteps"] = int(steps.attrs["NSteps"]) + 1
