"""Memory that a run takes, process by process."""

from __future__ import annotations

import math
from dataclasses import dataclass

from rdpm.config.case import Case

__all__ = ["MemoryNeeds", "memory_needs"]

#: Python and the libraries that a run loads; what it loads besides to write fields [bytes].
LIBRARIES, WRITING = 80_000_000, 12_000_000

#: Of a cell: a picture of the flow as it is rounded and packed; vorticity and Q; sums of averages [bytes].
PICTURE, DERIVED, AVERAGES = 30, 30, 56

#: What the libraries that draw add to the run's process; the view of the bodies; the encoder of the video [bytes].
FIGURES, VIEW, ENCODER = 62_000_000, 565_000_000, 120_000_000

#: Of a body: its state, and a row of the tables as text [bytes].
BODY = 4_000


@dataclass(frozen=True)
class MemoryNeeds:
    """Peak memory of a run, by what takes it.

    Attributes
    ----------
    solver : int, [bytes]
        Fields, factors of the pressure solve, markers.
    libraries : int, [bytes]
        Python and what it loads to compute.
    output : int, [bytes]
        What a picture of the flow takes while it is written; averages.
    figures : int, [bytes]
        What the report adds afterwards to the same process.
    view, video : int, [bytes]
        Processes of their own, for the three-dimensional view of the bodies and the video.
    """

    solver: int
    libraries: int
    output: int
    figures: int
    view: int
    video: int

    @property
    def process(self) -> int:
        """Peak of the run's own process [bytes]; ``peak_memory_bytes`` of a run without a report."""
        return self.solver + self.libraries + max(self.output, self.figures)

    @property
    def at_once(self) -> int:
        """Peak of all its processes together [bytes]: what a batch system must grant."""
        return self.process + self.view + self.video

    def to_dict(self) -> dict[str, int]:
        """Plain numbers for machines [bytes]."""
        return {**vars(self), "process": self.process, "at_once": self.at_once}


def memory_needs(case: Case, cells: tuple[int, int, int] | None, solver: int) -> MemoryNeeds:
    """Tell what memory a run will take.

    Parameters
    ----------
    case : Case
    cells : tuple of int, optional
        Of the grid; None for a dry case.
    solver : int, [bytes]
        Of `rdpm.setup.scales.memory_needed`.

    Notes
    -----
    Measured on x86-64 Linux with the shipped cases, Python 3.11 and matplotlib, h5py and pyvista of 2025.

    Examples
    --------
    >>> from rdpm.config.load import load_case
    >>> needs = memory_needs(load_case("dkt"), (54, 54, 270), 56_000_000)
    >>> round(needs.process / 1e6), round(needs.at_once / 1e6)
    (198, 883)
    """
    output, count, bodies = case.output, math.prod(cells) if cells else 0, len(case.expanded_bodies())
    written = 0
    if output.fields_every:
        written = WRITING + count * (PICTURE + (DERIVED if output.vorticity or output.q_criterion else 0))
    sums = AVERAGES * count if output.average_from is not None else 0
    has_report = output.report
    return MemoryNeeds(
        solver=solver + sums + BODY * bodies,
        libraries=LIBRARIES,
        output=written,
        figures=FIGURES if has_report else 0,
        view=VIEW if has_report and bodies else 0,
        video=ENCODER if has_report and output.video else 0,
    )
