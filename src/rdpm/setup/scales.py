"""What a case implies before it is run: speeds, dimensionless numbers, memory."""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rdpm import design
from rdpm.config.case import Case
from rdpm.setup.inflow import peak_inflow

__all__ = ["Scales", "available_memory", "memory_needed", "scales"]

#: A pair that drafts falls faster than one sphere, and a flow passes its own mean.
SPEED_MARGIN = 1.5

#: Bytes a marker: its stencils, arms, forces.
BYTES_PER_MARKER = 1000


@dataclass(frozen=True)
class Scales:
    """Speeds a run is expected to meet.

    Parameters
    ----------
    terminal : ndarray, (N,), [m/s]
        Speed of each free body alone in the fluid; 0 where it does not settle.
    speed : tuple of float, (3,), [m/s]
        Largest expected along each direction, with a margin.
    fall : float, [m/s]
        Largest terminal or given speed of a body: its impact speed in the worst case.
    """

    terminal: NDArray[np.float64]
    speed: tuple[float, float, float]
    fall: float


def scales(case: Case) -> Scales:
    """Estimate the speeds of a case.

    Parameters
    ----------
    case : Case

    Returns
    -------
    Scales
        Terminal speeds by Brown and Lawler's drag of one sphere alone; given velocities as they are; a driven
        flow by its laminar mean in the narrowest walled direction; an inflow by its largest.
    """
    bodies, gravity = case.expanded_bodies(), np.array(case.domain.gravity)
    n, g = len(bodies), float(np.linalg.norm(gravity))
    speed, terminal = np.abs(np.array(case.domain.wall_velocities)).max(axis=0), np.zeros(n)
    given = [np.abs(bodies.velocity)] if n else []
    for motion in bodies.motion:
        if not isinstance(motion, str):
            values = getattr(motion.velocity, "values", (motion.velocity,))
            given.append(np.abs(np.array(values)).max(axis=0, keepdims=True))
    for wall in case.walls:
        turning = 0.5 * (wall.diameter or 0.0) * abs(wall.angular_velocity or 0.0)
        speed = np.maximum(speed, np.abs(wall.velocity) + turning)
    fluid = case.fluid
    if fluid is not None:
        speed = speed + np.maximum(np.abs(fluid.initial_velocity), peak_inflow(case))
        moves = np.array([motion != "fixed" for motion in bodies.motion], bool)
        if n and g > 0.0:
            sinks = moves & (np.abs(bodies.density / fluid.density - 1.0) > 1e-12)
            terminal[sinks] = design.terminal_velocity(
                bodies.diameter[sinks], bodies.density[sinks], fluid.density, fluid.mu, g
            )[0]
            speed = speed + np.abs(gravity) / g * terminal.max(initial=0.0)
        drive = (
            np.abs(np.array(fluid.body_force or (0.0, 0.0, 0.0)))
            + np.abs(np.array(fluid.pressure_gradient or (0.0, 0.0, 0.0))) / fluid.density
        )
        walled = [length for length, kind in zip(case.domain.size, case.domain.kinds, strict=True) if kind == "wall"]
        # Laminar between walls; without any, what the force gives by the end.
        speed = speed + drive * (min(walled) ** 2 / (8.0 * fluid.nu) if walled else case.time.end)
    fastest = max((float(np.linalg.norm(v, axis=-1).max()) for v in given if v.size), default=0.0)
    along = np.max([v.max(axis=0) for v in given if v.size], axis=0) if any(v.size for v in given) else np.zeros(3)
    total = SPEED_MARGIN * np.maximum(speed, along)
    return Scales(
        terminal, (float(total[0]), float(total[1]), float(total[2])), max(fastest, float(terminal.max(initial=0.0)))
    )


def memory_needed(cells: tuple[int, int, int], is_explicit: bool, markers: int) -> int:
    """Memory of the fields, the solver's factors and the markers [bytes]."""
    nx, ny, nz = cells
    arrays = 8 if is_explicit else 11
    planes = 40  # factors of the pressure solve, buffers of the momentum step
    return 8 * (nx + 2) * (ny + 2) * (arrays * (nz + 2) + planes) + BYTES_PER_MARKER * markers


def available_memory() -> int:
    """Memory that a new program may take [bytes]."""
    try:
        with open("/proc/meminfo") as file:
            for line in file:
                if line.startswith("MemAvailable:"):
                    return int(line.split()[1]) * 1024
    except OSError:
        pass
    return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
