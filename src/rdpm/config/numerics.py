"""How finely and how fast a case is computed."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, model_validator

from rdpm.config.fields import Model, choice, number, to_number, whole_vector
from rdpm.config.rule import RuleError

__all__ = ["Resolution", "Time"]


class Resolution(Model):
    """The grid.

    Attributes
    ----------
    cells_per_diameter : float, optional
        Of the smallest body, 4 to 1000; this or `cells`.
    cells : tuple of 3 ints, optional
        Along x, y, z.
    """

    cells_per_diameter: Annotated[float | None, number("", least=4.0, most=1000.0)] = None
    cells: Annotated[tuple[int, int, int] | None, whole_vector(4, 100_000)] = None

    @model_validator(mode="after")
    def _is_one_way(self) -> Resolution:
        if (self.cells_per_diameter is None) == (self.cells is None):
            found = "neither is given" if self.cells is None else "both are given"
            raise RuleError('must have exactly one of "cells_per_diameter" and "cells"', found)
        return self


def _step(value: Any) -> float | str:
    if value == "adaptive":
        raise RuleError("is not in this version", cure='Use "auto", or a time.', value=value)
    if isinstance(value, str) and value.isalpha() and value != "auto":
        raise RuleError('must be "auto" or a time', cure='Write "auto", or text such as "1 ms".', value=value)
    return "auto" if isinstance(value, str) and value == "auto" else to_number(value, "s", above=0.0)


class Time(Model):
    """How long, and in which steps.

    Attributes
    ----------
    end : float, [s]
        > 0.
    step : float or "auto", [s]
        Of the fluid (of the contacts, in a dry case).
    diffusion : "auto", "explicit" or "stabilised"
    cfl : float, [-]
        Largest share of a cell the flow crosses in an automatic step, 0 < cfl <= 1.
    """

    end: Annotated[float, number("s", above=0.0)]
    step: Annotated[float | Literal["auto"], BeforeValidator(_step)] = "auto"
    diffusion: Annotated[
        Literal["auto", "explicit", "stabilised"], choice("auto", "explicit", "stabilised")
    ] = "auto"
    cfl: Annotated[float, number("", above=0.0, most=1.0)] = 0.5

    @model_validator(mode="after")
    def _fits(self) -> Time:
        if isinstance(self.step, float) and self.step > self.end:
            raise RuleError(
                f"must not be longer than time.end = {self.end:g} s", value=self.step, at=("step",)
            )
        return self
