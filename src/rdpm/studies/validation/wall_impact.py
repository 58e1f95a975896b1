"""A steel sphere that meets the floor of a tank of silicone oil: its motion, and its restitution as recorded."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm.config.load import load_case
from rdpm.setup import Simulation

__all__ = ["RESTITUTION", "Sphere", "Track", "peaks", "recorded_impacts", "wall_impact"]

Floats = NDArray[np.float64]

DENSITY, RESTITUTION = 7800.0, 0.97

#: Horizontal edges of the box [diameters].
ACROSS = 16.0 / 3.0

#: Time in which the prescribed speed is reached from rest [s].
RAMP = 1e-3


@dataclass(frozen=True)
class Sphere:
    """A steel sphere in oil.

    Parameters
    ----------
    diameter : float, [m]
    speed : float, [m/s]
        Of the approach, prescribed until the gap is one radius.
    oil_density : float, [kg/m^3]
    viscosity : float, [Pa s]

    Examples
    --------
    >>> round(Sphere(3e-3, 0.585, 935.0, 0.010).stokes_number())
    152
    """

    diameter: float
    speed: float
    oil_density: float
    viscosity: float

    def stokes_number(self, speed: float | None = None) -> float:
        """Give rho_p v d / (9 mu) at a speed [m/s], or at that of the approach."""
        return DENSITY * (self.speed if speed is None else speed) * self.diameter / (9.0 * self.viscosity)


@dataclass(frozen=True)
class Track:
    """Motion of the sphere.

    Parameters
    ----------
    time : ndarray, (T,), [s]
        From the first step in which the sphere moves up; negative throughout where it never does.
    gap : ndarray, (T,), [m]
    speed : ndarray, (T,), [m/s]
        Upwards.
    deepest : float, [-]
        Largest overlap over the diameter.
    """

    time: Floats
    gap: Floats
    speed: Floats
    deepest: float

    def speed_after(self, delay: float) -> float:
        """Upward speed [m/s] so long after the sphere has left the wall; 0 where it stays."""
        left = np.flatnonzero((self.gap > 0.0) & (self.time > 0.0))
        if not left.size:
            return 0.0
        n = int(left[0])
        leaves = np.interp(0.0, self.gap[n - 1 : n + 1], self.time[n - 1 : n + 1])
        return max(0.0, float(np.interp(leaves + delay, self.time, self.speed)))


def wall_impact(
    sphere: Sphere,
    across: float,
    step: float,
    contact: Mapping[str, Any],
    *,
    start: float,
    after: float,
    offset: float = 0.0,
    width: float = ACROSS,
) -> Track:
    """Let a sphere fall onto the floor.

    Parameters
    ----------
    sphere : Sphere
    across : float
        Cells a diameter.
    step : float, [s]
    contact : mapping
        Keys of the contact besides `restitution`.
    start : float, [diameters]
        Height of the centre at first; the box ends 2.5 diameters above.
    after : float, [s]
        Simulated from the first step on in which the sphere moves up. A sphere that does not is given up after twice
        the time of its fall.
    offset : float, [cells]
        Added to the start along all directions.
    width : float, [diameters]
        Horizontal edges of the box.
    """
    d = sphere.diameter
    size = [edge * d for edge in (width, width, start + 2.5)]
    shift = offset * d / across
    simulation = Simulation(load_case({
        "domain": {"size": size},
        "fluid": {"density": sphere.oil_density, "viscosity": sphere.viscosity},
        "bodies": [{
            "diameter": d,
            "density": DENSITY,
            "centers": [[0.5 * size[0] + shift, 0.5 * size[1] + shift, start * d + shift]],
            "motion": {
                "until": {"gap": 0.5 * d},
                "velocity": {"times": [0.0, RAMP], "values": [[0, 0, 0], [0, 0, -sphere.speed]]},
            },
        }],
        "contact": {"restitution": RESTITUTION, **contact},
        "resolution": {"cells_per_diameter": across},
        "time": {"end": 1.0, "step": step},
    }))  # fmt: skip
    rows, deepest, impact = [], 0.0, np.inf
    while simulation.time < min(impact, 2.0 * start * d / sphere.speed) + after:
        simulation.advance()
        velocity = float(simulation.bodies.velocity[0, 2])
        rows.append((simulation.time, float(simulation.bodies.position[0, 2] - 0.5 * d), velocity))
        last = simulation.system.last_contact
        deepest = max(deepest, last.max_overlap_fraction if last else 0.0)
        if impact == np.inf and len(rows) > 1 and velocity > 0.0:
            impact = simulation.time
    time, gap, speed = np.array(rows).T
    return Track(time - impact, gap, speed, deepest)


def peaks(time: Floats, gap: Floats, least: float) -> list[float]:
    """Heights of the first three rebounds that pass `least` [m]; nan where one did not end."""
    turn = np.flatnonzero((gap[1:-1] > gap[:-2]) & (gap[1:-1] >= gap[2:]) & (time[1:-1] > 0.0)) + 1
    found = [float(gap[n]) for n in turn if gap[n] > least]
    return (found + [float("nan")] * 3)[:3]


def recorded_impacts(frames: Floats, gaps: Floats, time: Floats, gap: Floats) -> list[tuple[float, float]]:
    """Speed before each impact [m/s] and restitution, from three frames of a camera before it and three after.

    Parameters
    ----------
    frames, gaps : ndarray, (F,), [s], [m]
        What the camera saw. An impact is before the frame whose gap is smaller than those beside it.
    time, gap : ndarray, (T,), [s], [m]
        What is measured: the same arrays, or a computed track, looked at when the camera would have looked. Its impacts
        are put where the line through the camera's last two frames before one meets the wall.

    Examples
    --------
    >>> t = np.arange(-5.0, 6.0)
    >>> seen = np.where(t < 0.0, -t, 0.5 * t)
    >>> [(speed, e)] = recorded_impacts(t, seen, t, seen)
    >>> round(speed, 12), round(e, 12)
    (1.0, 0.5)
    """
    found = []
    touches = np.flatnonzero((gap[1:] <= 0.0) & (gap[:-1] > 0.0)) + 1
    lowest = [n for n in range(3, len(gaps) - 2) if gaps[n - 1] >= gaps[n] < gaps[n + 1]]
    for k, n in enumerate(lowest):
        at = frames[n - 3 : n + 3]
        if time is not frames:
            if k >= len(touches):
                break
            meets = at[2] + gaps[n - 1] * (at[2] - at[1]) / (gaps[n - 2] - gaps[n - 1])
            at = at - meets + time[touches[k]]
        g = np.interp(at, time, gap)
        before = (g[0] - g[2]) / (at[2] - at[0])
        found.append((float(before), float((g[5] - g[3]) / (at[5] - at[3]) / before)))
    return found
