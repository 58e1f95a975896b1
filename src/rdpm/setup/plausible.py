"""Values of a case that are possible but hardly meant: most often a unit was forgotten."""

from __future__ import annotations

import math

import numpy as np

from rdpm.config.case import Case
from rdpm.setup.disk import fields_disk
from rdpm.setup.rows import EXPECTED_NS, PlanRow

__all__ = ["implausible"]

EARTH = 9.81  # m/s^2

#: Shares of the Earth's gravity beyond which a unit is suspected; between lie the Moon and the Sun.
GRAVITY = (0.1, 30.0)

#: Smallest diameter of a sphere that is suspected to be given in another unit than metres [m].
METRES = 0.5

#: Rows, pictures and checkpoints of a run beyond which their number is suspected.
OUTPUTS = {
    "table_every": (1_000_000, "rows"),
    "fields_every": (10_000, "pictures"),
    "checkpoint_every": (1_000, "files"),
}

#: Disk space of a run's pictures [bytes] and wall time of a run on one thread [s] that are suspected.
DISK, WALL = 1e12, 30 * 86400.0


def implausible(case: Case, cells: tuple[int, int, int] | None, steps: int) -> list[PlanRow]:
    """List the values of a case that are suspected to be given in another unit, each with what is absurd about it.

    Parameters
    ----------
    case : Case
    cells : tuple of int, optional
        Of the grid; None for a dry case.
    steps : int
        Of the run, at most.

    Returns
    -------
    list of PlanRow
        All of them warnings; empty for most cases.

    Examples
    --------
    >>> from rdpm.config.load import load_case
    >>> implausible(load_case("dkt", ["domain.gravity=[0, 0, -981]"]), (54, 54, 270), 1000)[0].note
    "100 times the Earth's; was it meant in cm/s^2?"
    """
    found = [*_gravity(case), *_diameter(case), *_duration(case, cells, steps), *_outputs(case, cells, steps)]
    return [PlanRow(name, value, "warning", note) for name, value, note in found]


def _gravity(case: Case) -> list[tuple[str, str, str]]:
    g = float(np.linalg.norm(case.domain.gravity))
    ratio = g / EARTH
    if g == 0.0 or GRAVITY[0] <= ratio <= GRAVITY[1]:
        return []
    units = {"cm/s^2": 1e2, "mm/s^2": 1e3, "km/s^2": 1e-3}
    meant = next((unit for unit, factor in units.items() if 0.9 < ratio / factor < 1.1), None)
    hint = f"was it meant in {meant}?" if meant else "is it in m/s^2?"
    return [("domain.gravity", f"{g:.4g} m/s^2", f"{ratio:.4g} times the Earth's; {hint}")]


def _diameter(case: Case) -> list[tuple[str, str, str]]:
    bodies = case.expanded_bodies()
    largest = float(bodies.diameter.max(initial=0.0))
    if largest < METRES:
        return []
    group = bodies.group[np.argmax(bodies.diameter)]
    return [(f"bodies[{group}].diameter", f"{largest:.4g} m", "a sphere of metres; was it meant in mm or cm?")]


def _duration(case: Case, cells: tuple[int, int, int] | None, steps: int) -> list[tuple[str, str, str]]:
    wall = steps * (math.prod(cells) if cells else 1) * EXPECTED_NS * 1e-9
    if wall <= WALL and steps <= 1e9:
        return []
    days = wall / 86400.0
    span = f"{days:.3g} days" if days < 3650.0 else f"{days / 365.25:.3g} years"
    took = f", about {span} on one thread" if cells else ""
    return [("time.end", f"{case.time.end:.4g} s", f"{steps:.3g} steps{took}; was it meant in another unit than s?")]


def _outputs(case: Case, cells: tuple[int, int, int] | None, steps: int) -> list[tuple[str, str, str]]:
    found = []
    for key, (most, what) in OUTPUTS.items():
        every = getattr(case.output, key)
        if not every:
            continue
        count = case.time.end / every
        fields = fields_disk(case, cells, steps) if key == "fields_every" else None
        size = float(fields.most) if fields else 0.0
        if count <= most and size <= DISK:
            continue
        taken = f", of which a run of {steps:.3g} steps makes one a step" if count > steps else ""
        disk = f", up to {size / 1e9:.3g} GB" if size else ""
        note = f"{count:.3g} {what}{taken}{disk}; was it meant in another unit than s?"
        found.append((f"output.{key}", f"{every:.4g} s", note))
    return found
