"""Two to six runs laid over each other."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from nicegui import ui

from rdpm.app.frame import chart, frame, heading, html, link_to_run, problem, table
from rdpm.app.run_figures import compared
from rdpm.app.run_results import numbers_of
from rdpm.app.settings import current
from rdpm.errors import RdpmError
from rdpm.results.run import Run, load_run

__all__ = ["overlay"]

FEWEST, MOST = 2, 6


def overlay(names: Sequence[str]) -> None:
    """Show runs over each other: curves, and key numbers side by side.

    Parameters
    ----------
    names : sequence of str
        Of their folders.
    """
    chosen = list(dict.fromkeys(names))
    with frame("Runs over each other", "runs"):
        if not FEWEST <= len(chosen) <= MOST:
            html(problem(f"Two to six runs can be laid over each other, not {len(chosen)}."))
            html('<p><a href="/runs">Choose among the runs</a></p>')
            return
        runs: dict[str, Run] = {}
        for name in chosen:
            try:
                runs[name] = load_run(current().work.run(name).path)
            except RdpmError as error:
                html(problem(f"{name[:80]} is left out: {error}"))
        if len(runs) < FEWEST:
            return
        html("<p>" + ", ".join(link_to_run(name) for name in runs) + "</p>")
        html('<p class="rdpm-soft">Of more than two bodies the velocity is the mean.</p>')
        with ui.element("div").classes("rdpm-even"):
            for options in compared(list(runs.values()), list(runs)).values():
                if any(one["data"] for one in options["series"]):
                    chart(options, options["title"]["text"])
        heading("Numbers")
        html(_side_by_side(runs))


def _side_by_side(runs: dict[str, Run]) -> str:
    found = {name: dict(numbers_of(run.summary)) for name, run in runs.items()}
    keys = list(dict.fromkeys(key for numbers in found.values() for key in numbers))
    rows = [(escape(key), *(escape(numbers.get(key, "-")) for numbers in found.values())) for key in keys]
    return table(rows, ("", *(escape(name) for name in found)), is_html=True)
