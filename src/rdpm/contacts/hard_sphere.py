"""Hard spheres: collisions as impulses in order of time, contacts at rest as forces, no overlap."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from rdpm import _core
from rdpm.errors import CaseError, OverlapError

from .driver import ContactStep, ContactTask
from .episodes import FINISHED
from .pair_table import PairTable
from .rows import Rows, as_bytes, check_layout
from .substeps import pair_names

__all__ = ["EventDriver", "HardSphere"]

Floats = NDArray[np.float64]

#: Intervals of a step with lubrication, which acts once in each and after every collision.
LUBRICATION_INTERVALS = 32

#: Relative speed at a contact at rest that counts as none: of the rest speed, and of the speeds of the step.
QUIET_REST, QUIET_SPEED = 1e-4, 1e-10

# The structs of contacts/hard_sphere.hpp.
_PARAMETERS = np.dtype(
    [(name, np.float64) for name in ("restitution", "tangential_restitution", "friction")]
)
_HISTORY = np.dtype([("normal", np.float64), ("tangential", np.float64, (3,))])
check_layout(_PARAMETERS, _core.hard_sphere_layouts()["parameters"], "hard-sphere parameters")
check_layout(_HISTORY, _core.hard_sphere_layouts()["history"], "hard-sphere history")


@dataclass(frozen=True)
class EventDriver:
    """Moves bodies from collision to collision.

    Between collisions each body flies on a parabola under its non-contact load, which is constant over the step. Of
    all collisions the earliest is next; of equal ones that of the first pair. Lubrication splits the step into equal
    intervals.

    Parameters
    ----------
    rest_speed : float, [m/s]
        Relative normal speed below which a collision does not rebound. >= 0.
    most_events : int
        Collisions of one pair in a step, after which it stays at rest until the step ends. >= 1.
    """

    rest_speed: float
    most_events: int
    parameters: ClassVar[np.dtype[np.void]] = _PARAMETERS
    history: ClassVar[np.dtype[np.void]] = _HISTORY

    def run(self, task: ContactTask, step: ContactStep, record: Callable[[NDArray[np.int32], Rows], None]) -> None:
        """Change bodies, states and histories of the task, and `step`; see :class:`rdpm.contacts.driver.Driver`."""
        b, rows = task.bodies, task.selection.rows
        if not len(rows):
            return
        table = task.table.part(rows)
        acceleration = task.inverse_mass[:, None] * task.force
        angular_acceleration = task.inverse_moment[:, None] * task.torque
        fastest = np.abs(b.velocity).max() + task.dt * np.abs(acceleration).max()
        quiet = QUIET_REST * self.rest_speed + QUIET_SPEED * float(fastest)
        finished = np.empty(len(table) + 64 + 2 * len(table), FINISHED)
        events = np.zeros(len(table), np.int64)
        step.substeps = LUBRICATION_INTERVALS if len(table.lubrication) else 1
        for interval in range(step.substeps):
            start, end = (task.dt * n / step.substeps for n in (interval, interval + 1))
            is_new = True
            while start < end:
                reached, count, collisions, rested, capped = _core.run_events(
                    task.box.table, b.position, b.velocity, b.angular_velocity, task.rotation, acceleration,
                    angular_acceleration, task.inverse_mass, task.inverse_moment, task.radius, step.impulse,
                    step.angular_impulse, step.contact_impulse, step.lubrication_angular_impulse,
                    task.selection.active, table.ids, as_bytes(table.parameters),
                    as_bytes(table.lubrication), as_bytes(table.state), as_bytes(table.history), as_bytes(finished),
                    events, task.time + start, end - start, self.rest_speed, quiet, self.most_events, is_new,
                )  # fmt: skip
                if count:
                    record(table.ids[finished["pair"][:count]], finished[:count])
                step.collisions += collisions
                step.rested += rested
                step.capped += capped
                start, is_new = end if reached >= end - start else start + reached, False
        task.table.state[rows], task.table.history[rows] = table.state, table.history
        self._part(task, table, step)

    def _part(self, task: ContactTask, table: PairTable, step: ContactStep) -> None:
        """Leave no overlap; stop where a pair cannot part."""
        step.min_gap, overlap, pair = _core.separate(
            task.box.table, task.bodies.position, task.inverse_mass, task.radius, table.ids
        )
        step.max_overlap_fraction = max(0.0, overlap)
        if overlap > task.overlap_limit:
            i, other = pair_names(table.ids[pair])
            raise OverlapError(
                f"overlap of body {i} and {other} at t = {task.time + task.dt:.6g} s",
                f"{100.0 * overlap:.3g} % of the diameter",
                f"must stay below contact.overlap_limit = {100.0 * task.overlap_limit:g} %",
                "hard spheres are squeezed between bodies that cannot give way",
                "Change the prescribed motion.",
            )


@dataclass(frozen=True)
class HardSphere:
    r"""Rebound :math:`u'=-e_n u` at once, with Coulomb's friction; at rest below a speed.

    Friction after Walton: a contact slides where sticking would need more than :math:`\mu_f J_n`, else the tangential
    velocity of the surfaces becomes :math:`-\beta_0` of itself.

    Parameters
    ----------
    restitution : float, [-]
        Normal, 0 <= e_n <= 1.
    friction : float, [-]
        Coulomb's coefficient, >= 0.
    tangential_restitution : float, [-]
        Of a contact that sticks, :math:`0\le\beta_0\le1`.
    rest_speed : float, [m/s]
        See :class:`EventDriver`.
    most_events : int
        See :class:`EventDriver`.

    Raises
    ------
    CaseError
        An argument outside its range.

    References
    ----------
    .. [1] Walton, in Particulate Two-Phase Flow (Butterworth-Heinemann, 1993) 884-911; Foerster et al., Phys. Fluids 6
       (1994) 1108-1115, doi:10.1063/1.868282; Hoomans et al., Chem. Eng. Sci. 51 (1996) 99-118,
       doi:10.1016/0009-2509(95)00271-5.

    Examples
    --------
    >>> law = HardSphere(restitution=0.8, friction=0.1)
    >>> law.driver.rest_speed, law.driver.most_events
    (0.0, 100)
    """

    restitution: float
    friction: float = 0.0
    tangential_restitution: float = 0.0
    rest_speed: float = 0.0
    most_events: int = 100

    def __post_init__(self) -> None:
        limits = {"restitution": 1.0, "friction": inf, "tangential_restitution": 1.0, "rest_speed": inf}
        for name, most in limits.items():
            value = getattr(self, name)
            if not (0.0 <= value <= most and value < inf):
                rule = "must be a finite number of at least 0" + (f" and at most {most:g}" if most < inf else "")
                raise CaseError(f"contact.{name}", value, rule, cure="Correct this value.")
        if not self.most_events >= 1:
            raise CaseError("contact.most_events", self.most_events, "must be at least 1", cure="Raise it.")

    @property
    def interaction_range(self) -> float:
        """Impulses act between surfaces that touch."""
        return 0.0

    @property
    def driver(self) -> EventDriver:
        """Collisions in order of time."""
        return EventDriver(self.rest_speed, self.most_events)

    def parameters(self, pairs: Rows) -> Rows:
        """Parameters of each pair; see :class:`rdpm.contacts.law.ContactLaw`."""
        result = np.empty(len(pairs), _PARAMETERS)
        result["restitution"], result["tangential_restitution"] = self.restitution, self.tangential_restitution
        result["friction"] = np.where(pairs["is_frictionless"], 0.0, self.friction)
        return result

    def time_scale(self, pairs: Rows) -> Floats:
        """A contact takes no time that a step must resolve: inf, (K,) [s]."""
        return np.full(len(pairs), inf)
