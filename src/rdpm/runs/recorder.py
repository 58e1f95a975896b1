"""What a run writes while it goes: the tables, the fields and the bodies."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from rdpm.contacts import nearest_gaps
from rdpm.errors import OutputError
from rdpm.io.files import reporting
from rdpm.io.tables import CONTACT_COLUMNS, HISTORY_COLUMNS, TableWriter
from rdpm.io.vtkhdf import BodyWriter, FieldWriter
from rdpm.io.wall_surface import write_walls
from rdpm.parallel.gather import Planes, with_planes
from rdpm.parallel.ranks import OnRoot, on_root
from rdpm.results.contacts import is_pressed
from rdpm.results.run_folder import TABLES, RunFolder
from rdpm.simulation.schedule import Every
from rdpm.simulation.time_loop import TimeLoop

__all__ = ["Recorder"]

Writer = TypeVar("Writer")


class Recorder:
    """Writes a run's tables and fields into its folder.

    On several ranks all follow the run alike, and the root writes. Leaving its context closes the files as they are;
    `close` also writes what is still open.

    Parameters
    ----------
    simulation : TimeLoop
    folder : RunFolder
        Must exist.
    table_every, fields_every : float, [s]
        Of simulated time; fields are not written at 0.
    resumed : tuple of (mapping of str to ndarray, mapping), optional
        What `state` gave: the files are continued from there, later rows and fields dropped.
    note : callable, optional
        Gets a sentence about a file that could not be continued.
    contact_times : mapping of str to float, optional, [s]
        Of the design, by kind of contact: tells impacts from pressed contacts.
    """

    def __init__(
        self,
        simulation: TimeLoop,
        folder: RunFolder,
        table_every: float,
        fields_every: float,
        resumed: tuple[Mapping[str, NDArray[Any]], Mapping[str, Any]] | None = None,
        note: Callable[[str], None] | None = None,
        contact_times: Mapping[str, float] | None = None,
    ) -> None:
        self.simulation = simulation
        self._contact_times = contact_times or {}
        self._tables, self._fields = Every(table_every), Every(fields_every)
        fluid, bodies = simulation.fluid, simulation.bodies
        self._contact_impulse = np.zeros((len(bodies), 3))
        self._since = simulation.time
        self._last_row = -1.0
        self._deepest = 0.0
        self.episodes: dict[str, Any] = {
            "count": 0, "pressed": 0, "max_overlap_fraction": 0.0, "total_time_s": 0.0, "came_to_rest": 0, "capped": 0,
        }  # fmt: skip
        self.max_speed = np.linalg.norm(bodies.velocity, axis=1)
        arrays, facts = resumed or ({}, {})
        with ExitStack() as files:
            at, ranks = facts.get("positions", {}), simulation.system.ranks
            writers = {}
            for name, columns in TABLES.items():
                make = partial(TableWriter, folder.table(name), columns, at.get(name))
                writers[name] = files.enter_context(OnRoot(ranks, make))
            self._flow = self._shapes = None
            until = simulation.time if resumed else None
            if fields_every > 0.0 and fluid:
                cells, spacing = fluid.grid.cells, fluid.grid.spacing
                self._flow = OnRoot(ranks, lambda: _continued(
                    folder.fields, until, note, lambda path, keep: FieldWriter(path, cells, spacing, keep)
                ))
            box = simulation.system.contacts.box
            if fields_every > 0.0 and box.walls:
                on_root(ranks, lambda: write_walls(folder.walls, box.walls, box.size))
            if fields_every > 0.0 and len(bodies):
                self._shapes = OnRoot(ranks, lambda: _continued(folder.bodies, until, note, BodyWriter))
            self._particles, self._contacts, self._history, self._timing = writers.values()
            self._writers = writers
            if resumed:
                self._take_over(arrays, facts)
            else:
                self._write()
            self._files = files.pop_all()
        simulation.on_step(self.step)

    def state(self) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
        """Sums and schedules, and where each table, now safe on the disk, stands: arrays, and plain values."""
        return {"contact_impulse": self._contact_impulse, "max_speed": self.max_speed}, {
            "positions": {name: writer.sync() for name, writer in self._writers.items()},
            "counts": [self._tables.count, self._fields.count],
            "since_s": self._since,
            "last_row_s": self._last_row,
            "deepest": self._deepest,
            "episodes": self.episodes,
        }

    def _take_over(self, arrays: Mapping[str, NDArray[Any]], facts: Mapping[str, Any]) -> None:
        np.copyto(self._contact_impulse, arrays["contact_impulse"])
        np.copyto(self.max_speed, arrays["max_speed"])
        self._tables.count, self._fields.count = facts["counts"]
        self._since, self._deepest = facts["since_s"], facts["deepest"]
        self._last_row = facts["last_row_s"]
        self.episodes |= facts["episodes"]

    def __enter__(self) -> Recorder:
        return self

    def __exit__(self, *exception: Any) -> None:
        self._files.__exit__(*exception)

    def step(self, simulation: TimeLoop) -> None:
        """Follow one step; write what has come due."""
        contact = simulation.system.last_contact
        if contact is not None and len(simulation.bodies):
            self._contact_impulse += contact.impulse
            self._deepest = max(self._deepest, contact.max_overlap_fraction)
            self.episodes["came_to_rest"] += contact.rested
            self.episodes["capped"] += contact.capped
            np.maximum(self.max_speed, np.linalg.norm(simulation.bodies.velocity, axis=1), out=self.max_speed)
        self._take_episodes()
        self._write()

    def _take_episodes(self) -> None:
        rows = self.simulation.system.contacts.take_episodes()
        if not len(rows):
            return
        pressed = is_pressed(rows["kind"], rows["stokes_number"], rows["duration_s"], self._contact_times)
        rows["restitution"][pressed] = np.nan
        self._contacts.write([[row[name] for name in CONTACT_COLUMNS] for row in rows])
        self.episodes["pressed"] += int(pressed.sum())
        self.episodes["count"] += len(rows)
        self.episodes["total_time_s"] += float(rows["duration_s"].sum())

    def _write(self) -> None:
        time = self.simulation.time
        if self._tables.is_due(time):
            self._write_tables()
        if self._fields.is_due(time):
            self._write_fields()

    def _write_tables(self) -> None:
        self.episodes["max_overlap_fraction"] = max(self.episodes["max_overlap_fraction"], self._deepest)
        if len(self.simulation.bodies):
            self._write_particles()
        self._write_history()
        sim, parts = self.simulation, self.simulation.system.watch.seconds
        named = [parts[name] for name in ("momentum", "bodies", "poisson", "contacts")]
        self._timing.write([[sim.steps, sim.time, sim.wall_seconds, *named]])
        for table in self._writers.values():
            table.flush()
        self._last_row = sim.time

    def _write_particles(self) -> None:
        sim, bodies, system = self.simulation, self.simulation.bodies, self.simulation.system
        n, span = len(bodies), sim.time - self._since
        contact = self._contact_impulse / span if span > 0.0 else np.zeros((n, 3))
        flow = system.immersed.hydrodynamic_force if system.immersed else np.zeros((n, 3))
        gap, neighbour = nearest_gaps(bodies, system.contacts.box)
        state = (bodies.position, bodies.velocity, bodies.angular_velocity)
        columns = (np.full(n, sim.time), np.arange(n), *state, flow, contact, gap, neighbour)
        self._particles.write(np.column_stack(columns))
        self._contact_impulse[:] = 0.0
        self._since = sim.time

    def _write_history(self) -> None:
        sim = self.simulation
        bodies, fluid, immersed = sim.bodies, sim.fluid, sim.system.immersed
        speed = np.linalg.norm(bodies.velocity, axis=1).max(initial=0.0)
        energy = 0.5 * float(
            bodies.mass @ (bodies.velocity**2).sum(axis=1)
            + bodies.moment_of_inertia @ (bodies.angular_velocity**2).sum(axis=1)
        )
        row = {
            "step": sim.steps,
            "time_s": sim.time,
            "dt_s": sim.last_dt or sim.dt,
            "cfl": fluid.cfl_rate * (sim.last_dt or sim.dt) if fluid else 0.0,
            "divergence": sim.check_divergence(),
            "kinetic_energy_fluid_J": fluid.kinetic_energy() if fluid else 0.0,
            "kinetic_energy_bodies_J": energy,
            "max_overlap_fraction": self._deepest,
            "slip": immersed.slip / speed if immersed and speed > 0.0 else 0.0,
        }
        self._history.write([[row[name] for name in HISTORY_COLUMNS]])
        self._deepest = 0.0

    def _write_fields(self) -> None:
        sim = self.simulation
        if self._flow and sim.fluid:
            ranks, flow = sim.system.ranks, self._flow.inner
            planes = [Planes(ranks, values) for values in sim.fluid.cell_values()]
            with_planes(ranks, planes, lambda: flow.write(sim.time, *planes))
        if self._shapes:
            b = sim.bodies
            self._shapes.write(sim.time, b.position, b.diameter, b.velocity, b.angular_velocity)

    def close(self) -> None:
        """Record contacts still open, write a last row, and close the tables."""
        sim = self.simulation
        try:
            sim.system.contacts.close_open(sim.time, sim.dt)
            self._take_episodes()
            if sim.time > self._last_row:
                self._write_tables()
        finally:
            self._files.close()


def _continued(
    path: Path, until: float | None, note: Callable[[str], None] | None, make: Callable[[Path, float | None], Writer]
) -> Writer:
    """Open a file of fields to go on after `until`; a broken one is set aside, as no checkpoint depends on it."""
    try:
        return make(path, until)
    except (OutputError, KeyError, RuntimeError, ValueError) as error:
        is_refused = "errno" in str(error.__cause__) or getattr(error.__cause__, "errno", None) is not None
        if until is None or is_refused:   # by the system: the file itself may be good
            raise
        aside = path.with_suffix(".broken")
        with reporting(aside):
            path.replace(aside)
        if note:
            note(f"{path} was broken off while it was written: a new one begins, the old is {aside}")
        return make(path, None)
