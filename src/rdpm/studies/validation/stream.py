r"""Drag of a fixed sphere in a uniform stream, Re 20 to 200.

The coefficient is :math:`C_d = F / (\tfrac12\rho_f U^2\,\pi d^2/4)` with the force F of the fluid on the sphere once
it is steady, against what solvers on grids fitted to a sphere give for an unbounded stream. The boundaries beside the
stream are free-slip. The box is a cube of 12 diameters with the sphere 7 diameters behind the inflow for Re 20 and
50, where a sphere is felt farther away, and one of 9 diameters with the sphere in the middle for Re 100 and 200. What
the coefficient owes to the box is measured on a coarser grid, with more room behind the sphere and in every
direction.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from rdpm.config.load import load_case
from rdpm.setup import Simulation
from rdpm.studies.validation.points import points
from rdpm.studies.validation.result import Found, Row, Tell

__all__ = ["Surroundings", "drag_coefficient", "stream"]

SOURCE = "Johnson & Patel 1999 and others"

BAND, QUICK_BAND = 0.03, 0.05

#: Cells a diameter; coarser for what the box does.
FINE, COARSE = 16, 8

#: Over SAMPLE [d/U] a steady coefficient changes by less than SETTLED; runs end at LONGEST [d/U] at the latest.
SAMPLE, SETTLED, LONGEST = 2.0, 1e-3, 20.0

#: Room that is added [diameters]; change of the coefficient with it behind the sphere, and in every direction.
MORE, BEHIND_BAND, ROOM_BAND = 4.0, 0.005, 0.02


@dataclass(frozen=True)
class Surroundings:
    """Of the sphere: the box's width, and its length before and behind the sphere's centre [diameters]."""

    width: float = 12.0
    before: float = 7.0
    behind: float = 5.0


#: For Re 20 and 50; for Re 100 and 200, which are felt less far away; for the quick run.
WIDE, NARROW, SMALL = Surroundings(), Surroundings(9.0, 4.5, 4.5), Surroundings(8.0, 4.0, 4.0)


def drag_coefficient(reynolds: float, across: int, room: Surroundings = WIDE) -> float:
    """Coefficient of the steady drag.

    Parameters
    ----------
    reynolds : float, [-]
        Of the diameter.
    across : int
        Cells a diameter.
    room : Surroundings

    Returns
    -------
    float, [-]
    """
    middle = 0.5 * room.width
    case = {
        "domain": {
            "size": [room.width, room.width, room.before + room.behind],
            "boundary": {"x": "free-slip", "y": "free-slip", "z": "inflow-outflow"},
            "gravity": [0, 0, 0],
            "inflow": {"velocity": 1.0},
        },
        "fluid": {"density": 1.0, "kinematic_viscosity": 1.0 / reynolds},
        "bodies": [{"diameter": 1.0, "density": 1.0, "motion": "fixed", "centers": [[middle, middle, room.before]]}],
        "resolution": {"cells_per_diameter": across},
        "time": {"end": LONGEST},
    }
    simulation = Simulation(load_case(case))
    immersed = simulation.system.immersed
    assert immersed is not None
    now, sampled = math.inf, 0.0
    while simulation.time < LONGEST * (1.0 - 1e-9):
        simulation.advance()
        if simulation.time < sampled + SAMPLE:
            continue
        before, now = now, float(immersed.hydrodynamic_force[0, 2]) / (0.125 * math.pi)
        sampled += SAMPLE
        if abs(now - before) < SETTLED * abs(now):
            break
    return now


def stream(quick: bool, tell: Tell) -> Found:
    """Rows for each Reynolds number, and what they owe to the box."""
    for reynolds, reference in zip(*points("isolated_sphere", "Re", "drag_coefficient"), strict=True):
        if quick and reynolds != 100.0:
            continue
        across, room = (COARSE, SMALL) if quick else (FINE, WIDE if reynolds < 100.0 else NARROW)
        tell(f"Re {reynolds:g}, {across} cells a diameter")
        yield Row(
            f"drag coefficient, Re {reynolds:g}, {across} cells/d", drag_coefficient(float(reynolds), across, room),
            float(reference), QUICK_BAND if quick else BAND, source=SOURCE,
        )  # fmt: skip
    if not quick:
        yield from _of_the_box(20.0, WIDE, tell)
        yield from _of_the_box(200.0, NARROW, tell)


def _of_the_box(reynolds: float, room: Surroundings, tell: Tell) -> Found:
    """Changes of the coefficient with other boxes, on the coarse grid."""
    alone = drag_coefficient(reynolds, COARSE, room)
    longer = replace(room, behind=room.behind + MORE)
    larger = replace(longer, before=room.before + MORE, width=room.width + MORE)
    for other, what, band in ((longer, "behind", BEHIND_BAND), (larger, "in every direction", ROOM_BAND)):
        tell(f"Re {reynolds:g}, {MORE:g} d more {what}, {COARSE} cells a diameter")
        change = drag_coefficient(reynolds, COARSE, other) / alone - 1.0
        name = f"change of the drag with {MORE:g} d more {what}, Re {reynolds:g}, {COARSE} cells/d"
        yield Row(name, change, None, band)
