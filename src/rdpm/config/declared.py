"""What a key of the case file may hold, declared beside it: unit, limits, choices, length.

A declaration is frozen and plain, so that the same one checks the value (:meth:`Declared.check`, which pydantic calls)
and describes it (:meth:`Declared.describe`, for documentation and forms). Values come out as plain SI numbers.
"""

from __future__ import annotations

import numbers
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel, GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

from rdpm.config.rule import RuleError, suggestion
from rdpm.config.units import QUANTITIES, parse_quantity

__all__ = [
    "Choice",
    "Components",
    "Declared",
    "EachOf",
    "File",
    "LeftOut",
    "OneOrEach",
    "OrTable",
    "Quantity",
    "Whole",
    "items",
    "placed",
]


class Declared(ABC):
    """A declaration: the metadata of an ``Annotated`` field of a :class:`~rdpm.config.fields.Model`."""

    @abstractmethod
    def check(self, value: Any) -> Any:
        """Return the value as the model holds it; raise :class:`~rdpm.config.rule.RuleError` where it breaks a rule."""

    @abstractmethod
    def describe(self) -> dict[str, Any]:
        """Return what is declared, as plain data; entries that are left out do not apply."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(self.check, handler(source))


@dataclass(frozen=True)
class Quantity(Declared):
    """A number in SI, or text with a unit.

    Parameters
    ----------
    unit : str
        SI; "" for a plain number.
    gt, ge, le : float, optional, [`unit`]
        Limits: value > gt, value >= ge, value <= le.
    words : tuple of str, optional
        Words that may stand instead of a number.
    example : str, optional
        For the message about a wrong word.

    Examples
    --------
    >>> length = Quantity("m", gt=0.0)
    >>> length.check("15 mm"), length.describe()
    (0.015, {'kind': 'number', 'unit': 'm', 'gt': 0.0})
    >>> length.check("-15 mm")
    Traceback (most recent call last):
    ...
    rdpm.config.rule.RuleError: "-15 mm": must be positive.
    """

    unit: str
    gt: float | None = None
    ge: float | None = None
    le: float | None = None
    words: tuple[str, ...] = ()
    example: str = ""

    def check(self, value: Any) -> float | str:
        """Return it in `unit`, or the word."""
        if isinstance(value, str) and value in self.words:
            return value
        if self.words and isinstance(value, str) and value.isalpha():
            known = ", ".join(map(_quoted, self.words))
            cure = f'Write {known}, or text such as "{self.example}".'
            raise RuleError(f"must be {known} or {QUANTITIES[self.unit][0]}", cure=cure, value=value)
        found = parse_quantity(value, self.unit, bare=False)
        named = f" {self.unit}" if self.unit else ""
        if self.gt is not None and found <= self.gt:
            rule = "must be positive" if self.gt == 0.0 else f"must be above {self.gt:g}{named}"
            raise RuleError(rule, value=value)
        if self.ge is not None and found < self.ge:
            raise RuleError(f"must be at least {self.ge:g}{named}" if self.ge else "must not be negative", value=value)
        if self.le is not None and found > self.le:
            raise RuleError(f"must be at most {self.le:g}{named}", value=value)
        return found

    def describe(self) -> dict[str, Any]:
        """Kind, unit, limits, words."""
        limits = {"gt": self.gt, "ge": self.ge, "le": self.le}
        said = {"kind": "number", "unit": self.unit, **{k: v for k, v in limits.items() if v is not None}}
        return said | ({"choices": list(self.words)} if self.words else {})


@dataclass(frozen=True)
class Whole(Declared):
    """A whole number, `ge` <= value <= `le`."""

    ge: int
    le: int

    def check(self, value: Any) -> int:
        """Return it as an int."""
        if isinstance(value, bool) or not isinstance(value, numbers.Integral):
            raise RuleError("must be a whole number", value=value)
        if not self.ge <= int(value) <= self.le:
            raise RuleError(f"must lie between {self.ge} and {self.le}", value=value)
        return int(value)

    def describe(self) -> dict[str, Any]:
        """Kind and limits."""
        return {"kind": "whole number", "ge": self.ge, "le": self.le}


@dataclass(frozen=True)
class Choice(Declared):
    """One of some names; those of `later` are known but not in this version."""

    names: tuple[str, ...]
    later: tuple[str, ...] = ()

    def check(self, value: Any) -> str:
        """Return the name."""
        if isinstance(value, str) and value in self.names:
            return value
        wanted = " or ".join(map(_quoted, self.names))
        if isinstance(value, str) and value in self.later:
            raise RuleError("is not in this version", cure=f"Use {wanted}.", value=value)
        cure = suggestion(value, self.names) if isinstance(value, str) and len(value) < 80 else ""
        raise RuleError(f"must be {wanted}", cure=cure, value=value)

    def describe(self) -> dict[str, Any]:
        """Kind and names."""
        return {"kind": "choice", "choices": list(self.names)}


@dataclass(frozen=True)
class Components(Declared):
    """Three of the same, along x, y and z."""

    item: Quantity | Whole

    def check(self, value: Any) -> tuple[Any, Any, Any]:
        """Return them as a tuple."""
        listed = items(value)
        if len(listed) != 3:
            raise RuleError("must have three components, x, y and z", value=value)
        x, y, z = (placed(i, self.item.check, item) for i, item in enumerate(listed))
        return x, y, z

    def describe(self) -> dict[str, Any]:
        """What a component is, and how many there are."""
        return {**self.item.describe(), "length": 3}


@dataclass(frozen=True)
class EachOf(Declared):
    """A list of any length."""

    item: Quantity | Whole | Components

    def check(self, value: Any) -> tuple[Any, ...]:
        """Return it as a tuple."""
        return tuple(placed(i, self.item.check, item) for i, item in enumerate(items(value)))

    def describe(self) -> dict[str, Any]:
        """What an item is."""
        return {**self.item.describe(), "count": "list"}


@dataclass(frozen=True)
class OneOrEach(Declared):
    """One for all bodies of a group, or a list with one each."""

    item: Quantity | Components

    def check(self, value: Any) -> Any:
        """Return the one, or a tuple of them."""
        is_each = _depth(value) > (1 if isinstance(self.item, Components) else 0)
        return EachOf(self.item).check(value) if is_each else self.item.check(value)

    def describe(self) -> dict[str, Any]:
        """What one is."""
        return {**self.item.describe(), "count": "one or each"}


@dataclass(frozen=True)
class OrTable(Declared):
    """What another declaration says, or a table of keys."""

    item: Declared
    table: type[BaseModel]

    def check(self, value: Any) -> Any:
        """Return the value, or the table as its model."""
        if isinstance(value, dict):
            return self.table.model_validate(value)
        try:
            return self.item.check(value)
        except RuleError:
            if not isinstance(self.item, Choice):
                raise
            keys = ", ".join(self.table.model_fields)
            names = ", ".join(map(_quoted, self.item.names))
            raise RuleError(f"must be {names} or {{ {keys} }}", value=value) from None

    def describe(self) -> dict[str, Any]:
        """What else it may be; the table's keys are added by :func:`rdpm.config.fields.describe`."""
        return self.item.describe()


@dataclass(frozen=True)
class File(Declared):
    """The name of a file; reading a case puts what the file holds in its place."""

    def check(self, value: Any) -> None:
        """Refuse a name: no file was read."""
        raise RuleError("must be read first", "a group holds bodies, not the name of their file", "Use load_case.")

    def describe(self) -> dict[str, Any]:
        """Kind alone."""
        return {"kind": "file"}


@dataclass(frozen=True)
class LeftOut:
    """What holds where a key is left out and no constant default says it: text for a reader."""

    text: str


def items(value: Any) -> list[Any]:
    """Return a TOML array, a tuple or an array as a list."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if not isinstance(value, list | tuple):
        raise RuleError("must be a list", value=value)
    return list(value)


def _depth(value: Any) -> int:
    """How many lists are nested."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if not isinstance(value, list | tuple):
        return 0
    return 1 + (_depth(value[0]) if value else 0)


def placed(at: int | str, check: Callable[..., Any], *given: Any) -> Any:
    """Call a check; what goes wrong in it is placed one level deeper, at `at`."""
    try:
        return check(*given)
    except RuleError as problem:
        raise problem.below(at) from None



def _quoted(name: str) -> str:
    return f'"{name}"'
