"""The tables of a case file as models, and what their keys are as plain data."""

from __future__ import annotations

import inspect
import re
from typing import Any, get_args

from pydantic import BaseModel, ConfigDict
from pydantic.fields import FieldInfo

from rdpm.config.declared import Declared, LeftOut, OrTable

__all__ = ["Model", "Vector", "Vectors", "describe", "table_of"]

Vector = tuple[float, float, float]
Vectors = tuple[Vector, ...]


class Model(BaseModel):
    """A table of the case file: frozen, unknown keys refused, its values plain SI numbers.

    Each key is declared once: ``Annotated[type, Quantity(unit, limits)]`` (or another of
    :mod:`rdpm.config.declared`) and a default; its meaning stands in the class's docstring under *Attributes*.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")


def describe(model: type[BaseModel]) -> list[dict[str, Any]]:
    """List the keys of a table of the case file: what forms and documentation need, as plain data.

    Parameters
    ----------
    model : type
        Such as ``Case``, ``Contact``.

    Returns
    -------
    list of dict
        One a key, in the order of the model: `name`; `kind` ("number", "whole number", "choice", "true or false",
        "text", "file", "table"); `unit` (SI, "" for a plain number, None where there is none); `gt`, `ge`, `le` (limits
        or None); `length` (3 for a vector, else None); `count` ("one", "list", or "one or each" of a group's bodies);
        `choices` (names that may stand; beside a number or a table, instead of it); `table` (the keys of a table that
        must, or may, stand there, described likewise; or None); `required`; `default` (in SI, or None); `left_out`
        (what holds without it where no constant says so, or ""); `help`.

    Examples
    --------
    >>> from rdpm.config.contact import Contact
    >>> key = {entry["name"]: entry for entry in describe(Contact)}["stiffness"]
    >>> key["kind"], key["unit"], key["gt"], key["required"]
    ('number', 'N/m', 0.0, False)
    """
    meaning = _meanings(model)
    return [_described(name, field, meaning.get(name, "")) for name, field in model.model_fields.items()]


def table_of(field: FieldInfo) -> type[BaseModel] | None:
    """Return the model of the table that must, or may, stand at a key; None where none may."""
    for declared in field.metadata:
        if isinstance(declared, OrTable):
            return declared.table
    return next((kind for kind in _kinds(field.annotation) if issubclass(kind, BaseModel)), None)


def _described(name: str, field: FieldInfo, meaning: str) -> dict[str, Any]:
    entry: dict[str, Any] = {
        "name": name,
        "kind": "table",
        "unit": None,
        **dict.fromkeys(("gt", "ge", "le", "length")),
        "count": "one",
        "choices": [],
    }
    declared = next((found for found in field.metadata if isinstance(found, Declared)), None)
    left_out = next((found.text for found in field.metadata if isinstance(found, LeftOut)), "")
    table = table_of(field)
    if declared is not None:
        entry |= declared.describe()
    elif table is None:
        entry["kind"] = "true or false" if bool in _kinds(field.annotation) else "text"
    elif getattr(field.annotation, "__origin__", None) is tuple:
        entry["count"] = "list"
    default = None if field.is_required() else field.get_default()
    return entry | {
        "table": describe(table) if table else None,
        "required": field.is_required() and not left_out,
        "default": None if isinstance(default, BaseModel) else _plain(default),
        "left_out": left_out,
        "help": meaning,
    }


def _plain(value: Any) -> Any:
    return [_plain(item) for item in value] if isinstance(value, tuple) else value


def _kinds(annotation: Any) -> list[type]:
    """The classes an annotation names, at any depth."""
    if isinstance(annotation, type):
        return [annotation]
    return [kind for inner in get_args(annotation) for kind in _kinds(inner)]


def _meanings(model: type[BaseModel]) -> dict[str, str]:
    """Name -> text of the docstring's section *Attributes*."""
    text = inspect.cleandoc(model.__doc__ or "")
    found = re.search(r"^Attributes\n-+\n(.*?)(?=^\w[^\n]*\n-+$|\Z)", text, re.MULTILINE | re.DOTALL)
    meanings = {}
    for part in re.split(r"\n(?=\S)", found.group(1).strip()) if found else ():
        names, _, body = part.partition("\n")
        meanings.update(dict.fromkeys(names.split(", "), " ".join(body.split())))
    return meanings
