"""Tables as CSV: written a row at a time while a run goes on, read back as columns."""

from __future__ import annotations

import errno
import os
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm.errors import CaseError, OutputError
from rdpm.io.files import reporting

__all__ = [
    "CONTACT_COLUMNS",
    "HISTORY_COLUMNS",
    "PARTICLE_COLUMNS",
    "TIMING_COLUMNS",
    "TableWriter",
    "read_table",
]

# force: hydrodynamic; gap: the smallest to any body or wall; neighbour: that body, -1..-6 a face of
# the box, `rdpm.conventions.NO_NEIGHBOUR` none; from hydrodynamic_force on: means since the row before.
PARTICLE_COLUMNS = (
    "time_s", "id", "x_m", "y_m", "z_m", "u_m_s", "v_m_s", "w_m_s",
    "omega_x_rad_s", "omega_y_rad_s", "omega_z_rad_s", "force_x_N", "force_y_N", "force_z_N",
    "contact_force_x_N", "contact_force_y_N", "contact_force_z_N", "gap_m", "neighbour",
    "hydrodynamic_force_x_N", "hydrodynamic_force_y_N", "hydrodynamic_force_z_N",
    "lubrication_force_x_N", "lubrication_force_y_N", "lubrication_force_z_N",
    "collision_force_x_N", "collision_force_y_N", "collision_force_z_N",
    "hydrodynamic_torque_x_N_m", "hydrodynamic_torque_y_N_m", "hydrodynamic_torque_z_N_m",
    "lubrication_torque_x_N_m", "lubrication_torque_y_N_m", "lubrication_torque_z_N_m",
    "collision_torque_x_N_m", "collision_torque_y_N_m", "collision_torque_z_N_m",
)
# outside: what left the range that the design promises, and why; "no" of a contact within.
CONTACT_COLUMNS = (
    "i", "j", "kind", "start_s", "duration_s", "steps", "max_overlap_fraction", "impact_speed_m_s",
    "rebound_speed_m_s", "restitution", "stokes_number", "work_J", "outside",
)
# slip: root mean square of the markers' slip over the fastest body's speed.
HISTORY_COLUMNS = (
    "step", "time_s", "dt_s", "cfl", "divergence", "kinetic_energy_fluid_J", "kinetic_energy_bodies_J",
    "max_overlap_fraction", "slip",
)
TIMING_COLUMNS = ("step", "time_s", "wall_s", "momentum_s", "bodies_s", "poisson_s", "contacts_s")

_HELD = 1 << 20  # bytes of rows that wait for a flush at most
_INTEGERS = {"id", "neighbour", "i", "j", "step", "point", "line"}
_TEXTS = {"kind", "outside"}


def _integer(value: Any) -> str:
    number = int(value)
    if number != value:
        raise ValueError(f"{value!r} is not a whole number")
    return str(number)


def _number(value: Any) -> str:
    # float() first: NumPy's scalars print their type; repr is the shortest text of the same bits.
    return repr(float(value))


def _formatter(column: str) -> Callable[[Any], str]:
    if column in _TEXTS:
        return str
    return _integer if column in _INTEGERS else _number


class TableWriter:
    """A CSV table that grows by rows; every number reads back bit for bit.

    Parameters
    ----------
    path : path
        The file; an older one is replaced unless `append_at` is given.
    columns : sequence of str
        Names for the header line. ``id, neighbour, i, j, step, point, line`` hold whole numbers, ``kind`` and
        ``outside`` words, all others floats.
    append_at : int, optional, [bytes]
        Continue an existing table from this position (see `tell`): what stands behind it is cut off.

    Raises
    ------
    OutputError
        The file cannot be written, or is not the table to continue.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp()) / "particles.csv"
    >>> with TableWriter(path, ("time_s", "id", "x_m")) as table:
    ...     table.write([(0.1, 0, 1 / 3), (0.1, 1, float("nan"))])
    >>> print(path.read_text(), end="")
    time_s,id,x_m
    0.1,0,0.3333333333333333
    0.1,1,nan
    """

    def __init__(self, path: str | Path, columns: Sequence[str], append_at: int | None = None) -> None:
        self.path = Path(path)
        self.columns = tuple(columns)
        self._formatters = [_formatter(name) for name in self.columns]
        header = (",".join(self.columns) + "\n").encode()
        self._rows = bytearray()   # not Python's buffer: it would try again, at closing, what a full disk refused
        with reporting(self.path):
            self._file = open(self.path, "wb" if append_at is None else "r+b", buffering=0)  # noqa: SIM115
        self._end = 0
        try:
            if append_at is None:
                self._rows += header
            else:
                self._continue(header, append_at)
            self.flush()
        except OSError:
            self._file.close()
            raise

    def _continue(self, header: bytes, append_at: int) -> None:
        found, size = self._file.read(len(header)), self._file.seek(0, 2)
        if found != header or not len(header) <= append_at <= size:
            raise OutputError(
                str(self.path), None, f"cannot be continued from byte {append_at}",
                "it is shorter, or has other columns, than when that position was noted",
                "Start the run anew in another folder.",
            )
        with reporting(self.path):
            self._file.truncate(append_at)
            self._end = self._file.seek(append_at)

    def write(self, rows: NDArray[Any] | Iterable[Sequence[Any]]) -> None:
        """Append rows: a 2-D array, or a sequence of rows in the order of the columns.

        Raises
        ------
        ValueError
            A row of another length, or a fraction in a column of whole numbers.
        OutputError
            The disk refuses.
        """
        listed: Iterable[Sequence[Any]] = rows.tolist() if isinstance(rows, np.ndarray) else rows
        lines = [
            ",".join([form(value) for form, value in zip(self._formatters, row, strict=True)]) + "\n"
            for row in listed
        ]
        self._rows += "".join(lines).encode()
        if len(self._rows) > _HELD:
            self.flush()

    def flush(self) -> None:
        """Hand what was written to the system, so that others can read it.

        Raises
        ------
        OutputError
            The disk refuses, or the file was removed; the table then ends with the last whole row before.
        """
        rows, self._rows = memoryview(bytes(self._rows)), bytearray()
        with reporting(self.path):
            if os.fstat(self._file.fileno()).st_nlink == 0:   # a removed file would take every row without a word
                raise FileNotFoundError(errno.ENOENT, "it was removed while the run went on")
            try:
                while rows:
                    rows = rows[self._file.write(rows) :]
            except OSError:
                with suppress(OSError):
                    self._file.truncate(self._end)
                    self._file.seek(self._end)
                raise
            self._end = self._file.tell()

    def sync(self) -> int:
        """Flush to the disk itself; the position in bytes from which `append_at` continues."""
        self.flush()
        with reporting(self.path):
            os.fsync(self._file.fileno())
        return self._end

    def tell(self) -> int:
        """The position in bytes from which `append_at` continues; flushes first."""
        self.flush()
        return self._end

    def close(self) -> None:
        """Flush and close; further calls do nothing."""
        if self._file.closed:
            return
        try:
            self.flush()
        finally:
            self._file.close()

    def __enter__(self) -> TableWriter:
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        if kind is None:
            self.close()
        else:   # what failed is told already
            self._file.close()


def read_table(path: str | Path) -> dict[str, NDArray[Any]]:
    """Columns of a CSV table by name.

    Parameters
    ----------
    path : path
        A table as `TableWriter` writes it; a last line without its end (being written) is left out.

    Returns
    -------
    dict of ndarray, (rows,)
        Whole numbers as int64, words as str, all others as float64; in the units of the names.

    Raises
    ------
    CaseError
        The file is missing, empty, or has a line that is no row of it.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp()) / "contacts.csv"
    >>> _ = path.write_text("i,j,kind,start_s\\n0,-1,sphere-wall,0.25\\n")
    >>> table = read_table(path)
    >>> table["j"].tolist(), table["kind"].tolist(), table["start_s"].tolist()
    ([-1], ['sphere-wall'], [0.25])
    """
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise CaseError(str(path), None, "must be a readable table", str(error)) from error
    lines = text[: text.rfind("\n") + 1].splitlines()
    if not lines:
        raise CaseError(str(path), None, "must have a header line", "the table is empty")
    names = lines[0].split(",")
    kinds = ["U64" if name in _TEXTS else "i8" if name in _INTEGERS else "f8" for name in names]
    dtype = np.dtype(list(zip(names, kinds, strict=True)))
    if len(lines) == 1:
        rows = np.zeros(0, dtype)
    else:
        try:
            rows = np.loadtxt(lines[1:], dtype=dtype, delimiter=",", ndmin=1, comments=None)
        except ValueError as error:
            rule = "must hold one value a column in every line"
            raise CaseError(str(path), None, rule, str(error)) from error
    return {name: np.ascontiguousarray(rows[name]) for name in names}
