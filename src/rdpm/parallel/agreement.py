"""What ranks do together: the root writes, and errors are raised by all."""

from __future__ import annotations

import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TypeVar

import numpy as np

from rdpm.errors import RdpmError
from rdpm.parallel.ranks import Ranks

__all__ = ["OnRoot", "agree", "guarding", "on_root", "together"]

T = TypeVar("T")


def on_root(ranks: Ranks, do: Callable[[], T]) -> T:
    """Have the root do something; everyone gets what it returned, or the error it raised.

    Parameters
    ----------
    ranks : Ranks
    do : callable
        Called on the root alone; what it returns must be plain data.

    Examples
    --------
    >>> from rdpm.parallel.ranks import ALONE
    >>> on_root(ALONE, lambda: 3)
    3
    """
    if ranks.size == 1:
        return do()
    outcome: tuple[bool, Any] = (True, None)
    if ranks.rank == 0:
        try:
            outcome = (True, do())
        except Exception as error:
            outcome = (False, error)
    is_done, value = ranks.share(outcome)
    if not is_done:
        vars(value)["is_agreed"] = True
        raise value
    result: T = value
    return result


def together(ranks: Ranks, do: Callable[[], T]) -> T:
    """Call something on every rank; where one of rdpm's errors is raised on some, all raise that of the lowest.

    Examples
    --------
    >>> from rdpm.parallel.ranks import ALONE
    >>> together(ALONE, lambda: 3)
    3
    """
    found: list[T] = []
    error: RdpmError | None = None
    try:
        found.append(do())
    except RdpmError as raised:
        error = raised
    agree(ranks, error)
    return found[0]


def agree(ranks: Ranks, error: Exception | None) -> None:
    """Raise on every rank the error of the lowest one that has one.

    Examples
    --------
    >>> from rdpm.parallel.ranks import ALONE
    >>> agree(ALONE, None)
    """
    if ranks.size == 1:
        if error is not None:
            raise error
        return
    failed = ranks.table([error is not None])[:, 0]
    if failed.any():
        shared: Exception = ranks.share(error, int(np.argmax(failed)))
        vars(shared)["is_agreed"] = True
        raise shared


@contextmanager
def guarding(ranks: Ranks) -> Iterator[None]:
    """End all ranks where one leaves the block by an error that the others do not know of."""
    try:
        yield
    except BaseException as error:
        if ranks.size > 1 and not getattr(error, "is_agreed", False):
            text = f"rdpm: rank {ranks.rank}: {error}\n" if hasattr(error, "exit_code") else traceback.format_exc()
            sys.stderr.write(text)
            sys.stderr.flush()
            ranks.abort(getattr(error, "exit_code", 130 if isinstance(error, KeyboardInterrupt) else 1))
        raise


class OnRoot:
    """A writer of files that only the root has; its methods are called on every rank.

    Parameters
    ----------
    ranks : Ranks
    make : callable
        Gives the writer; called on the root alone.

    Examples
    --------
    >>> from rdpm.parallel.ranks import ALONE
    >>> rows = OnRoot(ALONE, list)
    >>> rows.append(1)
    >>> len(rows.inner)
    1
    """

    def __init__(self, ranks: Ranks, make: Callable[[], Any]) -> None:
        self.inner: Any = None
        self._ranks = ranks

        def keep() -> None:
            self.inner = make()

        on_root(ranks, keep)

    def __getattr__(self, name: str) -> Callable[..., Any]:
        def call(*arguments: Any) -> Any:
            return on_root(self._ranks, lambda: getattr(self.inner, name)(*arguments))

        return call

    def __enter__(self) -> OnRoot:
        if self.inner is not None and hasattr(self.inner, "__enter__"):
            self.inner.__enter__()
        return self

    def __exit__(self, *exception: Any) -> None:
        if self.inner is not None and hasattr(self.inner, "__exit__"):
            self.inner.__exit__(*exception)
