"""What a run writes while it goes: the tables, the fields and the bodies."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from rdpm.contacts import nearest_gaps
from rdpm.io.tables import CONTACT_COLUMNS, HISTORY_COLUMNS, PARTICLE_COLUMNS, TIMING_COLUMNS, TableWriter
from rdpm.io.vtkhdf import BodyWriter, FieldWriter
from rdpm.simulation.schedule import Every
from rdpm.simulation.simulation import Simulation

__all__ = ["Recorder"]


class Recorder:
    """Writes a run's tables and fields into its folder.

    Parameters
    ----------
    simulation : Simulation
    folder : Path
        Must exist.
    table_every, fields_every : float, [s]
        Of simulated time; fields are not written at 0.
    """

    def __init__(self, simulation: Simulation, folder: Path, table_every: float, fields_every: float) -> None:
        self.simulation = simulation
        self._tables, self._fields = Every(table_every), Every(fields_every)
        self._particles = TableWriter(folder / "particles.csv", PARTICLE_COLUMNS)
        self._contacts = TableWriter(folder / "contacts.csv", CONTACT_COLUMNS)
        self._history = TableWriter(folder / "history.csv", HISTORY_COLUMNS)
        self._timing = TableWriter(folder / "timing.csv", TIMING_COLUMNS)
        fluid, bodies = simulation.fluid, simulation.bodies
        wants_fields = fields_every > 0.0
        self._flow = (
            FieldWriter(folder / "fields.vtkhdf", fluid.grid.cells, fluid.grid.spacing)
            if fluid and wants_fields
            else None
        )
        self._shapes = BodyWriter(folder / "bodies.vtkhdf") if len(bodies) and wants_fields else None
        self._contact_impulse = np.zeros((len(bodies), 3))
        self._since = simulation.time
        self._deepest = 0.0
        self.episodes: dict[str, Any] = {"count": 0, "max_overlap_fraction": 0.0, "total_time_s": 0.0}
        self.max_speed = np.linalg.norm(bodies.velocity, axis=1)
        simulation.on_step(self.step)
        self._write()

    def step(self, simulation: Simulation) -> None:
        """Follow one step; write what has come due."""
        contact = simulation.system.last_contact
        if contact is not None and len(simulation.bodies):
            self._contact_impulse += contact.impulse
            self._deepest = max(self._deepest, contact.max_overlap_fraction)
            np.maximum(self.max_speed, np.linalg.norm(simulation.bodies.velocity, axis=1), out=self.max_speed)
        self._take_episodes()
        self._write()

    def _take_episodes(self) -> None:
        rows = self.simulation.system.contacts.take_episodes()
        if not len(rows):
            return
        self._contacts.write([[row[name] for name in CONTACT_COLUMNS] for row in rows])
        self.episodes["count"] += len(rows)
        self.episodes["total_time_s"] += float(rows["duration_s"].sum())

    def _write(self) -> None:
        time = self.simulation.time
        if self._tables.is_due(time):
            self._write_tables()
        if self._fields.is_due(time):
            self._write_fields()

    def _write_tables(self) -> None:
        sim = self.simulation
        bodies, fluid, system = sim.bodies, sim.fluid, sim.system
        n = len(bodies)
        self.episodes["max_overlap_fraction"] = max(self.episodes["max_overlap_fraction"], self._deepest)
        if n:
            span = sim.time - self._since
            contact = self._contact_impulse / span if span > 0.0 else np.zeros((n, 3))
            flow = system.motion.hydrodynamic_force if system.motion else np.zeros((n, 3))
            gap, neighbour = nearest_gaps(bodies, system.contacts.box)
            self._particles.write(
                np.column_stack(
                    [
                        np.full(n, sim.time),
                        np.arange(n),
                        bodies.position,
                        bodies.velocity,
                        bodies.angular_velocity,
                        flow,
                        contact,
                        gap,
                        neighbour,
                    ]
                )
            )
            self._contact_impulse[:] = 0.0
            self._since = sim.time
        speed = np.linalg.norm(bodies.velocity, axis=1).max(initial=0.0)
        energy = 0.5 * float(
            bodies.mass @ (bodies.velocity**2).sum(axis=1)
            + bodies.moment_of_inertia @ (bodies.angular_velocity**2).sum(axis=1)
        )
        slip = system.motion.slip / speed if system.motion and speed > 0.0 else 0.0
        self._history.write(
            [
                [
                    sim.steps,
                    sim.time,
                    sim.dt,
                    fluid.cfl_rate * sim.dt if fluid else 0.0,
                    sim.check_divergence(),
                    fluid.kinetic_energy() if fluid else 0.0,
                    energy,
                    self._deepest,
                    slip,
                ]
            ]
        )
        self._deepest = 0.0
        parts = system.watch.seconds
        self._timing.write(
            [
                [
                    sim.steps,
                    sim.time,
                    sim.wall_seconds,
                    parts["momentum"],
                    parts["bodies"],
                    parts["poisson"],
                    parts["contacts"],
                ]
            ]
        )
        for table in (self._particles, self._contacts, self._history, self._timing):
            table.flush()

    def _write_fields(self) -> None:
        sim = self.simulation
        if self._flow and sim.fluid:
            self._flow.write(sim.time, *sim.fluid.cell_values())
        if self._shapes:
            b = sim.bodies
            self._shapes.write(sim.time, b.position, b.diameter, b.velocity, b.angular_velocity)

    def close(self) -> None:
        """Record contacts still open, write a last row, and close the tables."""
        sim = self.simulation
        sim.system.contacts.close_open(sim.time, sim.dt)
        self._take_episodes()
        if sim.time > self._since:
            self._write_tables()
        for table in (self._particles, self._contacts, self._history, self._timing):
            table.close()
