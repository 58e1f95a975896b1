"""Signals that end a run: the step in hand is finished first."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from rdpm.parallel.ranks import ALONE, Ranks

__all__ = ["Interrupted", "StopRequest", "listening"]


class Interrupted(Exception):  # noqa: N818 (no error: the end of the run was requested)
    """A signal requested the end of the run, and the step in hand is done."""


class StopRequest:
    """Remembers that a signal came.

    Parameters
    ----------
    ranks : Ranks
        Which end together, at the end of the same step.
    """

    def __init__(self, ranks: Ranks = ALONE) -> None:
        self.signal, self._ranks = "", ranks

    def ask(self, number: int, _frame: FrameType | None) -> None:
        """Take note of a signal; a second one raises KeyboardInterrupt at once."""
        if self.signal:
            raise KeyboardInterrupt
        self.signal = signal.Signals(number).name

    def check(self, _simulation: object) -> None:
        """Raise `Interrupted` if a signal came; for the end of a step."""
        number = signal.Signals[self.signal].value if self.signal else 0
        number = int(self._ranks.table([number]).max())
        if number:
            raise Interrupted(signal.Signals(number).name)


@contextmanager
def listening(ranks: Ranks = ALONE) -> Iterator[StopRequest]:
    """Have SIGINT, SIGTERM and SIGHUP (a lost terminal) ask instead of kill, until the block is left.

    Parameters
    ----------
    ranks : Ranks
        A signal to one of them ends all.

    Yields
    ------
    StopRequest
        Silent in a thread other than the main one, which gets no signals.

    Examples
    --------
    >>> with listening() as request:
    ...     signal.raise_signal(signal.SIGTERM)
    ...     request.signal
    'SIGTERM'
    """
    request = StopRequest(ranks)
    if threading.current_thread() is not threading.main_thread():
        yield request
        return
    numbers = [signal.SIGINT, signal.SIGTERM]
    hangup = getattr(signal, "SIGHUP", None)  # not on every system; nohup has it ignored
    if hangup is not None and signal.getsignal(hangup) != signal.SIG_IGN:
        numbers.append(hangup)
    before = {number: signal.signal(number, request.ask) for number in numbers}
    try:
        yield request
    finally:
        for number, handler in before.items():
            signal.signal(number, handler if handler is not None else signal.SIG_DFL)
