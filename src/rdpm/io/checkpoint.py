"""Checkpoints: arrays and facts in one file that is whole or absent, with a checksum."""

from __future__ import annotations

import hashlib
import json
import math
import os
from collections.abc import Container, Iterable, Iterator, Mapping
from io import FileIO
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from rdpm.errors import CheckpointError
from rdpm.io.files import replacing
from rdpm.parallel.gather import Planes

__all__ = ["read_checkpoint", "read_facts", "read_rows", "write_checkpoint"]

SCHEMA = 3

# Three lines of text, then the arrays' bytes one after the other: no library stands between the file and its
# checksum, which is verified before anything else is believed.
_NAME = b"rdpm checkpoint"
_DIGITS = 64  # of SHA-256 in hexadecimal
_BLOCK = 1 << 22

Arrays = dict[str, NDArray[Any]]


def write_checkpoint(
    path: str | Path, arrays: Mapping[str, NDArray[Any] | Planes], facts: Mapping[str, Any]
) -> None:
    """Write arrays and facts, whole or not at all.

    Parameters
    ----------
    path : path
        The file; an older one stays untouched until the new one is on the disk.
    arrays : mapping of str to ndarray or Planes
        Of any shape and plain type; planes of other ranks are taken one rank after the other.
    facts : mapping
        What JSON can hold; floats keep their bits.

    Raises
    ------
    OutputError
        The file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp()) / "step-000000004.checkpoint"
    >>> write_checkpoint(path, {"u": np.arange(3.0)}, {"time": 0.1})
    >>> arrays, facts = read_checkpoint(path)
    >>> arrays["u"].tolist(), facts
    ([0.0, 1.0, 2.0], {'time': 0.1})
    """
    listed = [[name, array.dtype.str, list(array.shape)] for name, array in arrays.items()]
    header = json.dumps({"facts": dict(facts), "arrays": listed}).encode() + b"\n"
    with replacing(path) as temporary, open(temporary, "wb", buffering=0) as file:
        digest = hashlib.sha256()
        _write(file, _NAME + b" %d\n" % SCHEMA)
        place = file.tell()
        _write(file, b"0" * _DIGITS + b"\n")
        for content in (memoryview(header), *_contents(arrays.values())):
            digest.update(content)
            _write(file, content)
        file.seek(place)
        _write(file, digest.hexdigest().encode())


def _contents(arrays: Iterable[NDArray[Any] | Planes]) -> Iterator[memoryview]:
    for array in arrays:
        for part in array if isinstance(array, Planes) else (array,):
            yield np.ascontiguousarray(part).reshape(-1).view(np.uint8).data


def _write(file: FileIO, content: bytes | memoryview) -> None:
    # Without a buffer of Python's: a full disk then shows here, and not once more when the file is closed.
    rest = memoryview(content)
    while rest:
        rest = rest[file.write(rest) :]


def read_checkpoint(path: str | Path, leave: Container[str] = ()) -> tuple[Arrays, dict[str, Any]]:
    """Read what `write_checkpoint` wrote, once its checksum is right.

    Parameters
    ----------
    path : path
    leave : container of str
        Arrays that are not read.

    Returns
    -------
    arrays : dict of str to ndarray
    facts : dict

    Raises
    ------
    CheckpointError
        The file is missing, spoiled, or of another schema.
    """
    try:
        with open(path, "rb") as file:
            given = _digest_given(path, file)
            begin = file.tell()
            digest = hashlib.sha256()
            while block := file.read(_BLOCK):
                digest.update(block)
            if digest.hexdigest().encode() != given:
                raise _refused(path, "its checksum is wrong: it was cut short or changed")
            file.seek(begin)
            header = json.loads(file.readline())
            arrays = {}
            for name, dtype, shape in header["arrays"]:
                if name in leave:
                    file.seek(_size(dtype, shape), os.SEEK_CUR)
                else:
                    arrays[name] = _read_array(file, dtype, shape)
    except OSError as error:
        raise _refused(path, error.strerror or str(error)) from None
    return arrays, header["facts"]


def _read_array(file: IO[bytes], dtype: str, shape: list[int]) -> NDArray[Any]:
    array = np.empty(shape, np.dtype(dtype))
    file.readinto(array.reshape(-1).view(np.uint8).data)  # type: ignore[attr-defined]
    return array


def read_rows(path: str | Path, names: Container[str], rows: slice) -> Arrays:
    """Read some rows of some arrays of a checkpoint that `read_checkpoint` found whole.

    Parameters
    ----------
    path : path
    names : container of str
    rows : slice
        Without a stride.

    Raises
    ------
    CheckpointError
        The file is missing or unreadable.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp()) / "step-000000004.checkpoint"
    >>> write_checkpoint(path, {"u": np.arange(6.0).reshape(3, 2)}, {})
    >>> read_rows(path, {"u"}, slice(1, 3))["u"].tolist()
    [[2.0, 3.0], [4.0, 5.0]]
    """
    arrays = {}
    try:
        with open(path, "rb") as file:
            _digest_given(path, file)
            for name, dtype, shape in json.loads(file.readline())["arrays"]:
                begin, row = file.tell(), _size(dtype, shape[1:])
                if name in names:
                    first, last, _ = rows.indices(shape[0])
                    file.seek(first * row, os.SEEK_CUR)
                    arrays[name] = _read_array(file, dtype, [last - first, *shape[1:]])
                file.seek(begin + _size(dtype, shape))
    except OSError as error:
        raise _refused(path, error.strerror or str(error)) from None
    return arrays


def _size(dtype: str, shape: list[int]) -> int:
    return np.dtype(dtype).itemsize * math.prod(shape)


def read_facts(path: str | Path) -> dict[str, Any]:
    """Read the facts alone, without verifying the arrays.

    Raises
    ------
    CheckpointError
        The file is missing, unreadable, or of another schema.
    """
    try:
        with open(path, "rb") as file:
            _digest_given(path, file)
            facts: dict[str, Any] = json.loads(file.readline())["facts"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise _refused(path, str(error)) from None
    return facts


def _digest_given(path: str | Path, file: IO[bytes]) -> bytes:
    line = file.readline(len(_NAME) + 16)
    if line.rstrip(b"\n") != _NAME + b" %d" % SCHEMA:
        if line.startswith(_NAME + b" "):
            raise _refused(path, f"it has schema {line[len(_NAME) :].decode(errors='replace').strip()}, not {SCHEMA}")
        raise _refused(path, "it does not begin as a checkpoint does")
    return file.readline(_DIGITS + 2).rstrip(b"\n")


def _refused(path: str | Path, reason: str) -> CheckpointError:
    return CheckpointError(str(path), None, "must be a whole checkpoint", reason)
