"""How finely and how fast a case is computed."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, PrivateAttr, model_validator

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
    if isinstance(value, str) and value in ("auto", "adaptive"):
        return value
    if isinstance(value, str) and value.isalpha():
        cure = 'Write "auto", "adaptive", or text such as "1 ms".'
        raise RuleError('must be "auto", "adaptive" or a time', cure=cure, value=value)
    return to_number(value, "s", above=0.0)


class Time(Model):
    """How long, and in which steps.

    Attributes
    ----------
    end : float, [s]
        > 0.
    step : float, "auto" or "adaptive", [s]
        Of the fluid (of the contacts, in a dry case). "auto": one for the whole run; "adaptive": multiples of that one
        wherever no contact needs it.
    diffusion : "auto", "explicit" or "stabilised"
    cfl : float, [-]
        Largest share of a cell the flow crosses in an automatic step, 0 < cfl <= 1.
    """

    end: Annotated[float, number("s", above=0.0)]
    step: Annotated[float | Literal["auto", "adaptive"], BeforeValidator(_step)] = "auto"
    diffusion: Annotated[
        Literal["auto", "explicit", "stabilised"], choice("auto", "explicit", "stabilised")
    ] = "auto"
    cfl: Annotated[float, number("", above=0.0, most=1.0)] = 0.5
    _contact_step: float | None = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _fits(self) -> Time:
        if isinstance(self.step, float) and self.step > self.end:
            raise RuleError(
                f"must not be longer than time.end = {self.end:g} s", value=self.step, at=("step",)
            )
        return self

    @property
    def contact_step(self) -> float | None:
        """Contact step with which the run began that adaptive steps now continue [s]; None in a new run."""
        return self._contact_step

    def continued(self, contact_step: float) -> Time:
        """The same for a run that began with this contact step [s], whatever its end is now."""
        kept = self.model_copy()
        kept._contact_step = contact_step
        return kept
