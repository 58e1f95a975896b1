"""Tables that the code writes: keys of the case file with units, limits and defaults; options of the command line."""

import importlib
import inspect
import re
from typing import Annotated, get_args, get_origin, get_type_hints

from cyclopts import Parameter
from docutils import nodes
from docutils.parsers.rst import Directive
from docutils.statemachine import StringList

from rdpm.config.fields import describe


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
    """Keys of one table of the case file, as its model declares them."""

    heads = ("key", "value", "default", "")

    def rows(self, name):
        """One row a key; a key without a description fails the build."""
        module, _, model_name = name.rpartition(".")
        for key in describe(getattr(importlib.import_module(module), model_name)):
            if not key["help"]:
                raise ValueError(f"{name}.{key['name']} has no description")
            default = "required" if key["required"] else key["left_out"] or self.written(key["default"])
            yield f"`{key['name']}`", self.value(key), default, key["help"]

    @classmethod
    def value(cls, key):
        """What may stand there: kind, unit, limits, choices."""
        kind, unit = key["kind"], f" [{key['unit']}]" if key["unit"] else ""
        names = [f'`"{choice}"`' for choice in key["choices"]]
        if kind == "choice":
            text = cls.joined(names)
        elif kind == "table":
            text = "list of tables" if key["count"] == "list" else "table"
        else:
            noun = kind if key["length"] is None else "vector" if kind == "number" else f"{key['length']} {kind}s"
            text = f"list of {noun}s{unit}" if key["count"] == "list" else f"{noun}{unit}"
            text += f", {limits}" if (limits := cls.limits(key)) else ""
            text += ", one or each" if key["count"] == "one or each" else ""
            text = cls.joined([*names, text])
        return f"{text} or table" if key["table"] and kind != "table" else text

    @staticmethod
    def limits(key):
        """Such as ``> 0, at most 1``."""
        low, high = ("" if key[name] is None else str(key[name]).removesuffix(".0") for name in ("ge", "le"))
        if low and high:
            return f"{low} to {high}"
        above = f"> {key['gt']:g}" if key["gt"] is not None else ""
        return ", ".join(filter(None, (above, low and f"at least {low}", high and f"at most {high}")))

    @staticmethod
    def joined(names):
        """Such as ``a, b or c``."""
        return " or ".join(part for part in (", ".join(names[:-1]), names[-1]) if part)

    @staticmethod
    def written(value):
        """A default as it would be written in a case file."""
        text = str(value).lower() if isinstance(value, bool) else f'"{value}"' if isinstance(value, str) else str(value)
        return "" if value in (None, "", []) else f"`{text}`"


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
