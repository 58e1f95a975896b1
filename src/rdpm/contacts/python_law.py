"""A contact law given as a Python function: slow, for trying."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray

from rdpm.conventions import FIRST_WALL
from rdpm.errors import CaseError, OverlapError

from .driver import ContactStep, ContactTask
from .episodes import FINISHED
from .pair_table import pairs_of
from .rows import APART, TOUCHING, Rows
from .substeps import pair_names

__all__ = ["PairMotion", "PythonLaw"]

Floats = NDArray[np.float64]


@dataclass
class PairMotion:
    """A pair in the middle of a sub-step, as a force law sees it.

    Parameters
    ----------
    i, j : int
        Bodies; j < 0 for a wall.
    normal : ndarray, (3,)
        From i to j.
    overlap : float, [m]
        Negative: a gap.
    rate : float, [m/s]
        Of the overlap: positive where the surfaces approach.
    slip : ndarray, (3,), [m/s]
        Velocity of the surface of i against that of j, in the tangent plane.
    duration : float, [s]
        Of the sub-step.
    reduced_mass, reduced_radius, smaller_diameter : float, [kg], [m], [m]
    is_frictionless : bool
        A free-slip face.
    memory : ndarray, (n,)
        What the law remembers of a contact; zero at its touch. The law changes it.
    """

    i: int
    j: int
    normal: Floats
    overlap: float
    rate: float
    slip: Floats
    duration: float
    reduced_mass: float
    reduced_radius: float
    smaller_diameter: float
    is_frictionless: bool
    memory: Floats


Force = Callable[[PairMotion], "float | tuple[float, Floats]"]


class PythonDriver:
    """Sub-steps of pairs whose force is a function; made by :class:`PythonLaw`.

    Parameters
    ----------
    force, contact_time, range, memory
        Those of the law.
    """

    def __init__(self, force: Force, contact_time: float, range: float, memory: int) -> None:
        self._force, self.contact_time, self.range = force, contact_time, range
        self._history = np.dtype([("memory", np.float64, (memory,))])

    @property
    def parameters(self) -> np.dtype[np.void]:
        """Row of a pair: nothing."""
        return np.dtype([])

    @property
    def history(self) -> np.dtype[np.void]:
        """Row of what a contact remembers."""
        return self._history

    def run(self, task: ContactTask, step: ContactStep, record: Callable[[NDArray[np.int32], Rows], None]) -> None:
        """Change bodies, states and histories of the task, and `step`; see :class:`rdpm.contacts.driver.Driver`."""
        b, table, active, rows = task.bodies, task.table, task.selection.active, task.selection.rows
        if len(table.lubrication):
            raise CaseError("contact.lubrication", True, "must be false with a law of Python's",
                            "it has no lubrication", "Leave it out.")  # fmt: skip
        if not len(rows):
            return
        facts = pairs_of(b, task.box, table.ids)
        step.substeps = 2 * ceil(0.5 * task.substeps_per_contact * task.dt / self.contact_time)
        h = task.dt / step.substeps
        dv = h * task.inverse_mass[:, None] * task.force
        dw = h * task.inverse_moment[:, None] * task.torque
        for n in range(step.substeps):
            _drift(task, active, 0.5 * h)
            b.velocity[active] += dv[active]
            b.angular_velocity[active] += dw[active]
            for k in rows if n % 2 == 0 else rows[::-1]:
                self._visit(task, step, k, facts[k], (dv, dw), h)
                self._record(task, k, task.time + n * h, h, record)
                if table.state["overlap"][k] > task.overlap_limit * facts["smaller_diameter"][k]:
                    i, other = pair_names(table.ids[k])
                    raise OverlapError(
                        f"overlap of body {i} and {other} at t = {task.time + (n + 1) * h:.6g} s",
                        f"{100.0 * table.state['overlap'][k] / facts['smaller_diameter'][k]:.3g} % of the diameter",
                        f"must stay below contact.overlap_limit = {100.0 * task.overlap_limit:g} %",
                        "the force that the law gives does not part them",
                        "Make it stronger.",
                    )
            _drift(task, active, 0.5 * h)
        overlaps = table.state["max_overlap"][rows]
        step.max_overlap_fraction = max(step.max_overlap_fraction, float(overlaps.max(initial=0.0)))

    def _visit(
        self, task: ContactTask, step: ContactStep, k: int, facts: Rows, load: tuple[Floats, Floats], h: float
    ) -> None:
        """Apply the impulse of one pair; its state holds overlap and rate for the record."""
        b, state = task.bodies, task.table.state
        i, j = (int(n) for n in task.table.ids[k])
        normal, distance, levers, partner = _geometry(task, i, j)
        radii = 0.5 * b.diameter[i] + (0.5 * b.diameter[j] if j >= 0 else 0.0)
        dv, dw = load
        velocity = b.velocity[i] - 0.5 * dv[i] - (b.velocity[j] - 0.5 * dv[j] if j >= 0 else partner[0])
        turning = levers[0] * (b.angular_velocity[i] - 0.5 * dw[i])
        turning = turning + levers[1] * (b.angular_velocity[j] - 0.5 * dw[j] if j >= 0 else partner[1])
        overlap, rate = float(radii - distance), float(velocity @ normal)
        state["overlap"][k], state["end"][k] = overlap, rate  # until _record
        step.min_gap = min(step.min_gap, -overlap)
        if overlap <= -self.range:
            return
        slip = velocity - rate * normal + np.cross(turning, normal)
        memory = task.table.history["memory"][k]
        given = self._force(PairMotion(
            i, j, normal, overlap, rate, slip, h, float(facts["reduced_mass"]), float(facts["reduced_radius"]),
            float(facts["smaller_diameter"]), bool(facts["is_frictionless"]), memory,
        ))  # fmt: skip
        push, along = given if isinstance(given, tuple) else (given, np.zeros(3))
        along = along - (along @ normal) * normal
        impulse = h * (along - push * normal)
        for body, sign, lever in ((i, 1.0, levers[0]), (j, -1.0, levers[1])):
            if body < 0:
                continue
            twist = lever * np.cross(normal, h * along)
            b.velocity[body] += sign * impulse * task.inverse_mass[body]
            b.angular_velocity[body] += twist * task.inverse_moment[body]
            step.impulse[body] += sign * impulse
            step.contact_impulse[body] += sign * impulse
            step.angular_impulse[body] += twist
        inverse_mass = task.inverse_mass[i] + (task.inverse_mass[j] if j >= 0 else 0.0)
        inverse = inverse_mass + levers[0] ** 2 * task.inverse_moment[i]
        inverse += levers[1] ** 2 * task.inverse_moment[j] if j >= 0 else 0.0
        tangent = h * along
        work = -h * push * (rate - 0.5 * h * push * inverse_mass) + tangent @ (slip + 0.5 * inverse * tangent)
        state["work"][k] += work

    def _record(
        self, task: ContactTask, k: int, time: float, h: float, record: Callable[[NDArray[np.int32], Rows], None]
    ) -> None:
        """Follow the contact of one pair: it lasts from touch to parting."""
        table = task.table
        state, overlap, rate = table.state[k], float(table.state["overlap"][k]), float(table.state["end"][k])
        middle = time + 0.5 * h
        touch = middle - overlap / rate if rate else middle
        if overlap > 0.0:
            if state["phase"] == APART:
                state["phase"], state["start"], state["impact_speed"] = TOUCHING, min(touch, middle), rate
            state["end"], state["rebound_speed"] = middle, -rate
            deepest = overlap / float(table.pairs["smaller_diameter"][k])
            state["max_overlap"] = max(float(state["max_overlap"]), deepest)
            return
        if state["phase"] == TOUCHING:
            row = np.zeros(1, FINISHED)
            row["pair"] = k
            for name in ("start", "max_overlap", "impact_speed", "rebound_speed", "work"):
                row[name] = state[name]
            row["end"] = touch if rate < 0.0 else middle
            record(table.ids[k : k + 1], row)
        table.state[k] = np.zeros(1, table.state.dtype)[0]
        if overlap <= -self.range:
            table.history[k] = np.zeros(1, table.history.dtype)[0]


class PythonLaw:
    """Contacts by a function of the pair's motion, called in every sub-step of every pair.

    Parameters
    ----------
    force : callable
        Takes a :class:`PairMotion`; gives the normal force [N], positive where it pushes, alone or with the tangential
        force on i, (3,) [N], whose part along the normal is left out.
    contact_time : float, [s]
        That the sub-steps resolve. > 0.
    interaction_range : float, [m]
        Gap below which the function is called; 0: in overlap alone.
    memory : int
        Numbers that a contact remembers.

    Raises
    ------
    CaseError
        An argument outside its range; lubrication beside it.

    Notes
    -----
    The force is explicit: it is taken in the middle of the sub-step, with half of its load. There is no lubrication.
    Some 30 microseconds a pair and sub-step.

    Examples
    --------
    A linear spring returns what it gets:

    >>> from rdpm.contacts import Contacts
    >>> from rdpm.grid import Box
    >>> from rdpm.particles.state import Bodies
    >>> ball = Bodies(np.array([0.01]), np.array([2500.0]), np.array([[0.05, 0.05, 0.0051]]),
    ...               np.array([[0.0, 0.0, -0.1]]))
    >>> law = PythonLaw(lambda pair: 1e4 * pair.overlap, contact_time=1e-3)
    >>> contacts = Contacts(ball, Box((0.1, 0.1, 0.1)), law)
    >>> for step in range(40):
    ...     _ = contacts.advance(step * 1e-4, 1e-4, np.zeros((1, 3)), np.zeros((1, 3)))
    >>> round(float(contacts.take_episodes()["restitution"][0]), 3)
    1.0
    """

    def __init__(self, force: Force, contact_time: float, interaction_range: float = 0.0, memory: int = 3) -> None:
        if not 0.0 < contact_time < np.inf:
            raise CaseError("law.contact_time", contact_time, "must be a finite number above 0")
        if not 0.0 <= interaction_range < np.inf:
            raise CaseError("law.interaction_range", interaction_range, "must be a finite number of at least 0")
        self._driver = PythonDriver(force, contact_time, interaction_range, memory)

    @property
    def interaction_range(self) -> float:
        """Gap below which the function is called [m]."""
        return self._driver.range

    @property
    def driver(self) -> PythonDriver:
        """Sub-steps in Python."""
        return self._driver

    def parameters(self, pairs: Rows) -> Rows:
        """None: the function knows its own; see :class:`rdpm.contacts.law.ContactLaw`."""
        return np.zeros(len(pairs), self._driver.parameters)

    def time_scale(self, pairs: Rows) -> Floats:
        """Time that the sub-steps must resolve, (K,) [s]."""
        return np.full(len(pairs), self._driver.contact_time)


def _drift(task: ContactTask, active: NDArray[np.int32], time: float) -> None:
    task.bodies.position[active] += time * task.bodies.velocity[active]
    task.rotation[active] += time * task.bodies.angular_velocity[active]


def _geometry(task: ContactTask, i: int, j: int) -> tuple[Floats, float, tuple[float, float], tuple[Floats, Floats]]:
    """Normal from i to j, distance (of a wall: from i's centre), levers, and a wall's velocity and angular velocity."""
    b, box, still = task.bodies, task.box, np.zeros(3)
    place = b.position[i]
    if j >= 0:
        apart = b.position[j] - place
        apart -= box.period * np.rint(np.divide(apart, box.period, out=np.zeros(3), where=box.period > 0.0))
        distance = float(np.linalg.norm(apart))
        share = b.diameter[i] / (b.diameter[i] + b.diameter[j])
        return apart / distance, distance, (distance * share, distance * (1.0 - share)), (still, still)
    if j <= FIRST_WALL:
        wall = box.walls[FIRST_WALL - j]
        apart, away = wall.distance(place[None], box.period)
        lever = 1.0 / wall.curvature if wall.curvature else 0.0
        return -away[0], float(apart[0]), (float(apart[0]), lever), (wall.row[3], wall.row[4])
    axis, is_upper = divmod(-1 - j, 2)
    normal = np.zeros(3)
    normal[axis] = 1.0 if is_upper else -1.0
    distance = float(box.size[axis] - place[axis] if is_upper else place[axis])
    return normal, distance, (distance, 0.0), (box.wall_velocity[-1 - j], still)
