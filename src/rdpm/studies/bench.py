"""Speed of the full coupled step, in nanoseconds and in bytes of this machine's memory bandwidth."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from rdpm.config.load import load_case
from rdpm.parallel.bandwidth import triad_bandwidth
from rdpm.parallel.ranks import ALONE, Ranks
from rdpm.parallel.threads import available_threads
from rdpm.setup import Simulation
from rdpm.setup.rank_plan import plan_ranks
from rdpm.studies.dry_bed import BEDS, dry_bed

__all__ = ["CASES", "bench", "measure"]

WARM_UP = 3  # steps: the first allocates and starts Adams-Bashforth
LEAST_STEPS = 5
SECONDS = 3.0  # of measured steps a case


def _tank(cells: tuple[int, int, int], diffusion: str, per_diameter: float = 16.0) -> dict[str, Any]:
    """One sphere of ten Cate's E3 in a closed box of so many cells."""
    h = 0.015 / per_diameter
    size = [n * h for n in cells]
    viscosity = 0.113 if diffusion == "explicit" else 0.373
    return {
        "title": "one sphere in a closed box",
        "domain": {"size": size},
        "fluid": {"density": 962.0, "viscosity": viscosity},
        "bodies": [{"diameter": 0.015, "density": 1120.0, "centers": [[0.5 * size[0], 0.5 * size[1], 0.6 * size[2]]]}],
        "contact": {"restitution": 0.5, "contact_steps": 8},
        "resolution": {"cells": list(cells)},
        "time": {"end": 10.0, "diffusion": diffusion},
    }


def _suspension() -> dict[str, Any]:
    """200 spheres at 19 % solids, 16 cells a diameter, in a periodic box."""
    d = 0.015
    length = (200 * np.pi / 6.0 * d**3 / 0.19) ** (1 / 3)
    cells = 2 * round(0.5 * length / d * 16.0)
    return {
        "title": "200 spheres",
        "domain": {"size": [length] * 3, "boundary": dict.fromkeys("xyz", "periodic")},
        "fluid": {"density": 962.0, "viscosity": 0.113},
        "bodies": [{"diameter": d, "density": 1120.0, "packing": {"count": 200, "seed": 1, "min_gap": 1e-4}}],
        "contact": {"restitution": 0.5, "contact_steps": 8, "friction": 0.1},
        "resolution": {"cells": [cells] * 3},
        "time": {"end": 10.0, "diffusion": "explicit"},
    }


#: Name -> (case, threads or 0 for all).
CASES: dict[str, tuple[Callable[[], dict[str, Any]], int]] = {
    "sphere-explicit": (lambda: _tank((112, 112, 176), "explicit"), 0),
    "sphere-stabilised": (lambda: _tank((112, 112, 176), "stabilised"), 0),
    "sphere-explicit-1": (lambda: _tank((112, 112, 176), "explicit"), 1),
    "cube-64-1": (lambda: _tank((64, 64, 64), "explicit", 8.0), 1),
    "cube-64": (lambda: _tank((64, 64, 64), "explicit", 8.0), 0),
    "cube-128": (lambda: _tank((128, 128, 128), "explicit"), 0),
    "cube-256": (lambda: _tank((256, 256, 256), "explicit"), 0),
    "suspension-200": (_suspension, 0),
}


def measure(name: str, bandwidth: float | None = None, ranks: Ranks = ALONE) -> dict[str, Any]:
    """Time the steps of one case.

    Parameters
    ----------
    name : str
        A key of `CASES`.
    bandwidth : float, optional, [bytes/s]
        Of the triad with the same number of threads; measured when left out.
    ranks : Ranks
        That share the case; all call this.

    Returns
    -------
    dict
        ``name, cells, threads, diffusion, bodies, steps, ns_per_cell_step, bytes_per_cell_step, memory_bytes_per_cell,
        parts`` (time by part [ns a cell and step]) and, with bodies, ``us_per_marker_pass``, a forcing
        pass from the velocity of the fluid at a marker to its force on the fluid, and ``us_per_marker_step``, all
        that bodies cost in a step; on several ``ranks``, of the first ``message_ns_per_cell_step``, ``messages`` and
        ``sent_bytes`` of a step, and of all ``sent_as_told``, whether that is what `rdpm check --ranks` tells. Of each
        the median over the steps.
    """
    make, requested = CASES[name]
    threads = requested or available_threads(ranks.sharers)
    simulation = Simulation(load_case(make()), threads, ranks=ranks)
    for _ in range(WARM_UP):
        simulation.advance()
    seconds = _timed(simulation, ranks)
    fluid = simulation.fluid
    assert fluid is not None
    cells = int(np.prod(fluid.grid.cells))
    steps, median, passes = (seconds.pop(name) for name in ("steps", "whole", "passes"))
    messages = {name: seconds.pop(name) for name in ("messages", "sent_bytes", "message_seconds")}
    bandwidth = bandwidth or triad_bandwidth(threads)
    immersed = simulation.system.immersed
    result: dict[str, Any] = {
        "name": name,
        "cells": list(fluid.grid.cells),
        "threads": threads,
        "ranks": ranks.size,
        "diffusion": "explicit" if fluid.is_explicit else "stabilised",
        "stages": simulation.plan.step.stages,
        "bodies": len(simulation.bodies),
        "steps": int(steps),
        "ns_per_cell_step": 1e9 * median / cells,
        "bytes_per_cell_step": median / cells * bandwidth,
        "memory_bytes_per_cell": fluid.bytes / int(np.prod(fluid.grid.cells_here)),
        "parts": {part: 1e9 * of_step / cells for part, of_step in seconds.items()},
    }
    if ranks.size > 1:
        told = plan_ranks(simulation.plan, ranks.size, threads).shares[ranks.rank].sent
        is_told = (told.messages, told.sent_bytes) == (messages["messages"], messages["sent_bytes"])
        result |= {
            "message_ns_per_cell_step": 1e9 * messages["message_seconds"] / cells,
            "messages": int(messages["messages"]),
            "sent_bytes": int(messages["sent_bytes"]),
            "sent_as_told": bool(ranks.table([is_told]).all()),
        }
    if immersed is not None and len(immersed.markers):
        markers, calls = len(immersed.markers), immersed.calibration.forcing_passes
        result["us_per_marker_pass"] = 1e6 * passes / calls / markers
        result["us_per_marker_step"] = 1e6 * seconds["bodies"] / markers
    return result


def _timed(simulation: Simulation, ranks: Ranks) -> dict[str, float]:
    """Medians over steps: seconds of the whole and of each part, of messages, and what was sent; and how many steps."""
    watch, immersed = simulation.system.watch, simulation.system.immersed
    rows: list[dict[str, float]] = []
    spent = 0.0
    while len(rows) < LEAST_STEPS or ranks.table([spent])[0, 0] < SECONDS:
        for part in watch.seconds:
            watch.seconds[part] = 0.0
        if immersed is not None:
            immersed.pass_seconds = 0.0
        sent, begin = (ranks.messages, ranks.sent_bytes, ranks.seconds), time.perf_counter()
        simulation.advance()
        whole = time.perf_counter() - begin
        spent += whole
        rows.append(
            {
                **watch.seconds,
                "whole": whole,
                "passes": immersed.pass_seconds if immersed else 0.0,
                "messages": ranks.messages - sent[0],
                "sent_bytes": ranks.sent_bytes - sent[1],
                "message_seconds": ranks.seconds - sent[2],
            }
        )
    return {name: float(np.median([row[name] for row in rows])) for name in rows[0]} | {"steps": len(rows)}


def bench(
    names: Iterable[str] = (),
    progress: Callable[[str], None] | None = None,
    ranks: Ranks = ALONE,
    is_quick: bool = False,
) -> dict[str, Any]:
    """Measure cases and the triad in one run.

    Parameters
    ----------
    names : iterable of str
        Keys of `CASES`, or of `rdpm.studies.dry_bed.BEDS`; all `CASES` when empty.
    progress : callable, optional
        Gets a line before each.
    ranks : Ranks
        That share each case; all call this.
    is_quick : bool
        Of beds: a small one alone.

    Returns
    -------
    dict
        ``triad_GB_s``, ``threads``, ``cases``; ``beds``, as `rdpm.studies.dry_bed.dry_bed` gives them.
    """
    tell = progress or (lambda text: None)
    tell("memory bandwidth")
    bandwidth: dict[int, float] = {}
    threads = available_threads(ranks.sharers)
    for n in sorted({1, threads}):
        bandwidth[n] = float(ranks.table([triad_bandwidth(n)]).sum())
    cases, beds = [], []
    for name in list(names) or CASES:
        if name in BEDS:
            beds.append(dry_bed(name, tell, is_quick))
            continue
        tell(name)
        cases.append(measure(name, bandwidth[CASES[name][1] or threads], ranks))
    return {
        "triad_GB_s": 1e-9 * bandwidth[threads],
        "triad_one_thread_GB_s": 1e-9 * bandwidth[1],
        "threads": threads,
        "ranks": ranks.size,
        "cases": cases,
        "beds": beds,
    }
