"""Walls within the box: planes at any angle, tubes, cylinders."""

from __future__ import annotations

from typing import Annotated, Any, Literal, get_args

from pydantic import model_validator

from rdpm.config.declared import Choice, Components, LeftOut, Quantity
from rdpm.config.fields import Model, Vector
from rdpm.config.rule import RuleError
from rdpm.surfaces import Side, Surface, surface_of

__all__ = ["Wall"]

Shape = Literal["plane", "cylinder"]

_PLACE, _DIRECTION = Components(Quantity("m")), Components(Quantity(""))
_OF_SHAPE = {"plane": ("normal",), "cylinder": ("axis", "diameter", "side", "angular_velocity")}
_NEEDED = {"plane": ("normal",), "cylinder": ("axis", "diameter")}
_ROUND_OFF = 1e-9


class Wall(Model):
    """A wall within the box; bodies touch it, and the fluid does not slip on it.

    Attributes
    ----------
    shape
        A plane, or a circular cylinder.
    point
        On the plane, or on the axis of the cylinder.
    normal
        Of a plane, of any length: points to the side where bodies are.
    axis
        Of a cylinder, of any length.
    diameter
        Of a cylinder.
    side
        Of a cylinder: whether bodies are inside (a tube) or outside.
    velocity
        Of the wall: in the plane, or along the cylinder's axis.
    angular_velocity
        Of a cylinder about its axis.
    """

    shape: Annotated[Shape, Choice(get_args(Shape))]
    point: Annotated[Vector, _PLACE]
    normal: Annotated[Vector | None, _DIRECTION] = None
    axis: Annotated[Vector | None, _DIRECTION] = None
    diameter: Annotated[float | None, Quantity("m", gt=0.0)] = None
    side: Annotated[Side | None, Choice(get_args(Side)), LeftOut('"inside", of a cylinder')] = None
    velocity: Annotated[Vector, Components(Quantity("m/s"))] = (0.0, 0.0, 0.0)
    angular_velocity: Annotated[float | None, Quantity("rad/s"), LeftOut("0, of a cylinder")] = None

    @model_validator(mode="before")
    @classmethod
    def _fill(cls, raw: Any) -> Any:
        if isinstance(raw, dict) and raw.get("shape") == "cylinder":
            return {"side": "inside", "angular_velocity": 0.0, **raw}
        return raw

    @model_validator(mode="after")
    def _is_of_its_shape(self) -> Wall:
        for shape, keys in _OF_SHAPE.items():
            for key in keys:
                value = getattr(self, key)
                if shape != self.shape and value is not None:
                    raise RuleError(
                        f'belongs to shape = "{shape}"', f'this wall has shape = "{self.shape}"', "Leave it out.",
                        value=value, at=(key,),
                    )  # fmt: skip
        for key in _NEEDED[self.shape]:
            if getattr(self, key) is None:
                raise RuleError(f'is missing for shape = "{self.shape}"', "it says where the wall is", at=(key,))
        direction = self.direction
        length = sum(c * c for c in direction) ** 0.5
        if not length > 0.0:
            key = "normal" if self.shape == "plane" else "axis"
            raise RuleError("must not be zero", "it has no direction", value=direction, at=(key,))
        along = sum(c * v for c, v in zip(direction, self.velocity, strict=True)) / length
        speed = sum(v * v for v in self.velocity) ** 0.5
        if self.shape == "plane" and abs(along) > _ROUND_OFF * speed:
            raise RuleError("must have no part along the normal", "a wall slides in its own plane",
                            value=self.velocity, at=("velocity",))  # fmt: skip
        if self.shape == "cylinder" and abs(abs(along) - speed) > _ROUND_OFF * speed:
            raise RuleError("must be along the axis", "a cylinder slides along itself",
                            value=self.velocity, at=("velocity",))  # fmt: skip
        return self

    @property
    def direction(self) -> Vector:
        """Normal or axis, as given."""
        return (self.normal if self.shape == "plane" else self.axis) or (0.0, 0.0, 0.0)

    @property
    def surface(self) -> Surface:
        """The wall as geometry."""
        return surface_of(self.model_dump())

    def check_periods(self, is_periodic: tuple[bool, bool, bool]) -> None:
        """Refuse a wall that does not repeat along a periodic direction."""
        direction = self.direction
        length = sum(c * c for c in direction) ** 0.5
        for axis, periodic in enumerate(is_periodic):
            part = abs(direction[axis]) / length
            repeats = part < _ROUND_OFF or (self.shape == "cylinder" and part > 1.0 - _ROUND_OFF)
            if periodic and not repeats:
                how = "at right angles to" if self.shape == "plane" else "along, or at right angles to,"
                raise RuleError(
                    f"must be {how} the periodic direction {'xyz'[axis]}", "the wall must go on beyond the box",
                    f'Change it, or set domain.boundary.{"xyz"[axis]} = "wall".', value=direction,
                    at=("normal" if self.shape == "plane" else "axis",),
                )  # fmt: skip
