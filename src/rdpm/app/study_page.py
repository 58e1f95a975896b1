"""A study: its question, its table, its figures, and the runs it is made of."""

from __future__ import annotations

import csv
from html import escape
from pathlib import Path
from urllib.parse import quote

from rdpm.app.frame import figure, files_link, frame, heading, html, link_to_run, problem
from rdpm.app.settings import current
from rdpm.app.workspace import Workspace
from rdpm.errors import CaseError, RdpmError
from rdpm.io.provenance import read_json
from rdpm.studies.folder import StudyFolder

__all__ = ["study", "study_links"]

_MOST_ROWS, _MOST_BYTES = 2000, 16 * 2**20


def study_links(work: Workspace) -> str:
    """Write the list of studies of the folder; empty where there are none."""
    items = []
    for name in work.studies():
        title = _titles(StudyFolder(work.inside(name)))[0]
        items.append(
            f'<li><a href="/study/{quote(name)}">{escape(name)}</a> <span class="rdpm-soft">{escape(title)}</span></li>'
        )
    return f'<ul class="rdpm-list">{"".join(items)}</ul>' if items else ""


def _titles(files: StudyFolder) -> tuple[str, str]:
    try:
        index = read_json(files.index)
        part: dict[str, str] = next(iter(index.get("parts", [])), {})
        return str(index.get("title") or part.get("title") or ""), str(
            index.get("question") or part.get("question") or ""
        )
    except (RdpmError, AttributeError, TypeError):
        return "", ""


def study(name: str, sort: str = "") -> None:
    """Show a study that was run.

    Parameters
    ----------
    name : str
        Of its folder.
    sort : str
        Column of its table by which rows are ordered.
    """
    work = current().work
    try:
        files = StudyFolder(work.inside(name))
        if not files.index.is_file():
            raise CaseError(f'"{name[:80]}"', None, "must be the folder of a study", "it holds no study.json")
    except CaseError as error:
        with frame("No such study", "runs"):
            html(problem(str(error)))
        return
    title, question = _titles(files)
    with frame(title or name, "runs"):
        html(f"<p>{escape(question)}</p>")
        files_of = {
            "The study as one page": files.path / "page.html",
            "table.csv": files.table_csv,
            "study.toml": files.study,
        }
        links = [files_link(work.name(path), text) for text, path in files_of.items() if path.is_file()]
        html(f"<p>{' &middot; '.join(links)}</p>")
        for path in sorted(files.figures.glob("*.png"))[:40]:
            html(figure(work.name(path), path.stem.replace("_", " ")))
        heading("Runs")
        html(_table(files, name, sort))


def _table(files: StudyFolder, name: str, sort: str) -> str:
    heads, rows = _rows(files.table_csv)
    if not heads:
        return '<p class="rdpm-note">There is no table yet: it is made when the study is done.</p>'
    if sort in heads:
        at = heads.index(sort)
        rows.sort(key=lambda row: _order(row[at]))
    seen = [n for n, head in enumerate(heads) if any(row[n] for row in rows)]  # columns that say something
    top = "".join(
        f'<th scope="col"><a href="/study/{quote(name)}?sort={quote(heads[n])}">{escape(heads[n])}</a></th>'
        for n in seen
    )
    body = "".join(
        "<tr>" + "".join(f"<td>{_cell(files, heads[n], row[n], name)}</td>" for n in seen) + "</tr>" for row in rows
    )
    return f'<div class="rdpm-wide"><table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table></div>'


def _rows(path: Path) -> tuple[list[str], list[list[str]]]:
    try:
        if path.stat().st_size > _MOST_BYTES:
            return [], []
        with path.open(encoding="utf-8", newline="") as file:
            lines = list(csv.reader(file))
    except (OSError, UnicodeDecodeError, csv.Error):
        return [], []
    heads = lines[0] if lines else []
    return heads, [row for row in lines[1 : _MOST_ROWS + 1] if len(row) == len(heads)]


def _order(text: str) -> tuple[int, float, str]:
    try:
        return (0, float(text), "")
    except ValueError:
        return (1 if text else 2, 0.0, text)


def _cell(files: StudyFolder, head: str, text: str, name: str) -> str:
    if (
        head == "run"
        and text.replace("-", "").replace("_", "").replace(".", "").isalnum()
        and files.run(text).case.is_file()
    ):
        return link_to_run(f"{name}/runs/{text}", text)
    try:
        return f"{float(text):.6g}" if text else ""
    except ValueError:
        return escape(text)
