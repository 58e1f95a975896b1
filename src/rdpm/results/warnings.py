"""What a run warns of: one form for terminal, log, summary and report."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

__all__ = ["RunWarning", "each_once"]

_VERDICT = re.compile(
    r"(?P<quantity>\D+?) (?P<value>[-+.\de]+(?: [^<>]*?)?) (?P<sign>[<>]=?) (?P<limit>[^()]+?)"
    r"(?: \((?P<condition>.*)\))?"
)


@dataclass(frozen=True)
class RunWarning:
    """One thing that is not as it should be. ``str`` says it as a reader does.

    Attributes
    ----------
    quantity : str
        What; a whole sentence where no number is judged.
    value : str
        With its unit.
    sign : str
        "<" or ">": how the value stands to the limit; empty without a limit.
    limit : str
        With its unit.
    condition : str
        Where, when or at what.
    cure : str
        What to do.

    Examples
    --------
    >>> print(RunWarning("overlap", "1.31 % d", ">", "0.5 %", "at 4.1 cm/s", "stiffen the contact"))
    overlap 1.31 % d > 0.5 % (at 4.1 cm/s): stiffen the contact
    """

    quantity: str
    value: str = ""
    sign: str = ""
    limit: str = ""
    condition: str = ""
    cure: str = ""

    def __str__(self) -> str:
        said = " ".join(part for part in (self.quantity, self.value, self.sign, self.limit) if part)
        where = f" ({self.condition})" if self.condition else ""
        return said + where + (f": {self.cure}" if self.cure else "")

    @classmethod
    def from_verdict(cls, text: str, cure: str = "") -> RunWarning:
        """Take a verdict's text apart: quantity, value, sign, limit, condition.

        Examples
        --------
        >>> RunWarning.from_verdict("contact resolved by 3 steps < 4").limit
        '4'
        """
        match = _VERDICT.fullmatch(text)
        return cls(**{name: part or "" for name, part in match.groupdict().items()}, cure=cure) if match else cls(
            text, cure=cure
        )


def each_once(warnings: Iterable[RunWarning]) -> tuple[RunWarning, ...]:
    """Leave out repetitions, such as of a limit that two kinds of contact break alike; the order is kept.

    Examples
    --------
    >>> [str(warning) for warning in each_once([RunWarning("a"), RunWarning("b"), RunWarning("a")])]
    ['a', 'b']
    """
    return tuple({str(warning): warning for warning in warnings}.values())
