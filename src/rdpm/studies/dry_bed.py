"""Speed of dry contacts in a bed of many spheres, beside LAMMPS's on the same bed in the same run."""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import time
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from rdpm.contacts import Contacts, SoftSphere
from rdpm.grid import Box
from rdpm.parallel.threads import available_threads
from rdpm.particles.state import Bodies

from . import dry_bed_case as case
from .dry_bed_lammps import find_lammps, find_mpiexec, lammps_error, time_lammps

__all__ = ["BEDS", "dry_bed", "grown", "restitution_error"]

Tell = Callable[[str], None]

#: Name -> spheres along an edge of the bed.
BEDS = {"dry-bed": 40}
GROWTH, QUICK = (20, 40, 80, 100), 20

#: Sub-steps to a contact at which both are timed: LAMMPS's usual number.
SUBSTEPS = 112
STEPS_PER_CONTACT = 8  # time steps; each has an even number of sub-steps
FEW = {10: 1, 16: 2, 32: 4, 56: 4, 112: 8}  # sub-steps to a contact -> time steps to one
FEW_LAMMPS = (14, 20, 28, 40, 56, 80, 112, 160, 224)

#: Largest errors of the restitution at which the time of a contact is compared.
ERRORS = (0.01, 0.002)

LEAST_STEPS, SECONDS = 4, 3.0  # time steps; wall time


def _contacts(bodies: Bodies, edge: float, substeps: int, threads: int = 1) -> Contacts:
    law = SoftSphere.from_contact_time(case.RESTITUTION, case.CONTACT_TIME, "zero-overlap", case.FRICTION)
    box = Box((edge, edge, edge), ("periodic",) * 3)
    return Contacts(bodies, box, law, substeps_per_contact=substeps, threads=threads)


def _time_step(steps: int) -> float:
    """So many to a contact; 0.1 % shorter, so that the number of sub-steps is not rounded up."""
    return case.CONTACT_TIME / steps * 0.999


def _time_rdpm(side: int, substeps: int, threads: int, steps_per_contact: int = STEPS_PER_CONTACT) -> dict[str, Any]:
    bodies, edge = case.bed(side)
    contacts = _contacts(bodies, edge, substeps, threads)
    none, dt = np.zeros_like(bodies.position), _time_step(steps_per_contact)
    count = steps = touching = 0
    wall = cpu = 0.0
    warm = round(case.WARM_UP * steps_per_contact)
    while steps < warm + LEAST_STEPS or wall < SECONDS:
        begin = time.perf_counter(), time.process_time()
        step = contacts.advance(steps * dt, dt, none, none)
        contacts.take_episodes()
        if steps >= warm:
            wall, cpu = wall + time.perf_counter() - begin[0], cpu + time.process_time() - begin[1]
            count, touching = count + step.substeps, step.touching
        steps += 1
    per_contact = count * steps_per_contact // (steps - warm)
    row = case.row("rdpm", len(bodies), threads, per_contact, wall / count, cpu / count)
    return row | {"contacts_per_body": touching / len(bodies)}


def restitution_error(substeps: int, steps_per_contact: int = STEPS_PER_CONTACT) -> case.Restitution:
    """Error of the restitution of two spheres, over where in a sub-step they touch.

    Parameters
    ----------
    substeps : int
        Sub-steps to a contact: a multiple of 2 `steps_per_contact`, at least 10.
    steps_per_contact : int
        Time steps to a contact.

    Examples
    --------
    >>> restitution_error(112)["worst"] < 1e-4
    True
    """
    position, velocity = case.pairs(case.CONTACT_TIME / substeps)
    bodies = Bodies(np.full(len(position), case.DIAMETER), np.full(len(position), case.DENSITY), position, velocity)
    contacts, none, dt = _contacts(bodies, 2.0, substeps), np.zeros_like(position), _time_step(steps_per_contact)
    for step in range(2 * steps_per_contact + 1):
        contacts.advance(step * dt, dt, none, none)
    return case.Restitution("rdpm", substeps, bodies.velocity[1::2, 0] / case.SPEED)


def grown(side: int) -> dict[str, Any]:
    """Time and memory of a bed on one core, the process's own: a row of `dry_bed`'s ``growth``."""
    unit = 1 if sys.platform == "darwin" else 1024
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    row = _time_rdpm(side, SUBSTEPS, 1)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return row | {"bytes_per_body": unit * (peak - before) / row["bodies"]}


def _growth(edges: Iterable[int], name: str, tell: Tell) -> list[dict[str, Any]]:
    rows = []
    for side in edges:
        tell(f"{name}: rdpm, {side**3} spheres, {SUBSTEPS} sub-steps a contact")
        program = f"import json\nfrom rdpm.studies.dry_bed import grown\nprint(json.dumps(grown({side})))"
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
        rows.append(json.loads(done.stdout))
    return rows


def _fewest(errors: list[case.Restitution], program: str, target: float) -> int | None:
    """Fewest sub-steps to a contact from which on the worst error stays below the target."""
    fewest = None
    mine = [error for error in errors if error["program"] == program]
    for error in sorted(mine, key=lambda error: -error["substeps_per_contact"]):
        if error["worst"] > target:
            break
        fewest = int(error["substeps_per_contact"])
    return fewest


def dry_bed(name: str, tell: Tell, is_quick: bool = False) -> dict[str, Any]:
    """Time a bed here and in LAMMPS, at equal sub-step and at equal error of the restitution.

    Parameters
    ----------
    name : str
        A key of `BEDS`.
    tell : callable
        Gets a line before each measurement, and one where LAMMPS is not installed.
    is_quick : bool
        A bed of 8000 spheres, and nothing of its growth.

    Returns
    -------
    dict
        ``name``; ``lammps``, whether it ran; ``rows``, at equal sub-step: ``program, bodies, threads,
        substeps_per_contact``, ``us`` and ``cpu_us`` (wall and processor time of a body and sub-step),
        ``us_per_contact_time`` and ``cpu_us_per_contact_time`` (of a body over the duration of a contact),
        ``contacts_per_body`` (of rdpm); ``errors``: rows of :class:`rdpm.studies.dry_bed_case.Restitution`;
        ``equal_error``: rows as those of ``rows``, with ``error``, the largest that was allowed; ``growth``: rows as
        those of ``rows``, with ``bytes_per_body``, for numbers of spheres.
    """
    side = min(QUICK, BEDS[name]) if is_quick else BEDS[name]
    programs: list[tuple[str, Callable[[int, int], dict[str, Any]]]] = [
        ("rdpm", lambda substeps, n: _time_rdpm(side, substeps, n, FEW.get(substeps, STEPS_PER_CONTACT)))
    ]
    threads = {"rdpm": sorted({1, min(2, available_threads())})}
    errors = [restitution_error(substeps, steps) for substeps, steps in FEW.items()]
    has_lammps = find_lammps() is not None
    if has_lammps:
        tell(f"{name}: error of the restitution of LAMMPS, {len(FEW_LAMMPS)} time steps")
        errors += [lammps_error(substeps) for substeps in FEW_LAMMPS]
        programs.append(("LAMMPS", lambda substeps, n: time_lammps(side, substeps, n)))
        threads["LAMMPS"] = threads["rdpm"] if find_mpiexec() else [1]
        if len(threads["LAMMPS"]) < len(threads["rdpm"]):
            tell(f"{name}: no mpiexec, so LAMMPS is timed on one core alone")
    else:
        tell(f"{name}: LAMMPS is not installed, so nothing is compared with it: pip install 'rdpm[bench]'")
    done: dict[tuple[str, int, int], dict[str, Any]] = {}

    def timed(program: str, measure: Callable[[int, int], dict[str, Any]], substeps: int) -> list[dict[str, Any]]:
        for n in threads[program]:
            if (program, substeps, n) not in done:
                tell(f"{name}: {program}, {side**3} spheres, {n} of the cores, {substeps} sub-steps a contact")
                done[program, substeps, n] = measure(substeps, n)
        return [done[program, substeps, n] for n in threads[program]]

    rows = [row for program, measure in programs for row in timed(program, measure, SUBSTEPS)]
    equal_error = []
    for target in ERRORS:
        for program, measure in programs:
            fewest = _fewest(errors, program, target)
            if fewest is not None:
                equal_error += [row | {"error": target} for row in timed(program, measure, fewest)]
    growth = [] if is_quick else _growth(GROWTH, name, tell)
    return {"name": name, "lammps": has_lammps, "rows": rows, "errors": errors, "equal_error": equal_error,
            "growth": growth}  # fmt: skip
