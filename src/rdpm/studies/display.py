"""What a study says while it works: one live display on a terminal or in a notebook, lines elsewhere."""

from __future__ import annotations

import sys
import time as clock
from typing import Any

from rdpm.studies.folder import DONE, Job
from rdpm.studies.notebook_bar import NotebookBar

__all__ = ["Display", "span"]

_BETWEEN_LINES = 15.0  # s, without a terminal
_ENDS = (DONE, "stopped", "failed", "interrupted")


class Display:
    """Progress of a study, on the error stream.

    Parameters
    ----------
    quiet : bool
        Say nothing.

    Examples
    --------
    >>> with Display(quiet=True) as display:
    ...     display.begin([], 1)
    """

    def __init__(self, quiet: bool = False) -> None:
        self.quiet = quiet
        self.failed: list[tuple[Job, str, str]] = []
        self._jobs: dict[str, Job] = {}
        self._share: dict[str, float] = {}
        self._ended: set[str] = set()
        self._first = self._said = clock.monotonic()
        self._workers = 1
        self._bar: Any = None
        self._tasks: dict[str, Any] = {}

    def __enter__(self) -> Display:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def begin(self, jobs: list[Job], workers: int) -> None:
        """Take note of the jobs that will be done."""
        self._jobs = {job.name: job for job in jobs}
        self._workers = max(1, min(workers, len(jobs)))
        self._first = clock.monotonic()
        if self.quiet or not jobs:
            return
        if sys.stderr.isatty() or _is_notebook():
            self._open()
        else:
            self.note(f"{_counted(len(jobs), 'run')}, {workers} at once")

    def update(self, job: Job, said: dict[str, Any]) -> None:
        """Take note of how a job goes, and show it."""
        phase = str(said.get("phase", ""))
        if said.get("end"):
            self._share[job.name] = float(said["time"]) / float(said["end"])
        if phase in _ENDS:
            self._ended.add(job.name)
            self._share[job.name] = 1.0
            if phase != DONE:
                self.failed.append((job, phase, str(said.get("reason", ""))))
        if self.quiet:
            return
        if self._bar is not None:
            self._show(job, phase, said)
        elif phase in _ENDS:
            reason = f": {said['reason']}" if said.get("reason") else ""
            self.note(f"{job.name}: {phase}{reason} ({self._so_far()})")
        elif clock.monotonic() - self._said > _BETWEEN_LINES:
            self.note(self._so_far())

    def note(self, text: str) -> None:
        """Say something once."""
        self._said = clock.monotonic()
        if self.quiet:
            return
        if isinstance(self._bar, NotebookBar):
            self._bar.note(text)
        elif self._bar is not None:
            self._bar.console.print(text, markup=False, highlight=False)
        else:
            print(text, file=sys.stderr, flush=True)

    def close(self) -> None:
        """Take the display from the terminal."""
        if self._bar is not None:
            self._bar.stop()
            self._bar = None

    def _so_far(self) -> str:
        said = f"{len(self._ended)} of {_counted(len(self._jobs), 'run')} ended"
        left = self._left()
        return f"{said}, {span(left)} left" if left is not None else said

    def _left(self) -> float | None:
        """Wall time that is left, by the work that is done [s]."""
        work = {name: max(job.cells, 1) * max(job.steps, 1) for name, job in self._jobs.items()}
        done = sum(work[name] * share for name, share in self._share.items() if name in work)
        elapsed = clock.monotonic() - self._first
        total = sum(work.values())
        if done < 0.02 * total or elapsed < 1.0:  # processes that start say nothing of the rate yet
            return None
        return max(0.0, total - done) * elapsed / done

    def _open(self) -> None:
        if _is_notebook():
            self._start(NotebookBar())
            return
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn

        columns = (
            TextColumn("{task.description}", markup=False), BarColumn(bar_width=24), TaskProgressColumn(),
            TextColumn("{task.fields[said]}", markup=False),
        )
        self._start(Progress(*columns, console=Console(file=sys.stderr)))

    def _start(self, bar: Any) -> None:
        self._bar = bar
        self._tasks = {"": bar.add_task("study", total=1.0, said="")}
        bar.start()

    def _show(self, job: Job, phase: str, said: dict[str, Any]) -> None:
        if phase in _ENDS:
            if job.name in self._tasks:
                self._bar.remove_task(self._tasks.pop(job.name))
            if phase != DONE:
                self.note(f"{job.name}: {phase}: {said.get('reason', '')}")
        else:
            if job.name not in self._tasks:
                self._tasks[job.name] = self._bar.add_task(job.name, total=1.0, said=phase)
            where = f"t = {said['time']:.4g} of {said['end']:.4g} s" if said.get("end") else phase
            self._bar.update(self._tasks[job.name], completed=self._share.get(job.name, 0.0), said=where)
        work = {name: max(item.cells, 1) * max(item.steps, 1) for name, item in self._jobs.items()}
        done = sum(work[name] * share for name, share in self._share.items() if name in work)
        self._bar.update(self._tasks[""], completed=done / max(sum(work.values()), 1), said=self._so_far())


def _counted(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def _is_notebook() -> bool:
    shell = sys.modules.get("IPython")
    return shell is not None and getattr(shell.get_ipython(), "kernel", None) is not None


def span(seconds: float) -> str:
    """A time in the unit a reader would choose.

    Examples
    --------
    >>> span(3.21), span(95), span(600), span(10000)
    ('3.2 s', '95 s', '10 min', '2.8 h')
    """
    if seconds < 120.0:
        return f"{seconds:.0f} s" if seconds >= 10.0 else f"{seconds:.1f} s"
    return f"{seconds / 60:.0f} min" if seconds < 7200.0 else f"{seconds / 3600:.1f} h"
