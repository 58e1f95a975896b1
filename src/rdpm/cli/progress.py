"""What a run says while it works: a bar on a terminal, a line now and then elsewhere."""

from __future__ import annotations

import sys
import time as clock
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rdpm.results.summary import Summary

__all__ = ["Reporter", "say"]

_BETWEEN_LINES = 10.0  # s, without a terminal
_BETWEEN_DRAWINGS = 0.1  # s, on one


def say(text: str) -> None:
    """Print a line beside the results, on the error stream."""
    print(text, file=sys.stderr, flush=True)


class Reporter:
    """Progress of a run, on the error stream.

    Parameters
    ----------
    quiet : bool
        Say nothing.

    Notes
    -----
    Call :meth:`close` at last, or use it as a context: an interrupted bar would leave the terminal without
    a cursor.

    Examples
    --------
    >>> with Reporter(quiet=True) as reporter:
    ...     reporter.update(1, 0.5, 2.0, "")
    """

    def __init__(self, quiet: bool = False) -> None:
        self.quiet = quiet
        self._bar: Any = None
        self._task: Any = None
        self._first: tuple[float, int, float] | None = None
        self._said = -_BETWEEN_LINES

    def __enter__(self) -> Reporter:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def start(self, plan: Any) -> None:
        """Show what will be run.

        Parameters
        ----------
        plan : rdpm.setup.Plan
        """
        if self.quiet:
            return
        from rich.console import Console

        from rdpm.cli.check import show_plan

        show_plan(plan, Console(stderr=True, highlight=False, markup=False))

    def update(self, step: int, time: float, end: float, message: str = "") -> None:
        """Tell how far the run is.

        Parameters
        ----------
        step : int
            Steps done.
        time, end : float, [s]
            Simulated time now and at the end.
        message : str, optional
            A few words on what happens.
        """
        if self.quiet:
            return
        now = clock.monotonic()
        if self._first is None:
            self._first = (now, step, time)
            if sys.stderr.isatty():
                self._open()
        if now - self._said < (_BETWEEN_LINES if self._bar is None else _BETWEEN_DRAWINGS) and time < end:
            return
        self._said = now
        said = self._said_so_far(now, step, time, end)
        if self._bar is None:
            say(", ".join(part for part in (f"{100 * time / end:3.0f} %", said, message) if part))
        else:
            self._bar.update(self._task, completed=min(time / end, 1.0), said=said, message=message)

    def note(self, text: str) -> None:
        """Say something once, such as a warning."""
        if self.quiet:
            return
        if self._bar is None:
            say(text)
        else:
            self._bar.console.print(text, markup=False, highlight=False)

    def finish(self, summary: Summary) -> None:
        """End the progress of a run that came to its end.

        Parameters
        ----------
        summary : Summary
            The run's; its wall time is said.
        """
        self.close()
        if not self.quiet and summary.wall_s is not None:
            say(f"{summary.steps} steps in {_span(summary.wall_s)}")

    def close(self) -> None:
        """Take the bar from the terminal."""
        if self._bar is not None:
            self._bar.stop()
            self._bar = None

    def _open(self) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn

        columns = (
            BarColumn(),
            TaskProgressColumn(),
            TextColumn("{task.fields[said]}"),
            TextColumn("{task.fields[message]}", markup=False),
        )
        self._bar = Progress(*columns, console=Console(stderr=True), auto_refresh=True)
        self._task = self._bar.add_task("run", total=1.0, said="", message="")
        self._bar.start()

    def _said_so_far(self, now: float, step: int, time: float, end: float) -> str:
        began, first_step, first_time = self._first or (now, step, time)
        elapsed, steps, gained = now - began, step - first_step, time - first_time
        said = f"t = {time:.4g} of {end:.4g} s, step {step}"
        if elapsed > 0.0 and steps > 0 and gained > 0.0:
            said += f", {steps / elapsed:.3g} steps/s, {_span(elapsed * max(0.0, end - time) / gained)} left"
        return said


def _span(seconds: float) -> str:
    """A time in the unit a reader would choose."""
    if seconds < 120.0:
        return f"{seconds:.0f} s" if seconds >= 10.0 else f"{seconds:.1f} s"
    return f"{seconds / 60:.0f} min" if seconds < 7200.0 else f"{seconds / 3600:.1f} h"
