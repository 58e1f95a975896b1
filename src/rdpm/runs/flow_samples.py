"""Samples of the flow that a case asks for: points, lines, planes, time averages."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm.config.output import Output
from rdpm.fluid import Fluid
from rdpm.fluid.means import FlowMeans
from rdpm.fluid.sampling import PointSampler, plane_parts, plane_sum
from rdpm.io.files import replacing
from rdpm.io.vtkhdf import FieldWriter
from rdpm.parallel.agreement import OnRoot, on_root
from rdpm.parallel.gather import Planes, rows_on_root, with_planes
from rdpm.results.run_folder import RunFolder
from rdpm.runs.continued import Note, continued
from rdpm.simulation.record import Record
from rdpm.simulation.time_loop import TimeLoop

__all__ = ["AVERAGES", "FlowSamples", "probes"]

#: Of `averages.vtkhdf`, and components of each.
AVERAGES = {"mean_velocity": 3, "mean_pressure": 1, "velocity_variance": 3}

Floats = NDArray[np.float64]


def probes(simulation: TimeLoop, output: Output, folder: RunFolder) -> list[tuple[Record, Path]]:
    """Make the records of points and lines, with their files."""
    fluid, made = simulation.fluid, []
    if fluid is None:
        return []
    if output.points:
        points = np.array(output.points)
        number = {"point": np.arange(len(points))}
        made.append((Record("points", _sampled(fluid, points, number), _due(simulation, output)), folder.points))
    if output.lines:
        parts = [np.linspace(line.start, line.end, line.count) for line in output.lines]
        number = {
            "line": np.repeat(np.arange(len(parts)), [len(part) for part in parts]),
            "along_m": np.concatenate([np.linalg.norm(part - part[0], axis=1) for part in parts]),
        }
        lines = _sampled(fluid, np.concatenate(parts), number)
        made.append((Record("lines", lines, _due(simulation, output)), folder.lines))
    return made


def _due(simulation: TimeLoop, output: Output) -> Any:
    return simulation.asked(output.sample_every or 0.0)


def _sampled(fluid: Fluid, points: Floats, number: dict[str, Any]) -> Callable[[TimeLoop], dict[str, Any]]:
    sampler = PointSampler(fluid.grid, points)
    places = number | dict(zip(("x_m", "y_m", "z_m"), points.T, strict=True))

    def rows(_: TimeLoop) -> dict[str, Any]:
        velocity, pressure = sampler.values(fluid)
        return {**places, **dict(zip(("u_m_s", "v_m_s", "w_m_s"), velocity.T, strict=True)), "pressure_Pa": pressure}

    return rows


class FlowSamples:
    """Writes planes, and averages the flow over time.

    Parameters
    ----------
    simulation : TimeLoop
        With a fluid.
    output : Output
    folder : RunFolder
    """

    def __init__(self, simulation: TimeLoop, output: Output, folder: RunFolder) -> None:
        assert simulation.fluid is not None
        self._simulation, self._folder, self._fluid = simulation, folder, simulation.fluid
        self._planes = [("xyz".index(plane.normal), plane.position) for plane in output.planes]
        self._planes_due = simulation.asked(output.planes_every or 0.0)
        self._average_due = simulation.asked(output.average_every or 0.0)
        self._from = output.average_from
        self.means = FlowMeans(self._fluid.grid.cells_here) if output.average_from is not None else None
        self._ranks = simulation.system.ranks
        self._files: list[OnRoot] = []

    def open(self, resumed: tuple[Mapping[str, NDArray[Any]], Mapping[str, Any]] | None, note: Note | None) -> None:
        """Begin the files, or continue them from what `state` gave."""
        until = self._simulation.time if resumed else None
        for n, (axis, position) in enumerate(self._planes):
            cells, spacing, origin = list(self._fluid.grid.cells), self._fluid.grid.spacing, [0.0, 0.0, 0.0]
            cells[axis], origin[axis] = 1, position - 0.5 * spacing[axis]

            def made(
                path: Path, keep: float | None, cells: Any = tuple(cells), corner: Any = tuple(origin)
            ) -> FieldWriter:
                return FieldWriter(path, cells, self._fluid.grid.spacing, keep, origin=corner)

            begin = partial(continued, self._folder.plane(n), until, note, made)
            self._files.append(OnRoot(self._ranks, begin))
        if resumed is None:
            self.step()
            return
        arrays, facts = resumed
        self._planes_due.count, self._average_due.count = facts["counts"]
        if self.means is not None:
            self.means.restore({key.removeprefix("means/"): value for key, value in arrays.items()})

    def step(self) -> None:
        """Take the samples that have come due."""
        time = self._simulation.time
        if self._files and self._planes_due.is_due(time):
            for (axis, position), file in zip(self._planes, self._files, strict=True):
                self._write_plane(file, axis, position)
        begins = self._from is not None and time >= self._from * (1.0 - 1e-9)
        if self.means is not None and begins and self._average_due.is_due(time):
            self.means.add(self._fluid, time)

    def _write_plane(self, file: OnRoot, axis: int, position: float) -> None:
        time, fluid, ranks = self._simulation.time, self._fluid, self._ranks
        parts = plane_parts(fluid, axis, position)
        if axis == 2:  # its two layers may be of two ranks
            shape = parts.shape[1:]
            gathered = rows_on_root(ranks, parts.reshape(len(parts), math.prod(shape))).reshape(-1, *shape)
            on_root(ranks, lambda: file.inner.write(time, *plane_sum(fluid, gathered)))
            return
        values = [Planes(ranks, part) for part in plane_sum(fluid, parts)]
        with_planes(ranks, values, lambda: file.inner.write(time, *values))

    def state(self) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
        """Sums and schedules: arrays, those of the averages of this rank's slab, and plain values."""
        arrays = {} if self.means is None else {f"means/{key}": value for key, value in self.means.state().items()}
        return arrays, {"counts": [self._planes_due.count, self._average_due.count]}

    def close(self) -> None:
        """Write the averages so far."""
        means, grid = self.means, self._fluid.grid
        if means is None or means.span <= 0.0:
            return
        planes = [Planes(self._ranks, values) for values in (means.velocity, means.pressure, means.variance)]

        def write() -> None:
            with replacing(self._folder.averages) as temporary:
                file = FieldWriter(temporary, grid.cells, grid.spacing, quantities=AVERAGES)
                file.write(means.last, *planes)

        with_planes(self._ranks, planes, write)
