"""A job of SLURM for one run, on one process or several ranks."""

from __future__ import annotations

import math
import shlex
import sys
from collections.abc import Sequence

from rdpm.setup.plan import Plan
from rdpm.setup.rank_plan import plan_ranks
from rdpm.setup.rows import EXPECTED_NS

__all__ = ["slurm_script"]

_TEXT = """#!/bin/bash
#SBATCH --job-name={name}
#SBATCH --output={name}-%j.out
#SBATCH --ntasks={ranks}
#SBATCH --cpus-per-task={threads}
#SBATCH --mem-per-cpu={memory}M
#SBATCH --time={hours:02d}:{minutes:02d}:00
#SBATCH --signal=TERM@120   # a checkpoint is written two minutes before the end; submit this again to go on

srun --cpu-bind=cores {words} --threads "$SLURM_CPUS_PER_TASK"
"""

#: What is asked for over what is foretold; the least time [minutes], and that of a case without a flow.
MEMORY_MARGIN, TIME_MARGIN, LEAST_MINUTES, DRY_MINUTES = 1.5, 4.0, 30, 240


def slurm_script(made: Plan, name: str, words: Sequence[str], ranks: int, threads: int) -> str:
    """Write down the job that starts a run, and continues it when it is submitted again.

    Parameters
    ----------
    made : Plan
    name : str
        Of the job.
    words : sequence of str
        Of the command line behind ``rdpm run``: the case, its changes and ``--out``.
    ranks, threads : int
        Processes, and threads of each.

    Returns
    -------
    str
        It asks for 1.5 times the memory and four times the time that `rdpm check` foretells, half an hour at least.

    Raises
    ------
    CaseError
        A dry case on several ranks; or too many of them.

    Examples
    --------
    >>> from rdpm.config.load import load_case
    >>> from rdpm.setup.plan import plan
    >>> text = slurm_script(plan(load_case("cloud")), "cloud", ["cloud", "--out", "cloud"], 2, 4)
    >>> print("\\n".join(text.splitlines()[1:4]))
    #SBATCH --job-name=cloud
    #SBATCH --output=cloud-%j.out
    #SBATCH --ntasks=2
    """
    needs, drawing = made.needs, made.needs.view + made.needs.video
    memory, seconds = needs.process, 60.0 * DRY_MINUTES / TIME_MARGIN
    if made.cells is not None:
        seconds = 1e-9 * EXPECTED_NS * made.steps * math.prod(made.cells) / threads
    if ranks > 1:
        shared = plan_ranks(made, ranks, threads)
        memory, seconds = max(share.memory for share in shared.shares), shared.seconds
    hours, minutes = divmod(max(LEAST_MINUTES, math.ceil(TIME_MARGIN * seconds / 60.0)), 60)
    command = [sys.executable, "-m", "rdpm.cli.main", "run", *words, "--resume", "--quiet"]
    return _TEXT.format(
        name=name, ranks=ranks, threads=threads, hours=hours, minutes=minutes, words=shlex.join(command),
        memory=math.ceil(1e-6 * MEMORY_MARGIN * (memory + drawing) / threads),
    )  # fmt: skip
