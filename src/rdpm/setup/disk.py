"""Disk that a run takes, file by file."""

from __future__ import annotations

import math
from dataclasses import dataclass

from rdpm.config.case import Case
from rdpm.io.sphere_surface import surface_level

__all__ = ["FieldsDisk", "bodies_disk", "checkpoint_bytes", "fields_disk", "run_disk", "size_text", "tables_disk"]

#: A value in single precision [bytes].
VALUE = 4

#: Part of the largest size that rounded fields take where most of the fluid is hardly disturbed.
QUIET = 0.25


#: Of ``bodies.vtkhdf``: its begun chunks, and of a point its triangles and its values in a picture, compressed [bytes].
BODIES, TRIANGLES, POINT = 85_000, 80, 10

#: A row of ``particles.csv`` with and without a fluid; of ``history.csv`` and ``timing.csv`` together; other texts; a
#: sample of the flow at a point [bytes].
WET_ROW, DRY_ROW, ROW, TEXTS, SAMPLE = 520, 320, 250, 8_000, 165

#: Arrays of a checkpoint the size of the grid with its halo, in double precision.
CHECKPOINT_ARRAYS = 7

#: Of a cell in ``averages.vtkhdf``, and in a checkpoint for them [bytes].
AVERAGE, AVERAGE_SUMS = 28, 56

#: Figures and report of a run with few bodies, and its video [bytes].
REPORT, VIDEO = 1_300_000, 80_000


@dataclass(frozen=True)
class FieldsDisk:
    """What ``fields.vtkhdf`` of a run takes.

    Attributes
    ----------
    count : int
        Pictures.
    least, most : int, [bytes]
        Equal where nothing is rounded. Of rounded fields `most` is what stirred fluid takes, `least` what spheres in a
        large tank at rest leave.
    """

    count: int
    least: int
    most: int

    def __str__(self) -> str:
        size = size_text(self.most) if self.least == self.most else f"{size_text(self.least)} to {size_text(self.most)}"
        return f"{self.count} pictures, {size}"


def fields_disk(case: Case, cells: tuple[int, int, int] | None, steps: int, start: float = 0.0) -> FieldsDisk | None:
    """Tell what the fields of a run will take.

    Parameters
    ----------
    case : Case
    cells : tuple of int, optional
        Of the grid; None for a dry case.
    steps : int
        Of the run.
    start : float, [s]
        Where it begins.

    Returns
    -------
    FieldsDisk or None
        None where it writes none.

    Notes
    -----
    Rounded by a tolerance t, a value within the largest magnitude has some log2(1/t) bits.

    Examples
    --------
    >>> from rdpm.config.load import load_case
    >>> str(fields_disk(load_case("dkt"), (54, 54, 270), 1000))
    '41 pictures, 44.2 MB to 177 MB'
    >>> str(fields_disk(load_case("dkt", ["output.fields_tolerance=0"]), (54, 54, 270), 1000))
    '41 pictures, 516 MB'
    """
    every, tolerance = case.output.fields_every, case.output.fields_tolerance
    if cells is None or not every:
        return None
    count = min(_times(case, every, start), steps + 1)
    each = 4 + (3 if case.output.vorticity else 0) + (1 if case.output.q_criterion else 0)
    values = count * each * math.prod(cells)
    if tolerance == 0.0:
        return FieldsDisk(count, VALUE * values, VALUE * values)
    most = min(math.log2(1.0 / tolerance) / 8.0, VALUE) * values
    return FieldsDisk(count, int(QUIET * most), int(most))


def bodies_disk(bodies: int, pictures: int) -> int:
    """What ``bodies.vtkhdf`` takes, about [bytes].

    Examples
    --------
    >>> bodies_disk(2, 41)
    714160
    """
    points = bodies * (10 * 4 ** surface_level(bodies) + 2)
    return BODIES + points * (TRIANGLES + POINT * pictures) if bodies else 0


def checkpoint_bytes(case: Case, cells: tuple[int, int, int] | None) -> int:
    """One checkpoint, about [bytes]."""
    if not cells:
        return 600 * len(case.expanded_bodies())
    sums = AVERAGE_SUMS * math.prod(cells) if case.output.average_from is not None else 0
    return 8 * CHECKPOINT_ARRAYS * math.prod(n + 2 for n in cells) + sums + 600 * len(case.expanded_bodies())


def tables_disk(case: Case, start: float = 0.0) -> dict[str, int]:
    """Tables of bodies and of the run's health, and other texts [bytes]."""
    rows, bodies = _times(case, case.output.table_every or case.time.end, start), len(case.expanded_bodies())
    row = DRY_ROW if case.fluid is None else WET_ROW
    return {"particles.csv": rows * bodies * row, "other tables and texts": TEXTS + rows * ROW}


def run_disk(case: Case, cells: tuple[int, int, int] | None, steps: int) -> dict[str, tuple[int, int]]:
    """Tell what each file of a run will take, at least and at most.

    Parameters
    ----------
    case : Case
    cells : tuple of int, optional
        Of the grid; None for a dry case.
    steps : int
        Of the run.

    Returns
    -------
    dict of str to (int, int), [bytes]
        By file; both are equal but for rounded fields. A row a contact in ``contacts.csv`` and tables of the user's own
        are not counted.

    Examples
    --------
    >>> from rdpm.config.load import load_case
    >>> found = run_disk(load_case("dkt", ["output.report=false"]), (54, 54, 270), 1000)
    >>> list(found), found["checkpoints"]
    (['particles.csv', 'other tables and texts', 'fields.vtkhdf', 'bodies.vtkhdf', 'checkpoints'], (95537504, 95537504))
    """
    output, bodies, flow = case.output, len(case.expanded_bodies()), fields_disk(case, cells, steps)
    found = {name: (size, size) for name, size in tables_disk(case).items()}
    if flow:
        found["fields.vtkhdf"] = flow.least, flow.most
    once: dict[str, int] = {}
    if output.fields_every:
        once["bodies.vtkhdf"] = bodies_disk(bodies, min(_times(case, output.fields_every), steps + 1))
    if cells:
        samples = min(_times(case, output.sample_every or case.time.end), steps + 1)
        once["points.csv"] = SAMPLE * samples * len(output.points)
        once["lines.csv"] = SAMPLE * samples * sum(line.count for line in output.lines)
        pictures = min(_times(case, output.planes_every or case.time.end), steps + 1)
        layers = (math.prod(cells) // cells["xyz".index(plane.normal)] for plane in output.planes)
        once["planes"] = 4 * VALUE * pictures * sum(layers)
        once["averages.vtkhdf"] = AVERAGE * math.prod(cells) if output.average_from is not None else 0
    once["checkpoints"] = output.checkpoints_kept * checkpoint_bytes(case, cells)
    once["figures and report"] = REPORT if output.report else 0
    once["video.mp4"] = VIDEO if output.report and output.video else 0
    return found | {name: (size, size) for name, size in once.items() if size}


def _times(case: Case, every: float, start: float = 0.0) -> int:
    """Multiples of an interval in a run, both ends counted."""
    return math.floor((case.time.end - start) / every * (1.0 + 1e-9)) + 1


def size_text(size: int) -> str:
    """Such as ``44.2 MB``."""
    return f"{size / 1e9:.3g} GB" if size >= 1e9 else f"{size / 1e6:.3g} MB"
