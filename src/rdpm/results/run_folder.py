"""The names of a run's files: the one place that knows them, for those who write and those who read."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from rdpm.io.tables import CONTACT_COLUMNS, HISTORY_COLUMNS, PARTICLE_COLUMNS, TIMING_COLUMNS

__all__ = ["TABLES", "RunFolder"]

#: Tables by name, and their columns.
TABLES = {
    "particles": PARTICLE_COLUMNS,
    "contacts": CONTACT_COLUMNS,
    "history": HISTORY_COLUMNS,
    "timing": TIMING_COLUMNS,
}


@dataclass(frozen=True)
class RunFolder:
    """Where the files of a run are; none of them need exist.

    Parameters
    ----------
    path : pathlib.Path
        The folder.

    Examples
    --------
    >>> folder = RunFolder(Path("dkt"))
    >>> folder.table("particles").as_posix(), folder.checkpoint(12).as_posix()
    ('dkt/particles.csv', 'dkt/checkpoints/step-000000012.checkpoint')
    """

    path: Path

    def __str__(self) -> str:
        return str(self.path)

    @property
    def case(self) -> Path:
        """The case as it was run, with all defaults."""
        return self.path / "case.toml"

    @property
    def summary(self) -> Path:
        """What the run found; see `rdpm.results.summary.Summary`."""
        return self.path / "summary.json"

    def table(self, name: str) -> Path:
        """A table by its name in `TABLES`."""
        return self.path / f"{name}.csv"

    @property
    def tables(self) -> list[Path]:
        """All tables."""
        return [self.table(name) for name in TABLES]

    @property
    def points(self) -> Path:
        """Samples of the flow at the points of the case."""
        return self.path / "points.csv"

    @property
    def lines(self) -> Path:
        """Likewise along its lines."""
        return self.path / "lines.csv"

    def plane(self, number: int) -> Path:
        """The flow on a plane of the case, as VTKHDF."""
        return self.path / f"plane-{number}.vtkhdf"

    @property
    def plane_files(self) -> list[Path]:
        """Planes that are there, in the order of the case."""
        return sorted(self.path.glob("plane-*.vtkhdf"), key=lambda path: int(path.stem.removeprefix("plane-")))

    @property
    def averages(self) -> Path:
        """Time averages of the flow, as VTKHDF."""
        return self.path / "averages.vtkhdf"

    @property
    def records(self) -> Path:
        """The folder of the user's own tables."""
        return self.path / "records"

    def record(self, name: str) -> Path:
        """A table of the user's own."""
        return self.records / f"{name}.csv"

    @property
    def fields(self) -> Path:
        """Velocity and pressure of the fluid, as VTKHDF."""
        return self.path / "fields.vtkhdf"

    @property
    def bodies(self) -> Path:
        """The bodies as surfaces, as VTKHDF."""
        return self.path / "bodies.vtkhdf"

    @property
    def walls(self) -> Path:
        """The walls within the box as surfaces, as VTKHDF."""
        return self.path / "walls.vtkhdf"

    @property
    def checkpoints(self) -> Path:
        """The folder of checkpoints."""
        return self.path / "checkpoints"

    def checkpoint(self, step: int) -> Path:
        """The checkpoint written after a step."""
        return self.checkpoints / f"step-{step:09d}.checkpoint"

    def checkpoint_files(self) -> list[Path]:
        """Checkpoints that are there, oldest first."""
        return sorted(self.checkpoints.glob("step-*.checkpoint"))

    @property
    def figures(self) -> Path:
        """The folder of figures."""
        return self.path / "figures"

    @property
    def video(self) -> Path:
        """The video."""
        return self.path / "video.mp4"

    @property
    def report(self) -> Path:
        """The page that holds figures, video and key numbers."""
        return self.path / "report.html"

    @property
    def log(self) -> Path:
        """What the run said."""
        return self.path / "run.log"

    @property
    def lock(self) -> Path:
        """Held while a run goes on in the folder."""
        return self.path / "run.lock"
