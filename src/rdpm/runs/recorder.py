"""What a run writes while it goes: the tables, the fields and the bodies."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import ExitStack, closing
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm.config.output import Output
from rdpm.contacts import nearest_gaps
from rdpm.fluid import Fluid
from rdpm.fluid.derived import vorticity_and_q
from rdpm.io.tables import CONTACT_COLUMNS, HISTORY_COLUMNS, TableWriter
from rdpm.io.vtkhdf import FLOW, FieldWriter
from rdpm.io.vtkhdf_bodies import BodyWriter
from rdpm.io.wall_surface import write_walls
from rdpm.parallel.agreement import OnRoot, on_root
from rdpm.parallel.gather import Planes, with_planes
from rdpm.particles.state import LOADS
from rdpm.results.contacts import NOT_OUTSIDE, count_reasons, is_pressed, outside_range
from rdpm.results.run_folder import TABLES, RunFolder
from rdpm.results.summary import ContactDesign
from rdpm.runs.continued import continued
from rdpm.runs.flow_samples import FlowSamples, probes
from rdpm.runs.record_tables import RecordTables
from rdpm.simulation.time_loop import TimeLoop

__all__ = ["Recorder"]


class Recorder:
    """Writes a run's tables and fields into its folder.

    On several ranks all follow the run alike, and the root writes. Leaving its context closes the files as they are;
    `close` also writes what is still open.

    Parameters
    ----------
    simulation : TimeLoop
    folder : RunFolder
        Must exist.
    output : Output
        What the case asks for.
    resumed : tuple of (mapping of str to ndarray, mapping), optional
        What `state` gave: the files are continued from there, later rows and fields dropped.
    note : callable, optional
        Gets a sentence about a file that could not be continued.
    design : ContactDesign, optional
        Tells impacts from pressed contacts, and what left the range that it promises.
    records : RecordTables, optional
        The user's own.
    """

    def __init__(
        self,
        simulation: TimeLoop,
        folder: RunFolder,
        output: Output,
        resumed: tuple[Mapping[str, NDArray[Any]], Mapping[str, Any]] | None = None,
        note: Callable[[str], None] | None = None,
        design: ContactDesign | None = None,
        records: RecordTables | None = None,
    ) -> None:
        self.simulation, self._output = simulation, output
        self._design = design or ContactDesign()
        self._tables = simulation.asked(output.table_every or 0.0)
        self._fields = simulation.asked(output.fields_every or 0.0)
        bodies = simulation.bodies
        self._contact_impulse = np.zeros((len(bodies), 3))
        self._impulses = np.zeros((len(LOADS), len(bodies), 3))
        self._since = simulation.time
        self._last_row = -1.0
        self._deepest = 0.0
        self.episodes: dict[str, Any] = {
            "count": 0, "pressed": 0, "max_overlap_fraction": 0.0, "total_time_s": 0.0, "came_to_rest": 0, "capped": 0,
            "outside": 0, "outside_reasons": {},
        }  # fmt: skip
        self.max_speed = np.linalg.norm(bodies.velocity, axis=1)
        arrays, facts = resumed or ({}, {})
        with ExitStack() as files:
            at, ranks = facts.get("positions", {}), simulation.system.ranks
            writers = {}
            for name, columns in TABLES.items():
                make = partial(TableWriter, folder.table(name), columns, at.get(name))
                writers[name] = files.enter_context(OnRoot(ranks, make))
            self._flow: OnRoot | None = None
            self._shapes: OnRoot | None = None
            self._open_fields(folder, simulation.time if resumed else None, note)
            self._particles, self._contacts, self._history, self._timing = writers.values()
            self._writers = writers
            self._probes = files.enter_context(closing(RecordTables(simulation, probes(simulation, output, folder))))
            self._records = files.enter_context(closing(records or RecordTables(simulation, [])))
            self._samples = FlowSamples(simulation, output, folder) if simulation.fluid else None
            if resumed:
                self._take_over(arrays, facts)
            else:
                self._write()
            self._probes.open(facts.get("probes"), note)
            self._records.open(facts.get("records"), note)
            if self._samples:
                self._samples.open((arrays, facts["samples"]) if resumed else None, note)
            self._files = files.pop_all()
        simulation.on_step(self.step)

    def _open_fields(self, folder: RunFolder, until: float | None, note: Callable[[str], None] | None) -> None:
        fluid, output, ranks = self.simulation.fluid, self._output, self.simulation.system.ranks
        if not output.fields_every:
            return
        if fluid:
            cells, spacing = fluid.grid.cells, fluid.grid.spacing
            quantities = FLOW | ({"vorticity": 3} if output.vorticity else {})
            quantities |= {"q_criterion": 1} if output.q_criterion else {}

            def made(path: Path, keep: float | None) -> FieldWriter:
                return FieldWriter(path, cells, spacing, keep, quantities, tolerance=output.fields_tolerance)

            self._flow = OnRoot(ranks, lambda: continued(folder.fields, until, note, made))
        if len(self.simulation.bodies):
            self._shapes = OnRoot(ranks, lambda: continued(folder.bodies, until, note, BodyWriter))
        box = self.simulation.system.contacts.box
        if box.walls:
            on_root(ranks, lambda: write_walls(folder.walls, box.walls, box.size))

    def state(self) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
        """Sums and schedules, and where each table, now safe on the disk, stands: arrays, and plain values."""
        arrays = {"contact_impulse": self._contact_impulse, "impulses": self._impulses, "max_speed": self.max_speed}
        sampled, samples = self._samples.state() if self._samples else ({}, {})
        return arrays | sampled, {
            "probes": self._probes.state(),
            "records": self._records.state(),
            "samples": samples,
            "positions": {name: writer.sync() for name, writer in self._writers.items()},
            "counts": [self._tables.count, self._fields.count],
            "since_s": self._since,
            "last_row_s": self._last_row,
            "deepest": self._deepest,
            "episodes": self.episodes,
        }

    def _take_over(self, arrays: Mapping[str, NDArray[Any]], facts: Mapping[str, Any]) -> None:
        np.copyto(self._contact_impulse, arrays["contact_impulse"])
        np.copyto(self._impulses, arrays["impulses"])
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
            for sum_, name in zip(self._impulses, LOADS, strict=True):
                sum_ += simulation.last_dt * getattr(simulation.bodies, name)
            self._deepest = max(self._deepest, contact.max_overlap_fraction)
            self.episodes["came_to_rest"] += contact.rested
            self.episodes["capped"] += contact.capped
            np.maximum(self.max_speed, np.linalg.norm(simulation.bodies.velocity, axis=1), out=self.max_speed)
        self._take_episodes()
        self._write()
        self._probes.step()
        self._records.step()
        if self._samples:
            self._samples.step()

    def _take_episodes(self) -> None:
        rows = self.simulation.system.contacts.take_episodes()
        if not len(rows):
            return
        pressed = is_pressed(rows["kind"], rows["stokes_number"], rows["duration_s"], self._design.contact_times)
        rows["restitution"][pressed] = np.nan
        outside = outside_range(rows, pressed, self._design)
        self._contacts.write(
            [[*(row[name] for name in CONTACT_COLUMNS[:-1]), said] for row, said in zip(rows, outside, strict=True)]
        )
        reasons = self.episodes["outside_reasons"]
        for reason, count in count_reasons(outside).items():
            reasons[reason] = reasons.get(reason, 0) + count
        self.episodes["outside"] += int((outside != NOT_OUTSIDE).sum())
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
        means = self._impulses / span if span > 0.0 else self._impulses
        columns = (np.full(n, sim.time), np.arange(n), *state, flow, contact, gap, neighbour, *means)
        self._particles.write(np.column_stack(columns))
        self._contact_impulse[:] = 0.0
        self._impulses[:] = 0.0
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
            planes = [Planes(ranks, part) for part in (*sim.fluid.cell_values(), *self._derived(sim.fluid))]
            with_planes(ranks, planes, lambda: flow.write(sim.time, *planes))
        if self._shapes:
            b = sim.bodies
            self._shapes.write(sim.time, b.position, b.diameter, b.velocity, b.angular_velocity)

    def _derived(self, fluid: Fluid) -> list[NDArray[np.float32]]:
        output = self._output
        if not (output.vorticity or output.q_criterion):
            return []
        vorticity, q = vorticity_and_q(fluid)
        return [*([vorticity] if output.vorticity else []), *([q] if output.q_criterion else [])]

    def close(self) -> None:
        """Record contacts still open, write a last row and the averages, and close the tables."""
        sim = self.simulation
        try:
            sim.system.contacts.close_open(sim.time, sim.dt)
            self._take_episodes()
            if sim.time > self._last_row:
                self._write_tables()
            if self._samples:
                self._samples.close()
        finally:
            self._files.close()
