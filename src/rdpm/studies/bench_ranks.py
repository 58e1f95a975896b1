"""The price of ranks: the same case on two ranks, and on one with all threads."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from rdpm.errors import CaseError
from rdpm.parallel.threads import processors

__all__ = ["CASES", "bench_ranks", "find_mpiexec"]

#: Cases that show it: the flow, many bodies, diffusion by stages.
CASES = ("cube-128", "suspension-200", "sphere-stabilised")

RANKS, TURNS = 2, 3  # turns: measured in alternation, against what else the machine does


def find_mpiexec() -> str | None:
    """Path of the launcher beside this Python, or of the one on the path; None without either.

    Examples
    --------
    >>> found = find_mpiexec()
    >>> found is None or Path(found).is_file()
    True
    """
    return shutil.which("mpiexec", path=str(Path(sys.executable).parent)) or shutil.which("mpiexec")


def bench_ranks(names: Sequence[str] = (), progress: Callable[[str], None] | None = None) -> list[dict[str, Any]]:
    """Time cases on two ranks, and on one rank with as many threads, in turns.

    Parameters
    ----------
    names : sequence of str
        Keys of `rdpm.studies.bench.CASES`; `CASES` when empty.
    progress : callable, optional
        Gets a line before each measurement.

    Returns
    -------
    list of dict
        ``name``; ``one`` and ``ranks``, as `rdpm.studies.bench.measure` gives them, each the one of median speed;
        ``speed``: that of the ranks over that of one.

    Raises
    ------
    CaseError
        There is no launcher, or it fails.
    """
    launcher, tell = find_mpiexec(), progress or (lambda text: None)
    if launcher is None:
        raise CaseError(
            "rdpm bench ranks", None, "needs mpiexec", "there is none here", "Install rdpm[mpi]."
        )  # fmt: skip
    each = max(1, processors() // RANKS)
    ways = {"one": ([], RANKS * each), "ranks": ([launcher, "-n", str(RANKS)], each)}
    found = []
    for name in list(names) or CASES:
        rows: dict[str, list[dict[str, Any]]] = {way: [] for way in ways}
        for turn in range(TURNS):
            for way, (words, threads) in ways.items():
                tell(f"{name}, turn {turn + 1}, {RANKS if words else 1} x {threads} threads")
                rows[way].append(_measured(name, words, threads))
        median = {way: sorted(of, key=lambda row: row["ns_per_cell_step"])[TURNS // 2] for way, of in rows.items()}
        speed = median["one"]["ns_per_cell_step"] / median["ranks"]["ns_per_cell_step"]
        found.append({"name": name, **median, "speed": float(np.round(speed, 4))})
    return found


def _measured(name: str, launcher: Sequence[str], threads: int) -> dict[str, Any]:
    words = [*launcher, sys.executable, "-m", "rdpm.cli.main", "bench", name, "--json"]
    done = subprocess.run(
        words, capture_output=True, text=True, env=os.environ | {"OMP_NUM_THREADS": str(threads)}, check=False
    )
    if done.returncode:
        reason = (done.stderr.strip() or "it said nothing").splitlines()[-1]
        raise CaseError("rdpm bench ranks", " ".join(words), "must run", reason)
    (case,) = json.loads(done.stdout)["cases"]
    return dict(case)
