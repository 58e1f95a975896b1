"""A form for a case file, made from the models of its keys: units, limits and help stand there, and nowhere else."""

from __future__ import annotations

import re
from collections.abc import Callable
from html import escape
from typing import Any

from nicegui import ui

from rdpm.app.case_text import dotted, found_at, value_of, written_value
from rdpm.app.frame import button, html
from rdpm.config.case import Case
from rdpm.config.contact import keys_of_other_models
from rdpm.config.fields import describe
from rdpm.config.rule import Path

__all__ = ["CaseForm", "hint_of"]

_KEYS = describe(Case)
_LEFT_OUT = "left out"
Entry = dict[str, Any]


def hint_of(entry: Entry) -> str:
    """Say what a key means, between which limits, and what holds without it.

    Examples
    --------
    >>> from rdpm.config.contact import Contact
    >>> hint_of(next(entry for entry in describe(Contact) if entry["name"] == "contact_steps"))
    'Duration of every contact in fluid steps; with `restitution`. At least 4, at most 1000.'
    """
    limits = [
        f"{word} {entry[key]:g}" for key, word in (("gt", "above"), ("ge", "at least"), ("le", "at most"))
        if entry[key] is not None
    ]  # fmt: skip
    said = ", ".join(limits)
    return " ".join(
        part for part in (entry["help"], f"{said[:1].upper()}{said[1:]}." if said else "", _without(entry)) if part
    )


def _without(entry: Entry) -> str:
    if entry["left_out"]:
        return f"Left out: {entry['left_out']}."
    return f"Left out: {written_value(entry['default'])}." if entry["default"] not in (None, [], "") else ""


def _as_code(text: str) -> str:
    return re.sub(r"`([^`]+)`", r"<code>\1</code>", text)


class CaseForm:
    """The form, within the element that is open where it is made.

    Parameters
    ----------
    changed : callable
        Gets the path and the new value, None for a key taken away.
    """

    def __init__(self, changed: Callable[[Path, Any], None]) -> None:
        self.changed = changed
        self.fields: dict[Path, list[Any]] = {}
        self._entries: dict[Path, Entry] = {}
        self._structure: Any = None
        self._is_setting = False
        self._values: dict[str, Any] = {}
        self.place = ui.element("div")

    def show(self, values: dict[str, Any], path: Path = (), message: str = "") -> None:
        """Show what a case holds, and what is wrong at the field that a path names."""
        self._values = values
        structure = _structure(values, _KEYS)
        self._is_setting = True
        if structure != self._structure:
            self._structure = structure
            self.fields.clear()
            self.place.clear()
            with self.place:
                self._table(_KEYS, (), values)
        for at, widgets in self.fields.items():
            self._set(widgets, self._entries[at], found_at(values, at))
        self._mark(path, message)
        self._is_setting = False

    def _mark(self, path: Path, message: str) -> None:
        while path and path not in self.fields:
            path = path[:-1]
        for at, widgets in self.fields.items():
            widgets[0].error = message if at == path and message else None

    def _set(self, widgets: list[Any], entry: Entry, value: Any) -> None:
        if len(widgets) == 3:
            parts = value if isinstance(value, list) and len(value) == 3 else [None] * 3
            for widget, part in zip(widgets, parts, strict=True):
                if value_of(widget.value or "") != part:
                    widget.set_value(written_value(part))
        elif isinstance(widgets[0], ui.select):
            known = value if isinstance(value, bool) or value in entry["choices"] else None
            widgets[0].set_value(_LEFT_OUT if known is None else written_value(known))
        elif value_of(widgets[0].value or "") != value:
            widgets[0].set_value(written_value(value))

    def _table(self, keys: list[Entry], path: Path, values: Any) -> None:
        """All keys of a table; those left out that need not be given stand folded below."""
        model = values.get("model", "soft-sphere") if path == ("contact",) and isinstance(values, dict) else ""
        shown: list[Entry] = []
        more: list[Entry] = []
        tables: list[Entry] = []
        for entry in keys:
            is_given = isinstance(values, dict) and entry["name"] in values
            if model and not is_given and entry["name"] in keys_of_other_models(model):
                continue
            if entry["kind"] == "table":
                tables.append(entry)
            else:
                (shown if is_given or entry["required"] else more).append(entry)
        for entry in shown:
            self._field(entry, path)
        if more:
            with ui.expansion(f"{len(more)} more, left out").props("dense").classes("rdpm-field"):
                for entry in more:
                    self._field(entry, path)
        for entry in tables:
            self._inner(entry, path, found_at(values, (entry["name"],)))

    def _inner(self, entry: Entry, path: Path, values: Any) -> None:
        """A table in a table, or a list of them."""
        at = (*path, entry["name"])
        if entry["count"] == "list":
            groups = values if isinstance(values, list) else []
            for n, group in enumerate(groups):
                with ui.element("fieldset"):
                    html(f"<legend>{entry['name']} [{n}]</legend>")
                    self._table(entry["table"], (*at, n), group)
                    button("Remove this group", lambda at=(*at, n): self.changed(at, None), "delete")
            with ui.element("fieldset"):
                button(f"Add a group of {entry['name']}", lambda: self._add_group(at), "add")
            return
        with ui.element("fieldset"):
            html(f"<legend>{escape(dotted(at))}</legend>")
            html(f'<p class="rdpm-soft">{_as_code(escape(hint_of(entry)))}</p>')
            if not entry["required"]:
                switch = ui.switch("given", value=values is not None)
                switch.props(f'dense aria-label="{dotted(at)} given"')
                switch.on_value_change(lambda e: self._give(at, bool(e.value)))
            if values is not None or entry["required"]:
                self._table(entry["table"], at, values)

    def _give(self, at: Path, is_given: bool) -> None:
        if not self._is_setting:
            self.changed(at, {} if is_given else None)

    def _add_group(self, at: Path) -> None:
        """Add a table: an empty one, or one body like those of the first group."""
        groups = found_at(self._values, at)
        if at != ("bodies",):
            self.changed(
                (*at, len(groups)) if isinstance(groups, list) else at, {} if isinstance(groups, list) else [{}]
            )
            return
        first = groups[0] if isinstance(groups, list) and groups and isinstance(groups[0], dict) else {}
        alike = {"diameter": first.get("diameter", "10 mm"), "density": first.get("density", "2500 kg/m^3")}
        group = alike | {"centers": [["0 m", "0 m", "0 m"]]}
        if isinstance(groups, list):
            self.changed((*at, len(groups)), group)
        else:
            self.changed(at, [group])

    def _field(self, entry: Entry, path: Path) -> None:
        at = (*path, entry["name"])
        unit = f" [{entry['unit']}]" if entry["unit"] else ""
        label = entry["name"].replace("_", " ") + unit + (" *" if entry["required"] else "")
        hint = f'hide-hint hint="{escape(hint_of(entry))}"'
        is_vector = entry["length"] == 3 and entry["count"] == "one" and entry["table"] is None
        if is_vector:
            with ui.element("div").classes("rdpm-vector").props(f'role=group aria-label="{escape(label)}"'):
                widgets = [
                    self._text(f"{label if axis == 'x' else ''} {axis}".strip(), at, hint if axis == "x" else "")
                    for axis in "xyz"
                ]
        elif entry["kind"] == "true or false" or (entry["kind"] == "choice" and entry["table"] is None):
            names = entry["choices"] or ["true", "false"]
            pick = ui.select([_LEFT_OUT, *names], label=label, value=_LEFT_OUT)
            pick.props(f'dense outlined {hint} data-key="{dotted(at)}"').classes("rdpm-field")
            pick.on_value_change(lambda: self._changed(at))
            widgets = [pick]
        else:
            is_long = entry["count"] != "one"
            widgets = [self._text(label, at, hint, is_long)]
        for widget in widgets:
            widget.without_auto_validation()  # what is wrong is told by the check of the whole case
        self.fields[at], self._entries[at] = widgets, entry

    def _text(self, label: str, at: Path, hint: str, is_long: bool = False) -> Any:
        made = ui.textarea(label).props("autogrow") if is_long else ui.input(label)
        made.props(f'dense outlined debounce=300 {hint} data-key="{dotted(at)}"').classes("rdpm-field")
        if is_long:
            made.classes("rdpm-toml")
        made.on_value_change(lambda: self._changed(at))
        return made

    def _changed(self, at: Path) -> None:
        if self._is_setting:
            return
        widgets = self.fields[at]
        if len(widgets) == 3:
            parts = [value_of(str(widget.value or "")) for widget in widgets]
            value: Any = (
                None if all(part is None for part in parts) else [0 if part is None else part for part in parts]
            )
        elif isinstance(widgets[0], ui.select):
            text = widgets[0].value
            value = None if text == _LEFT_OUT else {"true": True, "false": False}.get(text, text)
        else:
            value = value_of(str(widgets[0].value or ""))
        if value != found_at(self._values, at):
            self.changed(at, value)


def _structure(values: Any, keys: list[Entry], path: Path = ()) -> Any:
    """Which tables there are, and which fields belong to them: where this stays, fields only change their values."""
    held = values if isinstance(values, dict) else {}
    parts: list[Any] = [held.get("model") if path == ("contact",) else None]
    for entry in keys:
        if entry["kind"] != "table":
            continue
        value = held.get(entry["name"])
        if isinstance(value, list):
            parts.append([_structure(one, entry["table"], (*path, entry["name"])) for one in value])
        else:
            parts.append(None if value is None else _structure(value, entry["table"], (*path, entry["name"])))
    return parts
