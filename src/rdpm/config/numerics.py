"""How finely and how fast a case is computed."""

from __future__ import annotations

from typing import Annotated, Literal, get_args

from pydantic import model_validator

from rdpm.config.declared import Choice, Components, Quantity, Whole
from rdpm.config.fields import Model
from rdpm.config.rule import RuleError

__all__ = ["Resolution", "Time"]

Diffusion = Literal["auto", "explicit", "stabilised"]
Step = Literal["auto", "adaptive"]


class Resolution(Model):
    """The grid.

    Attributes
    ----------
    cells_per_diameter
        Of the smallest body; this or `cells`.
    cells
        Along x, y, z; instead of `cells_per_diameter`.
    """

    cells_per_diameter: Annotated[float | None, Quantity("", ge=4.0, le=1000.0)] = None
    cells: Annotated[tuple[int, int, int] | None, Components(Whole(4, 100_000))] = None

    @model_validator(mode="after")
    def _is_one_way(self) -> Resolution:
        if (self.cells_per_diameter is None) == (self.cells is None):
            found = "neither is given" if self.cells is None else "both are given"
            raise RuleError('must have exactly one of "cells_per_diameter" and "cells"', found)
        return self


class Time(Model):
    """How long, and in which steps.

    Attributes
    ----------
    end
        Simulated time.
    step
        Of the fluid (of the contacts, in a dry case). "auto": one for the whole run; "adaptive": longer wherever no
        contact needs it.
    diffusion
        Explicit, in stages that keep longer steps stable, or whichever is cheaper.
    cfl
        Largest share of a cell the flow crosses in an automatic step.
    """

    end: Annotated[float, Quantity("s", gt=0.0)]
    step: Annotated[float | Step, Quantity("s", gt=0.0, words=get_args(Step), example="1 ms")] = "auto"
    diffusion: Annotated[Diffusion, Choice(get_args(Diffusion))] = "auto"
    cfl: Annotated[float, Quantity("", gt=0.0, le=1.0)] = 0.5

    @model_validator(mode="after")
    def _fits(self) -> Time:
        if isinstance(self.step, float) and self.step > self.end:
            raise RuleError(
                f"must not be longer than time.end = {self.end:g} s", value=self.step, at=("step",)
            )
        return self
