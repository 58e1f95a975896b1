r"""How much numerics alone change a quantity: the measure against which studies judge.

Repeated runs differ only in what physics does not know (place within a cell, orientation of the markers, time step).
Their spread is two standard deviations,

.. math:: S = 2\,\Big[\tfrac1{n-1}\sum_i(q_i-\bar q)^2\Big]^{1/2},

and two runs differ when they differ by more than :math:`\sqrt2\,S`, as each of the two has this spread. Half the range
is not used: it rests on two runs of the n and grows with n (for normal scatter 1.03 standard deviations at n = 4, 1.27
at n = 6), so that studies with different n could not be compared. With n = 4 to 6 the standard deviation itself is
known to 30 to 40 % (:math:`1/\sqrt{2(n-1)}`); for normal scatter two runs that differ by numerics alone are then told
apart wrongly in 14 of 100 cases at n = 4 and in 10 at n = 6.

What spans decades in a sweep is compared by its logarithm.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from numbers import Real
from typing import Any, Literal

import numpy as np

from rdpm.studies.measures import QUANTITIES

__all__ = ["Spread", "number", "spread_of", "spreads_of"]


def number(row: Mapping[str, Any], name: str) -> float | None:
    """A finite number of a row, else None.

    Examples
    --------
    >>> number({"kisses": 1}, "kisses"), number({"kisses": float("nan")}, "kisses"), number({}, "kisses")
    (1.0, None, None)
    """
    value = row.get(name)
    return float(value) if isinstance(value, Real) and math.isfinite(value) else None


@dataclass(frozen=True)
class Spread:
    """Spread of a quantity over runs that differ in numerics alone.

    Attributes
    ----------
    quantity : str
    center : float or None
        Mean (on a log scale the geometric one); None where no run has a value.
    half_width : float
        Two standard deviations; on a log scale of the logarithm. inf where the quantity exists in some of the runs
        only: numerics then decide whether it happens at all.
    count : int
        Runs.
    scale : {"linear", "log"}
    """

    quantity: str
    center: float | None
    half_width: float
    count: int
    scale: Literal["linear", "log"] = "linear"

    def excess(self, start: float, end: float) -> float:
        r"""Signed change from one run to another over :math:`\sqrt2\,S`: beyond -1 or 1 the two differ.

        Examples
        --------
        >>> round(Spread("tumble_start_s", 2.7, 0.1, 5).excess(2.7, 2.6), 2)
        -0.71
        """
        return self.beyond(start, end) / math.sqrt(2.0)

    def beyond(self, limit: float, value: float) -> float:
        """Signed distance of one run from a limit over S: beyond -1 or 1 it is off the limit.

        Examples
        --------
        >>> round(Spread("max_overlap_fraction", 1e-3, 0.1, 4, "log").beyond(0.005, 0.0055), 2)
        0.95
        """
        if limit == value:
            return 0.0
        change = value - limit
        if self.scale == "log":
            if not (limit > 0.0 and value > 0.0):
                return math.copysign(math.inf, change)
            change = math.log(value / limit)
        return change / self.half_width if self.half_width > 0.0 else math.copysign(math.inf, change)

    def describe(self) -> str:
        """The spread as text.

        Examples
        --------
        >>> Spread("tumble_start_s", 2.7, 0.1, 5).describe()
        '2.7 ± 0.1 (n = 5)'
        >>> Spread("max_overlap_fraction", 1e-3, 0.0953, 4, "log").describe()
        '0.001 ± 10 % (n = 4)'
        """
        if self.center is None or math.isinf(self.half_width):
            return f"not the same event in all runs (n = {self.count})"
        width = f"{100.0 * math.expm1(self.half_width):.2g} %" if self.scale == "log" else f"{self.half_width:.2g}"
        return f"{self.center:.4g} ± {width} (n = {self.count})"


def spread_of(rows: Sequence[Mapping[str, Any]], quantity: str) -> Spread:
    """Spread of one quantity over repeated runs.

    Parameters
    ----------
    rows : sequence of mapping
        Rows of a study's table; at least two.
    quantity : str
        A column; its scale is that of `rdpm.studies.measures.QUANTITIES`, linear for any other.

    Returns
    -------
    Spread

    Raises
    ------
    ValueError
        Fewer than two rows.

    Examples
    --------
    >>> rows = [{"tumble_start_s": t} for t in (2.65, 2.75, 2.65, 2.75)]
    >>> spread_of(rows, "tumble_start_s").describe()
    '2.7 ± 0.12 (n = 4)'
    """
    if len(rows) < 2:
        raise ValueError(f"the spread of {quantity} needs at least two runs")
    scale = QUANTITIES[quantity].scale if quantity in QUANTITIES else "linear"
    values = [value for row in rows if (value := number(row, quantity)) is not None]
    if not values:
        return Spread(quantity, None, 0.0, len(rows), scale)
    if scale == "log" and min(values) <= 0.0:
        return Spread(quantity, float(np.mean(values)), math.inf, len(rows), scale)
    compared = np.log(values) if scale == "log" else np.array(values)
    center = float(np.exp(compared.mean()) if scale == "log" else compared.mean())
    whole = len(values) == len(rows)
    return Spread(quantity, center, 2.0 * float(compared.std(ddof=1)) if whole else math.inf, len(rows), scale)


def spreads_of(rows: Sequence[Mapping[str, Any]], quantities: Iterable[str]) -> dict[str, Spread]:
    """Spread of several quantities by name; see `spread_of`.

    Examples
    --------
    >>> sorted(spreads_of([{"kisses": 1}, {"kisses": 1}], ["kisses", "contact_kisses"]))
    ['contact_kisses', 'kisses']
    """
    return {quantity: spread_of(rows, quantity) for quantity in quantities}
