"""Threads of the kernels: how many, and how they wait."""

from __future__ import annotations

import os

__all__ = ["available_threads", "wait_passively"]


#: Turns of the waiting loop before an idle thread sleeps: about a tenth of a millisecond.
SHORT_SPIN = 4_000


def wait_passively() -> None:
    """Have idle OpenMP threads sleep after a short spin, unless the user chose how they wait.

    Must run before the first use of the kernels. Threads that spin on a busy machine slow each other many times over;
    threads that sleep at once are woken late, several times in every step.

    Examples
    --------
    >>> wait_passively()
    >>> import os
    >>> "OMP_WAIT_POLICY" in os.environ
    True
    """
    if "OMP_WAIT_POLICY" not in os.environ:
        os.environ["OMP_WAIT_POLICY"] = "passive"
        os.environ.setdefault("GOMP_SPINCOUNT", str(SHORT_SPIN))


def available_threads() -> int:
    """Processors this process may use, or OMP_NUM_THREADS where that is set.

    Returns
    -------
    int
        At least 1.

    Examples
    --------
    >>> available_threads() >= 1
    True
    """
    asked = os.environ.get("OMP_NUM_THREADS", "").split(",")[0]
    if asked.isdigit() and int(asked) > 0:
        return int(asked)
    return max(1, len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1)
