"""What happens every so often."""

from __future__ import annotations

import math

__all__ = ["Every"]


class Every:
    """Comes due at multiples of an interval of simulated time.

    Parameters
    ----------
    interval : float, [s]
        0: never due.

    Notes
    -----
    Due is the first step at or after a multiple. Adaptive steps end at those of `TimeLoop.asked`; a fixed step is never
    changed.

    Examples
    --------
    >>> every = Every(0.1)
    >>> [t for t in (0.0, 0.04, 0.08, 0.12, 0.16, 0.2) if every.is_due(t)]
    [0.0, 0.12, 0.2]
    >>> round(every.next_after(0.2), 12)
    0.3
    """

    def __init__(self, interval: float) -> None:
        self.interval = interval
        self.count = 0

    def is_due(self, time: float) -> bool:
        """Whether a multiple has been reached since the last time this said so."""
        if self.interval <= 0.0 or time < self.count * self.interval * (1.0 - 1e-9):
            return False
        self.count = int(time / self.interval * (1.0 + 1e-9)) + 1
        return True

    def next_after(self, time: float) -> float:
        """First multiple after a time [s] that is not done yet; infinite where there is none."""
        if self.interval <= 0.0:
            return math.inf
        return self.interval * max(self.count, math.floor(time / self.interval * (1.0 + 1e-9)) + 1)
