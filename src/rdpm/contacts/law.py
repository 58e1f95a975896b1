"""What a contact law is: it knows only the pair, never the neighbours, never the time step.

A law is a C++ struct (``contacts/law.hpp``), which gives the impulses of one pair over one sub-step, and a Python
class, which gives the parameters of each pair and names the driver compiled over that struct.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from .rows import Rows

if TYPE_CHECKING:
    from .driver import Driver

__all__ = ["PAIR", "ContactLaw"]

PAIR = np.dtype(
    [
        ("reduced_mass", np.float64),
        ("reduced_radius", np.float64),
        ("smaller_diameter", np.float64),
        ("is_frictionless", np.bool_),
    ]
)
r"""What a law may know of a pair.

``reduced_mass`` :math:`(1/m_i+1/m_j)^{-1}` [kg], the body's own mass against a wall or a body of prescribed motion;
``reduced_radius`` :math:`a_ia_j/(a_i+a_j)` [m], the body's radius against a wall; ``smaller_diameter`` [m];
``is_frictionless``: a free-slip face, which pushes along its normal alone.
"""


class ContactLaw(Protocol):
    """Parameters of each pair, and the driver that reads them."""

    @property
    def driver(self) -> Driver:
        """Runs the pairs over a step; its ``parameters`` and ``history`` are the dtypes of the law's rows."""

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
