"""The tables that records fill in a run's folder."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from rdpm.errors import CaseError
from rdpm.io.files import reporting
from rdpm.io.tables import TableWriter
from rdpm.parallel.agreement import OnRoot
from rdpm.simulation.record import Record
from rdpm.simulation.time_loop import TimeLoop

__all__ = ["RecordTables"]


class RecordTables:
    """Writes records as CSV, one file each, in a run that may be continued; on several ranks all make the rows alike.

    Parameters
    ----------
    simulation : TimeLoop
        In the state in which the run starts.
    records : iterable of (Record, pathlib.Path)
        With the file of each; folders are made by `open`.

    Raises
    ------
    CaseError
        A function fails, or gives what it may not: each is tried once, before anything is written.
    """

    def __init__(self, simulation: TimeLoop, records: Iterable[tuple[Record, Path]]) -> None:
        self._simulation = simulation
        self._records = {record.name: (record, path) for record, path in records}
        self._first = {name: record.rows(simulation) for name, (record, _) in self._records.items()}
        self._tables: dict[str, OnRoot] = {}

    def open(self, facts: Mapping[str, Mapping[str, int]] | None, note: Callable[[str], None] | None) -> None:
        """Begin each table with the present row, or continue it.

        Parameters
        ----------
        facts : mapping, optional
            What `state` gave, in a run that continues. What is not in it begins now.
        note : callable, optional
            Gets a sentence about a table that is not continued.
        """
        known = facts or {}
        for name in [name for name in known if name not in self._records]:
            if note:
                note(f"record {name!r} ends here: give its function again with record=, as checkpoints hold none")
        for name, (record, path) in self._records.items():
            fact = known.get(name)
            begin = partial(_begun, path, record.columns, fact["position"] if fact else None)
            self._tables[name] = OnRoot(self._simulation.system.ranks, begin)
            if fact:
                record.schedule.count = fact["count"]
            elif record.schedule.is_due(self._simulation.time) or facts is not None:
                self._write(name, self._first[name])
        self._first.clear()

    def step(self) -> None:
        """Write what has come due."""
        for name, (record, _) in self._records.items():
            if record.schedule.is_due(self._simulation.time):
                self._write(name, record.rows(self._simulation))

    def _write(self, name: str, rows: Any) -> None:
        try:
            self._tables[name].write(rows)
        except ValueError as error:
            raise CaseError(self._records[name][0].place, None, "must fit its columns", str(error)) from None
        self._tables[name].flush()

    def state(self) -> dict[str, dict[str, int]]:
        """Where each table, now safe on the disk, stands."""
        return {
            name: {"position": table.sync(), "count": self._records[name][0].schedule.count}
            for name, table in self._tables.items()
        }

    def close(self) -> None:
        """Close the tables."""
        for table in self._tables.values():
            table.close()


def _begun(path: Path, columns: Sequence[str], position: int | None) -> TableWriter:
    with reporting(path.parent):
        path.parent.mkdir(exist_ok=True)
    return TableWriter(path, columns, position)
