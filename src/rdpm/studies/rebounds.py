"""The first rebound of a body from a wall, seen from outside of the lubrication range."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm import design
from rdpm.results.run import Run

__all__ = ["first_rebound"]

Floats = NDArray[np.float64]

#: Gap at which speeds are read [diameters], and in cells where these are coarser.
OUTSIDE, OUTSIDE_CELLS = 0.1, 1.0

#: Of the approach: slower than this at its nearest, a body that did not touch was stopped by lubrication.
STOPPED = 0.1


def first_rebound(run: Run) -> dict[str, float | None]:
    r"""Speeds before and after the first impact on a wall, their ratio, and the height of the rebound.

    Parameters
    ----------
    run : Run

    Returns
    -------
    dict
        ``approach_speed_m_s`` at the last passage, before the impact, of a gap of 0.1 d (one cell if that is more):
        there the resolved fluid, not the correction, decides. ``rebound_speed_m_s``: that at which it passes the same
        gap on its way back; 0 where it does not come so far before the next impact or within the record.
        ``wet_restitution``: their ratio. ``approach_stokes_number`` :math:`\rho_p v d/(9\mu)` of the approach.
        ``rebound_height_m``: largest gap until the next impact, by a parabola through three rows. None where there is
        no impact on a wall, the approach begins nearer, or, for the height, the body still rises at the end of the
        record. A single body that lubrication stops before it touches has met the wall where it came nearest, if it had
        lost 90 % of the approach there.
    """
    names = (
        "approach_speed_m_s", "rebound_speed_m_s", "wet_restitution", "approach_stokes_number", "rebound_height_m"
    )  # fmt: skip
    found: dict[str, float | None] = dict.fromkeys(names, None)
    impact = _first_impact(run) or _nearest_wall(run)
    if impact is None or run.tracks is None:
        return found
    body, wall, start, following = impact
    t = run.tracks.times
    gap, away = _from_wall(run, body, wall)
    d = float(run.diameter[body])
    level = max(OUTSIDE * d, OUTSIDE_CELLS * max(run.summary.spacing_m or (0.0,)))
    before, after = np.flatnonzero(t <= start), np.flatnonzero((t > start) & (t < following))
    approach = _passage(gap[before][::-1], -away[before][::-1], level)
    touched = run.contacts is not None and bool(np.any(run.contacts["j"] < 0))
    if not touched and (approach is None or abs(away[before][-1]) > STOPPED * approach or gap[before][-1] > level):
        return found
    if approach is not None and approach > 0.0:
        back = _passage(gap[after], away[after], level) or 0.0
        found["approach_speed_m_s"], found["rebound_speed_m_s"] = approach, back
        found["wet_restitution"] = back / approach
        found["approach_stokes_number"] = _stokes(run, body, d, approach)
    found["rebound_height_m"] = _top(t[after], gap[after])
    return found


def _first_impact(run: Run) -> tuple[int, int, float, float] | None:
    """Body, wall, start and start of the next impact of the two (inf: none)."""
    rows = run.contacts
    walls = np.flatnonzero(rows["j"] < 0) if rows is not None else np.zeros(0, int)
    if rows is None or not walls.size:
        return None
    first = walls[np.argmin(rows["start_s"][walls])]
    body, wall, start = int(rows["i"][first]), int(rows["j"][first]), float(rows["start_s"][first])
    same = (rows["i"] == body) & (rows["j"] == wall) & (rows["start_s"] > start)
    return body, wall, start, float(np.min(rows["start_s"][same], initial=np.inf))


def _nearest_wall(run: Run) -> tuple[int, int, float, float] | None:
    """The same of a single body that touched no wall: the one it came nearest to, and when."""
    if run.tracks is None or run.tracks.count != 1 or not run.tracks.times.size:
        return None
    walls = [-1 - 2 * axis - upper for axis in range(3) if not run.periodic[axis] for upper in (0, 1)]
    nearest = {wall: _from_wall(run, 0, wall)[0] for wall in walls}
    if not nearest:
        return None
    wall = min(nearest, key=lambda one: float(nearest[one].min()))
    return 0, wall, float(run.tracks.times[np.argmin(nearest[wall])]), float("inf")


def _from_wall(run: Run, body: int, wall: int) -> tuple[Floats, Floats]:
    """Gap to a wall and speed away from it at the times of the rows."""
    assert run.tracks is not None
    axis, upper = divmod(-1 - wall, 2)
    centre, speed = run.tracks.position[:, body, axis], run.tracks.velocity[:, body, axis]
    gap = (run.box[axis] - centre if upper else centre) - 0.5 * run.diameter[body]
    return gap, -speed if upper else speed


def _passage(gap: Floats, speed: Floats, level: float) -> float | None:
    """Speed where the gap first reaches the level, on the way out from the impact."""
    beyond = np.flatnonzero(gap >= level)
    if not beyond.size:
        return None
    n = int(beyond[0])
    if n == 0:   # coarse rows: nothing nearer was recorded
        return float(speed[0])
    return float(np.interp(level, gap[n - 1 : n + 1], speed[n - 1 : n + 1]))


def _top(t: Floats, gap: Floats) -> float | None:
    if gap.size < 3:
        return None
    n = int(np.argmax(gap))
    if n in (0, gap.size - 1):
        return None
    curve = np.polynomial.polynomial.polyfit(t[n - 1 : n + 2] - t[n], gap[n - 1 : n + 2], 2)
    return float(curve[0] - curve[1] ** 2 / (4.0 * curve[2])) if curve[2] < 0.0 else float(gap[n])


def _stokes(run: Run, body: int, diameter: float, speed: float) -> float | None:
    fluid: dict[str, Any] = run.case.get("fluid", {})
    density = run.summary.bodies[body].density_kg_m3 if body < len(run.summary.bodies) else None
    viscosity = fluid.get("viscosity")
    if viscosity is None and fluid.get("kinematic_viscosity") is not None and fluid.get("density") is not None:
        viscosity = fluid["kinematic_viscosity"] * fluid["density"]
    if density is None or not viscosity:
        return None
    mass = design.sphere_mass(diameter, density)
    return float(design.stokes_number(mass, 0.5 * diameter, speed, viscosity))
