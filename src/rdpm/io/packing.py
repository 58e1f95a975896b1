"""Fields rounded and compressed: a twelfth of their size, at an error that no picture shows."""

from __future__ import annotations

import itertools
import math
import zlib
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rdpm.parallel.threads import available_threads

if TYPE_CHECKING:
    import h5py

__all__ = ["PACKED", "append_rounded", "packed_chunks", "rounded"]

#: Of a dataset whose chunks `packed_chunks` makes; VTK reads no lzf.
PACKED = {"compression": "gzip", "compression_opts": 1, "shuffle": True}

Values = NDArray[np.float32]


def rounded(values: Values, tolerance: float) -> Values:
    """Values brought to multiples of a power of two, so that they compress.

    Parameters
    ----------
    values : ndarray of float32
    tolerance : float, [-]
        Largest error over the largest magnitude of the values; 0 leaves them.

    Examples
    --------
    >>> rounded(np.array([1.0, 0.30001, -0.3, 1e-9], np.float32), 0.01).tolist()
    [1.0, 0.296875, -0.296875, 0.0]
    """
    top = max(float(values.max(initial=0.0)), -float(values.min(initial=0.0)))  # no copy: fields are large
    if tolerance <= 0.0 or top == 0.0 or not math.isfinite(top):
        return values
    quantum = np.float32(2.0 ** math.floor(math.log2(2.0 * tolerance * top)))
    whole = values / quantum
    np.rint(whole, out=whole)
    whole += np.float32(0.0)  # no negative zero
    whole *= quantum
    return np.asarray(whole, np.float32)


def append_rounded(dataset: h5py.Dataset, values: Values, tolerance: float) -> None:
    """Append one step of a field to a dataset, rounded; on all threads where it packs.

    Parameters
    ----------
    dataset : h5py.Dataset, (steps, ...)
        Of float32; packed as `PACKED` says, or not at all.
    values : ndarray of float32, (...)
    tolerance : float, [-]
        As for `rounded`.
    """
    count, values = dataset.shape[0], rounded(values, tolerance)
    dataset.resize(count + 1, axis=0)
    if dataset.compression is None:
        dataset[count] = values
        return
    for offset, packed in packed_chunks(values, dataset.chunks[1:]):
        dataset.id.write_direct_chunk((count, *offset), packed)


def packed_chunks(values: Values, chunk: tuple[int, ...]) -> Iterator[tuple[tuple[int, ...], bytes]]:
    """Chunks of an array as `PACKED` stores them, compressed side by side.

    Parameters
    ----------
    values : ndarray of float32
    chunk : tuple of int
        Shape of a chunk; those at the end are filled up with zeros.

    Yields
    ------
    offset : tuple of int
        Of the chunk's first value.
    packed : bytes
    """
    corners = list(itertools.product(*(range(0, n, step) for n, step in zip(values.shape, chunk, strict=True))))

    def pack(corner: tuple[int, ...]) -> bytes:
        part = values[tuple(slice(a, a + step) for a, step in zip(corner, chunk, strict=True))]
        if part.shape != chunk:
            part = np.pad(part, [(0, step - n) for n, step in zip(part.shape, chunk, strict=True)])
        bytewise = np.ascontiguousarray(part).view(np.uint8).reshape(-1, 4)
        return zlib.compress(bytewise.T.tobytes(), 1)

    with ThreadPoolExecutor(available_threads()) as pool:
        yield from zip(corners, pool.map(pack, corners), strict=True)
