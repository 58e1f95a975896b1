"""What a run writes, and how often."""

from __future__ import annotations

from typing import Annotated

from pydantic import StrictBool

from rdpm.config.declared import LeftOut, Quantity, Whole
from rdpm.config.fields import Model

__all__ = ["Output"]

ROWS, FRAMES = 500, 50  # of the tables and of the fields, where the case does not say


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
    report
        Whether a run makes its figures and `report.html`.
    video
        Whether the report has a video.
    """

    table_every: Annotated[float | None, Quantity("s", gt=0.0), LeftOut(f"time.end / {ROWS}")] = None
    fields_every: Annotated[float | None, Quantity("s", ge=0.0), LeftOut(f"time.end / {FRAMES}")] = None
    fields_tolerance: Annotated[float, Quantity("", ge=0.0, le=0.1)] = 5e-4
    checkpoint_every: Annotated[float | None, Quantity("s", gt=0.0)] = None
    checkpoints_kept: Annotated[int, Whole(2, 10_000)] = 2
    report: StrictBool = True
    video: StrictBool = True

    def filled(self, end: float) -> Output:
        """Return the same with the times that were left out, for a run until `end` [s]."""
        return self.model_copy(
            update={
                "table_every": end / ROWS if self.table_every is None else self.table_every,
                "fields_every": end / FRAMES if self.fields_every is None else self.fields_every,
            }
        )
