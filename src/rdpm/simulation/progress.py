"""A progress bar for long work in a script or a notebook."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

__all__ = ["bar"]


@contextmanager
def bar(end: float) -> Iterator[Callable[[int, float, float], None]]:
    """Show simulated time against its end, with the wall time left.

    Parameters
    ----------
    end : float, [s]

    Yields
    ------
    callable
        Takes step, time [s] and end [s].
    """
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    with Progress(
        TextColumn("t = {task.completed:.3g} of {task.total:.3g} s"),
        BarColumn(),
        TimeRemainingColumn(),
        TextColumn("left"),
    ) as shown:
        task = shown.add_task("run", total=end)
        yield lambda step, time, until: shown.update(task, completed=time)
