"""Where a run samples the flow."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import model_validator

from rdpm.config.declared import Choice, Components, Quantity, Whole
from rdpm.config.fields import Model, Vector
from rdpm.config.rule import RuleError

__all__ = ["Line", "Plane"]


class Line(Model):
    """Points at equal distances along a line.

    Attributes
    ----------
    start
        Its first point.
    end
        Its last point.
    count
        Points on it, both ends included.
    """

    start: Annotated[Vector, Components(Quantity("m"))]
    end: Annotated[Vector, Components(Quantity("m"))]
    count: Annotated[int, Whole(2, 100_000)]

    @model_validator(mode="after")
    def _has_length(self) -> Line:
        if self.start == self.end:
            raise RuleError("must differ from the start", "the line has no length", value=self.end, at=("end",))
        return self


class Plane(Model):
    """A plane through the whole box.

    Attributes
    ----------
    normal
        The direction it is normal to.
    position
        Along that direction.
    """

    normal: Annotated[Literal["x", "y", "z"], Choice(("x", "y", "z"))]
    position: Annotated[float, Quantity("m", ge=0.0)]
