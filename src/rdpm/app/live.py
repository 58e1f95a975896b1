"""The tables of a run while it writes them: new rows only, and what is drawn of them."""

from __future__ import annotations

import csv
import math
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm.app.status import read_case
from rdpm.errors import CaseError
from rdpm.figures.plane import viewing_plane
from rdpm.io.vtkhdf import field_grid, field_times, read_plane
from rdpm.results.run_folder import RunFolder

__all__ = ["Follower", "Frame", "LiveRun", "Slice"]

Floats = NDArray[np.float64]

_MOST_BYTES = 8 * 2**20  # read at once; of an older table the end only
_MOST_HEAD = 65536  # bytes of a first line
_MOST_POINTS = 3000  # of a curve; beyond, every other is dropped
_FEW = 8  # bodies drawn one by one
#: Columns of ``particles.csv`` that are drawn; others, which a run may add, are passed over.
_DRAWN = (
    "time_s", "id", "x_m", "y_m", "z_m", "u_m_s", "v_m_s", "w_m_s", "omega_x_rad_s", "omega_y_rad_s", "omega_z_rad_s",
    "gap_m",
)  # fmt: skip


class Follower:
    """New whole lines of a text file that grows.

    Parameters
    ----------
    path : pathlib.Path

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp()) / "history.csv"
    >>> _ = path.write_text("a,b" + chr(10) + "1,2" + chr(10) + "3")
    >>> new = Follower(path)
    >>> new.lines(), new.lines()
    (b'1,2\\n', b'')
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._at = 0
        self.heads: list[str] = []
        """Names of the columns, once they are there."""
        self.is_cut = False
        """Whether the beginning of the table was left out."""

    def lines(self) -> bytes:
        """Give what was added since the last call, without the head of the table."""
        try:
            with self.path.open("rb") as file:
                size = file.seek(0, 2)
                if size < self._at:  # begun anew, or set back by a run that continues from a checkpoint
                    self._at = 0
                is_first, start = self._at == 0, self._at
                if is_first:
                    file.seek(0)
                    self.heads = file.readline(_MOST_HEAD).decode("utf-8", "replace").strip().split(",")
                if size - start > _MOST_BYTES:
                    start, self.is_cut = size - _MOST_BYTES, True
                file.seek(start)
                data = file.read(size - start)
        except OSError:
            return b""
        if is_first and b"\n" not in data:
            return b""  # not even the head is whole
        if is_first or start != self._at:
            data = data.partition(b"\n")[2]  # the head, or half a line
        whole = data[: data.rfind(b"\n") + 1]
        self._at = size - (len(data) - len(whole))
        return whole


def numbers(data: bytes, columns: int) -> Floats:
    """Read lines of numbers: (rows, columns); what does not fit is left out."""
    if not data:
        return np.empty((0, columns))
    try:
        flat = np.fromstring(data.replace(b"\n", b",").decode("ascii"), sep=",")
        return flat.reshape(-1, columns)
    except (ValueError, UnicodeDecodeError, DeprecationWarning):
        rows = [line.split(b",") for line in data.splitlines()]
        return np.array([_floats(row) for row in rows if len(row) == columns]).reshape(-1, columns)


def _floats(row: list[bytes]) -> list[float]:
    try:
        return [float(text) for text in row]
    except ValueError:
        return [math.nan] * len(row)


@dataclass
class Frame:
    """The bodies at one time.

    Attributes
    ----------
    time : float, [s]
    position : ndarray, (N, 3), [m]
    rotation : ndarray, (N, 4)
        Unit quaternions x, y, z, w; from upright where the table begins to be read.
    """

    time: float
    position: Floats
    rotation: Floats


@dataclass(frozen=True)
class Slice:
    """The speed of the fluid in a plane.

    Attributes
    ----------
    time : float, [s]
    normal : int
    position : float, [m]
    speed : ndarray of float32, (n_up, n_across), [m/s]
    """

    time: float
    normal: int
    position: float
    speed: NDArray[np.float32]


@dataclass
class LiveRun:
    """What is known of a run so far; `read` adds what is new.

    Attributes
    ----------
    files : RunFolder
    gravity, box : ndarray, (3,)
    times : list of float, [s]
    settling : list of list of float, [m/s]
        At each time the velocity along gravity of each body, or of many the mean, the least and the greatest.
    gap : list of float, [m]
        Smallest gap of any body.
    contacts : list of dict
        Rows of ``contacts.csv``.
    frame : Frame or None
        The newest.
    """

    files: RunFolder
    gravity: Floats = field(default_factory=lambda: np.array([0.0, 0.0, -9.81]))
    box: Floats = field(default_factory=lambda: np.ones(3))
    times: list[float] = field(default_factory=list)
    settling: list[list[float]] = field(default_factory=list)
    gap: list[float] = field(default_factory=list)
    contacts: list[dict[str, Any]] = field(default_factory=list)
    frame: Frame | None = None

    def __post_init__(self) -> None:
        self._particles = Follower(self.files.table("particles"))
        self._episodes = Follower(self.files.table("contacts"))
        domain = read_case(self.files).get("domain", {})
        with suppress(TypeError, ValueError, AttributeError):
            self.box = np.array(domain.get("size", self.box), np.float64).reshape(3)
            self.gravity = np.array(domain.get("gravity", self.gravity), np.float64).reshape(3)
        self._seen_flow = (-1, -1)
        self._waiting, self._bodies = np.empty((0, len(_DRAWN))), 0

    @property
    def is_cut(self) -> bool:
        """Whether the beginning was left out, for its length."""
        return self._particles.is_cut

    @property
    def count(self) -> int:
        """Bodies."""
        return 0 if self.frame is None else len(self.frame.position)

    def read(self) -> bool:
        """Take in new rows; tell whether the bodies moved."""
        before = self.frame
        rows = self._new_rows()
        if self.times and len(rows) and rows[0, 0] <= self.times[-1]:
            self._drop_from(float(rows[0, 0]))
            self._waiting = self._waiting[:0]
        self._take_whole(rows)
        self._take_contacts()
        while len(self.times) > _MOST_POINTS:
            self.times, self.settling, self.gap = self.times[::2], self.settling[::2], self.gap[::2]
        return self.frame is not before

    def _new_rows(self) -> Floats:
        """New rows of the columns that are drawn; a row without a gap has no neighbour."""
        data, heads = self._particles.lines(), self._particles.heads
        if not data or not set(_DRAWN) <= set(heads):
            return np.empty((0, len(_DRAWN)))
        rows = numbers(data, len(heads))[:, [heads.index(name) for name in _DRAWN]]
        return np.asarray(rows[np.isfinite(rows[:, :-1]).all(axis=1)])

    def _take_whole(self, rows: Floats) -> None:
        """Take in the times of which all bodies are there; rows of the last one may still be on their way."""
        groups = _by_time(np.concatenate([self._waiting, rows]))
        self._waiting = np.empty((0, len(_DRAWN)))
        for n, one in enumerate(groups):
            is_last = n == len(groups) - 1
            if not self._bodies:
                if is_last:
                    self._waiting = one
                elif n or not self.is_cut:
                    self._bodies = len(one)
            if len(one) == self._bodies:
                self._take(one)
            elif is_last:
                self._waiting = one

    def _drop_from(self, time: float) -> None:
        keep = int(np.searchsorted(self.times, time))
        del self.times[keep:], self.settling[keep:], self.gap[keep:]
        self.contacts = [row for row in self.contacts if row["start_s"] < time]

    def _take(self, rows: Floats) -> None:
        rows = rows[np.argsort(rows[:, 1], kind="stable")]
        time, position, velocity, omega = float(rows[0, 0]), rows[:, 2:5], rows[:, 5:8], rows[:, 8:11]
        before = self.frame
        upright = np.tile([0.0, 0.0, 0.0, 1.0], (len(rows), 1))
        rotation = upright if before is None else turned(before.rotation, omega * (time - before.time))
        self.frame = Frame(time, position, rotation)
        fall = velocity @ _direction(self.gravity)
        self.times.append(time)
        self.settling.append(fall.tolist() if len(rows) <= _FEW else [fall.mean(), fall.min(), fall.max()])
        gaps = rows[:, -1]
        self.gap.append(float(np.nanmin(gaps)) if np.isfinite(gaps).any() else math.nan)

    def _take_contacts(self) -> None:
        text = self._episodes.lines().decode("utf-8", "replace")
        heads = self._episodes.heads
        for row in csv.reader(text.splitlines()):
            if len(row) == len(heads):
                self.contacts.append({name: _number(item) for name, item in zip(heads, row, strict=True)})

    def new_slice(self) -> Slice | None:
        """Read the newest stored picture of the flow, if there is a new one that is whole."""
        path = self.files.fields
        try:
            state = path.stat()
            if (state.st_mtime_ns, state.st_size) == self._seen_flow:
                return None
            step = len(field_times(path)) - 1
            if step < 0:
                return None
            found = self.slice_at(step)
            after = path.stat()
        except (CaseError, OSError, ValueError, IndexError):
            return None  # it is being written: at the next look
        if (after.st_mtime_ns, after.st_size) != (state.st_mtime_ns, state.st_size):
            return None
        self._seen_flow = (state.st_mtime_ns, state.st_size)
        return found

    def look_again(self) -> None:
        """Have `new_slice` give the newest picture once more."""
        self._seen_flow = (-1, -1)

    def slice_at(self, step: int) -> Slice:
        """Read a stored picture of the flow, in the plane of the bodies as they are now."""
        path = self.files.fields
        plane = viewing_plane(None, self.box, self.gravity)
        position = plane.position
        if self.frame is not None and self.count <= _FEW:
            position = float(self.frame.position[:, plane.normal].mean() % self.box[plane.normal])
        layer = read_plane(path, step, "xyz"[plane.normal], position)
        if plane.up < plane.across:
            layer = layer.transpose(1, 0, 2)
        cells, spacing = field_grid(path)
        centre = (math.floor(position / spacing[plane.normal]) + 0.5) * spacing[plane.normal]
        centre = min(max(centre, 0.0), cells[plane.normal] * spacing[plane.normal])
        return Slice(float(field_times(path)[step]), plane.normal, centre, np.linalg.norm(layer, axis=-1))


def _number(text: str) -> Any:
    try:
        return float(text)
    except ValueError:
        return text


def _by_time(rows: Floats) -> list[Floats]:
    """Split rows where the time changes."""
    return np.split(rows, np.flatnonzero(np.diff(rows[:, 0])) + 1) if len(rows) else []


def _direction(gravity: Floats) -> Floats:
    size = float(np.linalg.norm(gravity))
    return gravity / size if size > 0.0 else np.array([0.0, 0.0, -1.0])


def turned(rotation: Floats, vector: Floats) -> Floats:
    """Turn unit quaternions (x, y, z, w) by rotation vectors: (N, 4).

    Examples
    --------
    >>> turned(np.array([[0.0, 0.0, 0.0, 1.0]]), np.array([[0.0, 0.0, math.pi]])).round(6).tolist()
    [[0.0, 0.0, 1.0, 0.0]]
    """
    angle = np.linalg.norm(vector, axis=1, keepdims=True)
    axis = vector / np.where(angle > 0.0, angle, 1.0)
    a, w = axis * np.sin(0.5 * angle), np.cos(0.5 * angle)
    b, v = rotation[:, :3], rotation[:, 3:]
    part = w * b + v * a + np.cross(a, b)
    new = np.concatenate([part, w * v - (a * b).sum(axis=1, keepdims=True)], axis=1)
    return np.asarray(new / np.linalg.norm(new, axis=1, keepdims=True))
