"""Impacts and pressed contacts: which contacts have a restitution."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["LEAST_STOKES", "MOST_CONTACT_TIMES", "is_pressed"]

#: Stokes number of an impact below which the fluid sets both speeds.
LEAST_STOKES = 1.0

#: Designed contact times beyond which a force holds the bodies together.
MOST_CONTACT_TIMES = 3.0


def is_pressed(
    kind: ArrayLike, stokes_number: ArrayLike, duration: ArrayLike, contact_times: Mapping[str, float]
) -> NDArray[np.bool_]:
    """Tell contacts in which something presses the bodies together from impacts; they have no restitution.

    Pressed are those whose Stokes number is below 1, and those that lasted more than three contact times of the design:
    both speeds are then those of the flow or of a load, not of an impact.

    Parameters
    ----------
    kind : array_like of str, (K,)
        "sphere-sphere" or "sphere-wall".
    stokes_number : array_like, (K,), [-]
        Of the impact; nan when dry.
    duration : array_like, (K,), [s]
    contact_times : mapping of str to float, [s]
        Of the design, by kind; the longest where there are several of a kind. One that is missing judges nothing.

    Returns
    -------
    ndarray of bool, (K,)

    Examples
    --------
    >>> is_pressed(["sphere-wall"] * 3, [0.5, 20.0, 20.0], [0.01, 0.01, 0.05], {"sphere-wall": 0.012}).tolist()
    [True, False, True]
    """
    stokes, span = np.asarray(stokes_number, np.float64), np.asarray(duration, np.float64)
    designed = np.array([contact_times.get(str(name), np.inf) for name in np.asarray(kind)])
    return np.asarray((stokes < LEAST_STOKES) | (span > MOST_CONTACT_TIMES * designed))
