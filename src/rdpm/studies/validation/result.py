"""What a case of the validation hands back: rows of a table, and charts."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from rdpm.figures.validation import Chart, Curve

__all__ = ["Chart", "Curve", "Found", "Row", "Tell"]


@dataclass(frozen=True)
class Row:
    """One quantity beside its reference.

    Parameters
    ----------
    quantity : str
        With what was varied: ``"fall time, 8 cells a diameter"``.
    value : float
    reference : float, optional
        None where the value itself is bounded: a deviation, an error.
    band : float, optional
        Largest relative difference, or largest value where there is no reference; None: reported, not judged.
    unit : str
    source : str
        Of the reference.

    Examples
    --------
    >>> row = Row("drag", 2.79, 2.81, 0.015)
    >>> round(row.difference, 4), row.ok
    (-0.0071, True)
    """

    quantity: str
    value: float
    reference: float | None = None
    band: float | None = None
    unit: str = ""
    source: str = ""

    @property
    def difference(self) -> float | None:
        """Relative to the reference."""
        return None if self.reference is None else self.value / self.reference - 1.0

    @property
    def ok(self) -> bool | None:
        """Whether it lies in its band; None where there is none."""
        if self.band is None:
            return None
        judged = self.value if self.difference is None else self.difference
        return math.isfinite(judged) and abs(judged) <= self.band

    def to_dict(self) -> dict[str, Any]:
        """Plain values for machines."""
        return {
            "quantity": self.quantity,
            "value": self.value if math.isfinite(self.value) else None,
            "unit": self.unit,
            "reference": self.reference,
            "difference": self.difference if math.isfinite(self.value) else None,
            "band": self.band,
            "ok": self.ok,
            "source": self.source,
        }


Found = Iterator[Row | Chart]

#: Gets a line on what is being done.
Tell = Callable[[str], None]
