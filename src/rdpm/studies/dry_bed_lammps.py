"""The bed and the pairs of :mod:`rdpm.studies.dry_bed_case` in LAMMPS's ``gran/hooke/history``."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm import design

from . import dry_bed_case as case

__all__ = ["find_lammps", "find_mpiexec", "lammps_error", "time_lammps"]

SKIN, STEPS = 0.05, 1.0  # of the diameter; contact times that are timed

_HEAD = "units si\natom_style sphere\natom_modify map array\nboundary p p p\nnewton off\ncomm_modify vel yes\n"


def _find(name: str) -> str | None:
    return shutil.which(name, path=str(Path(sys.executable).parent)) or shutil.which(name)


def find_lammps() -> str | None:
    """Path of LAMMPS's executable; None where it is not installed."""
    return _find("lmp")


def find_mpiexec() -> str | None:
    """Path of the launcher of ranks; None where it is not installed."""
    return _find("mpiexec")


def _run(script: str, data: str, ranks: int = 1) -> str:
    """Output of LAMMPS for an input that reads ``data``."""
    command = [find_lammps() or "lmp", "-in", "in.lmp", "-log", "none"]
    if ranks > 1:
        command = [find_mpiexec() or "mpiexec", "-n", str(ranks), *command]
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "in.lmp").write_text(script, encoding="utf-8")
        Path(folder, "data").write_text(data, encoding="utf-8")
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"LAMMPS stopped:\n{done.stdout[-1000:]}{done.stderr[-1000:]}")
    return done.stdout


def _law() -> str:
    """The same spring and dashpot; LAMMPS's damping is over the reduced mass."""
    mass = 0.5 * case.DENSITY * np.pi / 6.0 * case.DIAMETER**3
    k_n, eta_n = design.contact_parameters(mass, case.RESTITUTION, case.CONTACT_TIME, "zero-overlap")
    k_t, eta_t = design.tangential_parameters(k_n, eta_n, 2.0 / 7.0)
    numbers = " ".join(f"{float(x):.17g}" for x in (k_n, k_t, eta_n / mass, eta_t / mass, case.FRICTION))
    return f"pair_style gran/hooke/history {numbers} 1\npair_coeff * *\nfix move all nve/sphere\n"


def _rows(rows: NDArray[np.float64], before: str = "") -> str:
    return "".join(f"{n} {before}" + " ".join(f"{x:.17g}" for x in row) + "\n" for n, row in enumerate(rows, 1))


def _data(position: NDArray[np.float64], velocity: NDArray[np.float64], edge: float) -> str:
    edges = "".join(f"0 {edge:.17g} {d}lo {d}hi\n" for d in "xyz")
    return (
        f"spheres\n\n{len(position)} atoms\n1 atom types\n\n{edges}\nAtoms # sphere\n\n"
        + _rows(position, f"1 {case.DIAMETER} {case.DENSITY} ")
        + "\nVelocities\n\n"
        + _rows(np.hstack([velocity, np.zeros_like(velocity)]))
    )


def time_lammps(side: int, substeps: int, ranks: int) -> dict[str, Any]:
    """A row of :func:`rdpm.studies.dry_bed_case.row`; one rank a core."""
    bodies, edge = case.bed(side)
    warm, steps = (round(substeps * n) for n in (case.WARM_UP, STEPS))
    script = (
        f"{_HEAD}read_data data\nneighbor {SKIN * case.DIAMETER:g} bin\nneigh_modify delay 0 every 1 check yes\n"
        f"{_law()}timestep {case.CONTACT_TIME / substeps:.17g}\nrun {warm}\nrun {steps}\n"
    )
    output = _run(script, _data(bodies.position, bodies.velocity, edge), ranks)
    wall = float(re.findall(r"^Loop time of (\S+)", output, re.M)[-1]) / steps
    share = float(re.findall(r"^(\S+)% CPU use", output, re.M)[-1]) / 100.0
    return case.row("LAMMPS", len(bodies), ranks, substeps, wall, wall * share * ranks)


def lammps_error(substeps: int) -> case.Restitution:
    """Error of the restitution of two spheres at so many steps to a contact."""
    h = case.CONTACT_TIME / substeps
    position, velocity = case.pairs(h)
    asked = "".join(
        f'variable v{n} equal vx[{n}]\nprint "SPEED $(v_v{n}:%20.15g)"\n' for n in range(2, 2 * case.PHASES + 1, 2)
    )
    script = (
        f"{_HEAD}read_data data\nneighbor {case.DIAMETER:g} bin\n{_law()}timestep {h:.17g}\n"
        f"run {int(1.6 * substeps) + 6}\n{asked}"
    )
    found = re.findall(r"^SPEED +(\S+)", _run(script, _data(position, velocity, 2.0)), re.M)
    return case.Restitution("LAMMPS", substeps, np.array(found, np.float64) / case.SPEED)
