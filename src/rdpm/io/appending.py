"""VTKHDF files that grow by steps, on a disk that may be full."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from rdpm.io.files import reporting

if TYPE_CHECKING:
    import h5py

__all__ = ["appending", "reserve"]

_SPARE = 1 << 20  # bytes that a step needs at most beside its values, for HDF5's indices


@contextmanager
def appending(path: Path, size: int = 0) -> Iterator[h5py.Group]:
    """Open a file for one step only: between two writes it is whole, and others may read it.

    Parameters
    ----------
    path : Path
    size : int, [bytes]
        Most that the values of the step take.

    Yields
    ------
    h5py.Group
        The root, ``VTKHDF``.

    Raises
    ------
    OutputError
        The file cannot be written; where the disk is full, it is as it was before.
    """
    import h5py

    with reporting(path):
        if size:
            reserve(path, size)
        try:
            with h5py.File(path, "r+") as file:
                yield file["VTKHDF"]
        except RuntimeError as error:   # what h5py makes of a failed write at closing
            raise OSError(str(error)) from error


def reserve(path: Path, size: int = 0) -> None:
    """Take room behind the file's end, which HDF5 gives back on closing.

    A disk that is full must say so before HDF5 writes: in the middle, the library leaves a broken file, and may crash.
    """
    if not hasattr(os, "posix_fallocate"):
        return
    handle = os.open(path, os.O_RDWR)
    end = os.fstat(handle).st_size
    try:
        os.posix_fallocate(handle, end, size + _SPARE)
    except OSError as error:
        os.ftruncate(handle, end)
        if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):   # others: a file system that cannot reserve
            raise
    finally:
        os.close(handle)
