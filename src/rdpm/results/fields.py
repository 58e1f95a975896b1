"""Stored fields as xarray, read as they are used."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rdpm.errors import CaseError
from rdpm.io.vtkhdf import field_grid, field_origin, field_quantities, field_times, read_steps

if TYPE_CHECKING:
    import xarray

__all__ = ["open_fields"]

_UNITS = {
    "velocity": "m/s", "pressure": "Pa", "vorticity": "1/s", "q_criterion": "1/s^2",
    "mean_velocity": "m/s", "mean_pressure": "Pa", "velocity_variance": "m^2/s^2",
}  # fmt: skip


def open_fields(path: str | Path) -> xarray.Dataset:
    """Open a VTKHDF file of fields; each part is read when it is used, and the file is open only then.

    Parameters
    ----------
    path : path
        ``fields.vtkhdf``, ``plane-0.vtkhdf``, ``averages.vtkhdf``.

    Returns
    -------
    xarray.Dataset
        Along time, z, y, x and, of vectors, the component; without variables where there is no such file.

    Raises
    ------
    CaseError
        xarray is not installed, or it is no such file.

    Examples
    --------
    >>> import tempfile
    >>> from rdpm.io.vtkhdf import FieldWriter
    >>> path = Path(tempfile.mkdtemp()) / "fields.vtkhdf"
    >>> FieldWriter(path, (4, 3, 2), (0.1, 0.1, 0.1)).write(0.5, np.ones((2, 3, 4, 3)), np.zeros((2, 3, 4)))
    >>> fields = open_fields(path)
    >>> dict(fields.sizes), float(fields.velocity.isel(time=-1).sel(component="z").mean())
    ({'time': 1, 'z': 2, 'y': 3, 'x': 4, 'component': 3}, 1.0)
    """
    try:
        import xarray
        from xarray.core.indexing import LazilyIndexedArray
    except ImportError:
        raise CaseError("fields", None, "need xarray", "it is not installed", "pip install 'rdpm[xarray]'.") from None
    path = Path(path)
    if not path.is_file():
        return xarray.Dataset()
    times, (cells, spacing) = field_times(path), field_grid(path)
    corner = field_origin(path)
    axes = {
        name: (name, start + (np.arange(n) + 0.5) * h, {"units": "m"})
        for name, start, n, h in zip("xyz", corner, cells, spacing, strict=True)
    }
    variables = {}
    for name, shape in field_quantities(path).items():
        dims = ("time", "z", "y", "x", "component")[: 1 + len(shape)]
        stored = LazilyIndexedArray(_lazily(path, name, (len(times), *shape)))
        variables[name] = xarray.Variable(dims, stored, {"units": _UNITS.get(name, "")})
    return xarray.Dataset(variables, {**axes, "time": ("time", times, {"units": "s"}), "component": list("xyz")})


def _lazily(path: Path, name: str, shape: tuple[int, ...]) -> Any:
    """What xarray indexes: a part is read from the disk when it asks for it."""
    from xarray.backends import BackendArray
    from xarray.core.indexing import IndexingSupport, explicit_indexing_adapter

    class Stored(BackendArray):
        def __init__(self) -> None:
            self.shape, self.dtype = shape, np.dtype(np.float32)

        def __getitem__(self, key: Any) -> Any:
            return explicit_indexing_adapter(key, shape, IndexingSupport.OUTER_1VECTOR, self._read)

        def _read(self, index: tuple[Any, ...]) -> NDArray[np.float32]:
            steps = index[0]
            if isinstance(steps, slice):  # the file may have more steps by now than when it was opened
                index = (slice(*steps.indices(shape[0])), *index[1:])
            return read_steps(path, name, index)

    return Stored()
