"""Disk that the pictures of the flow take."""

from __future__ import annotations

import math
from dataclasses import dataclass

from rdpm.config.case import Case
from rdpm.io.sphere_surface import surface_level

__all__ = ["FieldsDisk", "bodies_disk", "fields_disk"]

#: Velocity and pressure of a cell in single precision [bytes].
CELL = 16

#: Values of a cell.
VALUES = 4

#: Part of the largest size that rounded fields take where most of the fluid is hardly disturbed.
QUIET = 0.25


#: Of ``bodies.vtkhdf``: its begun chunks, and of a point its triangles and its values in a picture, compressed [bytes].
BODIES, TRIANGLES, POINT = 85_000, 80, 10


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
        size = _size(self.most) if self.least == self.most else f"{_size(self.least)} to {_size(self.most)}"
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
    count = min(math.floor((case.time.end - start) / every * (1.0 + 1e-9)), steps) + 1
    values = count * math.prod(cells)
    if tolerance == 0.0:
        return FieldsDisk(count, CELL * values, CELL * values)
    most = min(VALUES * math.log2(1.0 / tolerance) / 8.0, CELL) * values
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


def _size(size: int) -> str:
    return f"{size / 1e9:.3g} GB" if size >= 1e9 else f"{size / 1e6:.3g} MB"
