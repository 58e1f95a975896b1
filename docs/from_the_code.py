"""Tables that the code writes: keys of the case file, options of the command line, defaults and units included."""

import importlib
import inspect
import re
from typing import Annotated, get_args, get_origin, get_type_hints

from cyclopts import Parameter
from docutils import nodes
from docutils.parsers.rst import Directive
from docutils.statemachine import StringList


def described(docstring, heading):
    """Entries of one section of a numpydoc docstring: name -> (type, text)."""
    text = inspect.cleandoc(docstring or "")
    found = re.search(rf"^{heading}\n-+\n(.*?)(?=^\w[^\n]*\n-+$|\Z)", text, re.MULTILINE | re.DOTALL)
    entries = {}
    for part in re.split(r"\n(?=\S)", found.group(1).strip()) if found else ():
        head, _, body = part.partition("\n")
        names, _, kind = head.partition(" : ")
        for name in names.split(", "):
            entries[name] = (kind, " ".join(body.split()))
    return entries


class Table(Directive):
    """What both tables share."""

    required_arguments = 1
    has_content = False
    heads: tuple[str, ...] = ()

    def run(self):
        """Give the table."""
        lines = [self.heads, ["---"] * len(self.heads), *self.rows(self.arguments[0])]
        text = [f"| {' | '.join(cell.replace('|', '/') for cell in row)} |" for row in lines]
        holder = nodes.container()
        self.state.nested_parse(StringList(text, source=self.arguments[0]), 0, holder)
        return holder.children


class CaseKeys(Table):
    """Keys of one table of the case file, from its model."""

    heads = ("key", "type", "default", "")

    def rows(self, name):
        """One row a key; a key without a description fails the build."""
        module, _, model_name = name.rpartition(".")
        model = getattr(importlib.import_module(module), model_name)
        said = described(model.__doc__, "Attributes")
        filled = model._fill({}) if hasattr(model, "_fill") else {}
        for key, field in model.model_fields.items():
            kind, text = said[key]
            is_required = field.is_required() and key not in filled
            default = "required" if is_required else self.shown(field.get_default())
            yield f"`{key}`", kind.removesuffix(", optional"), default, re.sub(r":meth:|`{2}", "", text)

    @staticmethod
    def shown(value):
        """A default as it would be written in a case file."""
        if isinstance(value, tuple):
            value = list(value)
        if isinstance(value, bool):
            value = str(value).lower()
        elif isinstance(value, str):
            value = f'"{value}"'
        return f"`{value}`" if isinstance(value, str | int | float) or (isinstance(value, list) and value) else ""


class Verb(Table):
    """Arguments and options of one verb, from its function."""

    heads = ("option", "")

    def rows(self, verb):
        """One row an option."""
        function = getattr(importlib.import_module(f"rdpm.cli.{verb}"), verb)
        hints = get_type_hints(function, include_extras=True)
        said = described(function.__doc__, "Parameters")
        for key, parameter in inspect.signature(function).parameters.items():
            name = f"--{key.replace('_', '-')}"
            if parameter.kind is parameter.POSITIONAL_ONLY:
                name = key.upper()
            elif parameter.kind is parameter.VAR_POSITIONAL:
                name = f"{key.upper()}..."
            elif get_origin(hints[key]) is Annotated:
                given = [a.name for a in get_args(hints[key]) if isinstance(a, Parameter) and a.name]
                name = given[0][0] if given and isinstance(given[0], tuple) else given[0] if given else name
            yield f"`{name}`", said[key][1]


def setup(app):
    """Make the two directives known."""
    app.add_directive("case-keys", CaseKeys)
    app.add_directive("verb", Verb)
    return {"parallel_read_safe": True}
