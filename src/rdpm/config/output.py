"""What a run writes, and how often."""

from __future__ import annotations

from typing import Annotated, Literal, get_args

from pydantic import StrictBool

from rdpm.config.declared import Choice, LeftOut, Quantity, Whole
from rdpm.config.fields import Model

__all__ = ["Output"]

FigureFormat = Literal["png", "pdf", "svg"]
ROWS, FRAMES = 500, 50  # of the tables and of the fields, where the case does not say


class Output(Model):
    """What a run writes, and how often.

    Attributes
    ----------
    table_every
        Time between rows of the tables.
    fields_every
        Time between pictures of the flow and the bodies; 0 writes none.
    checkpoint_every
        Time between checkpoints, beside those every five minutes of wall time and at the end.
    checkpoints_kept
        The newest so many are kept.
    report
        Whether a run makes its figures and `report.html`.
    video
        Whether the report has a video.
    figure_format
        Charts are written as `png`, which the report holds, and in this format for print.
    """

    table_every: Annotated[float | None, Quantity("s", gt=0.0), LeftOut(f"time.end / {ROWS}")] = None
    fields_every: Annotated[float | None, Quantity("s", ge=0.0), LeftOut(f"time.end / {FRAMES}")] = None
    checkpoint_every: Annotated[float | None, Quantity("s", gt=0.0)] = None
    checkpoints_kept: Annotated[int, Whole(2, 10_000)] = 2
    report: StrictBool = True
    video: StrictBool = True
    figure_format: Annotated[FigureFormat, Choice(get_args(FigureFormat))] = "png"

    def filled(self, end: float) -> Output:
        """Return the same with the times that were left out, for a run until `end` [s]."""
        return self.model_copy(
            update={
                "table_every": end / ROWS if self.table_every is None else self.table_every,
                "fields_every": end / FRAMES if self.fields_every is None else self.fields_every,
            }
        )
