"""Threads of the kernels: how many, and how they wait."""

from __future__ import annotations

import os

from rdpm.errors import CaseError

__all__ = ["available_threads", "checked_threads", "processors", "wait_passively"]

#: Threads a processor above which their number is refused; more than one are warned of.
MOST_THREADS = 4

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


def processors() -> int:
    """Processors this process may use.

    Examples
    --------
    >>> processors() >= 1
    True
    """
    return max(1, len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1)


def available_threads(sharers: int = 1) -> int:
    """Processors this process may use, or OMP_NUM_THREADS where that is set.

    Parameters
    ----------
    sharers : int
        Ranks among which these processors are shared out.

    Returns
    -------
    int
        At least 1.

    Raises
    ------
    CaseError
        OMP_NUM_THREADS is no number, or an absurd one.

    Examples
    --------
    >>> available_threads() >= 1
    True
    """
    given = os.environ.get("OMP_NUM_THREADS", "").strip()
    if not given:
        return max(1, processors() // sharers)
    first = given.split(",")[0].strip()  # the others are of nested regions
    if not (first.isascii() and first.isdigit() and int(first) > 0):
        raise CaseError(
            "OMP_NUM_THREADS", given, "must be a whole number from 1",
            cure=f"Set it to {processors()}, the processors here, or unset it.",
        )  # fmt: skip
    return checked_threads(int(first), "OMP_NUM_THREADS")


def checked_threads(asked: int, place: str) -> int:
    """Return the number of threads asked for, unless it is absurd.

    Parameters
    ----------
    asked : int
    place : str
        Where it was asked for, for the message.

    Raises
    ------
    CaseError
        Fewer than one, or more than `MOST_THREADS` a processor.

    Examples
    --------
    >>> checked_threads(1, "--threads")
    1
    """
    most = MOST_THREADS * processors()
    if not 1 <= asked <= most:
        raise CaseError(
            place, asked, f"must lie between 1 and {most}",
            f"this process may use {processors()} processors; more threads than that slow each other",
            "Leave it out for one thread a processor.",
        )  # fmt: skip
    return asked
