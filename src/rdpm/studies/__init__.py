"""Studies made of many runs: sweeps over a case's parameters, published cases, speed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rdpm.studies.results import load, read_results

__all__ = ["load", "read_results"]


def __getattr__(name: str) -> Any:
    # Loaded on first use: published cases and the benchmark need no tables.
    if name in __all__:
        import importlib

        return getattr(importlib.import_module("rdpm.studies.results"), name)
    raise AttributeError(f"module 'rdpm.studies' has no attribute {name!r}")
