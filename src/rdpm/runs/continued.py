"""Files of fields that a run continues."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from rdpm.errors import OutputError
from rdpm.io.files import reporting

__all__ = ["Note", "continued"]

Writer = TypeVar("Writer")
Note = Callable[[str], None]


def continued(
    path: Path, until: float | None, note: Note | None, make: Callable[[Path, float | None], Writer]
) -> Writer:
    """Open a file of fields to go on after `until`; a broken one is set aside, as no checkpoint depends on it."""
    try:
        return make(path, until)
    except (OutputError, KeyError, RuntimeError, ValueError) as error:
        is_refused = "errno" in str(error.__cause__) or getattr(error.__cause__, "errno", None) is not None
        if until is None or is_refused:   # by the system: the file itself may be good
            raise
        aside = path.with_suffix(".broken")
        with reporting(aside):
            path.replace(aside)
        if note:
            note(f"{path} was broken off while it was written: a new one begins, the old is {aside}")
        return make(path, None)
