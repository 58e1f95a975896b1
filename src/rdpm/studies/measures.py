"""What a study measures in a run: groups of numbers by name, each number with its unit and meaning.

A group is a function of a run. It gives columns of the study's table, always the same ones: a number, or None where it
is not defined. docs/theory/dkt.md defines the numbers of a pair.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rdpm.results.dkt import Kiss, line_of_centres, pair_numbers
from rdpm.results.run import Run
from rdpm.studies.rebounds import first_rebound

__all__ = ["MEASURES", "QUANTITIES", "Quantity", "at_times"]

Floats = NDArray[np.float64]
Columns = dict[str, float | None]


class Quantity(NamedTuple):
    """A number of the table.

    Attributes
    ----------
    unit : str
        "-" for a pure number.
    meaning : str
    scale : {"linear", "log"}
        How two values are compared: by their difference, or by their ratio (of what spans decades in a sweep).
    """

    unit: str
    meaning: str
    scale: Literal["linear", "log"] = "linear"


#: Column -> what it is.
QUANTITIES: dict[str, Quantity] = {
    "kiss_time_s": Quantity("s", "start of the first kiss, a gap of at most 2 % d"),
    "kiss_duration_s": Quantity("s", "all kisses by the gap, as in summary.json"),
    "kisses": Quantity("-", "kisses by the gap, as in summary.json"),
    "tumble_time_s": Quantity("s", "line of centres first past 45 degrees after the first kiss, as in summary.json"),
    "final_angle_deg": Quantity("deg", "angle of the pair at the end"),
    "drafting_time_s": Quantity("s", "start of the longest spell of closing before the kiss, as in summary.json"),
    "drafting_start_s": Quantity("s", "gap 5 % d below the largest before the first kiss"),
    "tumble_start_s": Quantity("s", "line of centres past 45 degrees without turning back"),
    "gap_kisses": Quantity("-", "kisses by the gap with hysteresis: 2 % d to begin, 3 % d to end"),
    "gap_kiss_total_s": Quantity("s", "their total length"),
    "gap_kiss_longest_s": Quantity("s", "the longest of them"),
    "contact_kisses": Quantity("-", "kisses by mechanical contact; closer than one contact time are one"),
    "contact_kiss_total_s": Quantity("s", "their total length", "log"),
    "contact_kiss_longest_s": Quantity("s", "the longest of them", "log"),
    "contact_episodes": Quantity("-", "contacts of the pair as in contacts.csv"),
    "min_gap_fraction": Quantity("-", "smallest gap over the smaller diameter, negative in overlap"),
    "separation_rate_m_s": Quantity("m/s", "slope of the gap after tumble and last kiss"),
    "lateral_drift_m": Quantity("m", "of the pair's centre across gravity, start to end"),
    "contacts": Quantity("-", "contacts of all bodies"),
    "contact_total_time_s": Quantity("s", "their total length", "log"),
    "contact_mean_time_s": Quantity("s", "their mean length", "log"),
    "contact_longest_time_s": Quantity("s", "the longest of them", "log"),
    "max_overlap_fraction": Quantity("-", "largest overlap over the smaller diameter", "log"),
    "max_contact_work_J": Quantity("J", "largest work of a contact on its pair; above 0 it made energy"),
    "first_impact_speed_m_s": Quantity("m/s", "normal speed at the first touch", "log"),
    "first_rebound_speed_m_s": Quantity("m/s", "normal speed at the end of the first contact", "log"),
    "first_restitution": Quantity("-", "their ratio"),
    "first_stokes_number": Quantity("-", "Stokes number at the first touch", "log"),
    "max_stokes_number": Quantity("-", "largest Stokes number of all touches", "log"),
    "first_contact_duration_s": Quantity("s", "length of the first contact", "log"),
    "max_impact_speed_m_s": Quantity("m/s", "largest normal speed of all touches", "log"),
    "settling_speed_max_m_s": Quantity("m/s", "largest speed of any body along gravity"),
    "settling_speed_mean_m_s": Quantity("m/s", "of all bodies' centre, to the first kiss or the end"),
    "max_speed_m_s": Quantity("m/s", "largest speed of any body"),
    "min_gap_m": Quantity("m", "smallest gap of any body to another or a wall, of the rows"),
    "end_gap_m": Quantity("m", "the same in the last row"),
    "end_speed_m_s": Quantity("m/s", "largest speed of any body in the last row"),
    "end_height_m": Quantity("m", "lowest centre in the last row"),
    "approach_speed_m_s": Quantity("m/s", "speed towards the wall before the first impact, outside of lubrication"),
    "approach_stokes_number": Quantity("-", "Stokes number of that speed", "log"),
    "rebound_speed_m_s": Quantity("m/s", "speed away from the wall after it, at the same gap; 0 where it stays nearer"),
    "wet_restitution": Quantity("-", "their ratio"),
    "rebound_height_m": Quantity("m", "largest gap between the first two impacts on the wall"),
    "normal_stiffness_N_m": Quantity("N/m", "of the first kind of pair", "log"),
    "normal_damping_N_s_m": Quantity("N s/m", "of the first kind of pair"),
    "damping_ratio": Quantity("-", "of the first kind of pair: overdamped from 1 on"),
    "contact_steps_used": Quantity("-", "contact time over the time step"),
    "designed_restitution": Quantity("-", "dry, of the first kind of pair"),
    "cells_per_diameter_used": Quantity("-", "smallest diameter over the largest spacing"),
    "steps": Quantity("-", "time steps done"),
    "dt_s": Quantity("s", "time step; of adaptive ones that of contacts"),
    "wall_s": Quantity("s", "wall time"),
}


def pair_columns(run: Run) -> Columns:
    """Drafting, kissing and tumbling of two bodies.

    Returns
    -------
    dict
        Columns of `QUANTITIES` from ``kiss_time_s`` to ``lateral_drift_m``.
    """
    names = ("kiss_time_s", "kiss_duration_s", "kisses", "tumble_time_s", "final_angle_deg", "drafting_time_s")
    found: Columns = {name: _number(getattr(run.phases, name, None)) for name in names}
    names = (
        "drafting_start_s", "tumble_start_s", "min_gap_fraction", "separation_rate_m_s", "lateral_drift_m",
        "contact_episodes",
    )  # fmt: skip
    numbers = None
    if run.phases is not None and run.tracks is not None:
        numbers = pair_numbers(
            run.tracks.times, run.tracks.position[:, 0], run.tracks.position[:, 1], float(run.diameter[0]),
            float(run.diameter[1]), run.gravity, run.summary.contact.contact_time_s or 0.0, run.period, run.contacts,
        )  # fmt: skip
    found |= {name: _number(getattr(numbers, name, None)) for name in names}
    for kind in ("gap", "contact"):
        kisses: tuple[Kiss, ...] | None = getattr(numbers, f"{kind}_kisses", None)
        lengths = [kiss.duration_s for kiss in kisses or ()]
        found[f"{kind}_kisses"] = None if kisses is None else float(len(kisses))
        found[f"{kind}_kiss_total_s"] = sum(lengths) if lengths else None
        found[f"{kind}_kiss_longest_s"] = max(lengths, default=None)
    return found


def contact_columns(run: Run) -> Columns:
    """Contacts of all bodies, with each other and with walls.

    Returns
    -------
    dict
        Columns of `QUANTITIES` from ``contacts`` to ``max_impact_speed_m_s``.
    """
    rows, totals = run.contacts, run.summary.contacts

    def of(column: str, take: Callable[[Floats], Any]) -> float | None:
        values = rows[column][np.isfinite(rows[column])] if rows is not None else np.zeros(0)
        return _number(take(values)) if values.size else None

    found: Columns = {
        "contacts": float(totals.count),
        "contact_total_time_s": of("duration_s", np.sum),
        "contact_mean_time_s": of("duration_s", np.mean),
        "contact_longest_time_s": of("duration_s", np.max),
        "max_overlap_fraction": _number(totals.max_overlap_fraction) if totals.count else None,
        "max_contact_work_J": of("work_J", np.max),
        "max_stokes_number": of("stokes_number", np.max),
        "max_impact_speed_m_s": of("impact_speed_m_s", np.max),
    }
    first = int(np.argmin(rows["start_s"])) if rows is not None else None
    for column in ("impact_speed_m_s", "rebound_speed_m_s", "restitution", "stokes_number"):
        found[f"first_{column}"] = None if rows is None else _number(rows[column][first])
    found["first_contact_duration_s"] = None if rows is None else _number(rows["duration_s"][first])
    return found


def end_columns(run: Run) -> Columns:
    """Where the bodies are at the end: ``end_gap_m, end_speed_m_s, end_height_m``."""
    tracks = run.tracks
    if tracks is None or not tracks.times.size:
        return {"end_gap_m": None, "end_speed_m_s": None, "end_height_m": None}
    gaps = tracks.gap[-1][np.isfinite(tracks.gap[-1])]
    return {
        "end_gap_m": float(gaps.min()) if gaps.size else None,
        "end_speed_m_s": _number(np.linalg.norm(tracks.velocity[-1], axis=-1).max()),
        "end_height_m": _number(tracks.position[-1, :, 2].min()),
    }


def motion_columns(run: Run) -> Columns:
    """Speeds and the smallest gap.

    Returns
    -------
    dict
        ``settling_speed_max_m_s, settling_speed_mean_m_s, max_speed_m_s, min_gap_m``. The mean is the path of the
        centre over its time, so that the interval of the rows does not matter.
    """
    speeds = [body.max_speed_m_s for body in run.summary.bodies if body.max_speed_m_s is not None]
    if run.tracks is not None and run.tracks.times.size:   # the summary knows nothing of what lies before a checkpoint
        speeds.append(float(np.linalg.norm(run.tracks.velocity, axis=-1).max()))
    names = ("settling_speed_max_m_s", "settling_speed_mean_m_s", "min_gap_m")
    found: Columns = dict.fromkeys(names, None) | {"max_speed_m_s": max(speeds, default=None)}
    tracks, down = run.tracks, _down(run)
    if tracks is None or tracks.times.size < 2:
        return found
    gaps = tracks.gap[np.isfinite(tracks.gap)]
    found["min_gap_m"] = float(gaps.min()) if gaps.size else None
    if down is None:
        return found
    found["settling_speed_max_m_s"] = _number(np.max(tracks.velocity @ down))
    depth = tracks.position.mean(axis=1) @ down
    kiss = run.phases.kiss_time_s if run.phases is not None else None
    end = float(tracks.times[-1]) if kiss is None else kiss
    if end > tracks.times[0]:
        fallen = np.interp(end, tracks.times, depth) - depth[0]
        found["settling_speed_mean_m_s"] = _number(fallen / (end - tracks.times[0]))
    return found


def design_columns(run: Run) -> Columns:
    """The contact as it was designed, of the first kind of pair in ``summary.json``.

    Returns
    -------
    dict
        ``normal_stiffness_N_m, normal_damping_N_s_m, damping_ratio, contact_steps_used, designed_restitution``.
    """
    design = run.summary.contact
    pair = design.pairs[0] if design.pairs else None
    k_n, eta_n = (pair.stiffness_N_m, pair.damping_N_s_m) if pair else (None, None)
    zeta = None
    if pair and k_n and pair.reduced_mass_kg and eta_n is not None:
        zeta = 0.5 * eta_n / float(np.sqrt(pair.reduced_mass_kg * k_n))
    return {
        "normal_stiffness_N_m": _number(k_n),
        "normal_damping_N_s_m": _number(eta_n),
        "damping_ratio": zeta,
        "contact_steps_used": _number(design.contact_steps),
        "designed_restitution": _number(pair.restitution if pair else None),
    }


def cost_columns(run: Run) -> Columns:
    """Grid, steps and wall time: ``cells_per_diameter_used, steps, dt_s, wall_s``."""
    summary = run.summary
    return {
        "cells_per_diameter_used": _number(summary.cells_per_diameter),
        "steps": _number(summary.steps),
        "dt_s": _number(summary.dt_s),
        "wall_s": _number(summary.wall_s),
    }


def at_times(times: Sequence[float]) -> Callable[[Run], Columns]:
    """Measure at given times: mean settling speed of all bodies, and the angle of a pair.

    Parameters
    ----------
    times : sequence of float, [s]
        Interpolated between the rows; None past the record.

    Returns
    -------
    callable
        A group with the columns ``settling_speed_m_s@T`` and ``angle_deg@T`` for each time T.

    Examples
    --------
    >>> group = at_times([0.5, 1.0])
    """

    def group(run: Run) -> Columns:
        tracks, down = run.tracks, _down(run)
        found: Columns = {}
        for name in ("settling_speed_m_s", "angle_deg"):
            values = None
            if tracks is not None and down is not None and tracks.times.size:
                if name == "settling_speed_m_s":
                    values = tracks.velocity.mean(axis=1) @ down
                elif tracks.count == 2:
                    first, second = tracks.position[:, 0], tracks.position[:, 1]
                    values = line_of_centres(first, second, run.gravity, run.period)
            for time in times:
                value = None
                if tracks is not None and values is not None and tracks.times[0] <= time <= tracks.times[-1]:
                    value = np.interp(time, tracks.times, values)
                found[f"{name}@{time:g}"] = _number(value)
        return found

    return group


def _down(run: Run) -> Floats | None:
    """Unit vector along gravity; None without gravity."""
    size = float(np.linalg.norm(run.gravity))
    return run.gravity / size if size > 0.0 else None


def _number(value: Any) -> float | None:
    """A finite float, else None."""
    return float(value) if value is not None and np.isfinite(value) else None


#: Group -> function of a run that gives its columns.
MEASURES: dict[str, Callable[[Run], Mapping[str, float | None]]] = {
    "dkt": pair_columns,
    "contacts": contact_columns,
    "extremes": motion_columns,
    "end": end_columns,
    "rebound": first_rebound,
    "design": design_columns,
    "cost": cost_columns,
}
