"""What the page was started with; one page a process, as the toolkit has it."""

from __future__ import annotations

from dataclasses import dataclass

from rdpm.app.launch import Launcher
from rdpm.app.workspace import Workspace

__all__ = ["Settings", "current", "use"]


@dataclass(frozen=True)
class Settings:
    """The folder, and who starts runs in it."""

    work: Workspace
    launcher: Launcher


_in_use: list[Settings] = []


def use(settings: Settings) -> None:
    """Have the pages work with these."""
    _in_use[:] = [settings]


def current() -> Settings:
    """Give what the pages work with."""
    return _in_use[0]
