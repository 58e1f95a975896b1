"""What enters the box through one face, as the case file says it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import model_validator

from rdpm.config.declared import Choice, Declared, Quantity, items, placed
from rdpm.config.fields import Model
from rdpm.config.rule import RuleError
from rdpm.conventions import BoundaryKind

__all__ = ["Inflow", "check_inflow"]

Rows = tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class _Profile(Declared):
    """A name, or rows of numbers of equal length."""

    names: Choice
    item: Quantity

    def check(self, value: Any) -> str | Rows:
        """Return the name, or the rows as tuples; one row may be given without its outer brackets."""
        if isinstance(value, str):
            return self.names.check(value)
        listed = items(value)
        rows = listed if listed and isinstance(listed[0], list | tuple) else [listed]
        found = tuple(
            tuple(placed(at, placed, n, self.item.check, entry) for n, entry in enumerate(items(row)))
            for at, row in enumerate(rows)
        )
        if not found[0] or any(len(row) != len(found[0]) for row in found):
            raise RuleError("must have rows of one length, with one number at least", cure="Fill the rows up.")
        return found

    def describe(self) -> dict[str, Any]:
        """What a number is, how many there are, and the names."""
        return {**self.item.describe(), "count": "list", "choices": list(self.names.names)}


class Inflow(Model):
    """A stream through the box.

    Attributes
    ----------
    velocity
        Mean over the section: positive enters through the lower face, negative through the upper one.
    profile
        Over the section: uniform; a parabola between no-slip walls (of both directions where both have walls); or
        numbers at evenly spaced points from edge to edge, linear between them, of which only the ratios count: a list
        along the first of the other two directions, or such a list for each point along the second.
    start_up
        Time in which it rises from nothing.
    """

    velocity: Annotated[float, Quantity("m/s")]
    profile: Annotated[
        Literal["uniform", "parabolic"] | Rows, _Profile(Choice(("uniform", "parabolic")), Quantity("", ge=0.0))
    ] = "uniform"
    start_up: Annotated[float, Quantity("s", ge=0.0)] = 0.0

    @model_validator(mode="after")
    def _flows(self) -> Inflow:
        if self.velocity == 0.0:
            raise RuleError("must not be 0", "nothing would enter", "Use a wall instead.", at=("velocity",))
        if not isinstance(self.profile, str) and not any(map(any, self.profile)):
            raise RuleError(
                "must not be 0 everywhere", "nothing would enter", "Leave it out for a uniform inflow.", at=("profile",)
            )
        return self


def check_inflow(kinds: Sequence[BoundaryKind], inflow: Inflow | None) -> None:
    """Refuse open faces without an inflow, an inflow without them, and a parabola without walls.

    Raises
    ------
    RuleError
    """
    opened = [name for name, kind in zip("xyz", kinds, strict=True) if kind == "inflow-outflow"]
    if len(opened) > 1:
        raise RuleError(
            'must be "inflow-outflow" in one direction only',
            "one stream passes through the box",
            'Use "wall", "free-slip" or "periodic".',
            value="inflow-outflow",
            at=("boundary", opened[1]),
        )
    if opened and inflow is None:
        raise RuleError(
            f'is missing with boundary.{opened[0]} = "inflow-outflow"',
            "what enters must be known",
            'Add [domain.inflow] with velocity = "5 cm/s".',
            at=("inflow",),
        )
    if inflow is not None and not opened:
        raise RuleError(
            'must be left out where no boundary is "inflow-outflow"',
            "nothing can enter",
            'Set the boundary of one direction to "inflow-outflow", or leave it out.',
            at=("inflow",),
        )
    if inflow is not None and inflow.profile == "parabolic" and "wall" not in kinds:
        raise RuleError(
            "must not be parabolic without no-slip walls beside the stream",
            "a parabola falls to 0 at walls",
            'Use "uniform", a list, or a boundary "wall".',
            value="parabolic",
            at=("inflow", "profile"),
        )
