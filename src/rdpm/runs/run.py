"""``rdpm.run``: what the command does, from Python."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from rdpm.config.case import Case
from rdpm.config.load import load_case
from rdpm.errors import CaseError
from rdpm.io.files import reporting
from rdpm.parallel.agreement import on_root
from rdpm.parallel.ranks import world
from rdpm.results.frames import RunFrames, open_run
from rdpm.runs.runner import OwnRecord, run_case
from rdpm.setup import Simulation, plan

__all__ = ["run"]


def run(
    case: Case | str | Path | dict[str, Any],
    out: str | Path,
    *,
    on_step: Callable[[Simulation], None] | None = None,
    record: Mapping[str, OwnRecord] | None = None,
    threads: int | None = None,
    resume: bool = False,
) -> RunFrames:
    """Run a case into a folder, which then holds what ``rdpm run`` leaves there.

    Parameters
    ----------
    case : Case, str, Path or dict
        From `rdpm.load_case`, or what that takes.
    out : path
        New or empty; of the run to be continued with `resume`. Missing folders above it are made.
    on_step : callable, optional
        Called after every step with the simulation, before the step's rows are written; on every rank.
    record : mapping of str to callable, or to (callable, float or str), optional
        Own tables by name: a function of the simulation, and how often (seconds, or text with a unit; as often as the
        tables where it is not said). Written to ``records/NAME.csv``; see `rdpm.simulation.record.Record` for what the
        function may give. Checkpoints hold no functions: to continue a table, give its function again with `resume`.
    threads : int, optional
        All processors, or OMP_NUM_THREADS, when left out.
    resume : bool
        Continue from the newest checkpoint in `out`.

    Returns
    -------
    RunFrames

    Raises
    ------
    CaseError, CheckpointError
        The case or the folder is wrong; nothing was written.
    GuardError
        The numbers could no longer be trusted.

    Examples
    --------
    >>> import rdpm, tempfile
    >>> bead = {"diameter": 0.01, "density": 2500, "centers": [[0.05, 0.05, 0.05]]}
    >>> case = {"domain": {"size": [0.1, 0.1, 0.1]}, "bodies": [bead], "time": {"end": 0.05, "step": "1 ms"},
    ...         "output": {"report": False}}
    >>> heights = []
    >>> found = rdpm.run(case, tempfile.mkdtemp(), on_step=lambda sim: heights.append(sim.bodies.position[0, 2]),
    ...                  record={"energy_J": (lambda sim: sim.bodies.mass @ sim.bodies.velocity[:, 2]**2 / 2, "10 ms")})
    >>> len(heights), found.summary.steps, round(float(found.particles["z_m"].iloc[-1]), 6)
    (50, 50, 0.037738)
    >>> found.records["energy_J"].round(6).values[-1].tolist()
    [0.05, 0.000157]
    """
    loaded = case if isinstance(case, Case) else load_case(case)
    plan(loaded)  # refuses what cannot run, before a folder is made
    folder, ranks = Path(out), world()
    on_root(ranks, lambda: _make_folder(folder, resume))
    run_case(loaded, folder, threads=threads, resume=resume, on_step=on_step, ranks=ranks, record=record)
    return open_run(folder)


def _make_folder(folder: Path, resume: bool) -> None:
    if folder.exists() and not folder.is_dir():
        raise CaseError("out", str(folder), "must be a folder", "a file of that name is there", "Name another.")
    if not resume and folder.is_dir() and any(folder.iterdir()):
        cure = "Name another folder, or continue the run in it with resume=True."
        raise CaseError("out", str(folder), "must be new or empty", "it holds files, perhaps results", cure)
    with reporting(folder):
        folder.mkdir(parents=True, exist_ok=True)
