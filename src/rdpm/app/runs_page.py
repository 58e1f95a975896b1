"""The page of all runs and studies of the folder: what goes on, what was found, what is laid over each other."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from html import escape
from typing import Any
from urllib.parse import urlencode

from nicegui import run, ui

from rdpm.app.frame import frame, heading, html, link_to_run, state
from rdpm.app.settings import current
from rdpm.app.status import RunStatus, status_of
from rdpm.app.study_page import study_links
from rdpm.app.words import STATES, span
from rdpm.app.workspace import Workspace
from rdpm.errors import CaseError
from rdpm.results.run_folder import RunFolder

__all__ = ["RunsPage"]

_EVERY = 2.0  # s
_MOST = 500  # rows


def _summary(get: Callable[[Any], Any]) -> Callable[[RunStatus], Any]:
    def value(one: RunStatus) -> Any:
        return None if one.summary is None else get(one.summary)

    return value


def _fastest(found: Any) -> Any:
    return max((body.max_speed_m_s for body in found.bodies if body.max_speed_m_s is not None), default=None)


#: Key in the address: head of the column, its value, and how that is written.
_COLUMNS: dict[str, tuple[str, Callable[[RunStatus], Any], Callable[[Any], str]]] = {
    "name": ("run", lambda one: one.name, str),
    "state": ("state", lambda one: one.state, str),
    "time": ("t [s]", lambda one: one.time, lambda v: f"{v:.4g}"),
    "bodies": ("bodies", _summary(lambda s: len(s.bodies)), str),
    "speed": ("greatest speed [m/s]", _summary(_fastest), lambda v: f"{v:.4g}"),
    "contacts": ("contacts", _summary(lambda s: s.contacts.count), str),
    "overlap": ("overlap [% d]", _summary(lambda s: s.contacts.max_overlap_fraction), lambda v: f"{100 * v:.3g}"),
    "kiss": ("first kiss [s]", _summary(lambda s: s.dkt.kiss_time_s if s.dkt else None), lambda v: f"{v:.4g}"),
    "wall": ("wall time", lambda one: one.wall, span),
    "date": ("date", _summary(lambda s: s.date_utc), lambda v: str(v)[:16].replace("T", " ")),
}


def states(work: Workspace) -> list[RunStatus]:
    """Read how all runs stand; one whose folder goes meanwhile is left out."""
    found = []
    for name in work.runs()[:_MOST]:
        try:
            found.append(status_of(name, RunFolder(work.inside(name))))
        except (CaseError, OSError):
            continue
    return found


class RunsPage:
    """All runs, sorted as the address says.

    Parameters
    ----------
    query : mapping of str to str
        ``sort``, a key of the columns; ``down``.
    """

    def __init__(self, query: Mapping[str, str]) -> None:
        self.sort = query.get("sort", "") if query.get("sort", "") in _COLUMNS else "name"
        self.is_down = "down" in query
        self.work = current().work
        self.seen: list[Any] = []
        with frame("Runs", "runs"):
            start = 'A new run starts from a <a href="/cases">case</a>'
            html(f'<p class="rdpm-soft">{start}; those started on the command line in this folder are here too.</p>')
            self.active = html("").props('role=status aria-label="Under way"')
            self.list = html("")
            links = study_links(self.work)
            if links:
                heading("Studies")
                html(links)
        self.show(states(self.work))
        ui.timer(_EVERY, self._tick)

    async def _tick(self) -> None:
        found = await run.io_bound(states, self.work)
        if found is not None:
            self.show(found)

    def show(self, found: list[RunStatus]) -> None:
        """Show what goes on, and the list where a run came, went or changed its state."""
        active = sorted((one for one in found if one.is_active), key=lambda one: (one.state == "queued", one.asked_ns))
        self.active.set_content("".join(_active(one) for one in active))
        now = [(one.name, one.state) for one in found]
        if now != self.seen or not self.list.content:
            self.seen = now
            self.list.set_content(self._table(found))

    def _table(self, found: list[RunStatus]) -> str:
        if not found:
            return '<p class="rdpm-note">No runs in this folder yet.</p>'
        value = _COLUMNS[self.sort][1]
        known = [(value(one), one) for one in found]
        rows = sorted((pair for pair in known if pair[0] is not None), key=lambda pair: pair[0], reverse=self.is_down)
        ordered = [one for _, one in rows] + [one for given, one in known if given is None]
        heads = "".join(self._head(key) for key in _COLUMNS)
        body = "".join(_row(one) for one in ordered)
        top = f'<thead><tr><th scope="col">overlay</th>{heads}</tr></thead>'
        wide = f'<div class="rdpm-wide"><table>{top}<tbody>{body}</tbody></table></div>'
        send = '<p><button class="rdpm-form-button" type="submit">Overlay the chosen, two to six</button></p>'
        return f'<form action="/overlay" method="get">{wide}{send}</form>'

    def _head(self, key: str) -> str:
        is_here = key == self.sort
        ask = urlencode({"sort": key} | ({"down": "1"} if is_here and not self.is_down else {}))
        order = f' aria-sort="{"descending" if self.is_down else "ascending"}"' if is_here else ""
        sign = (" \u2193" if self.is_down else " \u2191") if is_here else ""
        return f'<th scope="col"{order}><a href="/runs?{ask}">{_COLUMNS[key][0]}{sign}</a></th>'


def _row(one: RunStatus) -> str:
    name = escape(one.name)
    cells = [f'<td><input type="checkbox" name="run" value="{name}" aria-label="overlay {name}"></td>',
             f'<th scope="row"><span class="rdpm-name">{link_to_run(one.name)}<br>'
             f'<span class="rdpm-soft">{escape(one.title)}</span></span></th>',
             f"<td>{state(one.state, STATES[one.state][0])}</td>"]  # fmt: skip
    for key, (_, value, write) in _COLUMNS.items():
        if key not in ("name", "state"):
            given = value(one)
            cells.append(f'<td class="one-line">{"-" if given is None else escape(write(given))}</td>')
    return f"<tr>{''.join(cells)}</tr>"


def _active(one: RunStatus) -> str:
    left = f", {span(one.left)} left" if one.left is not None else ""
    done = f"t = {one.time:.4g} of {one.end:.4g} s{left}" if one.time is not None and one.end else STATES[one.state][1]
    percent = round(100 * one.progress)
    bar = f'<progress max="100" value="{percent}" aria-label="{escape(one.name)}">{percent} %</progress>'
    bar = "" if one.state == "queued" and not percent else bar
    return f"<p>{link_to_run(one.name)} {state(one.state, STATES[one.state][0])} {escape(done)}{bar}</p>"
