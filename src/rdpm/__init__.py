"""rdpm: particle-resolved simulation of particulate flow with designed soft-sphere contacts."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

from rdpm.parallel.levels import kernel_folder
from rdpm.parallel.threads import wait_passively

wait_passively()   # before anything loads the kernels
if (_kernels := kernel_folder(Path(__file__).parent)) is not None:
    __path__.insert(0, str(_kernels))   # rdpm._core is the one in there

__version__ = "0.1.0"
__all__ = ["Simulation", "Study", "design", "load_case", "results", "run"]

_HOME = {
    "Simulation": "rdpm.setup.build",
    "Study": "rdpm.studies.study",
    "load_case": "rdpm.config.load",
    "run": "rdpm.runs.run",
}


def __getattr__(name: str) -> Any:
    # Loaded on first use: `rdpm info` and the design functions need neither the solver nor the case models.
    if name in {"design", "results"}:
        return importlib.import_module(f"rdpm.{name}")
    if name in _HOME:
        return getattr(importlib.import_module(_HOME[name]), name)
    raise AttributeError(f"module 'rdpm' has no attribute {name!r}")
