"""Wall time of the parts of a step."""

from __future__ import annotations

import time

__all__ = ["Stopwatch"]


class Stopwatch:
    """Adds up the seconds between laps under the names of the parts.

    Examples
    --------
    >>> watch = Stopwatch()
    >>> watch.lap("momentum")
    >>> sorted(watch.seconds)
    ['bodies', 'contacts', 'momentum', 'poisson']
    """

    def __init__(self) -> None:
        self.seconds = dict.fromkeys(("momentum", "bodies", "poisson", "contacts"), 0.0)
        self._last = time.perf_counter()

    def start(self) -> None:
        """Begin a lap here."""
        self._last = time.perf_counter()

    def lap(self, part: str) -> None:
        """Give the time since the last lap to a part."""
        now = time.perf_counter()
        self.seconds[part] += now - self._last
        self._last = now
