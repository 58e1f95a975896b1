"""Columns and tables of a user's own, filled while a simulation goes on."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm.errors import CaseError, RdpmError
from rdpm.simulation.schedule import Every

__all__ = ["Record"]

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_-]*")
_GIVES = "must give a number, a list of numbers, or a dict of columns"


class Record:
    """What a function of the simulation gives, at multiples of an interval.

    Parameters
    ----------
    name : str
        Letters, digits, ``_`` and ``-``.
    function : callable
        Takes the simulation. One number fills a column of the record's name; a list of k numbers the columns
        ``NAME_0`` ... ``NAME_k-1``; a dict one column a key, each with a number, or each with an array of the same
        length: then several rows a time.
    schedule : Every

    Attributes
    ----------
    columns : tuple of str
        ``time_s`` first; of the first time.

    Raises
    ------
    CaseError
        It is no name.

    Examples
    --------
    >>> import rdpm
    >>> sim = rdpm.Simulation({"domain": {"size": [0.1, 0.1, 0.1]}, "time": {"end": 0.05, "step": "1 ms"},
    ...                        "bodies": [{"diameter": 0.01, "density": 2500, "centers": [[0.05, 0.05, 0.05]]}]})
    >>> height = sim.record("height_m", lambda s: s.bodies.position[0, 2], every="10 ms")
    >>> sim.run(until=0.05)
    >>> height.values["time_s"].round(3).tolist(), height.values["height_m"].round(4).tolist()
    ([0.0, 0.01, 0.02, 0.03, 0.04, 0.05], [0.05, 0.0495, 0.048, 0.0456, 0.0422, 0.0377])
    """

    def __init__(self, name: str, function: Callable[[Any], Any], schedule: Every) -> None:
        self.name, self.function, self.schedule = name, function, schedule
        self.columns: tuple[str, ...] = ()
        self._rows: list[NDArray[np.float64]] = []
        if not _NAME.fullmatch(str(name)):
            raise CaseError(self.place, None, "must have a name of letters, digits, _ and -", cure="Rename it.")
        given: object = function
        if not callable(given):
            cure = 'Give a function, or a function and how often: (function, "1 ms").'
            raise CaseError(self.place, repr(given), "must be a function of the simulation", cure=cure)

    @property
    def place(self) -> str:
        """How messages name it."""
        return f"record {self.name!r}"

    @property
    def values(self) -> dict[str, NDArray[np.float64]]:
        """Columns by name, (rows,): all that `step` kept."""
        rows = np.concatenate(self._rows) if self._rows else np.empty((0, len(self.columns)))
        return dict(zip(self.columns, rows.T, strict=True))

    def step(self, simulation: Any) -> None:
        """Keep a row where one is due."""
        if self.schedule.is_due(simulation.time):
            self._rows.append(self.rows(simulation))

    def rows(self, simulation: Any) -> NDArray[np.float64]:
        """Rows of the present time, (R, columns).

        Raises
        ------
        CaseError
            The function fails, gives something else than it may, or other columns than before.
        """
        when = f"at t = {simulation.time:.6g} s"
        try:
            found = self.function(simulation)
        except RdpmError:
            raise
        except Exception as error:
            reason = f"{type(error).__name__} {when}: {error}"
            raise CaseError(self.place, None, "must not fail", reason, "Correct the function.") from error
        columns, values = self._taken_apart(found, when)
        if not self.columns:
            self.columns = columns
        elif columns != self.columns:
            reason = f"{', '.join(columns[1:])} {when}, {', '.join(self.columns[1:])} before"
            raise CaseError(self.place, None, "must give the same columns each time", reason)
        return np.column_stack([np.full(len(values), simulation.time), values])

    def _taken_apart(self, found: Any, when: str) -> tuple[tuple[str, ...], NDArray[np.float64]]:
        named = found if isinstance(found, Mapping) else self._named(found)
        try:
            if any(value is None for value in named.values()):
                raise TypeError("no value")
            table = {str(key): np.atleast_1d(np.asarray(value, np.float64)) for key, value in named.items()}
            shapes = {column.shape for column in table.values()}
            if len(shapes) != 1 or len(next(iter(shapes))) != 1:
                raise ValueError("columns of different lengths" if table else "no columns")
        except (TypeError, ValueError) as error:
            reason = f"it gave {type(found).__name__} {when}: {error}"
            raise CaseError(self.place, None, _GIVES, reason, "Correct the function.") from None
        wrong = [key for key in table if key == "time_s" or not re.fullmatch(r"[^,\s\"]+", key)]
        if wrong:
            rule = "must name its columns without commas, quotes and blanks, none of them time_s"
            raise CaseError(self.place, wrong[0], rule, cure="Rename the column.")
        return ("time_s", *table), np.column_stack(list(table.values()))

    def _named(self, found: Any) -> dict[str, Any]:
        try:
            values = np.asarray(found, np.float64)  # of None: nan
        except (TypeError, ValueError):
            return {self.name: found}  # refused by the caller, in its words
        if values.ndim == 1:
            return {f"{self.name}_{n}": value for n, value in enumerate(values)}
        return {self.name: found}
