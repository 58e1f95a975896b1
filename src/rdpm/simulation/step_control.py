"""Adaptive time step: longer than the contact step wherever neither the flow nor a close pair needs it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rdpm.coupling.system import System

__all__ = ["CLOSE", "GAP_CLOSING", "GAP_OPENING", "PARTS", "StepControl"]

#: A step is a whole number of parts of the contact step, so that a whole number of steps still ends at the end.
PARTS = 4

#: Parts by which a step may exceed the one before.
GROWTH = 2

#: Room left to the limit where a step grows, so that the noise of a flow does not make it flicker.
MARGIN = 0.95

#: Gap [cells] below which a pair limits the step: two, within which markers of both share cells, and half a one ahead.
CLOSE = 2.5

#: Fractions of a cell by which the gap of a close pair may close, and open, in a step longer than the contact step. The
#: speed of approach depends on the step the most: case dkt kisses 0.4 % earlier for every 0.01.
GAP_CLOSING, GAP_OPENING = 0.02, 0.1


@dataclass(frozen=True)
class StepControl:
    """Chooses each step from the state alone.

    Parameters
    ----------
    contact_step : float, [s]
        The shortest; to it the contacts' parameters are tied.
    longest : float, [s]
        What diffusion allows.
    cfl : float, [-]
        Largest fraction of a cell the flow crosses in a step longer than the contact step.
    end : float, [s]
        No step from before leads past it.

    Examples
    --------
    >>> control = StepControl(contact_step=1e-3, longest=4e-3, cfl=0.5, end=1.0)
    >>> control.parts(rate=400.0, last=12, time=0.0), control.parts(rate=0.0, last=8, time=0.0)
    (10, 10)
    """

    contact_step: float
    longest: float
    cfl: float
    end: float

    def choose(self, system: System, last: float) -> tuple[float, bool]:
        """Choose the coming step after one of length `last`.

        Returns
        -------
        dt : float, [s]
        is_isolated : bool
            No two surfaces are near each other.
        """
        rate, is_isolated = 0.0, False
        if system.fluid is not None:
            h = float(np.cbrt(np.prod(system.fluid.grid.spacing)))
            rate = system.fluid.cfl_rate / self.cfl
            speeds = system.contacts.gap_speeds(CLOSE * h)
            is_isolated = speeds is None
            if speeds is not None:
                rate = max(rate, speeds[0] / (GAP_CLOSING * h), speeds[1] / (GAP_OPENING * h))
        part = self.contact_step / PARTS
        return part * self.parts(rate, round(last / part), system.time), is_isolated

    def parts(self, rate: float, last: int, time: float) -> int:
        """Parts of the contact step in the coming step.

        Parameters
        ----------
        rate : float, [1/s]
            A step lasts at most 1 / rate, but need not be shorter than the contact step.
        last : int
            Parts in the last step.
        time : float, [s]
        """
        part = self.contact_step / PARTS
        most = 1.0 / (rate * part) if rate * part > 0.0 else math.inf
        longest = self.longest / part + 1e-6
        found = math.floor(min(most, longest))
        if found > last:
            found = max(last, min(math.floor(min(MARGIN * most, longest)), last + GROWTH))
        found = max(found, PARTS)
        left = math.ceil((self.end - time) / part - 1e-6)
        # The last two steps share what is left, so that the last is none of a few parts.
        if 0 < left < 2 * found:
            found = left if left <= found else (left + 1) // 2
        return found
