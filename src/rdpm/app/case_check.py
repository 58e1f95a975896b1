"""What ``rdpm check`` says, for a text that is being edited."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from html import escape
from pathlib import PurePosixPath
from typing import Any

from rdpm.app.case_text import path_of, read
from rdpm.app.frame import problem, state, table
from rdpm.app.workspace import Workspace
from rdpm.config.case import Case
from rdpm.config.lines import line_numbers
from rdpm.config.load import load_case
from rdpm.config.rule import Path
from rdpm.errors import CaseError, RdpmError
from rdpm.setup import Plan, plan

__all__ = ["Checked", "check"]


@dataclass(frozen=True)
class Checked:
    """A text that was checked: a plan, or a problem.

    Attributes
    ----------
    values : dict
        What the text holds; empty where it is no TOML.
    case : Case or None
    plan : Plan or None
    error : RdpmError or None
    path : tuple of str and int
        The key that the error is about.
    """

    values: dict[str, Any]
    case: Case | None = None
    plan: Plan | None = None
    error: RdpmError | None = None
    path: Path = ()
    line: int = 0

    @property
    def short(self) -> str:
        """Whether it can run, in a word."""
        if self.error is not None:
            return state("fail", "cannot run")
        return "" if self.plan is None else state("warning" if self.plan.warnings else "ok", "can run")

    @property
    def html(self) -> str:
        """The same for a reader."""
        if self.error is not None:
            where = f"Line {self.line}. " if self.line else ""
            return problem(where + str(self.error))
        return "" if self.plan is None else _sections(self.plan)


def check(text: str, name: str, work: Workspace) -> Checked:
    """Check a case file as far as can be done without a run.

    Parameters
    ----------
    text : str
    name : str
        Of the file, for the folder in which tables of bodies are sought; "" for one that is not saved.
    work : Workspace

    Examples
    --------
    >>> import tempfile, pathlib
    >>> from rdpm.cases import shipped_text
    >>> work = Workspace(pathlib.Path(tempfile.mkdtemp()).resolve())
    >>> check(shipped_text("dkt"), "", work).plan.cells
    (54, 54, 270)
    >>> found = check(shipped_text("dkt").replace("15 mm", "-15 mm"), "", work)
    >>> found.path, str(found.error)
    (('bodies', 0, 'diameter'), 'bodies[0].diameter = "-15 mm": must be positive.')
    """
    values: dict[str, Any] = {}
    try:
        values = read(text)
        case = load_case(_placed(read(text), name, work))
        return Checked(values, case, plan(case))
    except RdpmError as error:
        path = path_of(error.place) if values else ()
        return Checked(values, error=error, path=path, line=_line(text, path))
    except (ArithmeticError, MemoryError, RecursionError, ValueError) as error:
        rule = "cannot be worked out with these numbers"
        return Checked(values, error=CaseError("case", None, rule, f"{type(error).__name__}: {error}"))


def _placed(values: dict[str, Any], name: str, work: Workspace) -> dict[str, Any]:
    """Give the names of tables of bodies in full; those outside the folder are refused."""
    groups = values.get("bodies")
    for n, group in enumerate(groups if isinstance(groups, list) else ()):
        if isinstance(group, dict) and isinstance(group.get("file"), str):
            try:
                group["file"] = str(work.inside((PurePosixPath(name).parent / group["file"]).as_posix()))
            except CaseError as error:
                raise CaseError(f"bodies[{n}].file", f'"{group["file"][:80]}"', error.rule) from None
    return values


def _line(text: str, path: Path) -> int:
    with suppress(ValueError):
        lines = line_numbers(text)
        for length in range(len(path), 0, -1):
            if path[:length] in lines:
                return lines[path[:length]]
    return 0


def _sections(found: Plan) -> str:
    parts = []
    for title, rows in found.sections:
        cells = []
        for row in rows:
            verdict = f" {state(row.verdict)}" if row.verdict else ""
            note = f'<br><span class="rdpm-soft">{escape(row.note)}</span>' if row.note else ""
            cells.append((escape(row.name), f"{escape(row.value)}{verdict}{note}"))
        parts.append(table(cells, caption=title, is_html=True))
    warnings = len(found.warnings)
    word = "warning" if warnings else "ok"
    said = f"{warnings} warning{'s' if warnings > 1 else ''}" if warnings else "no warnings"
    return f"<p>{state(word, 'can run')} {said}.</p>" + "".join(parts)
