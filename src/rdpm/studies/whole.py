"""A run of a study from time zero: the common start, then its own part."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm.io.tables import read_table
from rdpm.results.dkt import from_particles_table
from rdpm.results.run import Run, load_run
from rdpm.results.run_folder import RunFolder
from rdpm.results.tracks import tracks_from_table

__all__ = ["load_whole"]

Table = dict[str, NDArray[Any]]


def load_whole(folder: RunFolder, start: RunFolder | None) -> Run:
    """Read a run with what came before the checkpoint it started from.

    Parameters
    ----------
    folder : RunFolder
    start : RunFolder, optional
        Of its common start.

    Returns
    -------
    Run
        ``tracks``, ``contacts``, ``history`` and ``phases`` from time zero; ``summary`` and ``fields`` of the run's own
        part.

    Raises
    ------
    CaseError
        A folder is not whole.
    """
    run = load_run(folder.path)
    if start is None:
        return run
    before = load_run(start.path)
    particles = _joined(read_table(start.table("particles")), read_table(folder.table("particles")), "time_s")
    tracks = tracks_from_table(particles, run.period)
    phases = run.phases
    if phases is not None:
        contact_time = run.summary.contact.contact_time_s or 0.0
        phases = from_particles_table(particles, run.diameter, run.gravity, contact_time, run.period)
    contacts = _joined(before.contacts, run.contacts, "start_s")
    history = _joined(before.history, run.history, "time_s")
    return replace(run, tracks=tracks, phases=phases, contacts=contacts or None, history=history or None)


def _joined(first: Table | None, second: Table | None, time: str) -> Table:
    """Rows of the first before those of the second begin, then these."""
    if not first or not second:
        return first or second or {}
    begin = second[time].min() if second[time].size else np.inf
    earlier = first[time] < begin
    return {name: np.concatenate([first[name][earlier], second[name]]) for name in second}
