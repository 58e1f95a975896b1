"""What a contact law is: it turns the masses of a pair into the numbers of its springs and dashpots."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

__all__ = ["ContactLaw", "PairParameters"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class PairParameters:
    """Parameters of M pairs.

    Parameters
    ----------
    normal_stiffness, normal_damping : ndarray, (M,), [N/m], [N s/m]
    tangential_stiffness, tangential_damping : ndarray, (M,), [N/m], [N s/m]
    friction : ndarray, (M,), [-]
        Coulomb's coefficient; 0: the surfaces are smooth and the tangential part is not computed.
    """

    normal_stiffness: Floats
    normal_damping: Floats
    tangential_stiffness: Floats
    tangential_damping: Floats
    friction: Floats


class ContactLaw(Protocol):
    """A contact law knows only the pair: never the neighbours, never the time step."""

    @property
    def ending(self) -> str:
        """``"zero-force"`` (no attraction) or ``"zero-overlap"``."""

    def parameters(self, reduced_mass: Floats, diameter: Floats) -> PairParameters:
        """Parameters of each pair.

        Parameters
        ----------
        reduced_mass : ndarray, (M,), [kg]
            The body's own mass against a wall or a body of prescribed motion. > 0.
        diameter : ndarray, (M,), [m]
            Of the smaller body. > 0.
        """

    def time_scale(self, reduced_mass: Floats, diameter: Floats) -> Floats:
        """Time that the sub-steps must resolve: the contact's duration where it has one.

        Parameters
        ----------
        reduced_mass, diameter : ndarray, (M,), [kg], [m]
            As in :meth:`parameters`.

        Returns
        -------
        ndarray, (M,), [s]
        """
