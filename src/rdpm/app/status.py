"""How a run stands, read from the files of its folder alone."""

from __future__ import annotations

import json
import tomllib
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

from rdpm.errors import CaseError
from rdpm.io.lock import holder, is_alive
from rdpm.results.run_folder import RunFolder
from rdpm.results.summary import Summary, read_summary

__all__ = [
    "CONSOLE", "QUEUED", "QueueMark", "RunStatus", "is_rdpm", "queue_mark", "read_case", "status_of", "summary_of",
]  # fmt: skip

#: Hidden files of a run's folder: that it waits for its turn, or the process that was started for it and has not
#: locked the folder yet; and what that process said.
QUEUED, CONSOLE = ".queued", ".console.log"

_TAIL = 4096  # bytes; some forty rows of timing.csv


@dataclass(frozen=True)
class RunStatus:
    """How a run stands.

    Attributes
    ----------
    name : str
        Of the folder.
    state : str
        "queued", "running", "reporting" (figures and video are made), "paused" (interrupted, a checkpoint written),
        "done", "guard" (a guard stopped it), "failed" (it could not run), "stopped" (without a summary).
    title : str
    time, end : float or None, [s]
        Simulated.
    steps : int or None
    wall, left : float or None, [s]
        Wall time so far and to come.
    process : int or None
    message : str
        What to know about it.
    asked_ns : int
        When it was queued; 0 of one that is not.
    summary : Summary or None
        While it runs, that of the part before.
    """

    name: str
    state: str
    title: str = ""
    time: float | None = None
    end: float | None = None
    steps: int | None = None
    wall: float | None = None
    left: float | None = None
    process: int | None = None
    message: str = ""
    summary: Summary | None = None
    asked_ns: int = 0

    @property
    def is_active(self) -> bool:
        """Whether a process works on it, or will."""
        return self.state in ("queued", "running", "reporting")

    @property
    def progress(self) -> float:
        """Part of the simulated time that is done, 0 to 1."""
        return min(1.0, self.time / self.end) if self.time and self.end else 0.0

    @property
    def can_go_on(self) -> bool:
        """Whether there is something left to run."""
        return self.state in ("paused", "stopped", "failed")


def status_of(name: str, files: RunFolder) -> RunStatus:
    """Read how a run stands.

    Parameters
    ----------
    name : str
        For the reader.
    files : RunFolder

    Examples
    --------
    >>> import tempfile
    >>> status_of("nothing", RunFolder(Path(tempfile.mkdtemp()))).state
    'stopped'
    """
    case, summary, process = read_case(files), summary_of(files), holder(files.lock)
    step, time, wall, rate = _clock(files)
    mark, end = queue_mark(files), _end(case)
    is_over = time is not None and end is not None and time >= end * (1.0 - 1e-9)
    message, left = "", None
    if process is not None:
        state = "reporting" if is_over and summary is not None and summary.status == "done" else "running"
        if rate and time is not None and end is not None:
            left = max(0.0, end - time) / rate
    elif mark is not None:
        state = "queued"
    elif summary is not None and summary.status == "done":
        state = "done"
    elif summary is not None and summary.status == "interrupted":
        state = "paused"
    elif summary is not None and summary.status:
        state, message = "guard", _last_line(files.log)
    else:
        message = _refusal(files.path / CONSOLE)
        state = "failed" if message else "stopped"
    title = str(case.get("title") or "") if case else ""
    return RunStatus(name, state, title, time, end, step, wall, left, process, message, summary,
                     mark.asked_ns if state == "queued" and mark else 0)  # fmt: skip


class QueueMark(NamedTuple):
    """That a run waits for its turn: since when, and the process once one was started for it."""

    asked_ns: int
    process: int | None = None


def queue_mark(files: RunFolder) -> QueueMark | None:
    """Read the mark of a run that is queued; None without one, or where the process that it names has ended.

    Examples
    --------
    >>> import tempfile
    >>> queue_mark(RunFolder(Path(tempfile.mkdtemp()))) is None
    True
    """
    try:
        found = json.loads((files.path / QUEUED).read_text(encoding="utf-8"))
        mark = QueueMark(int(found["asked_ns"]), None if found.get("process") is None else int(found["process"]))
    except FileNotFoundError:
        return None
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return QueueMark(0)
    return mark if mark.process is None or is_rdpm(mark.process) else None


def is_rdpm(process: int) -> bool:
    """Whether a process goes on and is one of ours; where the system does not tell which, whether it goes on."""
    if not is_alive(process):
        return False
    try:
        words = Path(f"/proc/{process}/cmdline").read_bytes()
    except OSError:
        return not Path("/proc/self/cmdline").exists()
    return b"python" in words or b"rdpm" in words


def read_case(files: RunFolder) -> dict[str, Any]:
    """Give what ``case.toml`` holds; empty where it cannot be read."""
    try:
        stat = files.case.stat()
    except OSError:
        return {}
    return _read_case(files.case, stat.st_mtime_ns, stat.st_size)


@lru_cache(maxsize=256)
def _read_case(path: Path, _changed: int, size: int) -> dict[str, Any]:
    if size > 64 * 2**20:
        return {}
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return {}


def summary_of(files: RunFolder) -> Summary | None:
    """Give the summary; None where there is none that can be read."""
    try:
        stat = files.summary.stat()
    except OSError:
        return None
    return _read_summary(files.summary, stat.st_mtime_ns, stat.st_size)


@lru_cache(maxsize=256)
def _read_summary(path: Path, _changed: int, _size: int) -> Summary | None:
    with suppress(CaseError, OSError):
        return read_summary(path)
    return None


def _end(case: dict[str, Any]) -> float | None:
    time = case.get("time")
    end = time.get("end") if isinstance(time, dict) else None
    return float(end) if isinstance(end, int | float) else None


def _clock(files: RunFolder) -> tuple[int | None, float | None, float | None, float | None]:
    """Steps, simulated time, wall time, and simulated over wall time lately, from the end of ``timing.csv``."""
    rows = []
    for line in tail(files.table("timing")).splitlines():
        with suppress(ValueError, IndexError):
            step, time, wall = (float(text) for text in line.split(",")[:3])
            rows.append((step, time, wall))
    if not rows:
        return None, None, None, None
    (_, before, began), (step, time, wall) = rows[0], rows[-1]
    rate = (time - before) / (wall - began) if wall > began and time > before else None
    return int(step), time, wall, rate


def tail(path: Path, size: int = _TAIL) -> str:
    """Give the last whole lines of a text file, up to `size` bytes; empty where it cannot be read."""
    try:
        with path.open("rb") as file:
            end = file.seek(0, 2)
            file.seek(max(0, end - size))
            data = file.read(size)
    except OSError:
        return ""
    if end > size:
        data = data.partition(b"\n")[2]
    return data[: data.rfind(b"\n") + 1].decode("utf-8", "replace")


def _last_line(path: Path) -> str:
    lines = tail(path).strip().splitlines()
    return lines[-1][:500] if lines else ""


def _refusal(path: Path) -> str:
    """What `rdpm` said when it gave up."""
    lines = [line for line in tail(path).splitlines() if line.startswith("rdpm: ") and "interrupted" not in line]
    return lines[-1].removeprefix("rdpm: ")[:500] if lines else ""
