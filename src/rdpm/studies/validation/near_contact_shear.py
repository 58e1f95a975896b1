r"""Shear and rotation in Stokes flow, beside a wall and of two equal spheres: what the grid resolves, and lubrication.

Bodies move at a given velocity and turn at a given rate, so slowly that they hardly change place, at one gap after
another. Motions that the mirror planes of the pair keep apart share a run. With `rdpm.contacts.TangentialLubrication`
at the same gap, forces over :math:`6\pi\mu aU` and torques over :math:`8\pi\mu a^2U` or :math:`8\pi\mu a^3\Omega` are
compared with O'Neill, Mathematika 11 (1964) 67-74, Dean and O'Neill, Mathematika 10 (1963) 13-24 (wall), and the
scalars of Jeffrey and Onishi, J. Fluid Mech. 139 (1984) 261-290 (two spheres). Wide gaps feel the box too.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rdpm.particles.calibration import CALIBRATION, Calibration
from rdpm.setup.build import lubrication_correction
from rdpm.studies.validation.points import points
from rdpm.studies.validation.result import Chart, Curve, Found, Row, Tell
from rdpm.studies.validation.slow_motion import SPEED, slow_motion

__all__ = ["near_contact_shear", "resolved_shear", "tangential_resistance"]

Floats = NDArray[np.float64]
Vector = tuple[int, int, int]

SOURCE = {"wall": "O'Neill 1964, Dean and O'Neill 1963", "spheres": "Jeffrey and Onishi 1984"}
TABLE = "tangential_stokes"

#: Quantities of each pair, as in the table of references.
QUANTITIES = {
    "wall": ("translation force", "translation torque", "rotation torque"),
    "spheres": ("shear force", "shear torque", "rotation torque, alike", "rotation torque, opposite",
                "twist torque, alike", "twist torque, opposite"),
}  # fmt: skip

#: Drawn: two of each pair.
DRAWN = ("translation force", "rotation torque", "shear force", "rotation torque, opposite")

#: Largest difference by cells a diameter. A torque of translation smaller than the last is not judged: it is the small
#: difference of what slip and roll do.
BANDS, LEAST_JUDGED = {8: 0.15, 16: 0.10}, 0.1

#: Viscous number nu dt / h^2 of a step; viscous times (radius squared over nu) until steady from rest, and from one
#: gap to the next.
STEP, START, NEXT = 0.6, 10.0, 1.5

#: Offsets from a corner of a cell that keep both mirror planes, lateral ones and, for two spheres, that of their middle
#: [cells]; means are shown.
OFFSETS = ((0.5, 0.0, 0.45), (0.0, 0.5, 0.2))

#: Edges of the box [diameters].
BOX = (6.0, 6.0, 5.0)


def resolved_shear(
    pair: str, across: int, gaps: tuple[float, ...], offset: tuple[float, float, float] = OFFSETS[0]
) -> dict[str, Floats]:
    """Resolved value of each of `QUANTITIES` at each gap.

    Parameters
    ----------
    pair : str
        "wall" or "spheres".
    across : int
        Cells a diameter.
    gaps : tuple of float, [radii]
        From wide to narrow.
    offset : tuple of float, [cells]
        Of the sphere, or of the middle of two, from a corner of a cell; the third only of two.
    """
    found: tuple[Floats, ...]
    if pair == "wall":
        force, torque = _loads(pair, across, gaps, offset, [((1, 0, 0), (1, 0, 0))])
        found = force[:, 0, 0], torque[:, 0, 1], torque[:, 0, 0]
    else:
        # velocity and rotation of each: what does not share a mirror plane does not mix
        first = [((1, 0, 0), (1, 0, 1)), ((-1, 0, 0), (1, 0, -1))]
        second = [((0, 0, 0), (1, 0, 1)), ((0, 0, 0), (-1, 0, 1))]
        force, torque = _loads(pair, across, gaps, offset, first)
        _, other = _loads(pair, across, gaps, offset, second)
        sign = np.array([1.0, -1.0])
        found = (
            (force[:, :, 0] @ sign) / 2, torque[:, :, 1].mean(1), torque[:, :, 0].mean(1),
            (other[:, :, 0] @ sign) / 2, other[:, :, 2].mean(1), (torque[:, :, 2] @ sign) / 2,
        )  # fmt: skip
    return {name: np.abs(values) for name, values in zip(QUANTITIES[pair], found, strict=True)}


def _loads(
    pair: str,
    across: int,
    gaps: tuple[float, ...],
    offset: tuple[float, float, float],
    motions: list[tuple[Vector, Vector]],
) -> tuple[Floats, Floats]:
    """Force over 6 pi mu a U and torque over 8 pi mu a^2 U of each body, (gaps, bodies, 3); rates are U over a."""
    given = [
        {"velocity": [SPEED * c for c in velocity], "rotation": [2.0 * SPEED * c for c in rotation]}
        for velocity, rotation in motions
    ]
    force, torque = [], []
    for state in slow_motion(pair, across, gaps, offset, given, box=BOX, step=STEP, settling=(START, NEXT)):
        force.append(state.hydrodynamic_force / (3.0 * np.pi * SPEED))
        torque.append(state.hydrodynamic_torque / (2.0 * np.pi * SPEED))
    return np.array(force), np.array(torque)


def tangential_resistance(
    pair: str, across: float, gaps: tuple[float, ...], calibration: Calibration = CALIBRATION
) -> dict[str, Floats]:
    """What tangential lubrication adds to each of `QUANTITIES`; nothing to twist."""
    model, gap = lubrication_correction(1.0, 1.0 / across, calibration=calibration), np.array(gaps)
    slip, roll = model.tangential_resistance(0.5 * gap, 0.5, np.inf if pair == "wall" else 0.5)
    force, torque = 3.0 * np.pi, 4.0 * np.pi  # per mu U: a is a half
    added: tuple[Floats, ...]
    if pair == "wall":
        lever = 1.0 + gap
        added = (slip + roll) / force, (slip - roll) * lever / torque, (slip + roll) * lever**2 / torque
    else:  # both slip or roll with twice the speed of one
        lever, slip, roll, none = 1.0 + 0.5 * gap, 2.0 * slip, 2.0 * roll, np.zeros_like(gap)
        added = (slip / force, slip * lever / torque, slip * lever**2 / torque, roll * lever**2 / torque, none, none)
    return dict(zip(QUANTITIES[pair], added, strict=True))


def near_contact_shear(quick: bool, tell: Tell) -> Found:
    """Resolved and modelled values at 8 and 16 cells a diameter (quick: the wall at 8, one place in a cell)."""
    for pair in ("wall",) if quick else ("wall", "spheres"):
        exact = {name: points(TABLE, "gap_over_a", "value", pair=pair, quantity=name) for name in QUANTITIES[pair]}
        gaps = tuple(exact[QUANTITIES[pair][0]][0].tolist())
        totals: dict[int, tuple[dict[str, Floats], dict[str, Floats]]] = {}
        for across in (8,) if quick else (8, 16):
            tell(f"{pair}, {across} cells a diameter")
            places = [resolved_shear(pair, across, gaps, place) for place in (OFFSETS[:1] if quick else OFFSETS)]
            added = tangential_resistance(pair, across, gaps)
            resolved = {name: np.mean([one[name] for one in places], axis=0) for name in QUANTITIES[pair]}
            totals[across] = resolved, {name: resolved[name] + added[name] for name in resolved}
            for name in QUANTITIES[pair]:
                for gap, reference, alone, both in zip(*exact[name], *(part[name] for part in totals[across])):  # noqa: B905
                    yield Row(
                        f"{pair}, {name}, gap {gap:g} a, {across} cells/d (resolved {alone:.3g}, "
                        f"lubrication {both - alone:.3g})",
                        float(both),
                        float(reference),
                        BANDS[across] if reference > LEAST_JUDGED else None,
                        source=SOURCE[pair],
                    )
        for name in QUANTITIES[pair]:
            if name in DRAWN:
                yield _chart(pair, name, exact[name], {across: (r[name], t[name]) for across, (r, t) in totals.items()})


def _chart(pair: str, name: str, exact: tuple[Floats, Floats], found: dict[int, tuple[Floats, Floats]]) -> Chart:
    gap, values = exact
    curves = [Curve("exact", gap, values, True)]
    for across, (resolved, total) in found.items():
        curves.append(Curve(f"resolved, {across} cells a diameter", gap, resolved))
        curves.append(Curve("  with lubrication", gap, total))
    return Chart(
        f"near_contact_{pair}_{name.replace(',', '').replace(' ', '_')}",
        f"{'Beside a wall' if pair == 'wall' else 'Two spheres'}: {name}",
        "gap / radius",
        "force / (6 pi mu a U)" if "force" in name else "torque / (8 pi mu a^3 Omega)",
        "Stokes flow; box of 6 x 6 x 5 (spheres: 6) diameters, periodic along the wall",
        curves,
        log_x=True,
    )
