"""Ranks as threads of one process: they exchange arrays through queues, and no MPI is needed."""

from __future__ import annotations

import copy
import queue
import threading
from typing import Any

import numpy as np

#: Seconds after which a rank that hears nothing gives up.
PATIENCE = 60.0


class _Mail:
    def __init__(self, size: int) -> None:
        self.queue = {(a, b): queue.Queue() for a in range(size) for b in range(size)}
        self.is_ended = threading.Event()


class ThreadRanks:
    """One of several ranks; as `rdpm.parallel.ranks.Ranks`, and counts what it sends as `MpiRanks` does."""

    def __init__(self, size: int, rank: int, mail: _Mail) -> None:
        self.size, self.rank, self._mail = size, rank, mail
        self.seconds, self.messages, self.sent_bytes, self.sharers = 0.0, 0, 0, size

    def _send(self, rank: int, value: Any) -> None:
        self._mail.queue[self.rank, rank].put(copy.deepcopy(value))

    def _receive(self, rank: int) -> Any:
        for _ in range(int(PATIENCE / 0.05)):
            if self._mail.is_ended.is_set():
                raise RuntimeError("another rank has ended")
            try:
                return self._mail.queue[rank, self.rank].get(timeout=0.05)
            except queue.Empty:
                continue
        raise TimeoutError(f"rank {self.rank} hears nothing of rank {rank}")

    def swap(self, sends, receives):
        for rank, values in sends:
            self._count(1, values.nbytes)
            self._send(rank, values)
        for rank, target in receives:
            received = self._receive(rank)
            assert received.shape == target.shape, (received.shape, target.shape)
            target[...] = received

    def all_to_all(self, send, counts, into, into_counts):
        parts = np.split(send, np.cumsum(counts)[:-1])
        self._count(self.size - 1, send.nbytes - parts[self.rank].nbytes)
        for rank, part in enumerate(parts):
            self._send(rank, part)
        np.concatenate([self._receive(rank) for rank in range(self.size)], out=into)

    def table(self, row):
        self._count(self.size - 1, 8 * len(row) * (self.size - 1))
        return np.array(self._gathered(list(row)), float)

    def rows(self, mine, counts):
        self._count(self.size - 1, mine.nbytes * (self.size - 1))
        found = self._gathered(mine)
        assert [len(part) for part in found] == list(counts)
        return np.concatenate(found)

    def share(self, value, source=0):
        if self.rank == source:
            for rank in range(self.size):
                self._send(rank, value)
        return self._receive(source)

    def abort(self, code):
        self._mail.is_ended.set()

    def _gathered(self, value):
        for rank in range(self.size):
            self._send(rank, value)
        return [self._receive(rank) for rank in range(self.size)]

    def _count(self, messages, sent):
        self.messages += messages
        self.sent_bytes += sent


def on_ranks(size: int, do) -> list[Any]:
    """Call `do(ranks)` on so many ranks at once: what each returned; the first error is raised."""
    mail = _Mail(size)
    results: list[Any] = [None] * size
    errors: list[tuple[int, BaseException]] = []

    def work(rank: int) -> None:
        try:
            results[rank] = do(ThreadRanks(size, rank, mail))
        except BaseException as error:
            errors.append((rank, error))
            mail.is_ended.set()

    threads = [threading.Thread(target=work, args=(rank,)) for rank in range(size)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    if errors:
        raise errors[0][1]
    return results
