"""A claim: a statement, what a table must show for it to hold, and what became of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

__all__ = [
    "Alike", "Approaches", "Claim", "Computed", "Expected", "Happens", "Insensitive", "Judgement", "Limit", "Trend",
    "Verdict",
]  # fmt: skip

#: "not judged": runs or their spread are missing.
Verdict = Literal["confirmed", "contradicted", "within the spread", "conditional", "not judged"]


@dataclass(frozen=True)
class Judgement:
    """What became of a claim.

    Attributes
    ----------
    verdict : str
        "confirmed", "contradicted", "within the spread", "conditional", or "not judged".
    sentence : str
        What was found, with its numbers.
    reason : str
        Why it is so.
    runs : tuple of str
        The runs that show it; empty where it was computed.
    numbers : mapping of str to float
        By names with units.
    """

    verdict: Verdict
    sentence: str
    reason: str = ""
    runs: tuple[str, ...] = ()
    numbers: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Trend:
    """A quantity rises (or falls) along a parameter.

    Attributes
    ----------
    quantity, along : str
        Columns of the table.
    rises : bool
    """

    quantity: str
    along: str
    rises: bool


@dataclass(frozen=True)
class Limit:
    """A quantity keeps to a limit, in each run whose parameter lies inside a range.

    Attributes
    ----------
    quantity : str
    value : float
    at_most : bool
        Or at least.
    along : str or None
        None: all runs.
    low, high : float
        Exclusive.
    """

    quantity: str
    value: float
    at_most: bool = True
    along: str | None = None
    low: float = float("-inf")
    high: float = float("inf")


@dataclass(frozen=True)
class Insensitive:
    """Quantities change by no more than their spread while a parameter goes through a range.

    Attributes
    ----------
    quantities : tuple of str
    along : str
    low, high : float
        Inclusive.
    """

    quantities: tuple[str, ...]
    along: str
    low: float = float("-inf")
    high: float = float("inf")


@dataclass(frozen=True)
class Alike:
    """No two runs differ by more than the spread, whatever tells them apart.

    Attributes
    ----------
    quantities : tuple of str
    """

    quantities: tuple[str, ...]


@dataclass(frozen=True)
class Approaches:
    """Runs come to a reference run as a parameter falls.

    Attributes
    ----------
    quantities : tuple of str
    along : str
    reference : mapping
        Column -> value of the reference.
    """

    quantities: tuple[str, ...]
    along: str
    reference: Mapping[str, Any]


@dataclass(frozen=True)
class Happens:
    """An event happens: its quantity exists.

    Attributes
    ----------
    quantity : str
    """

    quantity: str


@dataclass(frozen=True)
class Computed:
    """No run is needed.

    Attributes
    ----------
    judgement : callable
        Gives verdict, sentence and numbers from design functions.
    """

    judgement: Callable[[], Judgement]


Expected = Trend | Limit | Insensitive | Alike | Approaches | Happens | Computed


@dataclass(frozen=True)
class Claim:
    """A statement that runs or formulas can confirm or contradict.

    Attributes
    ----------
    id : str
    statement : str
    slide : str
        Where it was made.
    expected : Trend, Limit, Insensitive, Alike, Approaches, Happens or Computed
    reason : str
        The physics or numerics behind what is expected to be found.
    where : mapping
        Which rows of the table count: column -> value.
    condition : str
        Named when the claim is known to hold only under it: what would be confirmed is then conditional.
    """

    id: str
    statement: str
    slide: str
    expected: Expected
    reason: str
    where: Mapping[str, Any] = field(default_factory=dict)
    condition: str = ""
