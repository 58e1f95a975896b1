"""MPI ranks: the processes that work on one run, and what they say to each other."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from functools import lru_cache, partial
from time import perf_counter
from types import TracebackType
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from rdpm.errors import CaseError
from rdpm.parallel.launcher import launched

__all__ = ["ALONE", "Alone", "MpiRanks", "Ranks", "world"]

Array = NDArray[Any]
Floats = NDArray[np.float64]


class Ranks(Protocol):
    """What the ranks of a run can say to each other; every rank must make the same calls in the same order.

    Attributes
    ----------
    size, rank : int
        How many there are, and which one this is. Rank 0 is the root: it alone writes.
    sharers : int
        Ranks that share the processors this one may use, itself included.
    seconds, messages, sent_bytes
        Spent in these calls, and sent by this rank, so far.
    """

    size: int
    rank: int
    sharers: int
    seconds: float
    messages: int
    sent_bytes: int

    def swap(self, sends: Sequence[tuple[int, Array]], receives: Sequence[tuple[int, Array]]) -> None:
        """Send arrays to ranks, and receive into arrays from ranks; those between two ranks keep their order."""

    def all_to_all(self, send: Floats, counts: Sequence[int], into: Floats, into_counts: Sequence[int]) -> None:
        """Send a part of a flat array to every rank, and receive a part from each."""

    def table(self, row: Sequence[float]) -> Floats:
        """One row of numbers of each rank: (size, columns)."""

    def rows(self, mine: Floats, counts: Sequence[int]) -> Floats:
        """The rows of all ranks, rank after rank; `counts`: of each."""

    def share(self, value: Any, source: int = 0) -> Any:
        """Give everyone what one rank has."""

    def abort(self, code: int) -> None:
        """End all ranks at once."""


class Alone:
    """One rank: nobody to talk to.

    Examples
    --------
    >>> Alone().table([1.0, 2.0])
    array([[1., 2.]])
    """

    size, rank, sharers = 1, 0, 1
    seconds, messages, sent_bytes = 0.0, 0, 0

    def swap(self, sends: Sequence[tuple[int, Array]], receives: Sequence[tuple[int, Array]]) -> None:
        """Copy what is sent to oneself."""
        for (_, source), (_, target) in zip(sends, receives, strict=True):
            np.copyto(target, source)

    def all_to_all(self, send: Floats, counts: Sequence[int], into: Floats, into_counts: Sequence[int]) -> None:
        """Copy."""
        np.copyto(into, send)

    def table(self, row: Sequence[float]) -> Floats:
        """Give the one row."""
        return np.array([row], np.float64)

    def rows(self, mine: Floats, counts: Sequence[int]) -> Floats:
        """Give them back."""
        return mine

    def share(self, value: Any, source: int = 0) -> Any:
        """Give it back."""
        return value

    def abort(self, code: int) -> None:
        """Do nothing: the error itself ends this process."""


#: The one rank of a run without a launcher.
ALONE = Alone()


class MpiRanks:
    """The ranks of an MPI communicator.

    Parameters
    ----------
    communicator : mpi4py.MPI.Comm
    """

    def __init__(self, communicator: Any) -> None:
        from mpi4py import MPI

        self._mpi, self._comm = MPI, communicator
        self.size, self.rank = int(communicator.size), int(communicator.rank)
        node = communicator.Split_type(MPI.COMM_TYPE_SHARED)
        masks = node.allgather(sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else None)
        self.sharers = sum(mask == masks[node.rank] for mask in masks)
        node.Free()
        self.seconds, self.messages, self.sent_bytes = 0.0, 0, 0

    def swap(self, sends: Sequence[tuple[int, Array]], receives: Sequence[tuple[int, Array]]) -> None:
        """See `Ranks`."""
        begin = perf_counter()
        requests = [self._comm.Irecv(target, source) for source, target in receives]
        requests += [self._comm.Isend(values, target) for target, values in sends]
        self._mpi.Request.Waitall(requests)
        self._count(begin, len(sends), sum(values.nbytes for _, values in sends))

    def all_to_all(self, send: Floats, counts: Sequence[int], into: Floats, into_counts: Sequence[int]) -> None:
        """See `Ranks`."""
        begin = perf_counter()
        self._comm.Alltoallv([send, list(counts)], [into, list(into_counts)])
        self._count(begin, self.size - 1, send.nbytes - 8 * counts[self.rank])

    def table(self, row: Sequence[float]) -> Floats:
        """See `Ranks`."""
        begin = perf_counter()
        out = np.empty((self.size, len(row)))
        self._comm.Allgather(np.array(row, np.float64), out)
        self._count(begin, self.size - 1, 8 * len(row) * (self.size - 1))
        return out

    def rows(self, mine: Floats, counts: Sequence[int]) -> Floats:
        """See `Ranks`."""
        begin = perf_counter()
        width = mine.shape[1]
        out = np.empty((sum(counts), width))
        self._comm.Allgatherv(np.ascontiguousarray(mine), [out, [width * n for n in counts]])
        self._count(begin, self.size - 1, mine.nbytes * (self.size - 1))
        return out

    def share(self, value: Any, source: int = 0) -> Any:
        """See `Ranks`."""
        begin = perf_counter()
        shared = self._comm.bcast(value, root=source)
        self._count(begin, 1 if self.rank == source else 0, 0)
        return shared

    def abort(self, code: int) -> None:
        """See `Ranks`."""
        self._comm.Abort(code)

    def _count(self, begin: float, messages: int, sent: int) -> None:
        self.seconds += perf_counter() - begin
        self.messages += messages
        self.sent_bytes += sent


@lru_cache(maxsize=1)
def world() -> Ranks:
    """Return the ranks of this run: those that a launcher started, or one.

    Raises
    ------
    CaseError
        A launcher started several, but mpi4py is not installed, or is that of another MPI.

    Notes
    -----
    MPICH's own way of sharing within a machine waits milliseconds where there are more ranks than processors: another
    is chosen, unless the environment says which.

    Examples
    --------
    >>> world().size
    1
    """
    count, name = launched()
    if count == 1:
        return ALONE
    place = f"{count} MPI ranks ({name})"
    try:
        import mpi4py

        mpi4py.rc.thread_level = "funneled"
        for name in ("BCAST", "BARRIER", "REDUCE", "ALLREDUCE"):
            os.environ.setdefault(f"MPIR_CVAR_{name}_POSIX_INTRA_ALGORITHM", "mpir")
        from mpi4py import MPI
    except (ImportError, RuntimeError) as error:
        raise CaseError(
            "run", place, "needs mpi4py", str(error).partition("\n")[0] or "it is not installed",
            "Install rdpm[mpi], or start one process.",
        ) from None  # fmt: skip
    if count != MPI.COMM_WORLD.size:
        library = MPI.Get_library_version().split("\n")[0].strip("\0 ")
        raise CaseError(
            "run", place, f"must be as many as MPI sees, {MPI.COMM_WORLD.size}",
            f"mpi4py works with {library}, the launcher is that of another MPI",
            "Use that MPI's own mpiexec; with srun choose the interface by --mpi=pmi2 or --mpi=pmix.",
        )  # fmt: skip
    ranks = MpiRanks(MPI.COMM_WORLD)
    sys.excepthook = partial(_end_all, ranks)
    return ranks


def _end_all(ranks: Ranks, kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
    """What a script of the user's does not catch on one rank ends all: the others would wait for ever."""
    sys.__excepthook__(kind, error, trace)
    sys.stderr.flush()
    ranks.abort(getattr(error, "exit_code", 1))
