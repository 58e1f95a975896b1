"""``rdpm new``: the shipped cases, listed or copied."""

from __future__ import annotations

import os
import tomllib
from pathlib import Path

from rdpm.errors import CaseError

__all__ = ["new"]


def new(name: str | None = None, folder: Path = Path(), /) -> None:
    """List the shipped cases, or copy one as an editable TOML file.

    Parameters
    ----------
    name : str, optional
        The case to copy; without it all are listed.
    folder : Path, optional
        Where to; here when left out. It is made if its parent is there.

    Raises
    ------
    CaseError
        No such case; the file is there already, or cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as home:   # doctest: +ELLIPSIS
    ...     new("dkt", Path(home))
    Wrote ...dkt.toml. Edit it, then: rdpm run ...dkt.toml
    """
    from rdpm.cases import shipped_names, shipped_text
    from rdpm.config.rule import shown, suggestion

    if name is None:
        width = max(map(len, shipped_names()))
        for case in shipped_names():
            print(f"{case:{width}}  {tomllib.loads(shipped_text(case))['title']}")
        print("\nCopy one with: rdpm new NAME")
        return
    if name not in shipped_names():
        raise CaseError(
            "NAME", shown(name), "must be a shipped case", cure=suggestion(name[:80], shipped_names())
        )
    path = folder / f"{name}.toml"
    if path.exists():
        raise CaseError(
            str(path),
            None,
            "must not be there yet",
            "it may hold your changes",
            "Name another folder, or move it.",
        )
    try:
        folder.mkdir(exist_ok=True)
        draft = path.with_name(f".{path.name}.{os.getpid()}")
        draft.write_text(shipped_text(name), encoding="utf-8")
        draft.replace(path)
    except OSError as error:
        raise CaseError(
            str(path),
            None,
            "must be a place to write to",
            error.strerror or type(error).__name__,
            "Name another folder.",
        ) from None
    print(f"Wrote {path}. Edit it, then: rdpm run {path}")
