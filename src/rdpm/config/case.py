"""The case: box, fluid, bodies, contact, and how they are computed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BeforeValidator, StrictStr, ValidationError, ValidationInfo, field_validator, model_validator

from rdpm.config.bodies import BodyGroup, Gap, Motion
from rdpm.config.contact import DEFAULT_CONTACT, Contact
from rdpm.config.declared import LeftOut, items
from rdpm.config.domain import Domain, Fluid
from rdpm.config.fields import Model
from rdpm.config.numerics import Resolution, Time
from rdpm.config.output import Output
from rdpm.config.overrides import set_values
from rdpm.config.problems import Known, first_problem
from rdpm.config.rule import RuleError
from rdpm.config.walls import Wall
from rdpm.config.write import content

if TYPE_CHECKING:
    from rdpm.config.placement import BodyTable

__all__ = ["Case"]


def _tables(name: str) -> Callable[[Any], tuple[Any, ...]]:
    def check(value: Any) -> tuple[Any, ...]:
        if isinstance(value, dict):
            raise RuleError("must be a list of tables", cure=f"Write [[{name}]], not [{name}].", value=value)
        return tuple(items(value))

    return check


def _is_released(group: BodyGroup) -> bool:
    """Whether its bodies are free, now or later."""
    return group.motion == "free" or (isinstance(group.motion, Motion) and group.motion.until is not None)


class Case(Model):
    """A case as it will be run: plain SI numbers, defaults filled in.

    Attributes
    ----------
    title
        Of the report.
    domain
        The box and gravity.
    fluid
        What fills the box; without it the bodies move in a void.
    walls
        Walls within the box.
    bodies
        Groups of spheres.
    contact
        How bodies touch.
    resolution
        The grid; needed with a fluid.
    time
        How long, and in which steps.
    output
        What a run writes, and how often.
    """

    title: StrictStr = ""
    domain: Domain
    fluid: Fluid | None = None
    walls: Annotated[tuple[Wall, ...], BeforeValidator(_tables("walls"))] = ()
    bodies: Annotated[tuple[BodyGroup, ...], BeforeValidator(_tables("bodies"))] = ()
    contact: Annotated[Contact, LeftOut(", ".join(f"{key} = {value:g}" for key, value in DEFAULT_CONTACT.items()))]
    resolution: Resolution | None = None
    time: Time
    output: Annotated[Output, LeftOut("each key's own")]

    @model_validator(mode="before")
    @classmethod
    def _fill(cls, raw: Any) -> Any:
        if not isinstance(raw, dict):
            return raw
        filled = {"contact": dict(DEFAULT_CONTACT), "output": {}, **raw}
        if isinstance(filled["contact"], dict):
            # only a fluid lubricates
            filled["contact"] = {"lubrication": filled.get("fluid") is not None, **filled["contact"]}
        return filled

    @field_validator("output", mode="after")
    @classmethod
    def _fill_output(cls, output: Output, info: ValidationInfo) -> Output:
        time = info.data.get("time")
        return output.filled(time.end) if isinstance(time, Time) else output

    @model_validator(mode="after")
    def _is_consistent(self) -> Case:
        if self.fluid is None:
            self._check_dry()
        else:
            self._check_wet(self.fluid)
        self._check_walls()
        self._check_releases()
        self.output.check_places(self.domain.size, self.time.end)
        diameters = self.expanded_bodies().diameter
        cells = self.resolution.cells if self.resolution else None
        if cells is not None and len(diameters):
            across = [
                count * float(diameters.min()) / length
                for count, length in zip(cells, self.domain.size, strict=True)
            ]
            worst = min(range(3), key=across.__getitem__)
            if across[worst] < 4.0 - 1e-9:
                raise RuleError(
                    f"must put at least 4 cells across the smallest body, not {across[worst]:.3g} in "
                    f"{'xyz'[worst]}",
                    "the flow around it is not resolved",
                    f"Use at least {int(4 * cells[worst] / across[worst]) + 1} cells there.",
                    value=cells,
                    at=("resolution", "cells"),
                )
        return self

    def _check_dry(self) -> None:
        if not self.bodies:
            raise RuleError(
                "must have a fluid or bodies", "there is nothing to compute", "Add [fluid] or [[bodies]]."
            )
        if self.contact.lubrication:
            raise RuleError(
                "must not be true without [fluid]",
                "without a fluid nothing lubricates",
                "Leave it out.",
                value=True,
                at=("contact", "lubrication"),
            )
        if self.output.samples_flow:
            raise RuleError(
                "must be left out of a case without [fluid]",
                "there is no flow to sample",
                at=("output", self.output.samples_flow),
            )
        if self.contact.model == "repulsive" and self.contact.repulsion_range is None:
            raise RuleError(
                "is missing in a case without [fluid]",
                "there is no grid that would choose it",
                'Give it, such as "0.2 mm".',
                at=("contact", "repulsion_range"),
            )
        if self.domain.inflow is not None:
            raise RuleError(
                "must be left out in a case without [fluid]",
                "only a fluid flows in",
                "Leave it out, or add [fluid].",
                at=("domain", "inflow"),
            )
        if self.time.step == "adaptive":
            raise RuleError(
                "must not be in a case without [fluid]",
                "contacts alone set its step",
                'Use "auto", or a time.',
                value="adaptive",
                at=("time", "step"),
            )
        if self.time.step == "auto" and self.contact.way == "impulses":
            raise RuleError(
                "must be a time in a case without [fluid]",
                "collisions of hard spheres set no step",
                'Give time.step, such as "1 ms".',
                value="auto",
                at=("time", "step"),
            )
        if self.time.step == "auto" and self.contact.way == "contact-steps":
            raise RuleError(
                "must be a time in a case without [fluid]",
                "contact_steps counts steps, and no flow sets their length",
                'Give time.step, such as "0.1 ms", or contact.stiffness.',
                value="auto",
                at=("time", "step"),
            )

    def _check_wet(self, fluid: Fluid) -> None:
        if self.resolution is None:
            raise RuleError(
                "is missing",
                "the flow needs a grid",
                "Add [resolution] with cells_per_diameter = 8, or cells = [nx, ny, nz].",
                at=("resolution",),
            )
        if self.resolution.cells is None and not self.bodies:
            raise RuleError(
                "must be left out where there are no bodies",
                "there is no diameter",
                "Give resolution.cells = [nx, ny, nz].",
                value=self.resolution.cells_per_diameter,
                at=("resolution", "cells_per_diameter"),
            )
        if fluid.zero_mean_flow and not all(self.domain.is_periodic):
            raise RuleError(
                "must not be true where a boundary is not periodic",
                "walls, or an inflow, already set the mean flow",
                "Leave it out.",
                value=True,
                at=("fluid", "zero_mean_flow"),
            )
        axis = self.domain.inflow_axis
        if axis is not None and fluid.acceleration[axis] != 0.0:
            raise RuleError(
                f"must have no {'xyz'[axis]} component along the inflow",
                "the inflow sets how much passes, whatever drives it",
                f"Set component {axis} to 0, or change domain.inflow.velocity.",
                at=("fluid", "body_force" if fluid.body_force is not None else "pressure_gradient"),
            )

    def _check_walls(self) -> None:
        if self.walls and self.domain.inflow is not None:
            raise RuleError(
                "must be left out with domain.inflow",
                "a wall within the box would reach through the open ends, where it cannot act on the fluid",
                "Use the boundaries beside the stream as walls, or fixed bodies.",
                at=("walls",),
            )
        for n, wall in enumerate(self.walls):
            try:
                wall.check_periods(self.domain.is_periodic)
            except RuleError as problem:
                raise problem.below("walls", n) from None
            if self.contact.model == "hard-sphere" and wall.side == "inside":
                raise RuleError(
                    'must be "outside" with contact.model = "hard-sphere"',
                    "the time of touch is searched from below, which the inside of a cylinder does not allow",
                    'Use contact.model = "soft-sphere".',
                    value="inside",
                    at=("walls", n, "side"),
                )

    def _check_releases(self) -> None:
        for i, group in enumerate(self.bodies):
            by_gap = isinstance(group.motion, Motion) and isinstance(group.motion.until, Gap)
            no_wall = "wall" not in self.domain.kinds and not self.walls
            if by_gap and no_wall and len(self.expanded_bodies()) < 2:
                raise RuleError(
                    "must be a time for a lone body in a box without walls",
                    "a gap is measured to the nearest wall or body",
                    at=("bodies", i, "motion", "until"),
                )

    @property
    def zero_mean_flow(self) -> bool:
        """Whether the mean volume flow is kept at zero.

        Unless the case says: in a fully periodic box where bodies are free, gravity acts and no force
        drives the flow.
        """
        if self.fluid is None:
            return False
        if self.fluid.zero_mean_flow is not None:
            return self.fluid.zero_mean_flow
        has_free = any(_is_released(group) for group in self.bodies)
        return (
            all(self.domain.is_periodic)
            and has_free
            and any(self.domain.gravity)
            and not self.fluid.is_driven
        )

    def replace(self, changes: Mapping[str, Any] | None = None, **tables: Any) -> Case:
        """Return a case in which some values are others; all else stays, defaults that were filled in included.

        Parameters
        ----------
        changes : mapping of str to object, optional
            Dotted keys and their values, in SI or with a unit, such as ``{"fluid.viscosity": "0.2 Pa s"}``.
        **tables
            Whole tables, or the title; a table is replaced, not merged.

        Returns
        -------
        Case

        Raises
        ------
        CaseError
            The changed case is wrong; the message names the key.

        Examples
        --------
        >>> import rdpm
        >>> case = rdpm.load_case("dkt")
        >>> other = case.replace({"contact.restitution": 0.8}, fluid={"density": 962.0, "viscosity": 0.2})
        >>> other.contact.restitution, other.fluid.viscosity, other.time == case.time, case.contact.restitution
        (0.8, 0.2, True, 0.5)
        """
        raw = content(self)
        places = set_values(raw, {**tables, **(changes or {})})
        try:
            return type(self).model_validate(raw)
        except ValidationError as error:
            raise first_problem(error, raw, places, "", Known("case", type(self), {})) from None

    def expanded_bodies(self) -> BodyTable:
        """Return all bodies one by one, lattices and packings placed.

        Returns
        -------
        BodyTable
            Ids are the row numbers, in the order of the groups; the arrays are read-only.
        """
        from rdpm.config.placement import expand

        return expand(self.bodies, self.domain, self.walls)
