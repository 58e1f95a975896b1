"""Curves of runs, one or several in a chart: settling velocity, trajectory, gap, contacts, energies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from rdpm.app.curves import chart_of, line, mark, points, thinned
from rdpm.app.live import LiveRun
from rdpm.figures.plane import viewing_plane
from rdpm.figures.style import length_unit
from rdpm.results.dkt.geometry import line_of_centres
from rdpm.results.run import Run

__all__ = ["compared", "figures_of", "live_curves"]

_FEW = 8  # bodies drawn one by one
Chart = dict[str, Any]


def _bodies(count: int) -> list[str]:
    return [f"body {n}" for n in range(count)] if count > 1 else ["settling velocity"]


def live_curves(run: LiveRun) -> dict[str, Chart]:
    """Draw what a run has told so far.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> from rdpm.results.run_folder import RunFolder
    >>> sorted(live_curves(LiveRun(RunFolder(pathlib.Path(tempfile.mkdtemp())))))
    ['contacts', 'gap', 'velocity']
    """
    count = min(len(run.times), len(run.settling), len(run.gap))  # a reader may be adding to them
    step = thinned(count, 1500)
    times, rows, gaps = (np.array(values[:count][step]) for values in (run.times, run.settling, run.gap))
    names = ["mean", "least", "greatest"] if run.count > _FEW else _bodies(run.count)
    fall = [line(name, times, 100.0 * rows[:, n], n) for n, name in enumerate(names)] if len(times) else []
    gap = [line("smallest gap", times, 1e3 * gaps, 0)] if len(times) else []
    found = run.contacts[-2000:]
    dots = [points(kind, [row["start_s"] for row in found if row["kind"] == kind],
                   [100.0 * row["max_overlap_fraction"] for row in found if row["kind"] == kind], n)
            for n, kind in enumerate(("sphere-sphere", "sphere-wall"))]  # fmt: skip
    return {
        "velocity": chart_of("Settling velocity", "time [s]", "velocity along gravity [cm/s]", fall),
        "gap": chart_of("Smallest gap", "time [s]", "gap [mm]", gap),
        "contacts": chart_of(
            f"Contacts so far: {len(run.contacts) or 'none'}", "start [s]", "largest overlap [% d]", dots
        ),
    }


def _velocity(run: Run) -> tuple[Any, Any]:
    """Times, and velocity along gravity of each body: (T, N)."""
    assert run.tracks is not None
    size = float(np.linalg.norm(run.gravity))
    along = run.gravity / size if size > 0.0 else np.array([0.0, 0.0, -1.0])
    return run.tracks.times, run.tracks.velocity @ along


def figures_of(run: Run) -> dict[str, Chart]:
    """Draw what a run left: a chart a name."""
    found: dict[str, Chart] = {}
    if run.tracks is not None and run.tracks.count:
        step = thinned(len(run.tracks.times))
        times, fall = _velocity(run)
        times, fall = times[step], 100.0 * fall[step]
        few = run.tracks.count <= _FEW
        rows = fall.T if few else [fall.mean(axis=1), fall.min(axis=1), fall.max(axis=1)]
        names = _bodies(run.tracks.count) if few else ["mean", "least", "greatest"]
        lines = [line(name, times, row, n) for n, (name, row) in enumerate(zip(names, rows, strict=True))]
        found["velocity"] = chart_of("Settling velocity", "time [s]", "velocity along gravity [cm/s]", lines)
        found["trajectory"] = _trajectory([run], [""])
        gap = 1e3 * _least(run.tracks.gap[step])
        found["gap"] = chart_of("Smallest gap of any body", "time [s]", "gap [mm]", [line("gap", times, gap, 0)])
    if run.phases is not None and run.tracks is not None:
        first, second = run.tracks.position[:, 0], run.tracks.position[:, 1]
        angle = line_of_centres(first, second, run.gravity, run.period)
        step = thinned(len(angle))
        found["angle"] = chart_of("Line of centres", "time [s]", "angle from gravity [degrees]",
                                  [line("angle", run.tracks.times[step], angle[step], 0)])  # fmt: skip
    if run.contacts is not None:
        found["contacts"] = _contacts([run], [""])
    if run.history is not None:
        found |= _history(run)
    return found


def _least(gap: Any) -> Any:
    known = np.where(np.isfinite(gap), gap, np.inf).min(axis=1)
    return np.where(np.isfinite(known), known, np.nan)


def _trajectory(runs: Sequence[Run], names: Sequence[str]) -> Chart:
    """Where bodies went, in the plane in which the first run's move most."""
    first = runs[0]
    plane = viewing_plane(first.tracks, first.box, first.gravity)
    factor, unit = length_unit(first.box)
    lines = []
    for n, (run, name) in enumerate(zip(runs, names, strict=True)):
        if run.tracks is None:
            continue
        step = thinned(len(run.tracks.times), 1500)
        for body in range(min(run.tracks.count, 40)):
            path = factor * run.tracks.position[step, body]
            said = name or (f"body {body}" if run.tracks.count > 1 else "body")
            lines.append(line(said, path[:, plane.across], path[:, plane.up], n if name else body))
    x, y = (f"{'xyz'[axis]} [{unit}]" for axis in (plane.across, plane.up))
    return chart_of("Trajectories", x, y, lines, is_equal=True)


def _contact_name(run: str, kind: str) -> str:
    return kind if not run else run if kind == "sphere-sphere" else f"{run}, wall"


def _contacts(runs: Sequence[Run], names: Sequence[str]) -> Chart:
    dots = []
    for n, (run, name) in enumerate(zip(runs, names, strict=True)):
        if run.contacts is None:
            continue
        for kind in ("sphere-sphere", "sphere-wall"):
            of_kind = np.asarray(run.contacts["kind"]) == kind
            if of_kind.any():
                start, deep = (
                    np.asarray(run.contacts[key], np.float64)[of_kind] for key in ("start_s", "max_overlap_fraction")
                )
                step = thinned(len(start))
                is_wall = kind == "sphere-wall"
                said = _contact_name(name, kind)
                dots.append(points(said, start[step], 100.0 * deep[step], n if name else is_wall, is_wall))
    return chart_of("Contacts", "start [s]", "largest overlap [% d]", dots)


def _history(run: Run) -> dict[str, Chart]:
    assert run.history is not None
    step = thinned(len(run.history["time_s"]))
    times = np.asarray(run.history["time_s"], np.float64)[step]

    def of(key: str) -> Any:
        return np.asarray(run.history[key], np.float64)[step]  # type: ignore[index]

    energy = [
        line("fluid", times, 1e6 * of("kinetic_energy_fluid_J"), 6),
        line("bodies", times, 1e6 * of("kinetic_energy_bodies_J"), 0),
    ]
    numerics = [line("CFL number", times, of("cfl"), 0), line("slip at the markers", times, of("slip"), 2)]
    return {
        "energy": chart_of("Kinetic energy", "time [s]", "energy [uJ]", energy),
        "numerics": chart_of("CFL number and slip", "time [s]", "[-]", numerics),
    }


def compared(runs: Sequence[Run], names: Sequence[str]) -> dict[str, Chart]:
    """Lay two to six runs over each other: settling velocity, trajectory, gap, contacts."""
    fall, gap, kisses = [], [], []
    for n, (run, name) in enumerate(zip(runs, names, strict=True)):
        if run.tracks is None or not run.tracks.count:
            continue
        step = thinned(len(run.tracks.times), 1500)
        times, velocity = _velocity(run)
        some = velocity[step].T if run.tracks.count <= 2 else [velocity[step].mean(axis=1)]
        fall += [line(name, times[step], 100.0 * row, n) for row in some]
        gap.append(line(name, times[step], 1e3 * _least(run.tracks.gap[step]), n))
        if run.phases is not None:
            kiss = run.summary.dkt.kiss_time_s if run.summary.dkt else None
            kisses.append(mark(kiss, 0.0, f"{name}: first kiss") | {"symbolSize": 12})
    return {
        "velocity": chart_of("Settling velocity", "time [s]", "velocity along gravity [cm/s]", fall),
        "trajectory": _trajectory(runs, names),
        "gap": chart_of("Smallest gap", "time [s]", "gap [mm]", [*gap, *kisses]),
        "contacts": _contacts(runs, names),
    }
