"""A study as one page: question, set-up, findings, figures, verdicts, table, and how to make it again."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any

from rdpm.figures import page
from rdpm.io.files import replacing
from rdpm.studies.names import SHORT, in_words, parameter
from rdpm.studies.pictures import Picture, sweep_of
from rdpm.studies.results import StudyResults

__all__ = ["Block", "content", "write_markdown", "write_page"]

Judged = Sequence[Mapping[str, Any]]
Pictures = Mapping[str, Sequence[Picture]]

_PERCENT = ("max_overlap_fraction", "min_gap_fraction")


@dataclass(frozen=True)
class Block:
    """A piece of the page.

    Attributes
    ----------
    kind : {"title", "section", "part", "text", "note", "picture", "video", "table", "code"}
    text : str
        Heading, sentence, caption, or code.
    path : pathlib.Path, optional
        Of a picture or video.
    heads, rows : tuple
        Of a table.
    """

    kind: str
    text: str = ""
    path: Path | None = None
    heads: tuple[str, ...] = ()
    rows: tuple[tuple[str, ...], ...] = ()


def write_page(results: StudyResults, judged: Judged, pictures: Pictures) -> Path:
    """Write ``page.html``: figures inside, videos beside it.

    Parameters
    ----------
    results : StudyResults
    judged : sequence of mapping
        As in ``claims.json``.
    pictures : mapping of str to sequence of Picture
        By the name of the part.

    Returns
    -------
    pathlib.Path
    """
    path = results.folder.path / "page.html"
    parts: list[str] = []
    for kind, group in groupby(content(results, judged, pictures), key=lambda block: block.kind):
        made = [_html(block, path.parent) for block in group]
        parts += [made[0], page.row(made[1:])] if kind == "video" else made
    with replacing(path) as temporary:
        temporary.write_text(page.document(results.title or results.name, parts), encoding="utf-8")
    return path


def write_markdown(blocks: Sequence[Block], path: Path, images: Path, prefix: str) -> Path:
    """Write blocks as Markdown, their pictures as files.

    Parameters
    ----------
    blocks : sequence of Block
    path : Path
        Of the text.
    images : Path
        Folder of the pictures.
    prefix : str
        Of their names.

    Returns
    -------
    pathlib.Path
    """
    images.mkdir(parents=True, exist_ok=True)
    lines = [_markdown(block, path.parent, images, prefix) for block in blocks]
    with replacing(path) as temporary:
        temporary.write_text("\n\n".join(line for line in lines if line) + "\n", encoding="utf-8")
    return path


def content(results: StudyResults, judged: Judged, pictures: Pictures) -> list[Block]:
    """The page as blocks, in the order in which it is read."""
    parts = [results.part(name) for name in results.parts]
    blocks = [Block("title", results.title or results.name), Block("text", results.question)]
    blocks += [Block("section", "What was found"), *(Block("text", text) for text in findings(results, judged))]
    blocks += [Block("section", "Set-up"), _setup(parts)]
    own = pictures.get(results.name, ()) if len(parts) > 1 else ()
    if own:
        blocks += [Block("section", "Design charts"), *_shown(own)]
    for part in parts:
        shown = _shown(pictures.get(part.name, ()))
        title = part.title or part.name
        blocks += [Block("section", title if len(parts) > 1 else "Figures")] if shown else []
        blocks += [Block("note", part.question)] if shown and len(parts) > 1 else []
        blocks += shown
    if judged:
        blocks += [Block("section", "Confirmed and contradicted"), _verdicts(judged)]
    blocks.append(Block("section", "Runs"))
    for part in parts:
        blocks += [Block("part", part.title or part.name)] if len(parts) > 1 else []
        blocks.append(_table(part))
    lost = results.table[results.table["status"] != "done"]
    blocks += [Block("note", f"{row.study}/{row.run}: {row.status}: {row.reason}") for row in lost.itertuples()]
    return [*blocks, Block("section", "How it was made"), *_made(results)]


def findings(results: StudyResults, judged: Judged) -> list[str]:
    """Three sentences, by the verdicts; without claims by the table."""
    if not judged:
        return _changes(results)
    counts = {
        verdict: sum(item["verdict"] == verdict for item in judged)
        for verdict in ("confirmed", "contradicted", "conditional", "within the spread", "not judged")
    }
    told = ", ".join(f"{count} {verdict}" for verdict, count in counts.items() if count)
    sentences = [f"Of {len(judged)} statements {told}." if len(judged) > 1 else f"One statement: {told[2:]}."]
    for verdict in ("confirmed", "contradicted", "conditional", "within the spread"):
        items = sorted((item for item in judged if item["verdict"] == verdict), key=lambda item: not item["runs"])
        if items and len(sentences) < 3:
            sentences.append(f"{verdict.capitalize()}: {items[0]['statement']} {_sentence(items[0])}")
    return sentences


def _changes(results: StudyResults) -> list[str]:
    runs = results.runs()
    found = [f"{len(runs)} of {len(results.table[results.table['spread_of'].fillna('') == ''])} runs are done."]
    for column, words in SHORT.items():
        if column in runs and runs[column].nunique() > 1 and len(found) < 3:
            low, high = runs.loc[runs[column].idxmin()], runs.loc[runs[column].idxmax()]
            found.append(
                f"{words.capitalize()} goes from {_cell(column, low[column])} ({low['run']}) to "
                f"{_cell(column, high[column])} ({high['run']})."
            )
    return found


def _sentence(item: Mapping[str, Any]) -> str:
    text = in_words(str(item["sentence"]))
    return text[:1].upper() + text[1:]


def _setup(parts: Sequence[StudyResults]) -> Block:
    rows = []
    for part in parts:
        own = part.table[part.table["spread_of"].fillna("") == ""]
        again = len(part.table) - len(own)
        count = f"{len(own)}" + (f", and {again} repeated with other numerics" if again else "")
        try:
            sweep = sweep_of(part)
            what = sweep.about(sweep.runs()[0]).removeprefix(f"{part.title}: ")
            values = ", ".join(f"{value:g}" for value in sweep.values) if sweep.key else ", ".join(own["run"])
            varied = f"{sweep.name.plain} = {values} {sweep.name.unit}".strip() if sweep.key else values
        except ValueError:
            what, varied = "no run is done", ""
        rows.append((part.title or part.name, what, varied, count))
    return Block("table", heads=("study", "what was run", "varied", "runs"), rows=tuple(rows))


def _shown(pictures: Sequence[Picture]) -> list[Block]:
    return [Block("video" if one.path.suffix == ".mp4" else "picture", one.title, one.path) for one in pictures]


def _verdicts(judged: Judged) -> Block:
    several = len({item["study"] for item in judged}) > 1
    rows = tuple(
        (
            f"{item['statement']} ({item['slide']}" + (f"; {item['study']})" if several else ")"), str(item["verdict"]),
            _sentence(item), str(item["reason"]), ", ".join(item["runs"]) or "computed",
        )
        for item in judged
    )  # fmt: skip
    return Block("table", heads=("statement", "verdict", "what was found", "reason", "runs"), rows=rows)


def _table(part: StudyResults) -> Block:
    mine = [row["parameters"] for row in part.index["rows"] if row["study"] == part.name]
    parameters: dict[str, Any] = mine[0] if mine else {}
    keys = [
        key for key in parameters
        if key in part.table and not key.startswith(("bodies", "time.")) and part.table[key].nunique() > 1
    ]  # what one run alone lacks, as a dry one its fluid, tells the others not apart
    keys += ["time.step"] if "time.step" in parameters and "time.step" in part.table else []
    measures = [column for column in SHORT if column in part.table and part.table[column].notna().any()]
    heads = ["run", *(_head(parameter(key).plain, parameter(key).unit) for key in keys)]
    heads += [_measure_head(column) for column in measures]
    rows = []
    for row in part.table.to_dict("records"):
        name = str(row["run"]) + ("" if row["status"] == "done" else f" ({row['status']})")
        rows.append((name, *(_cell(str(key), row[key]) for key in (*keys, *measures))))
    return Block("table", heads=tuple(heads), rows=tuple(rows))


def _head(name: str, unit: str) -> str:
    return f"{name} [{unit}]" if unit else name


def _measure_head(column: str) -> str:
    from rdpm.studies.measures import QUANTITIES

    unit = "% d" if column in _PERCENT else QUANTITIES[column].unit
    return _head(SHORT[column], "" if unit == "-" else unit)


def _cell(column: str, value: Any) -> str:
    import pandas

    if value is None or pandas.isna(value):
        return "–"
    if isinstance(value, (str, bool)):
        return str(value)
    return f"{100.0 * value:.3g}" if column in _PERCENT else f"{value:.4g}"


def _made(results: StudyResults) -> list[Block]:
    index = results.index
    facts = [
        (key.replace("_", " "), str(value)) for key, value in index.items()
        if isinstance(value, (str, int, float)) and key not in ("name", "title", "question", "command")
    ]  # fmt: skip
    wall = results.table.drop_duplicates("folder")["wall_s"].sum()
    facts.append(("wall time of all runs together", f"{wall:.0f} s"))
    return [Block("code", index.get("command") or "rdpm study"), Block("table", rows=tuple(facts))]


def _html(block: Block, home: Path) -> str:
    if block.kind == "table":
        return page.table(block.rows, block.heads)
    if block.path is not None and block.kind == "picture":
        return page.picture(block.path, block.text)
    if block.path is not None:
        return page.video_beside(os.path.relpath(block.path, home), block.text)
    makers = {"title": page.heading, "text": page.paragraph, "code": page.code}
    if block.kind in ("section", "part"):
        return page.section(block.text, [" "], 2 if block.kind == "section" else 3)
    if block.kind == "note":
        return page.paragraph(block.text, soft=True)
    return makers[block.kind](block.text)


def _markdown(block: Block, home: Path, images: Path, prefix: str) -> str:
    if block.kind == "table":
        heads = block.heads or ("",) * len(block.rows[0]) if block.rows else ()
        rows = (heads, ("---",) * len(heads), *block.rows)
        return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows if row)
    if block.path is not None and block.kind == "picture":
        part = "" if block.path.parent.name == prefix else f"_{block.path.parent.name}"
        name = f"{prefix}{part}_{block.path.name}".replace("-", "_")
        with replacing(images / name) as temporary:
            temporary.write_bytes(block.path.read_bytes())
        return f"![{block.text}]({Path(os.path.relpath(images / name, home)).as_posix()})\n\n*{block.text}*"
    marks = {"title": "# ", "section": "## ", "part": "### "}
    if block.kind == "code":
        return f"```console\n$ {block.text}\n```"
    return "" if block.kind == "video" else marks.get(block.kind, "") + block.text
