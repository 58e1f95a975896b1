"""The folder that the page works in: nothing outside it is read, written or named."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from rdpm.errors import CaseError
from rdpm.results.run_folder import RunFolder

__all__ = ["SERVED", "Workspace"]

#: Endings of the files that may be opened or taken away.
SERVED = {".csv", ".html", ".json", ".log", ".md", ".mp4", ".parquet", ".pdf", ".png", ".svg", ".toml", ".vtkhdf"}

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9 _.+-]{0,79}")
_MOST_LEVELS = 5
_MOST_FOLDERS = 5000  # looked at; a page that lists more is of no use
_NEVER = {"checkpoints", "figures", "jobs", "__pycache__", "node_modules"}


@dataclass(frozen=True)
class Workspace:
    """A folder, and what is in it; names are relative to it, with ``/``.

    Parameters
    ----------
    root : pathlib.Path
        Exists.

    Examples
    --------
    >>> import tempfile
    >>> work = Workspace(Path(tempfile.mkdtemp()).resolve())
    >>> work.inside("dkt/summary.json").relative_to(work.root).as_posix()
    'dkt/summary.json'
    >>> work.inside("../secret")
    Traceback (most recent call last):
    ...
    rdpm.errors.CaseError: "../secret": must be a place inside the folder of the page.
    """

    root: Path

    def inside(self, name: str) -> Path:
        """Give the path of a name; refuse one that leads out of the folder, by dots or by links."""
        refused = CaseError(f'"{name[:200]}"', None, "must be a place inside the folder of the page")
        if "\0" in name or "\\" in name or len(name) > 1000:
            raise refused
        parts = PurePosixPath(name).parts
        if name.startswith(("/", "~")) or any(part == ".." or part.startswith(".") for part in parts):
            raise refused
        try:
            path = (self.root / name).resolve()
        except (OSError, RuntimeError, ValueError):
            raise refused from None
        if not path.is_relative_to(self.root):
            raise refused
        return path

    def name(self, path: Path) -> str:
        """Give the name of a path inside."""
        return path.relative_to(self.root).as_posix()

    def new(self, name: str, ending: str = "") -> Path:
        """Give the path of something to be made in the folder itself; refuse what is no plain name."""
        if not _NAME.fullmatch(name) or not name.strip(". ") or name.startswith("."):
            cure = "Use letters, digits, - and _; begin with a letter or digit."
            raise CaseError("name", f'"{name[:80]}"', "must be a plain name", "it becomes one in the folder", cure)
        return self.inside(name if name.endswith(ending) else name + ending)

    def free_name(self, name: str) -> str:
        """Give NAME, or NAME-2, NAME-3, ... where that is taken."""
        plain = re.sub(r"[^A-Za-z0-9_.+-]+", "-", name).strip("-.") or "run"
        number, free = 1, plain[:60]
        while (self.root / free).exists():
            number += 1
            free = f"{plain[:60]}-{number}"
        return free

    def file(self, name: str) -> Path:
        """Give the path of a file that may be sent to the browser."""
        path = self.inside(name)
        if path.suffix not in SERVED or not path.is_file():
            raise CaseError(f'"{name[:200]}"', None, "there is no such file")
        return path

    def run(self, name: str) -> RunFolder:
        """Give the folder of a run."""
        files = RunFolder(self.inside(name))
        if name in ("", ".") or not files.case.is_file():
            raise CaseError(f'"{name[:200]}"', None, "must be the folder of a run", "it holds no case.toml")
        return files

    def runs(self) -> list[str]:
        """List the folders of runs."""
        return sorted(self.name(path) for path, names in self._folders() if "case.toml" in names)

    def studies(self) -> list[str]:
        """List the folders of studies."""
        return sorted(self.name(path) for path, names in self._folders() if "study.json" in names)

    def cases(self) -> list[str]:
        """List the case files; those of runs and studies are not among them."""
        found = []
        for path, names in self._folders():
            if {"case.toml", "study.json"} & names:
                continue
            found += [self.name(path / name) for name in names if name.endswith(".toml")]
        return sorted(found)

    def _folders(self) -> Iterator[tuple[Path, set[str]]]:
        """Each folder that may hold something, with the names of its files; links are not followed."""
        for seen, (place, folders, files) in enumerate(os.walk(self.root)):
            if seen >= _MOST_FOLDERS:
                return
            path, names = Path(place), set(files)
            is_run = "case.toml" in names and path != self.root
            deep = len(path.relative_to(self.root).parts) >= _MOST_LEVELS
            wanted = () if is_run or deep else sorted(f for f in folders if f[0] != "." and f not in _NEVER)
            folders[:] = wanted
            yield path, {name for name in names if not name.startswith(".")} - ({"case.toml"} if not is_run else set())
