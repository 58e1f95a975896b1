"""Files that are either whole or absent, and one message when the disk refuses."""

from __future__ import annotations

import errno
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rdpm.errors import OutputError

__all__ = ["replacing", "reporting"]

_CURES = {
    errno.ENOSPC: "Free some space, or write elsewhere with --out.",
    errno.EDQUOT: "Free some of your quota, or write elsewhere with --out.",
    errno.EACCES: "Change the folder's permissions, or write elsewhere with --out.",
    errno.EPERM: "Change the folder's permissions, or write elsewhere with --out.",
    errno.EROFS: "Write elsewhere with --out.",
    errno.ENOENT: "The folder was removed or never made: make it again, or write elsewhere with --out.",
}


@contextmanager
def reporting(path: str | Path) -> Iterator[None]:
    """Turn the system's refusal to write `path` into an `OutputError`.

    Parameters
    ----------
    path : path
        The file being written; named in the message.

    Raises
    ------
    OutputError
        Disk full, no permission, folder gone: place, reason and cure.

    Examples
    --------
    >>> with reporting("results/particles.csv"):
    ...     raise OSError(28, "No space left on device")
    Traceback (most recent call last):
    ...
    rdpm.errors.OutputError: results/particles.csv: cannot be written (No space left on device). Free ...
    """
    try:
        yield
    except OutputError:
        raise
    except OSError as error:
        reason = error.strerror or str(error).splitlines()[0]
        cure = _CURES.get(_number(error), "Look at the disk, or write elsewhere with --out.")
        raise OutputError(str(path), None, "cannot be written", reason, cure) from error


def _number(error: OSError) -> int:
    """The system's error number; HDF5 gives it in its text only."""
    if error.errno is not None:
        return error.errno
    text = str(error)
    return next((number for number in _CURES if f"errno = {number}," in text), 0)


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """Write `path` whole or not at all: a temporary name in the same folder, then a rename.

    Parameters
    ----------
    path : path
        The file that shall exist afterwards; an older one stays untouched until then.

    Yields
    ------
    pathlib.Path
        The temporary name to write to, with the same ending. It is removed when the block raises.

    Raises
    ------
    OutputError
        The file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> folder = Path(tempfile.mkdtemp())
    >>> with replacing(folder / "note.txt") as temporary:
    ...     _ = temporary.write_text("done")
    >>> (folder / "note.txt").read_text()
    'done'
    """
    path = Path(path)
    with reporting(path):
        handle, name = tempfile.mkstemp(prefix=f".{path.stem}-", suffix=path.suffix, dir=path.parent)
        os.close(handle)
        temporary = Path(name)
        try:
            yield temporary
            _sync(temporary)
            temporary.chmod(0o666 & ~_umask())
            temporary.replace(path)
        except BaseException:
            temporary.unlink(missing_ok=True)
            raise


def _sync(path: Path) -> None:
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def _umask() -> int:
    # The mask can only be read by setting it; a private temporary file must become an ordinary one.
    mask = os.umask(0)
    os.umask(mask)
    return mask
