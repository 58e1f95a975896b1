"""What a run left, for its page: numbers, curves, video, figures, tables, and all files to take away."""

from __future__ import annotations

import csv
from html import escape
from pathlib import Path
from urllib.parse import quote

from nicegui import ui

from rdpm.app.frame import chart, figure, files_link, heading, html, state, table, written
from rdpm.app.replay import Replay
from rdpm.app.run_figures import figures_of
from rdpm.app.status import tail
from rdpm.app.words import span
from rdpm.app.workspace import SERVED, Workspace
from rdpm.results.run import Run
from rdpm.results.run_folder import TABLES
from rdpm.results.summary import Summary

__all__ = ["numbers_of", "show_results"]

_ROWS = 12  # of a table that are shown
_MOST_REPLAYED = 20_000  # bodies


def numbers_of(found: Summary) -> list[tuple[str, str]]:
    """Give the key numbers of a run.

    Examples
    --------
    >>> numbers_of(Summary.from_dict({"status": "done", "steps": 3}))[0]
    ('steps', '3, to t = -')
    """
    cells = " x ".join(map(str, found.cells)) if found.cells else "-"
    fastest = max((body.max_speed_m_s for body in found.bodies if body.max_speed_m_s is not None), default=None)
    rows = [
        ("steps", f"{found.steps}, to t = {written(found.time_s, 's')}"),
        ("time step", f"{written(found.dt_s, 's')} (limit: {found.dt_limit or '-'})"),
        ("cells", f"{cells}, {written(found.cells_per_diameter, '', 3)} a diameter"),
        ("bodies", f"{len(found.bodies)}, greatest speed {written(fastest, 'm/s')}"),
    ]
    if found.dkt is not None:
        pair = found.dkt
        rows.append(("first kiss", written(pair.kiss_time_s, "s")))
        rows.append(("kisses", f"{pair.kisses}, {written(pair.kiss_duration_s, 's')} together"))
        rows.append(
            (
                "tumbling",
                f"{written(pair.tumble_time_s, 's')}, final angle {written(pair.final_angle_deg, 'degrees', 3)}",
            )
        )
    deepest = found.contacts.max_overlap_fraction
    overlap = f", largest overlap {100 * deepest:.3g} % d" if found.contacts.count and deepest is not None else ""
    rows.append(("contacts", f"{found.contacts.count}{overlap}"))
    for kind in found.contact.pairs:
        spring = f"k_n {written(kind.stiffness_N_m, 'N/m')}, eta_n {written(kind.damping_N_s_m, 'N s/m')}"
        spring += f", t_c {written(kind.contact_time_s, 's')}, e_n {written(kind.restitution)}"
        rows.append((f"contact {kind.kind}", spring))
    cost = f", {float(f'{found.ns_per_cell_step:.3g}'):g} ns a cell and step" if found.ns_per_cell_step else ""
    threads = f"{found.threads} thread{'s' if found.threads != 1 else ''}"
    rows.append(("wall time", f"{span(found.wall_s or 0.0)}{cost}, {threads}"))
    return rows


def show_results(run: Run, work: Workspace, has_replay: bool) -> None:
    """Put all that a run left on the page."""
    place = run.folder.path
    heading("Results")
    html(table(numbers_of(run.summary)))
    if run.summary.warnings:
        items = "".join(f"<li>{state('warning')} {escape(text)}</li>" for text in run.summary.warnings)
        html(f'<ul class="rdpm-list">{items}</ul>')
    if has_replay and run.tracks is not None and 0 < run.tracks.count <= _MOST_REPLAYED:
        Replay(run)
    heading("Curves")
    html('<p class="rdpm-soft">Zoom with ctrl and the wheel, or with the frame above each chart.</p>')
    with ui.element("div").classes("rdpm-even"):
        for options in figures_of(run).values():
            chart(options, options["title"]["text"])
    pictures = sorted(place.glob("figures/*.png"))
    if run.folder.video.is_file():
        heading("Video")
        still = place / "figures" / "bodies_3d.png"
        poster = f' poster="/files/{quote(work.name(still))}"' if still.is_file() else ""
        source = f"/files/{quote(work.name(run.folder.video))}"
        html(f'<div class="rdpm-figure"><video controls preload="none"{poster} src="{source}"></video></div>')
    if pictures:
        heading("Figures of the report")
        with ui.element("div").classes("rdpm-even"):
            for path in pictures:
                html(figure(work.name(path), path.stem.replace("_", " ")))
    _tables(run, work)
    _downloads(place, work)


def _tables(run: Run, work: Workspace) -> None:
    heading("Tables")
    for name in TABLES:
        path = run.folder.table(name)
        if path.is_file():
            with ui.expansion(f"{name}.csv").props("dense").classes("rdpm-field"):
                html(table_end(path))
                html(files_link(work.name(path), f"{name}.csv, whole", is_download=True))


def table_end(path: Path) -> str:
    """Write the head of a CSV table and its last rows."""
    try:
        with path.open(encoding="utf-8") as file:
            heads = next(csv.reader([file.readline()]), [])
    except OSError:
        return ""
    rows = [
        row for row in csv.reader(tail(path, 8192).splitlines()[-_ROWS:]) if len(row) == len(heads) and row != heads
    ]
    return table(([_short(text) for text in row] for row in rows), heads, f"The last {len(rows)} rows", numbers=True)


def _short(text: str) -> str:
    try:
        return f"{float(text):.6g}"
    except ValueError:
        return text


def _downloads(place: Path, work: Workspace) -> None:
    heading("Files")
    rows = []
    for path in sorted(place.iterdir()):
        if path.is_file() and path.suffix in SERVED and not path.name.startswith("."):
            name, size = work.name(path), path.stat().st_size
            seen = files_link(name, "open") if path.suffix in (".html", ".json", ".toml", ".log", ".mp4", ".md") else ""
            rows.append((files_link(name, path.name, is_download=True), _size(size), seen))
    html(table(rows, ("file", "size", ""), is_html=True))


def _size(size: int) -> str:
    return f"{size / 1e6:.1f} MB" if size >= 1e6 else f"{max(1, round(size / 1e3))} kB"
