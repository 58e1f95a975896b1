"""Words and numbers of runs, the same on every page."""

from __future__ import annotations

__all__ = ["STATES", "span"]

#: State of a run: what the page says, and what it means.
STATES = {
    "queued": ("queued", "waits for its turn"),
    "running": ("running", ""),
    "reporting": ("making figures", "the run is done, figures and video are being made"),
    "paused": ("paused", "a checkpoint was written; it can be resumed"),
    "done": ("done", ""),
    "guard": ("stopped by a guard", "the numbers could no longer be trusted"),
    "failed": ("failed", "it could not run"),
    "stopped": ("stopped", "without a summary; it can be resumed from its last checkpoint"),
}


def span(seconds: float) -> str:
    """Write a time in the unit a reader would choose.

    Examples
    --------
    >>> span(5.2), span(300), span(9000)
    ('5.2 s', '5 min', '2.5 h')
    """
    if seconds < 120.0:
        return f"{seconds:.0f} s" if seconds >= 10.0 else f"{seconds:.1f} s"
    return f"{seconds / 60:.0f} min" if seconds < 7200.0 else f"{seconds / 3600:.1f} h"
