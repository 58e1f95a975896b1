"""What runs the pairs of a step: the task it gets, the result it fills."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from rdpm.grid import Box
from rdpm.particles.state import Bodies

from .neighbour_list import Selection
from .pair_table import PairTable
from .rows import Rows

__all__ = ["ContactStep", "ContactTask", "Driver", "Room"]

Floats = NDArray[np.float64]

#: Doubles of room a body while its pairs act, and for all to begin at a line of the cache
#: (``contacts/body_rows.hpp``); integers a pair.
BODY_ROOM, ROOM_TO_ALIGN, PAIR_ROOM = 32, 7, 2


class Room:
    """Memory that a driver works in. It grows and is kept; laws are shared by simulations, it is not."""

    def __init__(self) -> None:
        self._of_bodies, self._of_pairs = np.empty(0), np.empty(0, np.int32)

    def holding(self, bodies: int, pairs: int) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
        """Rooms for so many bodies and pairs or more, of unknown content."""
        if len(self._of_bodies) < BODY_ROOM * bodies + ROOM_TO_ALIGN:
            self._of_bodies = np.empty(BODY_ROOM * (bodies + bodies // 8) + ROOM_TO_ALIGN)
        if len(self._of_pairs) < PAIR_ROOM * pairs:
            self._of_pairs = np.empty(PAIR_ROOM * (pairs + pairs // 8 + 64), np.int32)
        return self._of_bodies, self._of_pairs


@dataclass
class ContactStep:
    """What contacts and lubrication did in one step.

    Parameters
    ----------
    impulse, angular_impulse : ndarray, (N, 3), [N s], [N m s]
        Given to each body by contacts and lubrication, prescribed bodies included.
    contact_impulse : ndarray, (N, 3), [N s]
        The part of ``impulse`` that is contact.
    lubrication_angular_impulse : ndarray, (N, 3), [N m s]
        The part of ``angular_impulse`` that is lubrication.
    impact_speed : ndarray, (N,), [m/s]
        Largest speed at touch of the contacts that a body had in the step; 0 without.
    min_gap : float, [m]
        Smallest gap met in the sub-steps; inf where no pair was in interaction range.
    max_overlap_fraction : float, [-]
        Largest peak overlap of the contacts of this step, of the smaller diameter.
    pairs, touching : int
        Pairs that were resolved, and those still in contact at the end.
    substeps : int
        0 where every body flew freely.
    collisions, rested, capped : int
        Of hard spheres: rebounds, contacts that came to rest, and those of them that the most events of a pair ended.
    """

    impulse: Floats
    angular_impulse: Floats
    contact_impulse: Floats
    lubrication_angular_impulse: Floats
    impact_speed: Floats
    min_gap: float = inf
    max_overlap_fraction: float = 0.0
    pairs: int = 0
    touching: int = 0
    substeps: int = 0
    collisions: int = 0
    rested: int = 0
    capped: int = 0

    @property
    def lubrication_impulse(self) -> Floats:
        """The part of ``impulse`` that is lubrication, (N, 3) [N s]."""
        return self.impulse - self.contact_impulse

    @property
    def contact_angular_impulse(self) -> Floats:
        """The part of ``angular_impulse`` that is contact, (N, 3) [N m s]."""
        return self.angular_impulse - self.lubrication_angular_impulse


@dataclass
class ContactTask:
    """One step of the bodies that have a pair.

    Parameters
    ----------
    bodies : Bodies
        Position, velocity and angular velocity of the active ones are moved on.
    box : Box
    table : PairTable
        Its states and histories are moved on.
    selection : Selection
        Pairs of the table that may meet, and the bodies that have one.
    radius : ndarray, (N,), [m]
    rotation : ndarray, (N, 3), [rad]
        Rotation vector of each body over the step, filled for the active ones.
    force, torque : ndarray, (N, 3), [N], [N m]
        Non-contact load, constant over the step.
    inverse_mass, inverse_moment : ndarray, (N,), [1/kg], [1/(kg m^2)]
        0 for a prescribed motion.
    time, dt : float, [s]
    substeps_per_contact : int
        Sub-steps to the table's shortest time scale.
    overlap_limit : float, [-]
        Of the smaller diameter.
    threads : int
    room : Room
        Of these contacts alone.
    """

    bodies: Bodies
    box: Box
    table: PairTable
    selection: Selection
    radius: Floats
    rotation: Floats
    force: Floats
    torque: Floats
    inverse_mass: Floats
    inverse_moment: Floats
    time: float
    dt: float
    substeps_per_contact: int
    overlap_limit: float
    threads: int
    room: Room


class Driver(Protocol):
    """Moves the bodies of a task over the step and fills the result."""

    @property
    def parameters(self) -> np.dtype[np.void]:
        """Row of a pair's parameters."""

    @property
    def history(self) -> np.dtype[np.void]:
        """What a pair in contact remembers for its law."""

    def run(self, task: ContactTask, step: ContactStep, record: Callable[[NDArray[np.int32], Rows], None]) -> None:
        """Change bodies, states and histories of the task, and `step`.

        Parameters
        ----------
        task : ContactTask
        step : ContactStep
        record : callable
            Gets the pairs (K, 2) and rows (:data:`rdpm.contacts.episodes.FINISHED`) of contacts that finish.

        Raises
        ------
        OverlapError
            A pair passed the overlap limit; the bodies are left in the middle of the step.
        """
