"""What a run writes, and how often."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, Literal, get_args

from pydantic import BeforeValidator, StrictBool

from rdpm.config.declared import Choice, Components, EachOf, LeftOut, Quantity, Whole, items
from rdpm.config.fields import Model, Vector, Vectors
from rdpm.config.probes import Line, Plane
from rdpm.config.rule import RuleError

__all__ = ["Output"]

FigureFormat = Literal["png", "pdf", "svg"]
ROWS, FRAMES = 500, 50  # of the tables and of the fields, where the case does not say


def _tables(key: str) -> Callable[[Any], tuple[Any, ...]]:
    def listed(value: Any) -> tuple[Any, ...]:
        if isinstance(value, dict):
            rule, cure = "must be a list of tables", f"Write [[output.{key}]], not [output.{key}]."
            raise RuleError(rule, cure=cure, value=value)
        return tuple(items(value))

    return listed


class Output(Model):
    """What a run writes, and how often.

    Attributes
    ----------
    table_every
        Time between rows of the tables.
    fields_every
        Time between pictures of the flow and the bodies; 0 writes none.
    fields_tolerance
        Error of velocity and pressure in the pictures of the flow, over the largest magnitude of each: rounded so, they
        take a twelfth of the disk. 0 keeps them in single precision.
    checkpoint_every
        Time between checkpoints, beside those every five minutes of wall time and at the end.
    checkpoints_kept
        The newest so many are kept.
    points
        Where `points.csv` samples the flow.
    lines
        Likewise `lines.csv`.
    planes
        Each has a file of its own, `plane-0.vtkhdf` and so on.
    sample_every
        Time between samples of points and lines.
    planes_every
        Time between pictures of the planes.
    average_from
        Start of the time averages in `averages.vtkhdf`; none are made without it.
    average_every
        Time between the samples that are averaged.
    vorticity
        Whether the fields hold the vorticity too.
    q_criterion
        Whether the fields hold the Q criterion too.
    report
        Whether a run makes its figures and `report.html`.
    video
        Whether the report has a video.
    figure_format
        Charts are written as `png`, which the report holds, and in this format for print.
    """

    table_every: Annotated[float | None, Quantity("s", gt=0.0), LeftOut(f"time.end / {ROWS}")] = None
    fields_every: Annotated[float | None, Quantity("s", ge=0.0), LeftOut(f"time.end / {FRAMES}")] = None
    fields_tolerance: Annotated[float, Quantity("", ge=0.0, le=0.1)] = 5e-4
    checkpoint_every: Annotated[float | None, Quantity("s", gt=0.0)] = None
    checkpoints_kept: Annotated[int, Whole(2, 10_000)] = 2
    points: Annotated[Vectors, EachOf(Components(Quantity("m")))] = ()
    lines: Annotated[tuple[Line, ...], BeforeValidator(_tables("lines"))] = ()
    planes: Annotated[tuple[Plane, ...], BeforeValidator(_tables("planes"))] = ()
    sample_every: Annotated[float | None, Quantity("s", gt=0.0), LeftOut("`table_every`")] = None
    planes_every: Annotated[float | None, Quantity("s", gt=0.0), LeftOut(f"time.end / {FRAMES}")] = None
    average_from: Annotated[float | None, Quantity("s", ge=0.0)] = None
    average_every: Annotated[float | None, Quantity("s", gt=0.0), LeftOut("`table_every`")] = None
    vorticity: StrictBool = False
    q_criterion: StrictBool = False
    report: StrictBool = True
    video: StrictBool = True
    figure_format: Annotated[FigureFormat, Choice(get_args(FigureFormat))] = "png"

    def filled(self, end: float) -> Output:
        """Return the same with the times that were left out, for a run until `end` [s]."""
        rows = end / ROWS if self.table_every is None else self.table_every
        filled = {"table_every": rows, "fields_every": end / FRAMES}
        if self.points or self.lines:
            filled["sample_every"] = rows
        if self.planes:
            filled["planes_every"] = end / FRAMES
        if self.average_from is not None:
            filled["average_every"] = rows
        return self.model_copy(update={key: value for key, value in filled.items() if getattr(self, key) is None})

    @property
    def samples_flow(self) -> str:
        """The first key that asks for samples of the flow; empty without one."""
        asked = {
            "points": self.points, "lines": self.lines, "planes": self.planes, "vorticity": self.vorticity,
            "q_criterion": self.q_criterion, "average_from": self.average_from is not None,
        }  # fmt: skip
        return next((key for key, value in asked.items() if value), "")

    def check_places(self, size: Vector, end: float) -> None:
        """Refuse samples outside a box of this size [m], and averages that begin after the end [s]."""
        places: list[tuple[tuple[str | int, ...], Vector]] = [(("points", n), at) for n, at in enumerate(self.points)]
        for n, line in enumerate(self.lines):
            places += [(("lines", n, "start"), line.start), (("lines", n, "end"), line.end)]
        for at, point in places:
            axis = next((d for d in range(3) if not 0.0 <= point[d] <= size[d]), None)
            if axis is not None:
                rule = f"must lie in the box, between 0 and {size[axis]:g} m along {'xyz'[axis]}"
                raise RuleError(rule, value=point, at=("output", *at))
        for n, plane in enumerate(self.planes):
            length = size["xyz".index(plane.normal)]
            if plane.position > length:
                rule = f"must be at most {length:g} m, the size of the box along {plane.normal}"
                raise RuleError(rule, value=plane.position, at=("output", "planes", n, "position"))
        if self.average_from is not None and not self.average_from < end:
            rule = f"must be before time.end = {end:g} s"
            raise RuleError(rule, "nothing would be averaged", value=self.average_from, at=("output", "average_from"))
