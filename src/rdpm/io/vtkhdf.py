"""Fields as VTKHDF with time steps: ParaView 5.13 or newer opens them as they are."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rdpm.errors import CaseError
from rdpm.io.appending import appending, reserve
from rdpm.io.files import replacing
from rdpm.io.packing import PACKED, append_rounded
from rdpm.parallel.gather import Planes

if TYPE_CHECKING:
    import h5py

__all__ = [
    "FLOW", "FieldWriter", "append_rows", "field_grid", "field_origin", "field_quantities", "field_times",
    "read_fields", "read_plane", "read_steps", "start_file", "steps_until",
]  # fmt: skip

Floats = NDArray[np.float64]
_CHUNK = 32   # cells an edge: a plane in any direction reads a part of the file only


def start_file(file: h5py.File, kind: str) -> h5py.Group:
    """Change an empty file: the groups that each kind of VTKHDF with time steps has; the root is returned."""
    root: h5py.Group = file.create_group("VTKHDF", track_order=True)
    root.attrs["Version"] = (2, 2)
    root.attrs["Type"] = np.bytes_(kind)
    steps = root.create_group("Steps")
    steps.attrs["NSteps"] = 0
    steps.create_dataset("Values", shape=(0,), maxshape=(None,), dtype="f8", chunks=(256,))
    return root


def append_rows(dataset: h5py.Dataset, rows: NDArray[Any]) -> None:
    """Change a dataset: rows more at its end."""
    count = dataset.shape[0]
    dataset.resize(count + len(rows), axis=0)
    dataset[count:] = rows


def steps_until(steps: h5py.Group, time: float) -> int:
    """Whole steps not after a time: a writer killed on the way leaves rows that NSteps does not count yet."""
    whole = steps["Values"][: int(steps.attrs["NSteps"])]
    return int(np.searchsorted(whole, time, side="right"))


#: What the cells of a flow hold, and how many components each has.
FLOW = {"velocity": 3, "pressure": 1}


class FieldWriter:
    """Quantities of the cells, one time step after the other (VTKHDF ImageData).

    Parameters
    ----------
    path : path
        The file, ``fields.vtkhdf`` in a run's folder.
    cells : tuple of int, (3,)
        nx, ny, nz.
    spacing : tuple of float, (3,), [m]
        dx, dy, dz.
    keep_until : float, optional, [s]
        Continues a file: steps after this time are dropped, later ones appended. Without it an older file is replaced.
    quantities : mapping of str to int
        Names, and components of each: 1 or 3. Velocity and pressure when left out.
    origin : tuple of float, (3,), [m]
        Lower corner.
    tolerance : float, [-]
        Rounds by at most so much of the largest magnitude of a step, and compresses; 0 keeps single precision.

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
        quantities: Mapping[str, int] = FLOW,
        origin: tuple[float, float, float] = (0.0, 0.0, 0.0),
        tolerance: float = 0.0,
    ) -> None:
        self.path, self.quantities, self.tolerance = Path(path), dict(quantities), tolerance
        self.shape = (int(cells[2]), int(cells[1]), int(cells[0]))
        if keep_until is not None and self.path.exists():
            self._rewind(keep_until)
            return
        with replacing(self.path) as temporary:
            self._create(temporary, spacing, origin)

    def _create(
        self, temporary: Path, spacing: tuple[float, float, float], origin: tuple[float, float, float]
    ) -> None:
        import h5py

        nz, ny, nx = self.shape
        reserve(temporary)
        with h5py.File(temporary, "w") as file:
            root = start_file(file, "ImageData")
            root.attrs["WholeExtent"] = np.array([0, nx, 0, ny, 0, nz], np.int64)
            root.attrs["Origin"] = np.array(origin, np.float64)
            root.attrs["Spacing"] = np.array(spacing, np.float64)
            root.attrs["Direction"] = np.eye(3).ravel()
            data = root.create_group("CellData")
            for kind, width in (("Vectors", 3), ("Scalars", 1)):
                name = next((name for name, n in self.quantities.items() if n == width), None)
                if name is not None:
                    data.attrs[kind] = np.bytes_(name)
            offsets = root["Steps"].create_group("CellDataOffsets")
            for name, width in self.quantities.items():
                tail = (width,) if width > 1 else ()
                shape = (*self.shape, *tail)
                chunk = (1, *[-(-n // -(-n // _CHUNK)) for n in self.shape], *tail)   # equal pieces: no padding
                packing: dict[str, Any] = PACKED if self.tolerance > 0.0 else {}   # unrounded it would save a third
                data.create_dataset(
                    name, shape=(0, *shape), maxshape=(None, *shape), dtype="f4", chunks=chunk, **packing
                )
                offsets.create_dataset(name, shape=(0,), maxshape=(None,), dtype="i8", chunks=(256,))

    def _rewind(self, time: float) -> None:
        with appending(self.path) as root:
            count = steps_until(root["Steps"], time)
            for dataset in (root["Steps/Values"], *root["CellData"].values(), *root["Steps/CellDataOffsets"].values()):
                dataset.resize(count, axis=0)
            root["Steps"].attrs["NSteps"] = count

    def write(self, time: float, *values: ArrayLike | Planes) -> None:
        """Append one step; afterwards the file on disk is complete.

        Parameters
        ----------
        time : float, [s]
            Later than the step before.
        *values : array_like, (nz, ny, nx, 3) or (nz, ny, nx)
            At the cells' centres, in the order of the quantities; stored in single precision.
            Planes of several ranks are put together, one quantity after the other.

        Raises
        ------
        ValueError
            Another shape.
        OutputError
            The file cannot be written.
        """
        arrays = {
            name: given if isinstance(given, Planes) else np.asarray(given, np.float32)
            for name, given in zip(self.quantities, values, strict=True)
        }
        for name, array in arrays.items():
            shape = (*self.shape, self.quantities[name]) if self.quantities[name] > 1 else self.shape
            if array.shape != shape:
                raise ValueError(f"{name} {array.shape}: must be {shape}")
        with appending(self.path, 4 * sum(math.prod(array.shape) for array in arrays.values())) as root:
            step = int(root["Steps"].attrs["NSteps"])
            for name, array in arrays.items():
                whole = np.concatenate(list(array)) if isinstance(array, Planes) else array
                append_rounded(root["CellData"][name], whole, self.tolerance)
                append_rows(root["Steps/CellDataOffsets"][name], np.array([step]))
            append_rows(root["Steps/Values"], np.array([time]))
            root["Steps"].attrs["NSteps"] = step + 1


@contextmanager
def _reading(path: str | Path) -> Iterator[h5py.Group]:
    import h5py

    try:
        # without a lock: a reader must not stop the run that writes the file
        with h5py.File(path, "r", locking=False) as file:
            yield file["VTKHDF"]
    except (OSError, KeyError, RuntimeError) as error:
        reason = str(error).splitlines()[0]
        raise CaseError(str(path), None, "must be a VTKHDF file of a run", reason) from error


def field_times(path: str | Path) -> Floats:
    """Times of the stored steps: (steps,), [s]; `CaseError` when there is no such file."""
    with _reading(path) as root:
        return np.asarray(root["Steps/Values"][: int(root["Steps"].attrs["NSteps"])], np.float64)


def field_origin(path: str | Path) -> tuple[float, float, float]:
    """Lower corner of the stored fields (x, y, z) [m]; `CaseError` when there is no such file."""
    with _reading(path) as root:
        x, y, z = (float(c) for c in root.attrs["Origin"])
        return x, y, z


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


def field_quantities(path: str | Path) -> dict[str, tuple[int, ...]]:
    """Names of the stored quantities, and the shape of one step of each, `(nz, ny, nx)` or `(nz, ny, nx, 3)`.

    Raises
    ------
    CaseError
        The file is missing or no VTKHDF file.
    """
    with _reading(path) as root:
        return {name: tuple(data.shape[1:]) for name, data in root["CellData"].items()}


def read_steps(path: str | Path, name: str, index: tuple[Any, ...]) -> NDArray[np.float32]:
    """Part of a quantity, as h5py takes it: steps first, then z, y, x and, of a vector, the component.

    Raises
    ------
    CaseError
        The file is missing or no VTKHDF file, or has no such quantity.
    """
    with _reading(path) as root:
        return np.asarray(root["CellData"][name][index])


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
