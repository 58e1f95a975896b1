"""The loop over time: a coupled system, its time step, checks after each step, callbacks."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable
from typing import Any, Self

from rdpm.coupling.step import step
from rdpm.coupling.system import System
from rdpm.errors import CaseError
from rdpm.fluid import Fluid
from rdpm.parallel.agreement import together
from rdpm.particles.state import Bodies
from rdpm.simulation.guards import check_alike, check_divergence, check_step
from rdpm.simulation.record import Record
from rdpm.simulation.schedule import Every
from rdpm.simulation.step_control import StepControl

__all__ = ["TimeLoop"]

#: Steps between two checks of the divergence, which read the whole velocity once more, and of bodies on all ranks.
DIVERGENCE_EVERY = 100

#: Share of a step that a time may be off by the sum of many steps.
ROUND_OFF = 1e-6

Progress = Callable[[int, float, float], None]


class TimeLoop:
    """Advances a coupled system and calls back.

    Parameters
    ----------
    system : System
    dt : float, [s]
        > 0.
    step_control : StepControl, optional
        Chooses every step; without it, all are `dt` long.

    Attributes
    ----------
    dt : float, [s]
        Of all steps; with a step control, of the last one before it was fitted to a time asked.
    last_dt : float, [s]
        Of the last step, which `run` shortens to end at the time asked.
    shortest_dt, longest_dt : float, [s]
        Of the steps done.
    bodies : Bodies
        ``position``, ``velocity`` ... are the arrays the kernels work on.
    fluid : Fluid or None
        ``u``, ``v``, ``w``, ``p`` likewise.
    records : dict of str to Record
        What `record` began, by name.
    """

    def __init__(self, system: System, dt: float, step_control: StepControl | None = None) -> None:
        self.system, self.dt, self.step_control = system, dt, step_control
        self.last_dt = self.shortest_dt = self.longest_dt = 0.0
        self.wall_seconds = 0.0
        self.max_divergence = 0.0
        self.records: dict[str, Record] = {}
        self._callbacks: list[tuple[int, Callable[[Any], None]]] = []
        self._asked: list[Every] = []

    @property
    def bodies(self) -> Bodies:
        """State of the bodies."""
        return self.system.bodies

    @property
    def fluid(self) -> Fluid | None:
        """State of the fluid; None in a dry case."""
        return self.system.fluid

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self.system.time

    @property
    def steps(self) -> int:
        """Steps done."""
        return self.system.steps

    def on_step(self, callback: Callable[[Self], None], every: int = 1) -> None:
        """Call `callback` with this loop after every so many steps.

        Parameters
        ----------
        callback : callable
        every : int
            >= 1.
        """
        if every < 1:
            raise ValueError(f"every = {every}: must be at least 1")
        self._callbacks.append((every, callback))

    def asked(self, interval: float) -> Every:
        """Make a schedule at whose times adaptive steps end, unless they would be shorter than the contact step for it.

        Parameters
        ----------
        interval : float, [s]
            0: never due.

        Returns
        -------
        Every
        """
        every = Every(interval)
        if self.step_control is not None and interval >= self.step_control.contact_step:
            self._asked.append(every)
        return every

    def record(self, name: str, function: Callable[[Self], Any], every: float) -> Record:
        """Keep what a function gives, now and at every multiple of an interval.

        Parameters
        ----------
        name : str
            Of the record, and of its column where the function gives one number.
        function : callable
            Takes this loop; see `Record` for what it may give.
        every : float, [s]
            > 0. Due is the first step at or after a multiple; adaptive steps end at it.

        Returns
        -------
        Record
            Also in `records`.

        Raises
        ------
        CaseError
            The name is taken or is no name; the function fails, or gives something else.
        """
        record = Record(name, function, self.asked(every))
        if name in self.records:
            rule = "must have a name of its own"
            raise CaseError(record.place, None, rule, "there is one of that name", "Choose another.")
        record.step(self)
        self.records[name] = record
        self.on_step(record.step)
        return record

    def advance(self, left: float = math.inf) -> None:
        """Make one step, check it, and call back.

        Parameters
        ----------
        left : float, [s]
            Steps end there: the last two share what is left, the last one is no longer.

        Raises
        ------
        GuardError
            The step's numbers cannot be trusted.
        """
        begin = clock.perf_counter()
        self.system.watch.start()
        is_isolated = False
        if self.step_control is not None:
            self.dt, is_isolated = self.step_control.choose(self.system, self.dt)
            left = min([left, *(every.next_after(self.time) - self.time for every in self._asked)])
        self.last_dt = dt = _fitted(self.dt, left)
        together(self.system.ranks, lambda: self._step(dt, is_isolated))
        if self.steps % DIVERGENCE_EVERY == 0:
            self.check_divergence()
            together(self.system.ranks, lambda: check_alike(self.system))
        self.wall_seconds += clock.perf_counter() - begin
        for every, callback in self._callbacks:
            if self.steps % every == 0:
                callback(self)

    def _step(self, dt: float, is_isolated: bool) -> None:
        """One step that passes its guards."""
        try:
            step(self.system, dt, is_isolated)
        except ValueError:
            # A kernel refuses bodies that are not finite in the middle of a step: the guard says which.
            self.system.steps, self.system.time = self.steps + 1, self.time + dt
            check_step(self.system, dt)
            raise
        self.shortest_dt, self.longest_dt = min(self.shortest_dt or dt, dt), max(self.longest_dt, dt)
        check_step(self.system, dt)

    def check_divergence(self) -> float:
        """Largest divergence now [1/s]; remembered over the run."""
        divergence = together(self.system.ranks, lambda: check_divergence(self.system))
        self.max_divergence = max(self.max_divergence, divergence)
        return divergence

    def run(self, until: float, progress: bool | Progress = False) -> None:
        """Make steps until the time is reached; the last one ends at it.

        Parameters
        ----------
        until : float, [s]
        progress : bool or callable
            True shows a bar; a callable gets step, time and `until` after each step.

        Raises
        ------
        GuardError
            The run was stopped; the state is that of the failed step.
        """
        if progress is True:
            from rdpm.simulation.progress import bar

            with bar(until) as tell:
                self.run(until, tell)
            return
        while (left := until - self.time) > ROUND_OFF * self.dt:
            self.advance(left)
            if progress:
                progress(self.steps, self.time, until)


def _fitted(dt: float, left: float) -> float:
    """A step of at most `dt`, so that steps end where only `left` is left; none of a small part of `dt`."""
    room = ROUND_OFF * dt
    if left < dt - room:
        return left
    return 0.5 * left if dt + room < left < 2.0 * dt - room else dt
