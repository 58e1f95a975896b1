"""Calls of `_core` that a type checker must refuse: an ignore that is not needed is an error, so mypy sees the stub."""

from typing import assert_type

import numpy as np
from numpy.typing import NDArray

from rdpm import _core


def refused(grid: _core.Grid, single: NDArray[np.float32], field: NDArray[np.float64]) -> None:
    _core.fill_halo(grid, single, 0)  # type: ignore[arg-type]
    _core.fill_halo(grid, field, "u")  # type: ignore[arg-type]
    _core.fill_halo(grid, field)  # type: ignore[call-arg]
    _core.fill_halo(grid, field, side=0)  # type: ignore[call-arg]
    _core.Markers(grid, field)  # type: ignore[arg-type]
    assert_type(_core.largest_divergence(grid, field, field, field), float)
