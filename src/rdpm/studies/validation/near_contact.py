r"""Approach in Stokes flow, to a wall and of two equal spheres: what the grid resolves, and what lubrication adds.

Bodies move at a given speed, so slowly that they hardly change place, at one gap after another; the hydrodynamic force
over :math:`6\pi\mu aU` is the resolved resistance. With the correction of `rdpm.contacts.Lubrication` at the same gap
it is compared with the exact series of Brenner, Chem. Eng. Sci. 16 (1961) 242-251 (wall) and Maude, Brit. J. Appl.
Phys. 12 (1961) 293-295 (two spheres). Wide gaps feel the box too.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rdpm.setup.build import lubrication_correction
from rdpm.studies.validation.points import points
from rdpm.studies.validation.result import Chart, Curve, Found, Row, Tell
from rdpm.studies.validation.slow_motion import SPEED, slow_motion

__all__ = ["lubrication_resistance", "near_contact", "resolved_resistance"]

SOURCE = {"wall": "Brenner 1961", "spheres": "Maude 1961"}

#: Gaps over the radius, from wide to narrow.
GAPS = (2.0, 1.0, 0.5, 0.3, 0.2, 0.1, 0.05, 0.02, 0.01)
BAND = 0.10

#: Viscous number nu dt / h^2 of a step, and others for the wall at 8 cells a diameter; viscous times (radius squared
#: over nu) until steady from rest, and from one gap to the next.
STEP, OTHER_STEPS = 0.6, (1.8, 0.15)
START, NEXT = 12.0, 2.5

#: Offsets from a corner of a cell, lateral ones and, for two spheres, that of their middle [cells]; means are shown.
OFFSETS = ((0.125, 0.375, 0.2), (0.5, 0.0, 0.45))

#: Edges of the box [diameters].
BOX = (7.0, 7.0, 6.0)


def resolved_resistance(
    pair: str, across: int, gaps: tuple[float, ...], step: float = STEP, offset: tuple[float, float, float] = OFFSETS[0]
) -> NDArray[np.float64]:
    """Force over 6 pi mu a U at each gap.

    Parameters
    ----------
    pair : str
        "wall" or "spheres".
    across : int
        Cells a diameter.
    gaps : tuple of float, [radii]
        From wide to narrow.
    step : float, [-]
        Viscous number nu dt / h^2.
    offset : tuple of float, [cells]
        Of the sphere, or of the middle of two, from a corner of a cell; the third only of two.
    """
    motions = [{"velocity": [0.0, 0.0, v]} for v in ([-SPEED] if pair == "wall" else [-SPEED, SPEED])]
    states = slow_motion(pair, across, gaps, offset, motions, box=BOX, step=step, settling=(START, NEXT))
    found = [float(np.mean(np.abs(state.hydrodynamic_force[:, 2])) / (3.0 * np.pi * SPEED)) for state in states]
    return np.array(found)


def lubrication_resistance(pair: str, across: float, gaps: tuple[float, ...]) -> NDArray[np.float64]:
    """Resistance the lubrication correction adds, over 6 pi mu a."""
    model = lubrication_correction(1.0, 1.0 / across)
    radius_j = np.inf if pair == "wall" else 0.5
    per_closing = model.resistance(0.5 * np.array(gaps), 0.5, radius_j) / (3.0 * np.pi)
    # two spheres close at twice the speed of each
    added: NDArray[np.float64] = per_closing * (1.0 if pair == "wall" else 2.0)
    return added


def near_contact(quick: bool, tell: Tell) -> Found:
    """Resolved and modelled resistance at 8 and 16 cells a diameter (quick: the wall at 8, one place in a cell)."""
    for pair in ("wall",) if quick else ("wall", "spheres"):
        gap, exact = points("approach_stokes", "gap_over_a", "resistance", pair=pair)
        order = np.argsort(gap)
        gap, exact = gap[order], exact[order]
        curves = [Curve("exact", gap, exact, True)]
        gaps = tuple(g for g in GAPS if g in gap)
        for across in (8,) if quick else (8, 16):
            tell(f"{pair}, {across} cells a diameter")
            places = OFFSETS[:1] if quick else OFFSETS
            resolved = np.mean([resolved_resistance(pair, across, gaps, STEP, place) for place in places], axis=0)
            total = resolved + lubrication_resistance(pair, across, gaps)
            for g, alone, both in zip(gaps, resolved, total, strict=True):
                reference = float(exact[gap == g][0])
                yield Row(
                    f"{pair}, gap {g:g} a, {across} cells/d (resolved {alone:.3g}, lubrication {both - alone:.3g})",
                    float(both),
                    reference,
                    BAND if across == 16 else None,
                    source=SOURCE[pair],
                )
            curves += [
                Curve(f"resolved, {across} cells a diameter", np.array(gaps), resolved),
                Curve("  with lubrication", np.array(gaps), total),
            ]
        for step in () if quick or pair == "spheres" else OTHER_STEPS:
            tell(f"{pair}, 8 cells a diameter, nu dt / h^2 = {step:g}")
            for g, alone in zip(gaps, resolved_resistance(pair, 8, gaps, step), strict=True):
                yield Row(f"{pair}, gap {g:g} a, 8 cells/d, resolved at nu dt / h^2 = {step:g}", float(alone))
        yield Chart(
            f"near_contact_{pair}",
            "Approach to a wall" if pair == "wall" else "Approach of two spheres",
            "gap / radius",
            "force / (6 pi mu a U)",
            "Stokes flow; box of 7 x 7 x 6 (spheres: 7) diameters, periodic along the wall",
            curves,
            log_x=True,
            log_y=True,
        )
