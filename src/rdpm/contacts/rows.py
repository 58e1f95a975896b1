"""Rows that cross the border to the kernels: structured dtypes, compared with the C++ structs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm import _core

__all__ = ["APART", "ENDED", "PAIR", "STATE", "TOUCHING", "Rows", "as_bytes", "check_layout", "zero_rows"]

Rows = NDArray[np.void]


def check_layout(dtype: np.dtype[np.void], layout: Mapping[str, Any], name: str) -> None:
    """Compare a structured dtype with the C++ struct that reads its rows.

    Parameters
    ----------
    dtype : dtype
        Fields of float64 and int64, or arrays of them.
    layout : mapping
        ``fields``: name, offset, count and kind ("f" or "i") of each member in order; ``size`` in bytes.
    name : str
        Of the rows, for the message.

    Raises
    ------
    ImportError
        They differ: the compiled module belongs to another version.

    Examples
    --------
    >>> layout = {"fields": [("xi", 0, 3, "f")], "size": 24}
    >>> check_layout(np.dtype([("xi", np.float64, (3,))]), layout, "history")
    >>> check_layout(np.dtype([("xi", np.float64)]), layout, "history")
    Traceback (most recent call last):
    ImportError: rows of history: Python has [('xi', 0, 1, 'f')] in 8 bytes, C++ [('xi', 0, 3, 'f')] in 24 bytes
    """
    places: Mapping[str, Any] = dtype.fields or {}
    fields = []
    for field, (kind, offset) in places.items():
        fields.append((field, offset, kind.itemsize // kind.base.itemsize, kind.base.kind))
        if kind.base.itemsize != 8:
            raise ImportError(f"rows of {name}: {field} must be of 8 bytes")
    if fields != list(layout["fields"]) or dtype.itemsize != layout["size"]:
        raise ImportError(
            f"rows of {name}: Python has {fields} in {dtype.itemsize} bytes, "
            f"C++ {list(layout['fields'])} in {layout['size']} bytes"
        )


def as_bytes(rows: Rows) -> NDArray[np.uint8]:
    """View (M,) rows as the (M, itemsize) bytes that the kernels take."""
    size = rows.dtype.itemsize
    return rows.view(np.uint8).reshape(len(rows), size) if size else np.empty((len(rows), 0), np.uint8)


def zero_rows(count: int, dtype: np.dtype[np.void]) -> Rows:
    """Rows of zeros that begin at a line of the cache, so that one of 64 bytes lies in one."""
    room = np.zeros(count * dtype.itemsize + 64, np.uint8)
    start = -room.ctypes.data % 64
    rows: Rows = room[start : start + count * dtype.itemsize].view(dtype)
    return rows


PAIR = np.dtype(
    [
        ("reduced_mass", np.float64),
        ("reduced_radius", np.float64),
        ("smaller_diameter", np.float64),
        ("is_frictionless", np.bool_),
    ]
)
r"""What a law may know of a pair.

``reduced_mass`` :math:`(1/m_i+1/m_j)^{-1}` [kg], the body's own mass against a wall or a body of prescribed motion;
``reduced_radius`` :math:`a_ia_j/(a_i+a_j)` [m], the body's radius against a wall; ``smaller_diameter`` [m];
``is_frictionless``: a free-slip face, which pushes along its normal alone.
"""

APART, TOUCHING, ENDED = 0, 1, 2

STATE = np.dtype(
    [("phase", np.int64)]
    + [
        (name, np.float64)
        for name in ("start", "end", "impact_speed", "rebound_speed", "max_overlap", "overlap", "work")
    ]
)
"""A contact, whatever its law.

``phase``: :data:`APART`, :data:`TOUCHING`, or :data:`ENDED` (the force has vanished, the surfaces still overlap);
``start``, ``end`` [s] of the force; ``impact_speed``, ``rebound_speed`` [m/s]; ``max_overlap`` [-] of the smaller
diameter; ``overlap`` [m] now; ``work`` [J] of the contact force.
"""
check_layout(STATE, _core.contact_layouts()["state"], "contact states")
