"""What happens every so often."""

from __future__ import annotations

__all__ = ["Every"]


class Every:
    """Comes due at multiples of an interval of simulated time.

    Parameters
    ----------
    interval : float, [s]
        0: never due.

    Notes
    -----
    The step length is never changed to meet a multiple: due is the first step at or after it.

    Examples
    --------
    >>> every = Every(0.1)
    >>> [t for t in (0.0, 0.04, 0.08, 0.12, 0.16, 0.2) if every.is_due(t)]
    [0.0, 0.12, 0.2]
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
