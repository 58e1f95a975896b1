"""What all pages have: head, links, look; and the few pieces of HTML they are made of."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from html import escape
from pathlib import Path
from typing import Any
from urllib.parse import quote

from nicegui import ui

__all__ = [
    "button", "chart", "code", "figure", "files_link", "frame", "heading", "html", "link_to_run", "problem", "state",
    "table", "written",
]  # fmt: skip

_LINKS = (("design", "Design"), ("cases", "Cases"), ("runs", "Runs"))
_DARK = """<script>addEventListener("load", () => {
  const dark = localStorage.getItem("rdpm-dark");
  if (dark !== null) Quasar.Dark.set(dark === "1");
});</script>"""
_TOGGLE = '() => { Quasar.Dark.toggle(); localStorage.setItem("rdpm-dark", Quasar.Dark.isActive ? "1" : "0"); }'


@cache
def _look() -> str:
    return (Path(__file__).parent / "static" / "app.css").read_text(encoding="utf-8")


@contextmanager
def frame(title: str, active: str = "") -> Iterator[None]:
    """Make a page: what is made within is its main part.

    Parameters
    ----------
    title : str
        Heading and name of the window.
    active : str
        Of the links in the head, the one that is open.
    """
    ui.page_title(f"{title} - rdpm")
    ui.add_head_html(f"<style>{_look()}</style>{_DARK}")
    html('<a class="rdpm-skip" href="#main">To the main part</a>')
    with ui.element("header").classes("rdpm-head"):
        html('<strong><a href="/">rdpm</a></strong>')
        with ui.element("nav").props('aria-label="Pages"').classes("rdpm-row"):
            for name, text in _LINKS:
                here = ' aria-current="page"' if name == active else ""
                html(f'<a href="/{name}"{here}>{text}</a>')
        light = (
            ui.button(icon="contrast").props('flat dense round color=none aria-label="Light or dark"').classes("push")
        )
        light.on("click", js_handler=_TOGGLE)
    with ui.element("div").props('id=main tabindex="-1"').classes("rdpm-main"):
        heading(title, 1)
        yield


def html(text: str, classes: str = "") -> ui.html:
    """Put HTML on the page; whoever calls has escaped what comes from files and users."""
    return ui.html(text, sanitize=False).classes(classes)


def heading(text: str, level: int = 2) -> ui.html:
    """Put a heading on the page."""
    return html(f"<h{level}>{escape(text)}</h{level}>")


def button(text: str, act: Any = None, icon: str = "", is_main: bool = False) -> ui.button:
    """Put a button on the page."""
    made = ui.button(text, on_click=act, icon=icon or None)
    return made.props("unelevated color=none").classes("rdpm-go") if is_main else made.props("outline color=none")


def table(
    rows: Iterable[Sequence[str]],
    heads: Sequence[str] = (),
    caption: str = "",
    is_html: bool = False,
    numbers: bool = False,
) -> str:
    """Write a table that scrolls by itself where it is too wide.

    Parameters
    ----------
    rows : iterable of sequence of str
        The first cell of each is its head.
    heads : sequence of str
    caption : str
    is_html : bool
        The cells and heads are HTML already.
    numbers : bool
        All but the first are numbers, set to the right.

    Examples
    --------
    >>> table([("N_c", "< 4")])
    '<div class="rdpm-wide"><table><tbody><tr><th scope="row">N_c</th><td>&lt; 4</td></tr></tbody></table></div>'
    """
    said = (lambda text: text) if is_html else escape
    kind = ' class="number"' if numbers else ""
    head = "".join(f'<th scope="col"{kind if n else ""}>{said(text)}</th>' for n, text in enumerate(heads))
    body = "".join(
        f'<tr><th scope="row">{said(first)}</th>' + "".join(f"<td{kind}>{said(text)}</td>" for text in others) + "</tr>"
        for first, *others in rows
    )
    top = f"<caption>{escape(caption)}</caption>" if caption else ""
    top += f"<thead><tr>{head}</tr></thead>" if heads else ""
    return f'<div class="rdpm-wide"><table>{top}<tbody>{body}</tbody></table></div>'


def code(text: str, label: str) -> str:
    """Write text as it is, in a box that the keyboard can scroll."""
    return f'<pre class="rdpm-code" tabindex="0" aria-label="{escape(label)}">{escape(text)}</pre>'


def problem(text: str) -> str:
    """Write what is wrong; a screen reader says it at once."""
    return f'<div class="rdpm-bad" role="alert">{escape(text)}</div>' if text else ""


def state(word: str, text: str = "") -> str:
    """Write a word on a ground that goes with it."""
    return f'<span class="rdpm-state {escape(word)}">{escape(text or word)}</span>'


def figure(name: str, text: str) -> str:
    """Write a picture of the folder, which opens by itself when it is clicked."""
    address = f"/files/{quote(name)}"
    picture = f'<a href="{address}" target="_blank"><img loading="lazy" src="{address}" alt="{escape(text)}"></a>'
    return f'<figure class="rdpm-figure">{picture}<figcaption>{escape(text)}</figcaption></figure>'


def link_to_run(name: str, text: str = "") -> str:
    """Write a link to the page of a run."""
    return f'<a href="/run/{quote(name)}">{escape(text or name)}</a>'


def files_link(name: str, text: str, is_download: bool = False) -> str:
    """Write a link to a file of the folder."""
    ask, more = ("?download=1", " download") if is_download else ("", ' target="_blank"')
    return f'<a href="/files/{quote(name)}{ask}"{more}>{escape(text)}</a>'


def written(value: float | None, unit: str = "", digits: int = 4) -> str:
    """Write a number with its unit; a dash where there is none.

    Examples
    --------
    >>> written(0.08731234, "m/s"), written(None)
    ('0.08731 m/s', '-')
    """
    return "-" if value is None or value != value else f"{value:.{digits}g} {unit}".rstrip()


def chart(options: dict[str, Any], label: str) -> ui.echart:
    """Put a chart on the page; its label says to those who do not see it what is drawn."""
    return (
        ui.echart(options, renderer="canvas")
        .classes("rdpm-chart")
        .props(f'role=img tabindex=0 aria-label="{escape(label)}"')
    )
