"""Compressed chunks of an HDF5 dataset, packed on several threads (HDF5 itself packs on one)."""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rdpm.io.provenance import available_threads

if TYPE_CHECKING:
    import h5py

__all__ = ["PACKED", "append_packed"]

# VTK reads gzip, not lzf; level 1 after a shuffle is within a tenth of level 9 on velocities.
PACKED = {"compression": "gzip", "compression_opts": 1, "shuffle": True}


def append_packed(dataset: h5py.Dataset, values: NDArray[Any]) -> None:
    """Append one entry along the first axis, as HDF5 would, its chunks packed in parallel.

    Parameters
    ----------
    dataset : h5py.Dataset, (entries, ...)
        Changed: one entry longer. Made with `PACKED` and chunks of one entry.
    values : ndarray, (...)
        Of the dataset's type and the shape of one entry.
    """
    entry = dataset.shape[0]
    dataset.resize(entry + 1, axis=0)
    chunk = dataset.chunks[1:]
    values = np.ascontiguousarray(values, dataset.dtype)

    def packed(corner: tuple[int, ...]) -> tuple[tuple[int, ...], bytes]:
        block = values[tuple(slice(a, a + n) for a, n in zip(corner, chunk, strict=True))]
        if block.shape != chunk:   # chunks at the border are stored whole
            whole = np.zeros(chunk, values.dtype)
            whole[tuple(slice(n) for n in block.shape)] = block
            block = whole
        # HDF5's shuffle: first bytes of all numbers, then their second bytes, ...
        shuffled = np.ascontiguousarray(block).view(np.uint8).reshape(-1, values.dtype.itemsize).T
        return corner, zlib.compress(shuffled.tobytes(), 1)

    with ThreadPoolExecutor(available_threads()) as pool:
        for corner, content in pool.map(packed, _corners(values.shape, chunk)):
            dataset.id.write_direct_chunk((entry, *corner), content)


def _corners(shape: tuple[int, ...], chunk: tuple[int, ...]) -> Iterator[tuple[int, ...]]:
    return product(*[range(0, n, c) for n, c in zip(shape, chunk, strict=True)])
