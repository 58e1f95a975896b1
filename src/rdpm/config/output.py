"""What a run writes, and how often."""

from __future__ import annotations

from typing import Annotated

from pydantic import StrictBool

from rdpm.config.fields import Model, number, whole

__all__ = ["Output"]

ROWS, FRAMES = 500, 50  # of the tables and of the fields, where the case does not say


class Output(Model):
    """What a run writes, and how often.

    Attributes
    ----------
    table_every : float, [s]
        Time between rows of the tables, > 0; ``time.end / 500`` when left out.
    fields_every : float, [s]
        Time between pictures of the flow and the bodies; 0 writes none; ``time.end / 50`` when left out.
    checkpoint_every : float, optional, [s]
        Time between checkpoints, > 0, beside those every five minutes of wall time and at the end.
    checkpoints_kept : int
        The newest so many are kept, 2 to 10000.
    report : bool
        Whether a run makes its figures and ``report.html``.
    video : bool
        Whether the report has a video.
    """

    table_every: Annotated[float | None, number("s", above=0.0)] = None
    fields_every: Annotated[float | None, number("s", least=0.0)] = None
    checkpoint_every: Annotated[float | None, number("s", above=0.0)] = None
    checkpoints_kept: Annotated[int, whole(2, 10_000)] = 2
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
