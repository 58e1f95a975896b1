"""Groups of bodies in a case file: what they are, where they start, how they move."""

from __future__ import annotations

import bisect
import itertools
from typing import Annotated, Any, Literal, get_args

from pydantic import field_validator, model_validator

from rdpm.config.declared import Choice, Components, EachOf, File, LeftOut, OneOrEach, OrTable, Quantity, Whole
from rdpm.config.fields import Model, Vector, Vectors
from rdpm.config.rule import RuleError, listed

__all__ = [
    "MAX_BODIES",
    "BodyGroup",
    "Gap",
    "Lattice",
    "Motion",
    "Packing",
    "RotationTable",
    "VectorTable",
    "VelocityTable",
]

MAX_BODIES = 1_000_000  # beyond it the case file is mistaken: 4 cells a diameter would not fit a memory

PLACES = ("centers", "file", "lattice", "packing")

_LENGTH, _SIZE = Components(Quantity("m")), Quantity("m", gt=0.0)
_VELOCITY, _ROTATION = Components(Quantity("m/s")), Components(Quantity("rad/s"))
_SEED = Whole(0, 2**63 - 1)
_Held = Literal["free", "fixed"]


class VectorTable(Model):
    """A vector given at some times, linear between them and constant outside.

    Attributes
    ----------
    times
        Increasing.
    values
        One a time.
    """

    times: Annotated[tuple[float, ...], EachOf(Quantity("s"))]
    values: Vectors

    @model_validator(mode="before")
    @classmethod
    def _has_both(cls, raw: Any) -> Any:
        if isinstance(raw, dict) and set(raw) != {"times", "values"}:
            raise RuleError(
                "must hold times and values, and nothing else",
                value=raw,
                cure="Write { times = [...], values = [[...], ...] }, or a constant vector.",
            )
        return raw

    @field_validator("times")
    @classmethod
    def _increase(cls, times: tuple[float, ...]) -> tuple[float, ...]:
        if any(b <= a for a, b in itertools.pairwise(times)):
            raise RuleError("must increase")
        return times

    @model_validator(mode="after")
    def _is_one_each(self) -> VectorTable:
        if not self.times or len(self.times) != len(self.values):
            raise RuleError(f"must have as many values as times, not {len(self.values)} and {len(self.times)}")
        return self

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


class VelocityTable(VectorTable):
    """A velocity at some times.

    Attributes
    ----------
    times
        Increasing.
    values
        One a time; linear between them, constant outside.
    """

    values: Annotated[Vectors, EachOf(_VELOCITY)]


class RotationTable(VectorTable):
    """An angular velocity at some times.

    Attributes
    ----------
    times
        Increasing.
    values
        One a time; linear between them, constant outside.
    """

    values: Annotated[Vectors, EachOf(_ROTATION)]


class Gap(Model):
    """A distance to the nearest wall or other body.

    Attributes
    ----------
    gap
        Between the surfaces.
    """

    gap: Annotated[float, _SIZE]


class Motion(Model):
    """A prescribed motion, and when it ends.

    Attributes
    ----------
    velocity
        The centre's velocity.
    rotation
        The angular velocity.
    until
        The time, or the gap to the nearest wall or body, at which the body is released.
    """

    velocity: Annotated[Vector | VelocityTable, OrTable(_VELOCITY, VelocityTable)] = (0.0, 0.0, 0.0)
    rotation: Annotated[Vector | RotationTable, OrTable(_ROTATION, RotationTable)] = (0.0, 0.0, 0.0)
    until: Annotated[float | Gap | None, OrTable(Quantity("s", gt=0.0), Gap), LeftOut("never")] = None

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
    counts
        Bodies along x, y, z.
    spacing
        Distance of neighbouring centres.
    origin
        The first centre.
    jitter
        Each centre is moved at random by up to this along each direction.
    seed
        Of the random numbers.
    """

    counts: Annotated[tuple[int, int, int], Components(Whole(1, MAX_BODIES))]
    spacing: Annotated[Vector, Components(_SIZE)]
    origin: Annotated[Vector | None, _LENGTH, LeftOut("half a spacing from the lower faces")] = None
    jitter: Annotated[float, Quantity("m", ge=0.0)] = 0.0
    seed: Annotated[int, _SEED] = 0

    @property
    def count(self) -> int:
        """Number of bodies."""
        nx, ny, nz = self.counts
        return nx * ny * nz


class Packing(Model):
    """Bodies placed at random in the whole box, one after the other, none touching.

    Attributes
    ----------
    count
        How many; this or `solid_fraction`.
    solid_fraction
        Their volume over the box's; instead of `count`.
    seed
        Of the random numbers.
    min_gap
        Least distance between surfaces, walls included.
    """

    count: Annotated[int | None, Whole(1, MAX_BODIES)] = None
    solid_fraction: Annotated[float | None, Quantity("", gt=0.0, le=1.0)] = None
    seed: Annotated[int, _SEED] = 0
    min_gap: Annotated[float, Quantity("m", ge=0.0)] = 0.0

    @model_validator(mode="after")
    def _one_amount(self) -> Packing:
        if (self.count is None) == (self.solid_fraction is None):
            found = "neither is given" if self.count is None else "both are given"
            raise RuleError("must have exactly one of count and solid_fraction", found)
        return self


class BodyGroup(Model):
    """Spheres that share a description.

    Attributes
    ----------
    diameter
        Of the spheres.
    density
        Mass a volume.
    centers
        Where the bodies are; this, `file`, `lattice` or `packing`.
    file
        CSV table with a body a line; its columns take the place of `centers` and what else they hold.
    lattice
        A regular arrangement.
    packing
        Places at random, no two bodies touching.
    velocity
        Of the centre at the start.
    angular_velocity
        At the start.
    motion
        Free, fixed, or a prescribed motion.
    orientation_seed
        Turns each body, and so its markers, at random. A sphere's motion should not depend on it: this shows by how
        much it does.
    """

    diameter: Annotated[float | tuple[float, ...], OneOrEach(_SIZE)]
    density: Annotated[float | tuple[float, ...], OneOrEach(Quantity("kg/m^3", gt=0.0))]
    centers: Annotated[Vectors | None, EachOf(_LENGTH)] = None
    file: Annotated[str | None, File()] = None
    lattice: Lattice | None = None
    packing: Packing | None = None
    velocity: Annotated[Vector | Vectors, OneOrEach(_VELOCITY)] = (0.0, 0.0, 0.0)
    angular_velocity: Annotated[Vector | Vectors, OneOrEach(_ROTATION)] = (0.0, 0.0, 0.0)
    motion: Annotated[_Held | Motion, OrTable(Choice(get_args(_Held)), Motion)] = "free"
    orientation_seed: Annotated[int | None, _SEED, LeftOut("upright")] = None

    @model_validator(mode="after")
    def _is_one_arrangement(self) -> BodyGroup:
        given = [name for name in PLACES if getattr(self, name) is not None]
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
