"""Checkpoints of a run: what is in them, when they are written, and which one is good."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Container, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from numpy.typing import NDArray

import rdpm
from rdpm.coupling.system import System
from rdpm.errors import CheckpointError
from rdpm.io.checkpoint import read_checkpoint, read_facts, read_rows, write_checkpoint
from rdpm.io.files import reporting
from rdpm.parallel.agreement import on_root
from rdpm.parallel.gather import Planes, with_planes
from rdpm.results.run_folder import RunFolder
from rdpm.runs.recorder import Recorder
from rdpm.simulation.guards import check_divergence
from rdpm.simulation.schedule import Every
from rdpm.simulation.time_loop import TimeLoop

__all__ = ["FIELDS", "Checkpoints", "Saved", "discard_later", "load_newest", "recorded", "restore"]

#: Wall time between two checkpoints, [s].
WALL_INTERVAL = 300.0

#: A checkpoint that took one second is followed by at least this many without one: at most 2 % of the time.
COST_RATIO = 50.0

#: Arrays of the whole box with its halo, and those of its cells: of these a rank reads its own planes.
WITH_HALO = frozenset(f"fluid/{name}" for name in ("u", "v", "w", "p", "tendency_x", "tendency_y", "tendency_z"))
OF_CELLS = frozenset(f"recorder/means/{name}" for name in ("velocity", "pressure", "square"))
FIELDS = WITH_HALO | OF_CELLS

#: Share of a requested time by which a checkpoint may be before it.
AT_TOLERANCE = 0.01

Arrays = Mapping[str, NDArray[Any]]


class _Part(Protocol):
    def state(self) -> dict[str, NDArray[Any]]: ...

    def restore(self, state: Arrays) -> None: ...


def _parts(system: System) -> dict[str, _Part]:
    """What holds state, by name, bodies first."""
    parts: dict[str, _Part | None] = {
        "bodies": system.bodies,
        "contacts": system.contacts,
        "prescription": system.prescription,
        "fluid": system.fluid,
        "immersed": system.immersed,
        "mean_flow": system.mean_flow,
    }
    return {name: part for name, part in parts.items() if part is not None}


@dataclass(frozen=True)
class Saved:
    """A checkpoint that was read and found whole.

    Attributes
    ----------
    path : Path
    arrays : mapping of str to ndarray
        ``part/name``.
    facts : dict
    """

    path: Path
    arrays: Arrays
    facts: dict[str, Any]

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return float(self.facts["time_s"])

    @property
    def case(self) -> str:
        """The case as TOML."""
        return str(self.facts["case"])

    def part(self, name: str) -> dict[str, NDArray[Any]]:
        """Arrays of one part."""
        begin = f"{name}/"
        return {key.removeprefix(begin): value for key, value in self.arrays.items() if key.startswith(begin)}


class Checkpoints:
    """Writes a run's checkpoints into its folder; the newest are kept.

    Parameters
    ----------
    simulation : TimeLoop
    recorder : Recorder
    folder : RunFolder
        Its folder of checkpoints is made.
    case : str
        The case as TOML; another one cannot continue from here.
    every : float, [s]
        Of simulated time, beside those by wall time; 0: none.
    kept : int
        >= 2: the newest may be spoiled by what stopped the machine.
    """

    def __init__(
        self,
        simulation: TimeLoop,
        recorder: Recorder,
        folder: RunFolder,
        case: str,
        every: float = 0.0,
        kept: int = 2,
    ) -> None:
        self._simulation, self._recorder, self._case, self._kept = simulation, recorder, case, kept
        self._folder, self._ranks = folder, simulation.system.ranks
        on_root(self._ranks, self._make_folder)
        self._every = Every(every)
        self._every.is_due(simulation.time)
        self._due = clock.monotonic() + WALL_INTERVAL
        self._written = -1

    def _make_folder(self) -> None:
        with reporting(self._folder.checkpoints):
            self._folder.checkpoints.mkdir(exist_ok=True)

    def step(self, simulation: TimeLoop) -> None:
        """Write one that has come due; by wall time, when it has on the root."""
        is_late = bool(self._ranks.table([clock.monotonic() >= self._due])[0, 0])
        if self._every.is_due(simulation.time) or is_late:
            self.write()

    def write(self) -> None:
        """Write one of the step just done, and remove the oldest; nothing where that is there already.

        Raises
        ------
        DivergenceError
            The state is not worth keeping; nothing was written.
        OutputError
        """
        begin = clock.monotonic()
        simulation = self._simulation
        system, control = simulation.system, simulation.step_control
        if system.steps == self._written:
            return
        check_divergence(system)
        recorded, record = self._recorder.state()
        arrays: dict[str, NDArray[Any] | Planes] = {f"recorder/{name}": value for name, value in recorded.items()}
        for name, part in _parts(system).items():
            arrays |= {f"{name}/{key}": value for key, value in part.state().items()}
        arrays |= {name: _planes(system, name, values) for name, values in arrays.items() if name in FIELDS}
        facts = {
            "rdpm_version": rdpm.__version__,
            "case": self._case,
            "time_s": system.time,
            "steps": system.steps,
            "dt_s": simulation.dt,
            "dt_range_s": [simulation.shortest_dt, simulation.longest_dt],
            "contact_step_s": control.contact_step if control else None,
            "wall_s": simulation.wall_seconds,
            "parts_s": system.watch.seconds,
            "max_divergence": simulation.max_divergence,
            "recorder": record,
        }
        planes = [values for values in arrays.values() if isinstance(values, Planes)]
        with_planes(self._ranks, planes, lambda: self._keep(arrays, facts))
        self._written = system.steps
        end = clock.monotonic()
        self._due = end + max(WALL_INTERVAL, COST_RATIO * (end - begin))

    def _keep(self, arrays: Mapping[str, NDArray[Any] | Planes], facts: Mapping[str, Any]) -> None:
        write_checkpoint(self._folder.checkpoint(facts["steps"]), arrays, facts)
        for older in self._folder.checkpoint_files()[: -self._kept]:
            older.unlink(missing_ok=True)


def _planes(system: System, name: str, values: Any) -> NDArray[Any] | Planes:
    """A field as the file holds it: whole, or of this rank's slab and to be put together."""
    slab = system.fluid.grid.slab if system.fluid is not None else None
    if slab is None:
        whole: NDArray[Any] = values
        return whole
    own = slice(slab.own.start - slab.first, slab.own.stop - slab.first) if name in WITH_HALO else slice(None)
    return Planes(system.ranks, values[own])


def recorded(simulation: TimeLoop, saved: Saved) -> dict[str, NDArray[Any]]:
    """What a recorder goes on from: of the averages this rank's planes."""
    slab = simulation.fluid.grid.slab if simulation.fluid is not None else None
    rows: Arrays = {}
    if slab is not None:
        rows = read_rows(saved.path, OF_CELLS, slice(slab.first, slab.first + slab.planes))
    return saved.part("recorder") | {name.removeprefix("recorder/"): values for name, values in rows.items()}


def restore(simulation: TimeLoop, saved: Saved, is_same_run: bool = True) -> None:
    """Change a simulation, made from the same bodies and grid, to the state of a checkpoint.

    Parameters
    ----------
    simulation : TimeLoop
    saved : Saved
    is_same_run : bool
        Continue: also the step length, the number of steps and the wall time. Otherwise they are those of a new run.
    """
    system = simulation.system
    fields: Arrays = {}
    if system.fluid is not None and system.fluid.grid.slab is not None:
        taken = read_rows(saved.path, WITH_HALO, system.fluid.grid.slab.take)
        fields = {key.removeprefix("fluid/"): rows for key, rows in taken.items()}
    for name, part in _parts(system).items():
        part.restore(saved.part(name) | (dict(fields) if name == "fluid" else {}))
    system.time = saved.time
    if is_same_run:
        system.steps, simulation.dt = int(saved.facts["steps"]), float(saved.facts["dt_s"])
        simulation.shortest_dt, simulation.longest_dt = saved.facts["dt_range_s"]
        simulation.wall_seconds = float(saved.facts["wall_s"])
        simulation.max_divergence = float(saved.facts["max_divergence"])
        system.watch.seconds.update(saved.facts["parts_s"])


def load_newest(
    folder: RunFolder,
    tell: Callable[[str], None],
    at: float | None = None,
    within: float | None = None,
    leave: Container[str] = (),
) -> Saved:
    """Read the newest good checkpoint of a run.

    Parameters
    ----------
    folder : RunFolder
    tell : callable
        Gets a sentence about each spoiled one that was passed over.
    at : float, optional, [s]
        Not after this time.
    within : float, optional, [s]
        Nor longer before it; `AT_TOLERANCE` of the time when left out.
    leave : container of str
        Arrays that are not read, such as `FIELDS`.

    Raises
    ------
    CheckpointError
        There is none, none is good, or none is near that time; the message says which, and the times there are.
    """
    found = folder.checkpoint_files()
    times: list[float] = []
    tolerance = (AT_TOLERANCE * max(at or 0.0, 0.0) if within is None else within) * (1.0 + 1e-9)
    spoiled = 0
    for path in reversed(found):
        try:
            time = float(read_facts(path)["time_s"])
            # A step ends within round-off of its target.
            if at is not None and not at - tolerance <= time <= at * (1.0 + 1e-9):
                times.append(time)
                continue
            return Saved(path, *read_checkpoint(path, leave))
        except CheckpointError as error:
            spoiled += 1
            tell(f"{error} The one before is taken.")
    if times:
        listed = ", ".join(f"{time:.6g}" for time in sorted(times))
        cure = (
            "Ask for one of these times, allow more with --within, or set output.checkpoints_kept and "
            "output.checkpoint_every in that run."
        )
        raise CheckpointError(
            "--at",
            f"{at:g} s",
            f"must be the time of a checkpoint, or at most {tolerance:.3g} s after it",
            f"there are those at {listed} s",
            cure,
        )
    reason = f"all {spoiled} are spoiled" if spoiled else "there is none"
    raise CheckpointError(str(folder), None, "must hold a good checkpoint", reason, "Start the run anew.")


def discard_later(saved: Saved) -> None:
    """Remove what stands in the way of a run that continues: later files, which are spoiled, and broken-off ones."""
    for path in saved.path.parent.iterdir():
        if path.name.startswith(".step-") or (path.suffix == saved.path.suffix and path.name > saved.path.name):
            path.unlink(missing_ok=True)
