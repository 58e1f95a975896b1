"""The text of a case: a shipped one, or a file; with what can be wrong with a file."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from rdpm.cases import shipped_names, shipped_text
from rdpm.config.rule import listed, shown, suggestion
from rdpm.errors import CaseError

__all__ = ["case_name", "local_file", "parse_toml", "read_source", "read_text"]

_LARGEST = 64 * 2**20  # bytes; a million centres fit


def case_name(source: str | Path | dict[str, Any]) -> str:
    """Return the name of a case: the shipped name, the file's without its ending, or ``case``.

    Examples
    --------
    >>> case_name("dkt"), case_name("studies/beads.toml"), case_name({})
    ('dkt', 'beads', 'case')
    """
    return "case" if isinstance(source, dict) else Path(source).stem or "case"


def local_file(name: str, folder: Path | None = None, what: str = "case") -> tuple[Path, str] | None:
    """The file ``NAME.toml`` that goes before what is shipped under a bare name: it is a copy that was edited.

    Parameters
    ----------
    name : str
        Shipped.
    folder : Path, optional
        Where the file is sought; here when left out.
    what : str
        Kind of what is shipped, for the note.

    Returns
    -------
    (Path, str) or None
        The file, and a line to tell; None where there is no such file.

    Examples
    --------
    >>> local_file("dkt") is None
    True
    """
    path = (folder or Path()) / f"{name}.toml"
    if not path.is_file():
        return None
    return path, f"note: {name} is the file {path} here, not the shipped {what} of that name"


def read_source(source: str | Path) -> tuple[str, str, Path]:
    """Return the text of a case, the name messages give it, and the folder its files are sought in."""
    if isinstance(source, str) and source in shipped_names():
        return shipped_text(source), f"{source}.toml", Path()
    path = Path(source)
    return read_text(path, is_case=True), shown(str(source), longest=200)[1:-1], path.parent


def read_text(path: Path, *, is_case: bool = False) -> str:
    """Read a text file, or say in one CaseError why not."""
    place = shown(str(path), longest=200)[1:-1]
    try:
        if path.is_dir():
            inside = path / "case.toml"
            cure = f"Name the file {inside}." if inside.is_file() else "Name a file in it."
            raise CaseError(place, None, "must be a file", "it is a folder", cure)
        if not path.exists():
            raise CaseError(place, None, "there is no such file", cure=_near(path, is_case))
        if not path.is_file():
            raise CaseError(place, None, "must be a regular file")
        if path.stat().st_size > _LARGEST:
            raise CaseError(place, None, f"must be at most {_LARGEST // 2**20} MiB", "it is no case file")
        data = path.read_bytes()
    except (OSError, ValueError) as error:
        if isinstance(error, CaseError):
            raise
        reason = error.strerror if isinstance(error, OSError) and error.strerror else "the name is not valid"
        raise CaseError(place, None, "must be a readable file", reason) from None
    if not data.strip():
        raise CaseError(
            place, None, "must not be empty", cure="`rdpm new dkt` writes an example." if is_case else ""
        )
    if b"\0" in data:
        raise CaseError(place, None, "must be a text file", "it holds binary data")
    try:
        return data.decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise CaseError(
            f"{place}:{line}",
            None,
            "must be UTF-8 text",
            f"byte {error.start} is not",
            "Save the file as UTF-8.",
        ) from None


def parse_toml(text: str, place: str) -> dict[str, Any]:
    """Parse TOML, or say in one CaseError on which line it breaks."""
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        said, _, where = str(error).partition(" (at ")
        line = where.removeprefix("line ").partition(",")[0]
        line = line if line.isdigit() else str(text.count("\n") + 1)
        column = where.partition("column ")[2].rstrip(")")
        near = f", column {column}" if column.isdigit() else ""
        raise CaseError(
            f"{place}:{line}",
            None,
            f"must be TOML: {said.rstrip('.')}{near}",
            cure="Text needs quotes, a list brackets, a table a [header].",
        ) from None
    except ValueError:
        raise CaseError(place, None, "must be TOML", "a number has thousands of digits") from None
    except RecursionError:
        raise CaseError(
            place, None, "must be TOML of a few levels", "lists or tables are nested too deeply"
        ) from None


def _near(path: Path, is_case: bool) -> str:
    if not is_case:
        return ""
    names = shipped_names()
    if path.suffix in ("", ".toml") and path.parent == Path():
        return suggestion(path.stem, names).replace("There are:", "Shipped cases are:")
    return f"Shipped cases are: {listed(names)}."
