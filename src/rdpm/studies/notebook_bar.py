"""Progress in a notebook: one output of the cell that is renewed, by what every notebook has."""

from __future__ import annotations

import time as clock
from html import escape
from itertools import count
from typing import Any

__all__ = ["NotebookBar"]

_BETWEEN = 0.3  # s, between two drawings


class NotebookBar:
    """Bars under a cell, with the few calls that `rich.progress.Progress` is used for.

    Notes
    -----
    It needs nothing but IPython: rich's own bar wants ipywidgets.
    """

    def __init__(self) -> None:
        self._bars: dict[int, dict[str, Any]] = {}
        self._notes: list[str] = []
        self._handle: Any = None
        self._drawn = 0.0
        self._numbers = count()

    def start(self) -> None:
        """Show the output."""
        from IPython.display import HTML, display

        self._handle = display(HTML(self.html()), display_id=True)

    def stop(self) -> None:
        """Draw a last time."""
        self._draw(at_once=True)

    def add_task(self, description: str, total: float = 1.0, said: str = "") -> int:
        """Add a bar; its number."""
        number = next(self._numbers)
        self._bars[number] = {"description": description, "total": total, "completed": 0.0, "said": said}
        self._draw()
        return number

    def update(self, number: int, *, completed: float, said: str) -> None:
        """Move a bar."""
        self._bars[number] |= {"completed": completed, "said": said}
        self._draw()

    def remove_task(self, number: int) -> None:
        """Take a bar away."""
        self._bars.pop(number, None)
        self._draw()

    def note(self, text: str) -> None:
        """Say something that stays."""
        self._notes.append(text)
        self._draw(at_once=True)

    def html(self) -> str:
        """What is shown.

        Examples
        --------
        >>> bar = NotebookBar()
        >>> number = bar.add_task("study", said="1 of 2 runs ended")
        >>> bar.html().count("<progress")
        1
        """
        rows = [
            f'<tr><td style="text-align:left">{escape(bar["description"])}</td>'
            f'<td><progress value="{bar["completed"]:.4f}" max="{bar["total"]:g}"></progress></td>'
            f'<td style="text-align:left">{100 * bar["completed"] / bar["total"]:.0f} %, {escape(bar["said"])}'
            "</td></tr>"
            for bar in self._bars.values()
        ]
        notes = "".join(f"<div>{escape(text)}</div>" for text in self._notes)
        return f"{notes}<table>{''.join(rows)}</table>"

    def _draw(self, at_once: bool = False) -> None:
        if self._handle is None or (not at_once and clock.monotonic() - self._drawn < _BETWEEN):
            return
        from IPython.display import HTML

        self._drawn = clock.monotonic()
        self._handle.update(HTML(self.html()))
