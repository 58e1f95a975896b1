"""Contacts of a set of bodies: who meets whom, the motion over a step, what each contact did."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm import _core
from rdpm.errors import CaseError
from rdpm.grid import Box
from rdpm.particles.state import Bodies

from .driver import ContactStep, ContactTask, Room
from .episodes import EPISODE, Episodes
from .history import History
from .law import ContactLaw
from .lubrication import Lubrication
from .neighbour_list import NeighbourList, Selection
from .neighbours import Neighbours, gaps_and_rates
from .pair_table import KindParameters, PairTable, pairs_of
from .rows import STATE, TOUCHING, Rows, as_bytes

__all__ = ["Contacts"]

Floats = NDArray[np.float64]


class Contacts:
    r"""Contacts of a set of bodies, their history and their episodes.

    The law's driver moves the bodies that have a pair (`rdpm.contacts.substeps`), the others fly freely.

    Parameters
    ----------
    bodies : Bodies
        N spheres; :meth:`advance` changes their state.
    box : Box
    law : ContactLaw
    lubrication : Lubrication, optional
    substeps_per_contact : int
        Sub-steps in the shortest contact of the pairs in interaction range. >= 10.
    overlap_limit : float, [-]
        Of the smaller diameter, 0 < limit < 1; more raises :class:`~rdpm.errors.OverlapError`.
    viscosity : float, optional, [Pa s]
        For the Stokes numbers of the episodes; that of ``lubrication`` when left out.
    threads : int
        Results do not depend on it.

    Raises
    ------
    CaseError
        An argument outside its range.

    References
    ----------
    .. [1] Cundall, Strack, Geotechnique 29 (1979) 47-65; Kempe, Froehlich, J. Fluid Mech. 709 (2012) 445-489
       (sub-steps under a constant fluid force).

    Examples
    --------
    A ball dropped on the floor, dry:

    >>> from rdpm.contacts import SoftSphere
    >>> ball = Bodies(np.array([0.01]), np.array([2500.0]), np.array([[0.05, 0.05, 0.02]]))
    >>> box = Box((0.1, 0.1, 0.1))
    >>> contacts = Contacts(ball, box, SoftSphere.from_contact_time(restitution=0.5, contact_time=1e-3))
    >>> weight = ball.mass[:, None] * [[0.0, 0.0, -9.81]]
    >>> for step in range(700):
    ...     _ = contacts.advance(step * 1e-4, 1e-4, weight, np.zeros((1, 3)))
    >>> bool(abs(contacts.take_episodes()["restitution"][0] - 0.5) < 0.01)
    True
    """

    def __init__(
        self,
        bodies: Bodies,
        box: Box,
        law: ContactLaw,
        lubrication: Lubrication | None = None,
        substeps_per_contact: int = 100,
        overlap_limit: float = 0.2,
        viscosity: float | None = None,
        threads: int = 1,
    ) -> None:
        if not substeps_per_contact >= 10:
            raise CaseError("contact.substeps", substeps_per_contact, "must be at least 10",
                            "touch and end are not resolved", "Raise it.")  # fmt: skip
        if not 0.0 < overlap_limit < 1.0:
            rule = "must be in 0 < limit < 1"
            raise CaseError("contact.overlap_limit", overlap_limit, rule, cure="Correct this value.")
        self.bodies, self.box, self.law, self.lubrication = bodies, box, law, lubrication
        self.substeps_per_contact, self.overlap_limit, self.threads = substeps_per_contact, overlap_limit, threads
        self._list, self._close, self._room = NeighbourList(bodies, box), Neighbours(bodies, box), Room()
        self._lubrication_range = 0.0
        if lubrication and len(bodies):
            self._lubrication_range = lubrication.largest_gap(0.5 * bodies.diameter, bool(box.walls))
        if viscosity is None and lubrication:
            viscosity = lubrication.viscosity
        self._episodes, self._kinds = Episodes(bodies, box, viscosity), KindParameters(bodies, law, len(box.walls))
        self._history = History(len(bodies), law.driver.history, box.partners)
        self._table = self._table_of(self._list.ids)

    def advance(
        self,
        time: float,
        dt: float,
        force: Floats,
        torque: Floats,
        inertia: Floats | None = None,
        moment: Floats | None = None,
    ) -> ContactStep:
        """Change the bodies' state from ``time`` to ``time + dt``.

        Positions are wrapped into periodic directions. A body of prescribed motion keeps its velocity.

        Parameters
        ----------
        time, dt : float, [s]
            dt > 0.
        force, torque : ndarray, (N, 3), [N], [N m]
            On each body, constant over the step; gravity included.
        inertia, moment : ndarray, (N,), [kg], [kg m^2], optional
            Taken instead of the bodies' mass and moment of inertia, to move them; the pairs' stiffness and
            damping follow from the mass all the same.

        Returns
        -------
        ContactStep

        Raises
        ------
        OverlapError
            A pair passed the overlap limit; the bodies are left in the middle of the step.
        """
        b = self.bodies
        n = len(b)
        force, torque = np.ascontiguousarray(force), np.ascontiguousarray(torque)
        free = b.is_free
        inverse_mass = free / (b.mass if inertia is None else inertia)
        inverse_moment = free / (b.moment_of_inertia if moment is None else moment)
        # A spring under load may throw its bodies apart.
        margin = max(self._lubrication_range, self.law.interaction_range) + 2.0 * self._history.largest_overlap
        reach, is_new = self._list.update(force, inverse_mass, dt, margin)
        if is_new:
            self._table = self._table_of(self._list.ids)
        linear, angular, by_contact, by_lubrication = np.zeros((4, n, 3))
        step = ContactStep(linear, angular, by_contact, by_lubrication, np.zeros(n))
        rotation, is_active = np.zeros((n, 3)), np.zeros(n, np.bool_)
        chosen = self._select(step, reach, is_new, dt)
        is_active[chosen.active] = True
        self._resolve(step, ContactTask(
            b, self.box, self._table, chosen, self._list.radius, rotation, force, torque, inverse_mass, inverse_moment,
            time, dt, self.substeps_per_contact, self.overlap_limit, self.threads, self._room,
        ))  # fmt: skip
        _core.end_step(
            self.box.table, b.position, b.velocity, b.angular_velocity, b.orientation, b.crossings, rotation,
            force, torque, inverse_mass, inverse_moment, is_active, dt, self.threads if n >= 10_000 else 1,
        )  # fmt: skip
        return step

    def _table_of(self, ids: NDArray[np.int32]) -> PairTable:
        return PairTable(ids, self.bodies, self.box, self.law, self._kinds, self.lubrication)

    def _record(self, step: ContactStep, dt: float, ids: NDArray[np.int32], finished: Rows) -> None:
        """Keep finished contacts; note their speeds at touch in `step`."""
        self._episodes.add(ids, finished, dt)
        for body in ids.T:
            is_body = body >= 0
            np.fmax.at(step.impact_speed, body[is_body], finished["impact_speed"][is_body])

    def _select(self, step: ContactStep, reach: float, is_new: bool, dt: float) -> Selection:
        """Pairs of the table that may meet; the contacts of those that cannot are over."""
        table = self._table
        if is_new:
            lost = self._history.carry_to(table)
            if len(lost[0]):
                self._record(step, dt, *lost)
        chosen = self._list.select(reach, table.times, table.state)
        if len(chosen.lost):
            lost_rows = np.sort(chosen.lost)
            self._record(step, dt, table.ids[lost_rows], table.state[lost_rows])
            table.state[lost_rows], table.history[lost_rows] = np.zeros((), STATE), np.zeros((), table.history.dtype)
        return chosen

    def _resolve(self, step: ContactStep, task: ContactTask) -> None:
        """Fill `step`; move the bodies of the task, carry and keep the history."""

        def record(ids: NDArray[np.int32], finished: Rows) -> None:
            self._record(step, task.dt, ids, finished)

        step.pairs = len(task.selection)
        self.law.driver.run(task, step, record)
        step.touching, overlap = _core.contacts_under_way(
            self.box.table, task.table.ids, as_bytes(task.table.state), step.impact_speed
        )
        self._history.keep(step.touching, overlap)

    def close_pairs(self, gap: float) -> NDArray[np.int32]:
        """Pairs of surfaces nearer than this [m], of whatever motion, (K, 2); a negative second id is a face."""
        still = np.zeros((len(self.bodies), 3))
        return self._close.pairs(still, np.ones(len(self.bodies)), 0.0, gap)

    def gap_speeds(self, largest: float) -> tuple[float, float] | None:
        """Largest speeds at which gaps below `largest` [m] close and open [m/s]; None where there is no such gap.

        A spring under load counts as if it closed with the speed it would give back: at the peak of an impact nothing
        moves.
        """
        ids = self.close_pairs(largest)
        if not len(ids):
            return None
        gap, rate = gaps_and_rates(self.bodies, self.box, ids)
        closing = np.maximum(-rate, 0.0)
        pairs = pairs_of(self.bodies, self.box, ids)
        loaded = (gap < 0.0) & np.isfinite(pairs["reduced_mass"])
        if loaded.any():
            closing[loaded] -= np.pi * gap[loaded] / self.law.time_scale(pairs[loaded])
        return float(closing.max()), float(rate.max(initial=0.0))

    def take_episodes(self) -> NDArray[np.void]:
        """Give the contacts that have finished since the last call, and forget them.

        Returns
        -------
        ndarray of :data:`rdpm.contacts.EPISODE`
            In the order of their end.
        """
        return self._episodes.take()

    def close_open(self, time: float, dt: float) -> None:
        """End the record of the pairs still in touch, at the end of a run; their springs are forgotten.

        Parameters
        ----------
        time, dt : float, [s]
            When, and the time step.
        """
        ids, states, _ = self._history.rows()
        states = states.copy()
        touching = states["phase"] == TOUCHING
        states["end"][touching] = time
        states["rebound_speed"][touching] = np.nan
        self._episodes.add(ids, states, dt)
        self._history = History(len(self.bodies), self.law.driver.history, self.box.partners)
        self._table = self._table_of(self._list.ids)
        self._history.carry_to(self._table)

    def state(self) -> dict[str, NDArray[Any]]:
        """All that the next step needs beside the bodies, as copies.

        Returns
        -------
        dict of str to ndarray
            ``pairs`` (K, 2); ``state/...`` and ``history/...``, a field of the rows each, (K, ...);
            ``episodes/...``, a field of :data:`rdpm.contacts.EPISODE` each, (E,); ``neighbours/...``: what the list
            of pairs, and so their order, was made from.
        """
        ids, states, histories = self._history.rows()
        result: dict[str, NDArray[Any]] = {"pairs": ids.copy()}
        for name, array in (("state", states), ("history", histories), ("episodes", self._episodes.rows)):
            result |= {f"{name}/{field}": array[field].copy() for field in array.dtype.names or ()}
        return result | {f"neighbours/{name}": array for name, array in self._list.state().items()}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Take over what :meth:`state` gave; the next step is then bit-identical.

        Parameters
        ----------
        state : mapping of str to ndarray

        Notes
        -----
        Of a law that remembers other things no contact is taken over: one under way begins anew.
        """

        def rows(name: str, dtype: np.dtype[np.void], count: int) -> Rows:
            result = np.zeros(count, dtype)
            for field in dtype.names or ():
                result[field] = state[f"{name}/{field}"]
            return result

        ids = np.array(state["pairs"], np.int32).reshape(-1, 2)
        history = self._history = History(len(self.bodies), self.law.driver.history, self.box.partners)
        dtype = self.law.driver.history
        remembered = {key.removeprefix("history/") for key in state if key.startswith("history/")}
        if remembered == set(dtype.names or ()):
            history.restore(ids, rows("state", STATE, len(ids)), rows("history", dtype, len(ids)))
        self._list.restore({name: state[f"neighbours/{name}"] for name in self._list.state()})
        self._table = self._table_of(self._list.ids)
        history.carry_to(self._table)
        self._episodes.rows = rows("episodes", EPISODE, len(state["episodes/i"]))
