"""A study from its file, or from Python, to its table."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from rdpm.config.case import Case
from rdpm.config.write import case_to_toml
from rdpm.errors import CaseError
from rdpm.io.lock import locked
from rdpm.studies.collect import collect
from rdpm.studies.display import Display
from rdpm.studies.finish import finish
from rdpm.studies.folder import Job, StudyFolder
from rdpm.studies.local import Watcher, run_locally, workers_here
from rdpm.studies.prepare import Prepared, prepare, write_folder
from rdpm.studies.results import StudyResults
from rdpm.studies.study_file import LoadedStudy, load_study

__all__ = ["Study", "run_study", "still_to_do"]


class Study:
    """A family of runs of one case.

    Parameters
    ----------
    base : str, Path, dict or Case
        The case all runs share: a shipped name, a path, or what a case file holds.
    vary : mapping of str to values, optional
        Dotted keys of the case (``"contact.stiffness"``) and a list of values or a range such as ``"0.1:0.9:9"`` or
        ``"log 5e3:1e5:5 dyn/cm"``. The runs are all combinations.
    linked : iterable of mapping, optional
        Columns varied together.
    runs : iterable of dict, optional
        ``{"name": ..., "set": {...}}`` each: runs beside the others.
    set : mapping, optional
        Keys and values for all runs.
    start : float or str, optional, [s]
        Where runs begin that differ in contact parameters, end and output only: one run to there serves all.
    measure : iterable of str, optional
        Names of `rdpm.studies.registry.MEASURES`.
    spread : mapping, optional
        ``of``, ``shifts``, ``orientation_seeds``, ``time_steps``; see `rdpm.studies.study_file.Spread`.
    name, title, question : str, optional
        The name is that of the folder, where none is given to `run`.

    Raises
    ------
    CaseError
        A key, a value or the case of a run is wrong.

    Examples
    --------
    >>> study = Study("dkt", vary={"contact.restitution": [0.5, 0.9]}, measure=["dkt"])
    >>> [(run.name, run.case.contact.restitution) for run in study.plan().runs]
    [('restitution-0.5', 0.5), ('restitution-0.9', 0.9)]

    Its table, when it was run: ``study.run(workers=2).table``.
    """

    def __init__(
        self,
        base: str | Path | dict[str, Any] | Case,
        *,
        vary: Mapping[str, Any] | None = None,
        linked: Iterable[Mapping[str, Any]] = (),
        runs: Iterable[Mapping[str, Any]] = (),
        set: Mapping[str, Any] | None = None,
        start: float | str | None = None,
        measure: Iterable[str] | None = None,
        spread: Mapping[str, Any] | None = None,
        name: str = "study",
        title: str = "",
        question: str = "",
    ) -> None:
        import tomllib

        case = tomllib.loads(case_to_toml(base)) if isinstance(base, Case) else base
        content: dict[str, Any] = {
            "name": name, "title": title, "question": question,
            "base": {"case": str(case) if isinstance(case, Path) else case, "set": dict(set or {})},
            "vary": dict(vary or {}), "linked": [dict(item) for item in linked], "runs": [dict(row) for row in runs],
        }
        if start is not None:
            content["start"] = {"at": start}
        if measure is not None:
            content["measure"] = list(measure)
        if spread is not None:
            content["spread"] = dict(spread)
        self._take(load_study(content))

    def _take(self, loaded: LoadedStudy) -> None:
        self.loaded = loaded
        prepare(loaded)  # refuses what cannot run

    @classmethod
    def load(cls, source: str | Path) -> Study:
        """Load a study file, or a shipped study by its name.

        Raises
        ------
        CaseError

        Examples
        --------
        >>> len(Study.load("dkt-stiffness").plan(quick=True).runs)
        3
        """
        study = cls.__new__(cls)
        study._take(load_study(source))
        return study

    def plan(self, quick: bool = False) -> Prepared:
        """What would be run: its runs, jobs, cost."""
        return prepare(self.loaded, quick)

    def run(
        self,
        out: str | Path | None = None,
        *,
        workers: int | None = None,
        quick: bool = False,
        scheduler: str | None = None,
        progress: bool = True,
    ) -> StudyResults:
        """Run what is not run yet, and measure.

        Parameters
        ----------
        out : path, optional
            The study's folder: new, or that of the study from before, of which finished runs are kept; ``./NAME`` when
            left out.
        workers : int, optional
            Runs at once; one a processor, as far as the memory lasts, when left out.
        quick : bool
            The miniature of the study file.
        scheduler : str, optional
            Address of a Dask scheduler whose workers make the runs.
        progress : bool
            Whether to show how far it is.

        Returns
        -------
        StudyResults
            Its `table` has one row a run. Runs that failed have a status and a reason there.
        """
        path = Path(out) if out is not None else Path(self.loaded.name)
        with Display(quiet=not progress) as display:
            return run_study(
                self.loaded, path, workers=workers, quick=quick, scheduler=scheduler, watcher=display, tell=display.note
            )


def run_study(
    study: LoadedStudy,
    path: Path,
    *,
    workers: int | None = None,
    quick: bool = False,
    scheduler: str | None = None,
    watcher: Watcher | None = None,
    tell: Callable[[str], None] = lambda _: None,
    command: str = "",
) -> StudyResults:
    """Run a study into a folder, or go on with it.

    Parameters
    ----------
    study : LoadedStudy
    path : Path
        New, empty, or the folder of a study.
    workers, quick, scheduler
        As for `Study.run`.
    watcher : Watcher, optional
        Is told how the runs go.
    tell : callable, optional
        Gets sentences.
    command : str, optional
        That makes the study again; kept in its folder.

    Returns
    -------
    StudyResults

    Raises
    ------
    CaseError
        A run's case is wrong, or the folder holds something else; nothing was written.
    KeyboardInterrupt
        Runs were stopped at the end of a step, with a checkpoint.
    """
    if workers is not None and not 1 <= workers <= 1024:
        raise CaseError("--workers", workers, "must lie between 1 and 1024")
    prepared = prepare(study, quick)
    for note in dict.fromkeys(note for run in prepared.runs for note in run.notes if note.startswith("note: ")):
        tell(note)
    is_new = not path.exists()
    with ExitStack() as stack:
        if not is_new and StudyFolder(path).index.is_file():
            stack.enter_context(locked(StudyFolder(path).lock))
        folder = write_folder(prepared, path, command)
        if is_new:
            stack.enter_context(locked(folder.lock))
        todo = still_to_do(folder, prepared.jobs)
        kept = len(prepared.jobs) - len(todo)
        if kept:
            tell(f"{kept} of {len(prepared.jobs)} runs need not be made again")
        if todo and scheduler is not None:
            from rdpm.studies.on_dask import run_on_dask

            run_on_dask(folder, todo, scheduler, watcher or Display(quiet=True))
        elif todo:
            count = workers_here(todo, workers)
            run_locally(folder, todo, count, watcher or Display(quiet=True))
        results = collect(folder)
        finish(results, tell)
        return results


def still_to_do(folder: StudyFolder, jobs: list[Job]) -> list[Job]:
    """Jobs whose end is not known yet, and the starts that these need.

    Parameters
    ----------
    folder : StudyFolder
    jobs : list of Job
        Starts first.
    """

    def is_open(job: Job) -> bool:
        record = folder.read_record(job)
        return record is None or not record.is_final

    runs = [job for job in jobs if not job.is_start and is_open(job)]
    needed = {job.start for job in runs}
    return [*(job for job in jobs if job.is_start and job.name in needed and is_open(job)), *runs]
