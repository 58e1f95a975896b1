"""Speed of dry contacts in a bed of many spheres, beside LAMMPS's on the same bed in the same run."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm import design
from rdpm.contacts import Contacts, SoftSphere
from rdpm.grid import Box
from rdpm.parallel.threads import available_threads
from rdpm.particles.state import Bodies

__all__ = ["BEDS", "dry_bed", "find_lammps", "lammps_error", "restitution_error"]

Tell = Callable[[str], None]

#: Name -> spheres along an edge of the bed.
BEDS = {"dry-bed": 40, "dry-bed-million": 100}

DIAMETER, DENSITY, SOLIDS, SPEED = 5e-3, 2500.0, 0.49, 0.1  # speed: standard deviation of each component
RESTITUTION, FRICTION, CONTACT_TIME, STEPS_PER_CONTACT = 0.9, 0.3, 8e-4, 8

#: Sub-steps to a contact: LAMMPS's usual number, and the fewest here.
SUBSTEPS, FEWEST = 112, 16
WARM_UP, LEAST_STEPS, SECONDS, SKIN = 12, 4, 3.0, 0.05  # contact steps; wall time; of the diameter

PHASES = 8  # of the touch within a sub-step, over which the error of the restitution is the largest


def _bed(side: int) -> tuple[Bodies, float]:
    """Spheres on a simple cubic lattice, with velocities at random, and the edge of their periodic box."""
    spacing = DIAMETER * (np.pi / 6.0 / SOLIDS) ** (1.0 / 3.0)
    k, j, i = np.meshgrid(*[np.arange(side)] * 3, indexing="ij")
    place = (np.stack([i, j, k], -1).reshape(-1, 3) + 0.5) * spacing
    count = side**3
    velocity = np.random.default_rng(1).normal(0.0, SPEED, (count, 3))
    return Bodies(np.full(count, DIAMETER), np.full(count, DENSITY), place, velocity), side * spacing


def _least(substeps: int) -> int:
    """What is asked for so that rounding up to an even number a step gives so many sub-steps to a contact."""
    return round(0.9 * substeps)


def _law() -> SoftSphere:
    return SoftSphere.from_contact_time(RESTITUTION, CONTACT_TIME, "zero-overlap", FRICTION)


def _time_rdpm(side: int, substeps: int, threads: int) -> dict[str, Any]:
    bodies, edge = _bed(side)
    box = Box((edge, edge, edge), ("periodic",) * 3)
    contacts = Contacts(bodies, box, _law(), substeps_per_contact=_least(substeps), threads=threads)
    none, dt = np.zeros_like(bodies.position), CONTACT_TIME / STEPS_PER_CONTACT
    count = steps = touching = 0
    wall = cpu = 0.0
    while steps < WARM_UP + LEAST_STEPS or wall < SECONDS:
        begin = time.perf_counter(), time.process_time()
        step = contacts.advance(steps * dt, dt, none, none)
        contacts.take_episodes()
        if steps >= WARM_UP:
            wall, cpu = wall + time.perf_counter() - begin[0], cpu + time.process_time() - begin[1]
            count, touching = count + step.substeps, step.touching
        steps += 1
    per_contact = count * STEPS_PER_CONTACT // (steps - WARM_UP)
    row = _row("rdpm", len(bodies), threads, per_contact, wall / count, cpu / count)
    return row | {"contacts_per_body": touching / len(bodies)}


def _row(program: str, bodies: int, threads: int, per_contact: int, wall: float, cpu: float) -> dict[str, Any]:
    return {
        "program": program, "bodies": bodies, "threads": threads, "substeps_per_contact": per_contact,
        "us": 1e6 * wall / bodies, "cpu_us": 1e6 * cpu / bodies,
        "us_per_contact_time": 1e6 * wall / bodies * per_contact,
    }  # fmt: skip


def restitution_error(substeps: int) -> float:
    """Largest relative error of the restitution of two spheres, over where in a sub-step they touch.

    Parameters
    ----------
    substeps : int
        Sub-steps to a contact: a multiple of 2 `STEPS_PER_CONTACT`.

    Examples
    --------
    >>> restitution_error(112) < 1e-4
    True
    """
    dt, worst = CONTACT_TIME / STEPS_PER_CONTACT, 0.0
    box = Box((1.0, 1.0, 1.0), ("periodic",) * 3)
    for phase in range(PHASES):
        x = 0.5 + np.array([0.0, DIAMETER + 2.0 * SPEED * dt * (0.3 + phase / PHASES)])
        place = np.column_stack([x, np.full(2, 0.5), np.full(2, 0.5)])
        velocity = np.array([[SPEED, 0.0, 0.0], [-SPEED, 0.0, 0.0]])
        pair = Bodies(np.full(2, DIAMETER), np.full(2, DENSITY), place, velocity)
        contacts, none = Contacts(pair, box, _law(), substeps_per_contact=_least(substeps)), np.zeros((2, 3))
        for step in range(2 * STEPS_PER_CONTACT):
            contacts.advance(step * dt, dt, none, none)
        achieved = (pair.velocity[1, 0] - pair.velocity[0, 0]) / (2.0 * SPEED)
        worst = max(worst, abs(float(achieved) / RESTITUTION - 1.0))
    return worst


def find_lammps() -> str | None:
    """Path of LAMMPS's executable; None where it is not installed."""
    return shutil.which("lmp", path=str(Path(sys.executable).parent)) or shutil.which("lmp")


def _find_mpiexec() -> str | None:
    return shutil.which("mpiexec", path=str(Path(sys.executable).parent)) or shutil.which("mpiexec")


def _run_lammps(script: str, ranks: int = 1, files: dict[str, str] | None = None) -> str:
    """Output of LAMMPS for an input."""
    executable = find_lammps()
    assert executable is not None
    with tempfile.TemporaryDirectory() as folder:
        for name, text in ({"in.lmp": script} | (files or {})).items():
            Path(folder, name).write_text(text, encoding="utf-8")
        command = [executable, "-in", "in.lmp", "-log", "none"]
        if ranks > 1:
            command = [_find_mpiexec() or "mpiexec", "-n", str(ranks), *command]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"LAMMPS stopped:\n{done.stdout[-1000:]}{done.stderr[-1000:]}")
    return done.stdout


def _lammps_law() -> str:
    """The same spring and dashpot; its damping is over the reduced mass."""
    mass = 0.5 * DENSITY * np.pi / 6.0 * DIAMETER**3
    k_n, eta_n = design.contact_parameters(mass, RESTITUTION, CONTACT_TIME, "zero-overlap")
    k_t, eta_t = design.tangential_parameters(k_n, eta_n, 2.0 / 7.0)
    numbers = " ".join(f"{float(x):.17g}" for x in (k_n, k_t, eta_n / mass, eta_t / mass, FRICTION))
    return f"pair_style gran/hooke/history {numbers} 1\npair_coeff * *\nfix move all nve/sphere\n"


_HEAD = "units si\natom_style sphere\natom_modify map array\nboundary p p p\nnewton off\ncomm_modify vel yes\n"


def _rows_text(rows: NDArray[np.float64], before: str = "") -> str:
    return "".join(f"{n} {before}" + " ".join(f"{x:.17g}" for x in row) + "\n" for n, row in enumerate(rows, 1))


def _time_lammps(side: int, substeps: int, ranks: int) -> dict[str, Any]:
    bodies, edge = _bed(side)
    edges = "".join(f"0 {edge:.17g} {d}lo {d}hi\n" for d in "xyz")
    data = f"bed\n\n{len(bodies)} atoms\n1 atom types\n\n{edges}\nAtoms # sphere\n\n"
    data += _rows_text(bodies.position, f"1 {DIAMETER} {DENSITY} ")
    data += "\nVelocities\n\n" + _rows_text(np.hstack([bodies.velocity, np.zeros_like(bodies.velocity)]))
    warm, steps = (substeps * n // STEPS_PER_CONTACT for n in (WARM_UP, 2 * LEAST_STEPS))
    script = (
        f"{_HEAD}read_data bed.data\nneighbor {SKIN * DIAMETER:g} bin\nneigh_modify delay 0 every 1 check yes\n"
        f"{_lammps_law()}timestep {CONTACT_TIME / substeps:.17g}\nrun {warm}\nrun {steps}\n"
    )
    output = _run_lammps(script, ranks, {"bed.data": data})
    wall = float(re.findall(r"^Loop time of (\S+)", output, re.M)[-1]) / steps
    share = float(re.findall(r"^(\S+)% CPU use", output, re.M)[-1]) / 100.0
    return _row("LAMMPS", len(bodies), ranks, substeps, wall, wall * share * ranks)


def lammps_error(substeps: int) -> float:
    """`restitution_error` of LAMMPS's ``gran/hooke/history`` at so many steps to a contact."""
    h, worst = CONTACT_TIME / substeps, 0.0
    for phase in range(PHASES):
        gap = 2.0 * SPEED * h * (2.0 + phase / PHASES)
        script = (
            f"{_HEAD}region all block 0 0.1 0 0.1 0 0.1\ncreate_box 1 all\n"
            f"create_atoms 1 single 0.05 0.05 0.05\ncreate_atoms 1 single {0.05 + DIAMETER + gap:.17g} 0.05 0.05\n"
            f"set group all diameter {DIAMETER} density {DENSITY}\nset atom 1 vx {SPEED}\nset atom 2 vx -{SPEED}\n"
            f"neighbor 0.001 bin\n{_lammps_law()}timestep {h:.17g}\nrun {int(1.6 * substeps) + 6}\n"
            'variable v equal vx[2]\nprint "RESTITUTION $(v_v:%20.15g)"\n'
        )
        found = re.findall(r"^RESTITUTION +(\S+)", _run_lammps(script), re.M)
        worst = max(worst, abs(float(found[-1]) / SPEED / RESTITUTION - 1.0))
    return worst


def dry_bed(name: str, tell: Tell) -> dict[str, Any]:
    """Time a bed here and in LAMMPS, at equal sub-step and at the fewest sub-steps here.

    Parameters
    ----------
    name : str
        A key of `BEDS`.
    tell : callable
        Gets a line before each measurement, and one where LAMMPS is not installed.

    Returns
    -------
    dict
        ``name``, ``lammps`` (whether it ran) and ``rows``: ``program, bodies, threads, substeps_per_contact``,
        ``us`` and ``cpu_us`` (wall and processor time of a body and sub-step), ``us_per_contact_time`` (wall time of a
        body over the duration of a contact), ``restitution_error`` (relative), ``contacts_per_body`` (of rdpm).
    """
    side, rows = BEDS[name], []
    threads = sorted({1, min(2, available_threads())})
    for substeps in (SUBSTEPS, FEWEST):
        for n in threads:
            tell(f"{name}: rdpm, {n} threads, {substeps} sub-steps a contact")
            error = {"restitution_error": restitution_error(substeps)}
            rows.append(_time_rdpm(side, substeps, n) | error)
    has_lammps = find_lammps() is not None
    if not has_lammps:
        tell(f"{name}: LAMMPS is not installed, so nothing is compared with it: pip install 'rdpm[bench]'")
    else:
        error = {"restitution_error": lammps_error(SUBSTEPS)}
        for n in threads:
            if n > 1 and _find_mpiexec() is None:
                tell(f"{name}: no mpiexec, so LAMMPS is timed on one core alone")
                continue
            tell(f"{name}: LAMMPS, {n} ranks, {SUBSTEPS} steps a contact")
            rows.append(_time_lammps(side, SUBSTEPS, n) | error)
    return {"name": name, "lammps": has_lammps, "rows": rows}
