"""Bodies whose motion is given, for good or until they are released."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm.particles.state import FREE, PRESCRIBED, Bodies

__all__ = ["Motion", "Prescription"]

#: Share of a step that a time may be off by the sum of many steps.
ROUND_OFF = 1e-6

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Motion:
    """Given velocity of one body.

    Parameters
    ----------
    times : ndarray, (T,), [s]
        Rising; one entry for a constant velocity.
    velocity, rotation : ndarray, (T, 3), [m/s], [rad/s]
        Linear in between, held beyond the ends.
    until : float, [s]
        Free from then on.
    until_gap : float, [m]
        Free once the nearest body or wall is this close.

    Examples
    --------
    >>> rest = Motion(np.zeros(1), np.zeros((1, 3)), np.zeros((1, 3)))
    >>> rest.at(1.0)[0]
    array([0., 0., 0.])
    """

    times: Floats
    velocity: Floats
    rotation: Floats
    until: float = math.inf
    until_gap: float = -math.inf

    def mean(self, start: float, end: float) -> tuple[Floats, Floats]:
        """Mean velocity (3,) and angular velocity (3,) over a span of time, kinks of the table inside it included.

        Examples
        --------
        >>> up = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]])
        >>> kink = Motion(np.array([0.0, 1.0, 2.0]), up, np.zeros((3, 3)))
        >>> float(kink.mean(0.5, 1.5)[0][2])
        0.75
        """
        if end <= start:
            return self.at(start)
        inside = self.times[(self.times > start) & (self.times < end)]
        times = np.concatenate([[start], inside, [end]])
        share = np.diff(times) / (end - start)
        linear, angular = (
            np.array([share @ (0.5 * (at[1:] + at[:-1])) for at in (np.interp(times, self.times, v) for v in of.T)])
            for of in (self.velocity, self.rotation)
        )
        return linear, angular

    def at(self, time: float) -> tuple[Floats, Floats]:
        """Velocity (3,) and angular velocity (3,) at a time."""
        linear = [np.interp(time, self.times, values) for values in self.velocity.T]
        angular = [np.interp(time, self.times, values) for values in self.rotation.T]
        return np.array(linear), np.array(angular)


class Prescription:
    """Applies the given motions and releases bodies.

    Parameters
    ----------
    motions : dict of int to Motion
        By body id; a body that is not in it is free.
    """

    def __init__(self, motions: dict[int, Motion]) -> None:
        self.motions = dict(motions)

    def state(self) -> dict[str, NDArray[Any]]:
        """Ids of the bodies that are still held."""
        return {"held": np.array(sorted(self.motions), np.int64)}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Forget the motions of the bodies that were released before `state`."""
        held = set(state["held"].tolist())
        self.motions = {body: motion for body, motion in self.motions.items() if body in held}

    def hold(self, bodies: Bodies, time: float, dt: float) -> None:
        """Give each body its mean velocity over the step, with which its position advances."""
        for body, motion in self.motions.items():
            bodies.motion[body] = PRESCRIBED
            bodies.velocity[body], bodies.angular_velocity[body] = motion.mean(time, time + dt)

    def set(self, bodies: Bodies, time: float) -> None:
        """Give each body its velocity at a time."""
        for body, motion in self.motions.items():
            bodies.velocity[body], bodies.angular_velocity[body] = motion.at(time)

    def release(self, bodies: Bodies, time: float, dt: float, gaps: Callable[[], Floats]) -> None:
        """Free the bodies whose time has come, or whose surface is close enough to the next one.

        A sum of many steps of `dt` may fall short of a time by round-off. `gaps` gives the smallest surface gap of each
        body, (N,) [m]; it is called only where some body waits for one.
        """
        if not self.motions:
            return
        need_gap = any(math.isfinite(motion.until_gap) for motion in self.motions.values())
        gap = gaps() if need_gap else np.full(len(bodies), math.inf)
        for body in [b for b, m in self.motions.items() if time >= m.until - ROUND_OFF * dt or gap[b] <= m.until_gap]:
            del self.motions[body]
            bodies.motion[body] = FREE
