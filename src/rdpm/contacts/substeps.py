"""Motion of the bodies over one time step, contacts and lubrication resolved in sub-steps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import ceil, inf
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm import _core
from rdpm.errors import CaseError, OverlapError
from rdpm.particles.state import Bodies

from .episodes import EPISODE, FINISHED_COLUMNS, Episodes
from .history import LAW_COLUMNS, PHASE_TOUCHING, STATE_COLUMNS, History
from .law import ContactLaw
from .lubrication import Lubrication
from .neighbours import Neighbours, gaps_and_rates
from .walls import SIDES, Box

__all__ = ["ContactStep", "Contacts"]

Floats = NDArray[np.float64]


@dataclass
class ContactStep:
    """What contacts and lubrication did in one step.

    Parameters
    ----------
    impulse, angular_impulse : ndarray, (N, 3), [N s], [N m s]
        Given to each body by contacts and lubrication, prescribed bodies included.
    contact_impulse : ndarray, (N, 3), [N s]
        The part of ``impulse`` that is contact.
    min_gap : float, [m]
        Smallest gap met in the sub-steps; inf where no pair was within reach.
    max_overlap_fraction : float, [-]
        Largest peak overlap of the contacts of this step, of the smaller diameter.
    pairs, touching : int
        Pairs that were resolved, and those still in contact at the end.
    substeps : int
        0 where every body flew freely.
    """

    impulse: Floats
    angular_impulse: Floats
    contact_impulse: Floats
    min_gap: float = inf
    max_overlap_fraction: float = 0.0
    pairs: int = 0
    touching: int = 0
    substeps: int = 0


class Contacts:
    r"""Contacts of a set of bodies, their history and their episodes.

    Each sub-step drifts the bodies by half, adds what the outer forces give, visits the pairs in order of
    their ids (odd sub-steps backwards), applies each impulse at once, and drifts the other half. Touch and
    end of a contact are located inside the sub-step.

    Parameters
    ----------
    bodies : Bodies
        N spheres; :meth:`advance` changes their state.
    box : Box
    law : ContactLaw
    lubrication : Lubrication, optional
    substeps_per_contact : int
        Sub-steps in the shortest contact of the pairs in reach. >= 10.
    overlap_limit : float, [-]
        Of the smaller diameter, 0 < limit < 1; more raises :class:`~rdpm.errors.OverlapError`.
    viscosity : float, optional, [Pa s]
        For the Stokes numbers of the episodes; that of ``lubrication`` when left out.

    Raises
    ------
    CaseError
        An argument outside its range.

    References
    ----------
    .. [1] Cundall, Strack, Geotechnique 29 (1979) 47-65; Kempe, Froehlich, J. Fluid Mech. 709 (2012) 445-489
       (sub-steps under a held fluid force).

    Examples
    --------
    A ball dropped on the floor, dry:

    >>> from rdpm.contacts import Box, SoftSphere
    >>> ball = Bodies(np.array([0.01]), np.array([2500.0]), np.array([[0.05, 0.05, 0.02]]))
    >>> box = Box((0.1, 0.1, 0.1), (False,) * 3, (True,) * 3)
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
    ) -> None:
        if not substeps_per_contact >= 10:
            raise CaseError("contact.substeps", substeps_per_contact, "must be at least 10",
                            "touch and end are not resolved", "Raise it.")  # fmt: skip
        if not 0.0 < overlap_limit < 1.0:
            rule = "must be in 0 < limit < 1"
            raise CaseError("contact.overlap_limit", overlap_limit, rule, cure="Correct this value.")
        self.bodies, self.box, self.law, self.lubrication = bodies, box, law, lubrication
        self.substeps_per_contact, self.overlap_limit = substeps_per_contact, overlap_limit
        self._neighbours, self._history = Neighbours(bodies, box), History(len(bodies))
        self._close = Neighbours(bodies, box)
        self._film_reach = lubrication.largest_gap(0.5 * bodies.diameter) if lubrication and len(bodies) else 0.0
        film_viscosity = lubrication.viscosity if lubrication else None
        self._episodes = Episodes(bodies, film_viscosity if viscosity is None else viscosity)
        self._pairs, self._motion = np.empty((0, 2), np.int32), np.empty(0, np.int32)
        self._laws, self._shortest = np.empty((0, len(LAW_COLUMNS))), inf

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
            On each body, held over the step; gravity included.
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
        free = b.is_free
        inverse_mass = free / (b.mass if inertia is None else inertia)
        inverse_moment = free / (b.moment_of_inertia if moment is None else moment)
        film = self._film_reach
        margin = film + 2.0 * self._history.largest_overlap  # a spring under load may throw its bodies apart
        pairs = self._neighbours.pairs(force, inverse_mass, dt, margin)
        step = ContactStep(*np.zeros((3, n, 3)))
        turn, is_active = np.zeros((n, 3)), np.zeros(n, np.bool_)
        if len(pairs) or len(self._history):
            inverse = inverse_mass, inverse_moment
            self._resolve(step, pairs, turn, is_active, time, dt, (force, torque), inverse)
        _core.end_step(
            self.box.table, b.position, b.velocity, b.angular_velocity, b.orientation, b.crossings, turn,
            force, torque, inverse_mass, inverse_moment, is_active, dt,
        )  # fmt: skip
        return step

    def _resolve(
        self,
        step: ContactStep,
        pairs: NDArray[np.int32],
        turn: Floats,
        is_active: NDArray[np.bool_],
        time: float,
        dt: float,
        loads: tuple[Floats, Floats],
        inverse: tuple[Floats, Floats],
    ) -> None:
        """Fill ``step``, ``turn`` and ``is_active``; move the bodies that have a pair."""
        b = self.bodies
        self._set_laws(pairs)
        states, is_lost = self._history.carried_to(pairs)
        if is_lost.any():
            self._record(self._history.pairs[is_lost], self._history.states[is_lost], dt)
        is_active[pairs[pairs >= 0]] = True
        active = np.flatnonzero(is_active).astype(np.int32)
        step.pairs = len(pairs)
        if len(pairs):  # an even number: what the order of the pairs does cancels between two sub-steps
            step.substeps = 2 * ceil(0.5 * self.substeps_per_contact * dt / self._shortest)
        h = dt / max(step.substeps, 1)
        kick, spin = (h * inv[:, None] * load for inv, load in zip(inverse, loads, strict=True))
        finished = np.empty((max(64, 2 * len(pairs)), len(FINISHED_COLUMNS)))
        at = 0
        while at < step.substeps:
            at, count, failed, min_gap, max_overlap = _core.run_substeps(
                self.box.table, b.position, b.velocity, b.angular_velocity, turn, kick, spin, *inverse,
                self._neighbours.radius, step.impulse, step.angular_impulse, step.contact_impulse, active,
                pairs, self._laws, states, finished, time, h, self.overlap_limit,
                self.law.ending == "zero-force", at, step.substeps,
            )  # fmt: skip
            step.min_gap = min(step.min_gap, min_gap)
            step.max_overlap_fraction = max(step.max_overlap_fraction, max_overlap)
            if count:
                done = finished[:count]
                self._episodes.add(pairs[done[:, 0].astype(np.int64)], done, dt)
            if failed >= 0:
                self._refuse_overlap(pairs[failed], states[failed], time + at * h)
        self._history.keep(pairs, states)
        step.touching = len(self._history)

    def _set_laws(self, pairs: NDArray[np.int32]) -> None:
        """Look up the parameters of the pairs, unless they are the pairs of the last step."""
        b = self.bodies
        if np.array_equal(pairs, self._pairs) and np.array_equal(b.motion, self._motion):
            return
        self._pairs, self._motion = pairs.copy(), b.motion.copy()
        i, j = self._pairs.T
        wall = j < 0
        other = np.where(wall, i, j)
        mass, diameter = self._sizes(pairs)
        # Few kinds of pairs, many pairs: the law is asked once a kind.
        kinds, kind = np.unique(mass + 1j * diameter, return_inverse=True)
        self._laws = laws = np.zeros((len(pairs), len(LAW_COLUMNS)))
        if not len(pairs):
            return
        of_kind = self.law.parameters(kinds.real.copy(), kinds.imag.copy())
        self._shortest = float(self.law.time_scale(kinds.real.copy(), kinds.imag.copy()).min())
        for column, values in enumerate(vars(of_kind).values()):
            laws[:, column] = values[kind]
        if self.lubrication:
            radius = self._neighbours.radius
            radii = radius[i], np.where(wall, inf, radius[other])
            films = self.lubrication.coefficients(*radii)
            laws[:, 5:8] = np.transpose(films)
            laws[:, 8:10] = np.transpose(self.lubrication.reach(*radii))
        laws[wall & self.box.is_slip_side[np.where(wall, -1 - j, 0)], 2:] = 0.0

    def _sizes(self, pairs: NDArray[np.int32]) -> tuple[Floats, Floats]:
        """Reduced mass, inf where neither moves freely, and smaller diameter of each pair."""
        b, (i, j) = self.bodies, pairs.T
        other = np.where(j < 0, i, j)
        inverse_mass = b.is_free / b.mass
        with np.errstate(divide="ignore"):
            mass = 1.0 / (inverse_mass[i] + np.where(j < 0, 0.0, inverse_mass[other]))
        return mass, np.minimum(b.diameter[i], b.diameter[other])

    def _record(self, pairs: NDArray[np.int32], states: Floats, dt: float) -> None:
        """Record contacts from what is remembered of them."""
        columns = [STATE_COLUMNS.index(name) for name in FINISHED_COLUMNS[1:]]
        self._episodes.add(pairs, np.column_stack([np.zeros(len(pairs)), states[:, columns]]), dt)

    def _refuse_overlap(self, pair: NDArray[np.int32], state: Floats, time: float) -> None:
        i, j = (int(k) for k in pair)
        of = dict(zip(STATE_COLUMNS, state, strict=True))
        smaller = self.bodies.diameter[i] if j < 0 else min(self.bodies.diameter[i], self.bodies.diameter[j])
        other = f"the side {SIDES[-1 - j]}" if j < 0 else f"body {j}"
        raise OverlapError(
            f"overlap of body {i} and {other} at t = {time:.6g} s",
            f"{100.0 * of['overlap'] / smaller:.3g} % of the diameter",
            f"must stay below contact.overlap_limit = {100.0 * self.overlap_limit:g} %",
            f"they met at {of['impact_speed']:.3g} m/s and the contact is too soft for that",
            "Stiffen it: lower contact.contact_steps or time.step, or give a higher stiffness.",
        )

    @property
    def touching(self) -> NDArray[np.int32]:
        """Pairs in contact at the end of the last step, (K, 2); a negative second id is a wall."""
        return self._history.pairs

    def close_pairs(self, gap: float) -> NDArray[np.int32]:
        """Pairs of surfaces nearer than this [m], of whatever motion, (K, 2); a negative second id is a side."""
        still = np.zeros((len(self.bodies), 3))
        return self._close.pairs(still, np.ones(len(self.bodies)), 0.0, gap)

    def gap_speeds(self, reach: float) -> tuple[float, float] | None:
        """Largest speeds at which gaps below `reach` [m] close and open [m/s]; None where there is no such gap.

        A spring under load counts as if it closed with the speed it would give back: at the turn of an impact nothing
        moves.
        """
        pairs = self.close_pairs(reach)
        if not len(pairs):
            return None
        gap, rate = gaps_and_rates(self.bodies, self.box, pairs)
        closing = np.maximum(-rate, 0.0)
        mass, diameter = self._sizes(pairs)
        loaded = (gap < 0.0) & np.isfinite(mass)
        if loaded.any():
            closing[loaded] -= np.pi * gap[loaded] / self.law.time_scale(mass[loaded], diameter[loaded])
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
        states = self._history.states.copy()
        touching = states[:, STATE_COLUMNS.index("phase")] == PHASE_TOUCHING
        states[touching, STATE_COLUMNS.index("end")] = time
        states[touching, STATE_COLUMNS.index("rebound_speed")] = np.nan
        self._record(self._history.pairs, states, dt)
        self._history = History(len(self.bodies))

    def state(self) -> dict[str, NDArray[Any]]:
        """All that the next step needs beside the bodies, as copies.

        Returns
        -------
        dict of str to ndarray
            ``pairs`` (K, 2), ``history`` (K, 11), ``episode_pairs`` (E, 2), ``episodes`` (E, 9).
        """
        rows, names = self._episodes.rows, EPISODE.names or ()
        return {
            "pairs": self._history.pairs.copy(),
            "history": self._history.states.copy(),
            "episode_pairs": np.column_stack([rows["i"], rows["j"]]).astype(np.int64),
            "episodes": np.column_stack([rows[name] for name in names[3:]]),
        }

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Take over what :meth:`state` gave; the next step is then bit-identical.

        Parameters
        ----------
        state : mapping of str to ndarray
        """
        self._history.pairs = np.array(state["pairs"], np.int32).reshape(-1, 2)
        self._history.states = np.array(state["history"], np.float64).reshape(-1, len(STATE_COLUMNS))
        rows = np.empty(len(state["episode_pairs"]), EPISODE)
        rows["i"], rows["j"] = np.transpose(np.reshape(state["episode_pairs"], (-1, 2)))
        rows["kind"] = np.where(rows["j"] < 0, "sphere-wall", "sphere-sphere")
        for column, name in enumerate((EPISODE.names or ())[3:]):
            rows[name] = state["episodes"][:, column]
        self._episodes.rows = rows
