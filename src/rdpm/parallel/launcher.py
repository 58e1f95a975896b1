"""Whether a launcher started this process as one of several: asked before MPI is, or any array is there."""

from __future__ import annotations

import os
import re

from rdpm.errors import CaseError

__all__ = ["launched", "launched_here", "launched_rank", "single"]

# Set for each process by the launchers; SLURM's batch script itself has no step.
_LAUNCHERS = (
    "OMPI_COMM_WORLD_SIZE",
    "PMI_SIZE",
    "MV2_COMM_WORLD_SIZE",
    "MPI_LOCALNRANKS",
    "SLURM_STEP_NUM_TASKS",
)


def launched() -> tuple[int, str]:
    """How many ranks a launcher started, and the variable that says so; 1 and nothing without one.

    Examples
    --------
    >>> launched()
    (1, '')
    """
    for name in _LAUNCHERS:
        count = os.environ.get(name, "")
        if count.isdigit() and int(count) > 1:
            return int(count), name
    return 1, ""


def launched_rank() -> int:
    """Which rank the launcher says this is, before MPI is asked; 0 without one.

    Examples
    --------
    >>> launched_rank()
    0
    """
    if launched()[0] == 1:
        return 0
    names = ("OMPI_COMM_WORLD_RANK", "PMI_RANK", "MV2_COMM_WORLD_RANK", "PMIX_RANK", "SLURM_PROCID")
    found = [os.environ[name] for name in names if os.environ.get(name, "").isdigit()]
    return int(found[0]) if found else 0


def launched_here() -> int:
    """How many of the processes the launcher started on this machine; all of them where it does not say.

    Examples
    --------
    >>> launched_here()
    1
    """
    names = ("MPI_LOCALNRANKS", "OMPI_COMM_WORLD_LOCAL_SIZE", "MV2_COMM_WORLD_LOCAL_SIZE", "SLURM_STEP_TASKS_PER_NODE")
    found = [re.match(r"[1-9]\d*", os.environ.get(name, "")) for name in names]
    return next((int(match.group()) for match in found if match), launched()[0])


def single(what: str) -> None:
    """Refuse several ranks, for a command that is one process.

    Parameters
    ----------
    what : str
        The command.

    Raises
    ------
    CaseError

    Examples
    --------
    >>> single("rdpm tune")
    """
    count, name = launched()
    if count > 1:
        raise CaseError(
            what, f"{count} MPI ranks ({name})", "must be one process", "only rdpm run shares its work among ranks",
            "Start it without mpiexec or srun; use --threads.",
        )  # fmt: skip
