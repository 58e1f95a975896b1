"""The bed of spheres that is timed, and the pairs that tell the error of the restitution: the same for each program."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm.particles.state import Bodies

__all__ = ["Restitution", "bed", "pairs", "row"]

DIAMETER, DENSITY, SOLIDS, SPEED = 5e-3, 2500.0, 0.49, 0.1  # speed: standard deviation of each component
RESTITUTION, FRICTION, CONTACT_TIME = 0.9, 0.3, 8e-4

#: Places in a sub-step where a contact may begin, over which the errors are taken.
PHASES = 16

WARM_UP = 1.5  # contact times before the clock starts


class Restitution(dict[str, Any]):
    """``program``, ``substeps_per_contact``, and the relative error over the phases: ``worst`` and ``rms``.

    Parameters
    ----------
    program : str
    substeps : int
    achieved : ndarray, (PHASES,), [-]
    """

    def __init__(self, program: str, substeps: int, achieved: NDArray[np.float64]) -> None:
        error = achieved / RESTITUTION - 1.0
        super().__init__(
            program=program, substeps_per_contact=substeps, worst=float(np.abs(error).max()),
            rms=float(np.sqrt(np.mean(error**2))),
        )  # fmt: skip


def bed(side: int) -> tuple[Bodies, float]:
    """Spheres on a simple cubic lattice, with velocities at random, and the edge of their periodic box [m].

    Examples
    --------
    >>> bodies, edge = bed(4)
    >>> len(bodies), round(64 * np.pi / 6.0 * DIAMETER**3 / edge**3, 6)
    (64, 0.49)
    """
    spacing = DIAMETER * (np.pi / 6.0 / SOLIDS) ** (1.0 / 3.0)
    k, j, i = np.meshgrid(*[np.arange(side)] * 3, indexing="ij")
    place = (np.stack([i, j, k], -1).reshape(-1, 3) + 0.5) * spacing
    count = side**3
    velocity = np.random.default_rng(1).normal(0.0, SPEED, (count, 3))
    return Bodies(np.full(count, DIAMETER), np.full(count, DENSITY), place, velocity), side * spacing


def pairs(substep: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Positions [m] and velocities [m/s], (2 PHASES, 3), of pairs that meet head-on after two sub-steps and a phase."""
    gap = 2.0 * SPEED * substep * (2.0 + np.arange(PHASES) / PHASES)
    position, velocity = np.full((PHASES, 2, 3), 0.05), np.zeros((PHASES, 2, 3))
    position[:, :, 1] += 4.0 * DIAMETER * np.arange(PHASES)[:, None]
    position[:, 1, 0] += DIAMETER + gap
    velocity[:, 0, 0], velocity[:, 1, 0] = SPEED, -SPEED
    return position.reshape(-1, 3), velocity.reshape(-1, 3)


def row(program: str, bodies: int, threads: int, per_contact: int, wall: float, cpu: float) -> dict[str, Any]:
    """One timing, from the wall and processor time of a sub-step [s]."""
    return {
        "program": program, "bodies": bodies, "threads": threads, "substeps_per_contact": per_contact,
        "us": 1e6 * wall / bodies, "cpu_us": 1e6 * cpu / bodies,
        "us_per_contact_time": 1e6 * wall / bodies * per_contact,
        "cpu_us_per_contact_time": 1e6 * cpu / bodies * per_contact,
    }  # fmt: skip
