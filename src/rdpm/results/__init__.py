"""What a run left: the files of its folder, and what they say."""

from __future__ import annotations

from typing import Any

__all__ = ["open"]


def __getattr__(name: str) -> Any:
    # On first use: whoever needs one module of the room does not load all.
    if name == "open":
        from rdpm.results.frames import open_run

        return open_run
    raise AttributeError(f"module 'rdpm.results' has no attribute {name!r}")
