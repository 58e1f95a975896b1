"""What a contact law is: it knows only the pair, never the neighbours, never the time step.

A law is a C++ struct (``contacts/law.hpp``), which gives the impulses of one pair over one sub-step, and a Python
class, which gives the parameters of each pair and names the driver compiled over that struct.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from .driver import Driver
from .rows import Rows

__all__ = ["ContactLaw"]

class ContactLaw(Protocol):
    """Parameters of each pair, and the driver that reads them."""

    @property
    def driver(self) -> Driver:
        """Runs the pairs over a step; its ``parameters`` and ``history`` are the dtypes of the law's rows."""

    @property
    def interaction_range(self) -> float:
        """Gap below which the force acts [m]; 0 where it acts between surfaces that overlap alone."""

    def parameters(self, pairs: Rows) -> Rows:
        """Parameters of each pair, without friction where the pair has none.

        Parameters
        ----------
        pairs : ndarray of :data:`PAIR`, (K,)

        Returns
        -------
        ndarray of ``driver.parameters``, (K,)
        """

    def time_scale(self, pairs: Rows) -> NDArray[np.float64]:
        """Time that the sub-steps must resolve: the contact's duration where it has one.

        Parameters
        ----------
        pairs : ndarray of :data:`PAIR`, (K,)

        Returns
        -------
        ndarray, (K,), [s]
        """
