"""Groups of bodies in a case file: what they are, where they start, how they move."""

from __future__ import annotations

import bisect
import itertools
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, model_validator

from rdpm.config.fields import (
    Model,
    Vector,
    Vectors,
    items,
    number,
    placed,
    to_number,
    to_vector,
    to_vectors,
    vector,
    whole,
    whole_vector,
)
from rdpm.config.rule import RuleError, listed

__all__ = ["MAX_BODIES", "BodyGroup", "Gap", "Lattice", "Motion", "Packing", "VectorTable"]

MAX_BODIES = 1_000_000  # beyond it the case file is mistaken: 4 cells a diameter would not fit a memory

PLACES = ("centers", "file", "lattice", "packing")


class VectorTable(Model):
    """A vector given at some times, linear between them and constant outside.

    Attributes
    ----------
    times : tuple of float, [s]
        Increasing.
    values : tuple of 3-tuples, [m/s] or [rad/s]
        One a time.
    """

    times: tuple[float, ...]
    values: Vectors

    def at(self, time: float) -> Vector:
        """Return the vector at a time [s].

        Examples
        --------
        >>> VectorTable(times=(0.0, 2.0), values=((0.0, 0.0, 0.0), (0.0, 0.0, -1.0))).at(0.5)
        (0.0, 0.0, -0.25)
        """
        i = bisect.bisect_right(self.times, time)
        if i == 0 or i == len(self.times):
            return self.values[max(i - 1, 0)]
        t0, t1 = self.times[i - 1 : i + 1]
        w = (time - t0) / (t1 - t0)
        x, y, z = (a + w * (b - a) for a, b in zip(self.values[i - 1], self.values[i], strict=True))
        return x, y, z


class Gap(Model):
    """A distance to the nearest wall or other body.

    Attributes
    ----------
    gap : float, [m]
        Between the surfaces, > 0.
    """

    gap: Annotated[float, number("m", above=0.0)]


def _times(value: Any) -> tuple[float, ...]:
    times = tuple(placed(i, to_number, time, "s") for i, time in enumerate(items(value)))
    if any(b <= a for a, b in itertools.pairwise(times)):
        raise RuleError("must increase")
    return times


def _course(unit: str) -> BeforeValidator:
    """Check a constant vector, or a table of times and values."""

    def check(value: Any) -> Vector | VectorTable:
        if not isinstance(value, dict):
            return to_vector(value, unit)
        if set(value) != {"times", "values"}:
            raise RuleError(
                "must hold times and values, and nothing else",
                value=value,
                cure="Write { times = [...], values = [[...], ...] }, or a constant vector.",
            )
        times = placed("times", _times, value["times"])
        values = placed("values", to_vectors, value["values"], unit)
        if not times or len(times) != len(values):
            raise RuleError(f"must have as many values as times, not {len(values)} and {len(times)}")
        return VectorTable(times=times, values=values)

    return BeforeValidator(check)


def _until(value: Any) -> float | Gap:
    if isinstance(value, dict):
        return Gap.model_validate(value)
    return to_number(value, "s", above=0.0)


class Motion(Model):
    """A prescribed motion, and when it ends.

    Attributes
    ----------
    velocity, rotation : tuple of 3 floats or VectorTable, [m/s], [rad/s]
        The centre's velocity and the angular velocity; zero when left out.
    until : float or Gap, [s] or [m], optional
        The time, or the gap to the nearest wall or body, at which the body is released; never when left out.
    """

    velocity: Annotated[Vector | VectorTable, _course("m/s")] = (0.0, 0.0, 0.0)
    rotation: Annotated[Vector | VectorTable, _course("rad/s")] = (0.0, 0.0, 0.0)
    until: Annotated[float | Gap | None, BeforeValidator(_until)] = None

    def velocity_at(self, time: float) -> Vector:
        """Return the prescribed velocity [m/s] of the centre at a time [s]."""
        return self.velocity.at(time) if isinstance(self.velocity, VectorTable) else self.velocity

    def rotation_at(self, time: float) -> Vector:
        """Return the prescribed angular velocity [rad/s] at a time [s]."""
        return self.rotation.at(time) if isinstance(self.rotation, VectorTable) else self.rotation


class Lattice(Model):
    """A regular arrangement of bodies.

    Attributes
    ----------
    counts : tuple of 3 ints
        Bodies along x, y, z.
    spacing : tuple of 3 floats, [m]
        Distance of neighbouring centres.
    origin : tuple of 3 floats, [m], optional
        The first centre; half a spacing from the lower sides when left out.
    jitter : float, [m]
        Each centre is moved at random by up to this along each direction.
    seed : int
        Of the random numbers.
    """

    counts: Annotated[tuple[int, int, int], whole_vector(1, MAX_BODIES)]
    spacing: Annotated[Vector, vector("m", above=0.0)]
    origin: Annotated[Vector | None, vector("m")] = None
    jitter: Annotated[float, number("m", least=0.0)] = 0.0
    seed: Annotated[int, whole(0, 2**63 - 1)] = 0

    @property
    def count(self) -> int:
        """Number of bodies."""
        nx, ny, nz = self.counts
        return nx * ny * nz


class Packing(Model):
    """Bodies placed at random in the whole box, one after the other, none touching.

    Attributes
    ----------
    count : int, optional
        How many; this or `solid_fraction`.
    solid_fraction : float, [-], optional
        Their volume over the box's.
    seed : int
        Of the random numbers.
    min_gap : float, [m]
        Least distance between surfaces, walls included.
    """

    count: Annotated[int | None, whole(1, MAX_BODIES)] = None
    solid_fraction: Annotated[float | None, number("", above=0.0, most=1.0)] = None
    seed: Annotated[int, whole(0, 2**63 - 1)] = 0
    min_gap: Annotated[float, number("m", least=0.0)] = 0.0

    @model_validator(mode="after")
    def _one_amount(self) -> Packing:
        if (self.count is None) == (self.solid_fraction is None):
            found = "neither is given" if self.count is None else "both are given"
            raise RuleError("must have exactly one of count and solid_fraction", found)
        return self


def _one_or_each(unit: str) -> BeforeValidator:
    """Check one positive quantity for all bodies, or a list with one each."""

    def check(value: Any) -> float | tuple[float, ...]:
        if not hasattr(value, "tolist") and not isinstance(value, list | tuple):
            return to_number(value, unit, above=0.0)
        return tuple(placed(i, to_number, item, unit, above=0.0) for i, item in enumerate(items(value)))

    return BeforeValidator(check)


def _vector_or_each(unit: str) -> BeforeValidator:
    """Check one vector for all bodies, or a list with one each."""

    def check(value: Any) -> Vector | Vectors:
        is_each = isinstance(value, list | tuple) and len(value) > 0 and isinstance(value[0], list | tuple)
        return to_vectors(value, unit) if is_each else to_vector(value, unit)

    return BeforeValidator(check)


def _motion(value: Any) -> str | Motion:
    if isinstance(value, dict):
        return Motion.model_validate(value)
    if isinstance(value, str) and value in ("free", "fixed"):
        return value
    raise RuleError('must be "free", "fixed" or { velocity, rotation, until }', value=value)


class BodyGroup(Model):
    """Spheres that share a description.

    Attributes
    ----------
    diameter : float or tuple of float, [m]
        One for all, or one each.
    density : float or tuple of float, [kg/m^3]
        One for all, or one each.
    centers : tuple of 3-tuples, [m], optional
        This, `lattice` or `packing` (a case file may also name a CSV ``file``: its rows become `centers`).
    lattice : Lattice, optional
    packing : Packing, optional
    velocity, angular_velocity : tuple of 3 floats, or one such each, [m/s], [rad/s]
        At the start; zero when left out.
    motion : "free", "fixed" or Motion
    orientation_seed : int, optional
        Turns each body, and so its markers, at random; upright when left out. A sphere's motion should not depend on
        it: this shows by how much it does.
    """

    diameter: Annotated[float | tuple[float, ...], _one_or_each("m")]
    density: Annotated[float | tuple[float, ...], _one_or_each("kg/m^3")]
    centers: Annotated[Vectors | None, BeforeValidator(lambda value: to_vectors(value, "m"))] = None
    lattice: Lattice | None = None
    packing: Packing | None = None
    velocity: Annotated[Vector | Vectors, _vector_or_each("m/s")] = (0.0, 0.0, 0.0)
    angular_velocity: Annotated[Vector | Vectors, _vector_or_each("rad/s")] = (0.0, 0.0, 0.0)
    motion: Annotated[Literal["free", "fixed"] | Motion, BeforeValidator(_motion)] = "free"
    orientation_seed: Annotated[int | None, whole(0, 2**63 - 1)] = None

    @model_validator(mode="after")
    def _is_one_arrangement(self) -> BodyGroup:
        given = [name for name in PLACES if name != "file" and getattr(self, name) is not None]
        if len(given) != 1:
            found = f"given are {listed(given)}" if given else "none is given"
            raise RuleError(f"must have exactly one of {listed(PLACES)}", found)
        if self.centers is not None and not self.centers:
            raise RuleError(
                "must hold at least one center",
                value=[],
                at=("centers",),
                cure="Leave the group out for a case without bodies.",
            )
        if self.lattice is not None and self.lattice.count > MAX_BODIES:
            raise RuleError(
                f"must make at most {MAX_BODIES} bodies, not {self.lattice.count}", at=("lattice", "counts")
            )
        if self.motion != "free" and (_moves(self.velocity) or _moves(self.angular_velocity)):
            raise RuleError(
                "must be left out where the motion is prescribed",
                "the motion says the velocity",
                at=("velocity" if _moves(self.velocity) else "angular_velocity",),
            )
        return self


def _moves(velocity: Vector | Vectors) -> bool:
    return any(any(v) if isinstance(v, tuple) else v != 0.0 for v in velocity)
