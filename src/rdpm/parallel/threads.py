"""Threads of the kernels: how many, and how they wait."""

from __future__ import annotations

import os

__all__ = ["available_threads", "wait_passively"]


def wait_passively() -> None:
    """Have idle OpenMP threads sleep instead of spin, unless the user chose otherwise.

    Must run before the first use of the kernels. Spinning threads on a busy machine slow each other many times over.

    Examples
    --------
    >>> wait_passively()
    >>> import os
    >>> "OMP_WAIT_POLICY" in os.environ
    True
    """
    os.environ.setdefault("OMP_WAIT_POLICY", "passive")


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
