"""A steel sphere falls onto the floor of a tank of silicone oil and rebounds, St 152.

Measured by Gondret, Lance and Petit, Phys. Fluids 14 (2002) 643-652: d = 3 mm, 7800 in 935 kg/m3, 0.010 Pa s. The
approach is prescribed until the gap is one radius, as in the shipped case `rebound`, but at the impact speed of
0.585 m/s from 12 diameters above the floor: the wake of the last diameters is there, at half of the time. The second
and the third impact are those of a sphere that falls back through its own wake.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from rdpm.studies.validation.points import points
from rdpm.studies.validation.result import Chart, Curve, Found, Row, Tell
from rdpm.studies.validation.wall_impact import Sphere, Track, peaks, recorded_impacts, wall_impact

__all__ = ["rebound"]

SOURCE = "Gondret et al. 2002"

Floats = NDArray[np.float64]

SPHERE = Sphere(3e-3, 0.585, 935.0, 0.010)

#: Start of the centre above the floor [diameters].
START = 12.5

#: Time after impact that holds three rebounds, and the top of the first [s]; lower rebounds are not counted [m].
AFTER, AFTER_FIRST, LEAST = 0.15, 0.05, 0.01 * SPHERE.diameter

#: Relative, of the first and the second height; absolute, of these two restitutions. Recorded gaps are read to some
#: 0.05 mm, which is 0.08 of the third one.
PEAK_BANDS, RESTITUTION_BAND = (0.05, 0.10), 0.05

#: Cells a diameter, step [s], contact steps and start [diameters] of the runs that are varied; their bands.
VARIED = (12, 0.025e-3, 12, 5.5)
PLACE_BAND, STEP_BAND, CONTACT_BAND = 0.05, 0.03, 0.05


def _fall(across: float, step: float, contact_steps: float, offset: float, after: float, start: float) -> Track:
    contact = {"contact_steps": contact_steps}
    return wall_impact(SPHERE, across, step, contact, start=start, after=after, offset=offset)


def _first_peak(across: float, step: float, contact_steps: float, offset: float, wake: float) -> float:
    """Height of the first rebound [m] after a fall from so many diameters."""
    track = _fall(across, step, contact_steps, offset, AFTER_FIRST, wake)
    return peaks(track.time, track.gap, LEAST)[0]


def _dependence(tell: Tell) -> Iterator[Row]:
    """What step, contact time and place within a cell change in the first rebound, after a shorter fall."""
    across, step, steps, wake = VARIED

    def row(what: str, found: float, band: float | None) -> Row:
        return Row(f"rebound 1, {across} cells/d, {what}", 1e3 * found, 1e3 * base, band, "mm", "the row above")

    tell(f"{across} cells a diameter, from {wake:g} diameters, offset 0")
    places = [base := _first_peak(across, step, steps, 0.0, wake)]
    label = f"dt {1e3 * step:g} ms, {steps} contact steps"
    yield Row(f"rebound 1, {across} cells/d, from {wake:g} d, {label}", 1e3 * base, unit="mm")
    for offset in (0.2, 0.4, 0.6, 0.8):
        tell(f"offset {offset:g} cells")
        places.append(_first_peak(across, step, steps, offset, wake))
    yield row("five places in a cell, lowest", min(places), PLACE_BAND)
    yield row("five places in a cell, highest", max(places), PLACE_BAND)
    tell("half the step")
    yield row("half the step, the same contact time", _first_peak(across, 0.5 * step, 2 * steps, 0.0, wake), STEP_BAND)
    for other, dt in ((8, step), (30, 12 / 30 * step)):
        tell(f"{other} contact steps")
        what = f"{other} contact steps of {1e3 * dt:.3g} ms"
        yield row(what, _first_peak(across, dt, other, 0.0, wake), CONTACT_BAND)


def rebound(quick: bool, tell: Tell) -> Found:
    """Heights of three rebounds at 16 cells a diameter; what place, step and contact time change in the first at 12."""
    time, gap = points("gondret_2002", "time_s", "gap_m")
    measured = peaks(time, gap, LEAST)
    across, step, steps = (10, 0.05e-3, 8) if quick else (16, 0.02e-3, 16)
    tell(f"{across} cells a diameter")
    track = _fall(across, step, steps, 0.0, AFTER, START)
    t, g = track.time, track.gap
    for n, (height, reference) in enumerate(zip(peaks(t, g, LEAST), measured, strict=True)):
        what = f"rebound {n + 1}, {across} cells/d, dt {1e3 * step:g} ms, {steps} contact steps"
        band = None if quick or n >= len(PEAK_BANDS) else PEAK_BANDS[n]
        yield Row(what, 1e3 * height, 1e3 * reference, band, "mm", SOURCE)
    recording = recorded_impacts(time, gap, time, gap)
    for n, (ours, theirs) in enumerate(zip(recorded_impacts(time, gap, t, g), recording, strict=False)):
        stokes = ", ".join(f"{SPHERE.stokes_number(speed):.0f}" for speed, _ in (theirs, ours))
        band = None if quick or n >= len(PEAK_BANDS) else RESTITUTION_BAND / theirs[1]
        what = f"restitution, impact {n + 1} (St measured, computed: {stokes})"
        yield Row(what, ours[1], theirs[1], band, "", SOURCE)
    yield Row(f"largest overlap, {across} cells/d, dt {1e3 * step:g} ms", 100.0 * track.deepest, unit="% d")
    if quick:
        return
    yield from _dependence(tell)
    yield Chart(
        "rebound",
        "Rebound of a steel sphere in oil, St 152",
        "time from impact [ms]",
        "gap [mm]",
        f"d = 3 mm, 7800 in 935 kg/m³, 0.010 Pa s; {across} cells a diameter, dt = {1e3 * step:g} ms",
        [Curve("measured", 1e3 * time, 1e3 * gap, True), Curve("rdpm", 1e3 * t[t > -0.012], 1e3 * g[t > -0.012])],
    )
