"""The page of cases: form and text of one case, both ways, and what it implies beside them."""

from __future__ import annotations

import json
from collections.abc import Mapping
from html import escape
from pathlib import Path as FilePath
from typing import Any
from urllib.parse import quote

from nicegui import events, run, ui

from rdpm.app.case_check import Checked, check
from rdpm.app.case_form import CaseForm
from rdpm.app.case_text import put
from rdpm.app.frame import button, frame, heading, html, problem, table
from rdpm.app.guard import LARGEST_BODY
from rdpm.app.settings import current
from rdpm.cases import shipped_names, shipped_text
from rdpm.config.rule import Path
from rdpm.config.source import read_text
from rdpm.errors import CaseError, RdpmError
from rdpm.io.files import replacing

__all__ = ["CasePage", "case_list"]


def case_list() -> None:
    """Show all cases, shipped and own."""
    work = current().work
    with frame("Cases", "cases"):
        heading("Shipped")
        shipped = [(name, escape(_title(shipped_text(name)))) for name in shipped_names()]
        html(table([(f'<a href="/cases?shipped={name}">{name}</a>', title) for name, title in shipped], is_html=True))
        heading("Own, in this folder")
        own = work.cases()
        links = "".join(f'<li><a href="/cases?file={quote(name)}">{escape(name)}</a></li>' for name in own)
        none = '<p class="rdpm-soft">None yet: open one that is shipped and save it here, or bring one.</p>'
        html(f'<ul class="rdpm-list">{links}</ul>' if own else none)
        heading("Bring a case file")
        _upload()


def _title(text: str) -> str:
    return next(
        (line.partition("=")[2].strip().strip('"') for line in text.splitlines() if line.startswith("title")), ""
    )


def _upload() -> None:
    said = html("")

    async def take(event: events.UploadEventArguments) -> None:
        """Save the file if it is a case."""
        try:
            text = (await event.file.read()).decode("utf-8-sig").replace("\r\n", "\n")
            found = await run.io_bound(check, text, "", current().work)
            if found is None or found.error is not None:
                raise found.error if found and found.error else CaseError("case", None, "cannot be checked")
            name = current().work.free_name(FilePath(event.file.name).stem[:40] + ".toml")
            with replacing(current().work.new(name, ".toml")) as temporary:
                temporary.write_text(text, encoding="utf-8")
            ui.navigate.to(f"/cases?file={quote(name)}")
        except UnicodeDecodeError:
            said.set_content(problem("The file must be UTF-8 text."))
        except RdpmError as error:
            said.set_content(problem(f"Not taken: {error}"))

    taken = ui.upload(
        label="Case file (.toml)", on_upload=take, auto_upload=True, max_files=1, max_file_size=LARGEST_BODY // 2
    )
    taken.on_rejected(lambda: said.set_content(problem("Not taken: a case file ends in .toml and has at most 1 MiB.")))
    taken.props('accept=".toml" flat bordered')


class CasePage:
    """One case that is edited; nothing is kept until it is saved or run.

    Parameters
    ----------
    query : mapping of str to str
        Of the address: ``shipped`` or ``file``.
    """

    def __init__(self, query: Mapping[str, str]) -> None:
        self.work, self.launcher = current().work, current().launcher
        self.file = "" if {"shipped", "run"} & set(query) else query.get("file", "")
        self.text, wrong = self._opened(query)
        name = query.get("shipped") or FilePath(query.get("run", self.file)).stem
        self.checked = Checked({})
        self._number, self._is_setting = 0, False
        with frame(f"Case {name}", "cases"):
            html(problem(wrong))
            self._actions(name)
            with ui.element("div").classes("rdpm-even"):
                with ui.element("section").props('aria-label="Form"'):
                    self.form = CaseForm(self._form_changed)
                with ui.element("section").props('aria-label="Text and check"'):
                    self.editor = ui.textarea("Case file (TOML)", value=self.text).props(
                        "outlined autogrow debounce=300"
                    )
                    self.editor.props("spellcheck=false").classes("rdpm-field rdpm-toml")
                    self.editor.on_value_change(self._text_changed)
                    heading("What it implies")
                    self.found = html("").props('aria-live=polite id="check"')
        self._show(check(self.text, self.file, self.work))

    def _opened(self, query: Mapping[str, str]) -> tuple[str, str]:
        try:
            if query.get("shipped") in shipped_names():
                return shipped_text(query["shipped"]), ""
            if "run" in query:
                return read_text(self.work.run(query["run"]).case, is_case=True), ""
            path = self.work.file(self.file)
            if path.suffix != ".toml":
                raise CaseError(f'"{self.file[:80]}"', None, "must be a case file")
            return read_text(path, is_case=True), ""
        except CaseError as error:
            return "", str(error)

    def _actions(self, name: str) -> None:
        with ui.element("div").classes("rdpm-row"):
            self.name = ui.input("name of the run", value=self.work.free_name(name or "run")).props("dense outlined")
            button("Run", self._run, "play_arrow", is_main=True)
            self.save_as = ui.input("save as", value=self.file or f"{name}.toml").props("dense outlined")
            button("Save", self._save, "save")
            self.short = html("")
        self.said = html("").props("aria-live=polite")

    async def _text_changed(self, event: events.ValueChangeEventArguments[Any]) -> None:
        if self._is_setting:
            return
        self.text = str(event.value or "")
        await self._check()

    async def _form_changed_later(self, path: Path, value: Any) -> None:
        try:
            self.text = put(self.text, path, value)
        except CaseError as error:
            self.found.set_content(problem(str(error)))
            return
        self._is_setting = True
        self.editor.set_value(self.text)
        self._is_setting = False
        await self._check()

    def _form_changed(self, path: Path, value: Any) -> Any:
        return ui.timer(0.0, lambda: self._form_changed_later(path, value), once=True)

    async def _check(self) -> None:
        self._number += 1
        number = self._number
        found = await run.io_bound(check, self.text, self.file, self.work)
        if found is not None and number == self._number:  # else a later one is on its way
            self._show(found)

    def _show(self, found: Checked) -> None:
        self.checked = found
        self.found.set_content(found.html)
        self.short.set_content(f'<a href="#check">{found.short}</a>' if found.short else "")
        if found.values:
            message = "" if found.error is None else f"{found.error.rule}. {found.error.cure}".strip()
            self.form.show(found.values, found.path, message)

    def _run(self) -> None:
        try:
            if self.checked.case is None or self.checked.error is not None:
                raise self.checked.error or CaseError("case", None, "must be checked first")
            name = self.launcher.add(self.checked.case, str(self.name.value or ""))
            ui.navigate.to(f"/run/{quote(name)}")
        except RdpmError as error:
            self.said.set_content(problem(str(error)))

    def _save(self) -> None:
        try:
            path = (
                self.work.new(str(self.save_as.value or ""), ".toml")
                if "/" not in str(self.save_as.value)
                else self.work.inside(str(self.save_as.value))
            )
            name = self.work.name(path)
            if path.suffix != ".toml" or path.name == "case.toml":
                raise CaseError("save as", f'"{name[:80]}"', "must end in .toml, and not be the case of a run")
            if path.exists() and name != self.file:
                raise CaseError(
                    "save as", f'"{name[:80]}"', "must be new", "a file of that name is there", "Take another name."
                )
            with replacing(path) as temporary:
                temporary.write_text(self.text, encoding="utf-8")
            self.file = name
            self.said.set_content(f'<p role="status">Saved as {escape(name)}.</p>')
            ui.run_javascript(f'history.replaceState(history.state, "", {json.dumps("/cases?file=" + quote(name))})')
        except RdpmError as error:
            self.said.set_content(problem(str(error)))
