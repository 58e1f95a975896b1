"""One run in a folder at a time, and which process it is."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from rdpm.errors import CaseError
from rdpm.parallel.agreement import on_root
from rdpm.parallel.ranks import ALONE, Ranks

__all__ = ["holder", "is_alive", "locked"]


@contextmanager
def locked(path: str | Path, ranks: Ranks = ALONE) -> Iterator[None]:
    """Hold a run's folder against a second run.

    Parameters
    ----------
    path : path
        Of the lock, a file in that folder, which must exist.
    ranks : Ranks
        That run in it together; the root holds the lock.

    Raises
    ------
    CaseError
        Another process runs in the folder, or it cannot be written to.

    Notes
    -----
    The system takes the lock from a process that ends in whatever way: a file left behind by a killed run is taken
    over. On a file system without locks a second run is not noticed.

    Examples
    --------
    >>> import tempfile
    >>> lock = Path(tempfile.mkdtemp()) / "run.lock"
    >>> with locked(lock):
    ...     int(lock.read_text()) == os.getpid()
    True
    >>> lock.exists()
    False
    """
    path = Path(path)
    handle = on_root(ranks, lambda: _held(path))
    try:
        yield
    finally:
        if ranks.rank == 0:
            with suppress(OSError):
                path.unlink()
            os.close(handle)


def _held(path: Path) -> int:
    """The locked file, with the number of this process in it."""
    try:
        handle = _open_locked(path)
    except OSError as error:
        reason = error.strerror or str(error)
        raise CaseError(
            str(path.parent), None, "must be a folder to write to", reason, "Name another with --out."
        ) from None
    with suppress(OSError):
        os.ftruncate(handle, 0)
        os.write(handle, f"{os.getpid()}\n".encode())
    return handle


def holder(path: str | Path) -> int | None:
    """Tell which process holds a lock.

    Parameters
    ----------
    path : path
        Of the lock; need not exist.

    Returns
    -------
    int or None
        The process; None where nobody holds it, as where a run was killed and left the file behind.

    Notes
    -----
    The lock itself is tried only where the process that the file names is alive: a run that starts is not disturbed.

    Examples
    --------
    >>> import tempfile
    >>> lock = Path(tempfile.mkdtemp()) / "run.lock"
    >>> with locked(lock):
    ...     holder(lock) == os.getpid()
    True
    >>> holder(lock) is None
    True
    """
    try:
        with open(path, encoding="ascii", errors="replace") as file:
            text = file.read(32).strip()
            process = int(text) if text.isdecimal() else 0
            if not process or not is_alive(process):
                return None
            return process if _is_locked(file.fileno()) else None
    except OSError:
        return None


def is_alive(process: int) -> bool:
    """Whether there is a process of this number."""
    try:
        os.kill(process, 0)
    except PermissionError:  # of another user
        return True
    except (OSError, OverflowError):
        return False
    return True


def _is_locked(handle: int) -> bool:
    try:
        import fcntl
    except ImportError:  # no such locks on this system: the process is alive, and that is all there is to know
        return True
    try:
        fcntl.flock(handle, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:  # a file system without locks
        return True
    fcntl.flock(handle, fcntl.LOCK_UN)
    return False


def _open_locked(path: Path) -> int:
    """Open and lock the file; the one that is locked is the one that carries the name."""
    try:
        import fcntl
    except ImportError:  # no such locks on this system
        return os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
    while True:
        handle = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if os.path.samestat(os.fstat(handle), path.stat()):
                return handle
        except BlockingIOError:
            holder = os.pread(handle, 32, 0).decode(errors="replace").strip()
            os.close(handle)
            raise CaseError(
                str(path.parent),
                None,
                "must be the folder of one run at a time",
                f"process {holder or 'unknown'} runs in it",
                "Wait for its end, or name another folder with --out.",
            ) from None
        except FileNotFoundError:
            pass  # the run before removed it between our opening and our lock
        except OSError:
            return handle  # a file system without locks
        os.close(handle)
