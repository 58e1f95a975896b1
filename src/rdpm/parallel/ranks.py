"""MPI ranks: how many processes work on a run."""

from __future__ import annotations

import os

from rdpm.errors import CaseError

__all__ = ["working_ranks"]

# Set for each process by the launchers; SLURM's batch script itself has no step.
_LAUNCHERS = (
    "OMPI_COMM_WORLD_SIZE",
    "PMI_SIZE",
    "MV2_COMM_WORLD_SIZE",
    "MPI_LOCALNRANKS",
    "SLURM_STEP_NUM_TASKS",
)


def working_ranks() -> int:
    """Processes that share the work: one in this version.

    Returns
    -------
    int

    Raises
    ------
    CaseError
        A launcher started several, each of which would do the whole work.

    Examples
    --------
    >>> working_ranks()
    1
    """
    for name in _LAUNCHERS:
        count = os.environ.get(name, "")
        if count.isdigit() and int(count) > 1:
            raise CaseError(
                "run",
                f"{count} MPI ranks ({name})",
                "must be one process in this version",
                "each rank would run the whole case",
                "Start it without mpiexec or srun; use --threads.",
            )
    return 1
