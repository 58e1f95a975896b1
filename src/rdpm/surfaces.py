"""Walls within the box: planes at any angle and cylinders, for cases, contacts, fluid and pictures alike."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Cylinder", "Plane", "Side", "Surface", "surface_of"]

Floats = NDArray[np.float64]
Vector = tuple[float, float, float]
Side = Literal["inside", "outside"]

_STILL = (0.0, 0.0, 0.0)


def _unit(vector: Vector) -> Floats:
    return np.asarray(vector, np.float64) / np.linalg.norm(vector)


def _nearest(apart: Floats, period: ArrayLike) -> Floats:
    length = np.asarray(period, np.float64)
    return apart - length * np.rint(np.divide(apart, length, out=np.zeros_like(apart), where=length > 0.0))


@dataclass(frozen=True)
class Plane:
    """A plane; bodies are on the side that its normal points to.

    Parameters
    ----------
    point : tuple of float, (3,), [m]
        On the plane.
    normal : tuple of float, (3,)
        Of any length above 0; at right angles to every periodic direction of the box.
    velocity : tuple of float, (3,), [m/s]
        In the plane.

    Examples
    --------
    >>> slope = Plane((0.0, 0.0, 1.0), (-3.0, 0.0, 4.0))
    >>> distance, away = slope.distance([[0.0, 0.0, 2.0]])
    >>> round(float(distance[0]), 12), away.tolist()
    (0.8, [[-0.6, 0.0, 0.8]])
    """

    point: Vector
    normal: Vector
    velocity: Vector = _STILL

    @property
    def curvature(self) -> float:
        """0 [1/m]."""
        return 0.0

    @property
    def row(self) -> Floats:
        """As the contact kernels read it, (5, 3)."""
        return np.array([_STILL, self.point, _unit(self.normal), self.velocity, _STILL])

    def distance(self, points: ArrayLike, period: ArrayLike = _STILL) -> tuple[Floats, Floats]:
        """Distance of points, (N, 3) [m], and unit vectors away from the wall; see :meth:`Cylinder.distance`."""
        normal = _unit(self.normal)
        return (np.asarray(points, np.float64) - self.point) @ normal, np.broadcast_to(normal, np.shape(points))


@dataclass(frozen=True)
class Cylinder:
    """A circular cylinder, a tube where bodies are inside.

    Parameters
    ----------
    point : tuple of float, (3,), [m]
        On the axis.
    axis : tuple of float, (3,)
        Of any length above 0; along or at right angles to every periodic direction of the box.
    radius : float, [m]
        > 0.
    side : {"inside", "outside"}
        Where bodies are.
    velocity : tuple of float, (3,), [m/s]
        Along the axis.
    angular_velocity : float, [rad/s]
        About the axis.

    Examples
    --------
    >>> tube = Cylinder((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), radius=2.0)
    >>> distance, away = tube.distance([[1.5, 0.0, 7.0]])
    >>> float(distance[0]), (away + 0.0).tolist()
    (0.5, [[-1.0, 0.0, 0.0]])
    """

    point: Vector
    axis: Vector
    radius: float
    side: Side = "inside"
    velocity: Vector = _STILL
    angular_velocity: float = 0.0

    @property
    def _sign(self) -> float:
        return 1.0 if self.side == "outside" else -1.0

    @property
    def curvature(self) -> float:
        """Across the axis [1/m]; negative where bodies are inside."""
        return self._sign / self.radius

    @property
    def row(self) -> Floats:
        """As the contact kernels read it, (5, 3)."""
        axis = _unit(self.axis)
        return np.array([(1.0, self._sign, self.radius), self.point, axis, self.velocity, self.angular_velocity * axis])

    def distance(self, points: ArrayLike, period: ArrayLike = _STILL) -> tuple[Floats, Floats]:
        """Distance of points from the wall, and unit vectors away from it.

        Parameters
        ----------
        points : array_like, (N, 3), [m]
        period : array_like, (3,), [m]
            Of the box; 0 in a direction that is not periodic.

        Returns
        -------
        distance : ndarray, (N,), [m]
            Negative on the side where no bodies are.
        away : ndarray, (N, 3)
            Zero on the axis of a tube.
        """
        axis = _unit(self.axis)
        apart = _nearest(np.asarray(points, np.float64) - self.point, period)
        across = apart - (apart @ axis)[:, None] * axis
        from_axis = np.linalg.norm(across, axis=1)
        away = self._sign * across / np.where(from_axis > 0.0, from_axis, 1.0)[:, None]
        return self._sign * (from_axis - self.radius), away


Surface: TypeAlias = Plane | Cylinder


def surface_of(wall: Mapping[str, Any]) -> Surface:
    """A wall of a case file.

    Parameters
    ----------
    wall : mapping of str to object
        Keys and plain SI values of one of its tables ``[[walls]]``.

    Examples
    --------
    >>> surface_of({"shape": "plane", "point": [0.0, 0.0, 0.1], "normal": [0.0, 0.0, 1.0]})
    Plane(point=(0.0, 0.0, 0.1), normal=(0.0, 0.0, 1.0), velocity=(0.0, 0.0, 0.0))
    """
    if wall["shape"] == "plane":
        return Plane(_vector(wall["point"]), _vector(wall["normal"]), _vector(wall.get("velocity") or _STILL))
    return Cylinder(
        _vector(wall["point"]), _vector(wall["axis"]), 0.5 * float(wall["diameter"]), wall.get("side") or "inside",
        _vector(wall.get("velocity") or _STILL), float(wall.get("angular_velocity") or 0.0),
    )  # fmt: skip


def _vector(given: Any) -> Vector:
    x, y, z = (float(c) for c in given)
    return x, y, z
