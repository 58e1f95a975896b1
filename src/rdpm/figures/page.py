"""The parts of a self-contained HTML page: text, tables, pictures, video; nothing comes from elsewhere."""

from __future__ import annotations

import base64
from collections.abc import Iterable, Sequence
from html import escape
from pathlib import Path

__all__ = [
    "code", "document", "folded", "heading", "note_list", "pairs", "paragraph", "picture", "row", "section", "table",
    "video", "video_beside",
]  # fmt: skip

_LOOK = """
:root { color-scheme: light dark; --page: #fbfbfa; --text: #1d1d1f; --soft: #5c5c60; --line: #dcdcdc;
  --card: #fff; --warn: #fff3d6; }
@media (prefers-color-scheme: dark) { :root { --page: #161719; --text: #ececee; --soft: #a5a5aa;
  --line: #3a3b3f; --card: #202124; --warn: #453613; } }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 62rem; padding: 1.2rem 1rem 3rem; background: var(--page);
  color: var(--text); font: 16px/1.5 system-ui, sans-serif; }
h1 { font-size: 1.6rem; line-height: 1.25; margin: 0.4rem 0; }
h2 { font-size: 1.15rem; margin: 2.2rem 0 0.6rem; padding-bottom: 0.2rem;
  border-bottom: 1px solid var(--line); }
h3 { font-size: 1rem; margin: 1.2rem 0 0.3rem; }
p { margin: 0.4rem 0; } .soft, figcaption { color: var(--soft); font-size: 0.92rem; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; min-width: min(100%, 24rem); }
th, td { text-align: left; padding: 0.28rem 1.1rem 0.28rem 0; border-bottom: 1px solid var(--line);
  vertical-align: top; }
thead th { color: var(--soft); font-weight: 600; font-size: 0.9rem; } tbody th { font-weight: 400; }
figure { margin: 1.2rem 0; } figure img, figure video { display: block; max-width: 100%; height: auto;
  margin: 0 auto 0.4rem; border-radius: 6px; background: #fff; border: 1px solid var(--line); }
figure video { max-height: 88vh; }
.pairs { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 26rem), 1fr)); gap: 1.2rem;
  align-items: start; } .pairs figure { margin: 0; }
.row { display: flex; flex-wrap: wrap; gap: 1rem; } .row figure { flex: 1 1 14rem; margin: 0; }
.warnings { background: var(--warn); border-radius: 6px; padding: 0.6rem 1rem 0.6rem 2rem; }
details { margin: 0.8rem 0; } pre { overflow-x: auto; background: var(--card); border: 1px solid var(--line);
  border-radius: 6px; padding: 0.8rem; font-size: 0.85rem; }
"""


def document(title: str, parts: Iterable[str]) -> str:
    """The whole page, light or dark as the reader's system is.

    Examples
    --------
    >>> document("A & B", ["<p>text</p>"]).startswith("<!doctype html>")
    True
    """
    head = (
        '<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{escape(title)}</title><style>{_LOOK}</style>"
    )
    body = "\n".join(part for part in parts if part)
    return f'<!doctype html>\n<html lang="en"><head>{head}</head>\n<body>\n{body}\n</body></html>\n'


def heading(text: str) -> str:
    """The page's title.

    Examples
    --------
    >>> heading("A & B")
    '<h1>A &amp; B</h1>'
    """
    return f"<h1>{escape(text)}</h1>"


def paragraph(text: str, soft: bool = False) -> str:
    """A paragraph, in the softer colour for side notes.

    Examples
    --------
    >>> paragraph("a < b")
    '<p>a &lt; b</p>'
    """
    return f'<p class="soft">{escape(text)}</p>' if soft else f"<p>{escape(text)}</p>"


def section(title: str, parts: Sequence[str], level: int = 2) -> str:
    """Parts under a title; nothing where there is no part.

    Examples
    --------
    >>> section("Empty", [])
    ''
    """
    kept = [part for part in parts if part]
    return "\n".join([f"<h{level}>{escape(title)}</h{level}>", *kept]) if kept else ""


def table(rows: Sequence[Sequence[str]], heads: Sequence[str] = ()) -> str:
    """A table whose first column names the row.

    Examples
    --------
    >>> "<th>steps</th><td>100</td>" in table([("steps", "100")])
    True
    """
    if not rows:
        return ""
    top = f"<thead><tr>{''.join(f'<th>{escape(h)}</th>' for h in heads)}</tr></thead>" if heads else ""
    lines = [
        f"<tr><th>{escape(row[0])}</th>{''.join(f'<td>{escape(cell)}</td>' for cell in row[1:])}</tr>"
        for row in rows
    ]
    return f'<div class="wide"><table>{top}<tbody>{"".join(lines)}</tbody></table></div>'


def note_list(notes: Sequence[str]) -> str:
    """Warnings as a list that stands out; nothing where there are none.

    Examples
    --------
    >>> note_list(["overlap is large"])
    '<ul class="warnings"><li>overlap is large</li></ul>'
    """
    items = "".join(f"<li>{escape(note)}</li>" for note in notes)
    return f'<ul class="warnings">{items}</ul>' if items else ""


def folded(title: str, text: str) -> str:
    """Preformatted text behind a title to click on.

    Examples
    --------
    >>> folded("case.toml", "a = 1")
    '<details><summary>case.toml</summary><pre>a = 1</pre></details>'
    """
    return f"<details><summary>{escape(title)}</summary><pre>{escape(text)}</pre></details>"


def picture(path: Path, caption: str) -> str:
    """A PNG file inside the page, with its caption; one for print is shown at 1.6 times its size on paper."""
    width, inches = _png_width(path)
    look = f' style="width: {min(width, round(150 * inches))}px"' if inches else ""
    image = f'<img{look} alt="{escape(caption)}" src="data:image/png;base64,{_embedded(path)}">'
    return f"<figure>{image}<figcaption>{escape(caption)}</figcaption></figure>"


def _png_width(path: Path) -> tuple[int, float]:
    """Pixels across, and inches on paper; 0 where the file does not say."""
    with path.open("rb") as file:
        head = file.read(256)
    pixels = int.from_bytes(head[16:20], "big")
    at = head.find(b"pHYs")
    if at < 0:
        return pixels, 0.0
    a_metre = int.from_bytes(head[at + 4 : at + 8], "big")
    return pixels, pixels / (0.0254 * a_metre) if a_metre else 0.0


def video(path: Path, caption: str) -> str:
    """An MP4 file inside the page, with its caption."""
    player = f'<video controls loop muted playsinline src="data:video/mp4;base64,{_embedded(path)}"></video>'
    return f"<figure>{player}<figcaption>{escape(caption)}</figcaption></figure>"


def video_beside(source: str, caption: str) -> str:
    """An MP4 file beside the page, with its caption.

    Examples
    --------
    >>> 'src="videos/a.mp4"' in video_beside("videos/a.mp4", "Two spheres.")
    True
    """
    player = f'<video controls loop muted playsinline preload="metadata" src="{escape(source)}"></video>'
    return f"<figure>{player}<figcaption>{escape(caption)}</figcaption></figure>"


def row(parts: Sequence[str]) -> str:
    """Parts beside each other; nothing where there is none.

    Examples
    --------
    >>> row([])
    ''
    """
    return f'<div class="row">{"".join(parts)}</div>' if parts else ""


def pairs(parts: Sequence[str]) -> str:
    """Figures two beside each other, one on a narrow screen; nothing where there is none.

    Examples
    --------
    >>> pairs([])
    ''
    """
    return f'<div class="pairs">{"".join(parts)}</div>' if parts else ""


def code(text: str) -> str:
    """A command.

    Examples
    --------
    >>> code("rdpm study seed")
    '<pre>rdpm study seed</pre>'
    """
    return f"<pre>{escape(text)}</pre>"


def _embedded(path: Path) -> str:
    return base64.b64encode(path.read_bytes()).decode("ascii")
