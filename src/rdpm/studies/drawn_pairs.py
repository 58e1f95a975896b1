"""Drawings of two settling spheres: speeds, paths, gaps, kisses."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm.figures.plane import viewing_plane
from rdpm.figures.study_charts import Bars, Curve, PairPath, Panel, bar_chart, chart, path_chart
from rdpm.results.dkt import contact_kisses, gap_kisses, pair_gap
from rdpm.results.run import Run
from rdpm.results.tracks import Tracks
from rdpm.studies.pictures import Picture, sweep_of
from rdpm.studies.results import StudyResults

__all__ = ["draw_gap", "draw_kisses", "draw_relative", "draw_trajectory", "draw_velocity"]

Floats = NDArray[np.float64]
_PANELS = 5   # runs whose paths are drawn side by side
_SPHERES = "the sphere that begins above solid, the one below dashed"


def _pair(run: Run) -> Tracks:
    if run.tracks is None or run.tracks.count != 2:
        raise ValueError("the runs are not of two bodies")
    return run.tracks


def _order(run: Run) -> tuple[int, int]:
    """The sphere that begins above, and the other."""
    height = -_pair(run).position[0] @ run.gravity
    return (0, 1) if height[0] >= height[1] else (1, 0)


def _gap(run: Run) -> Floats:
    """Of the pair, over the smaller diameter."""
    first, second = (_pair(run).position[:, n] for n in (0, 1))
    gap = pair_gap(first, second, float(run.diameter[0]), float(run.diameter[1]), run.period)
    return np.asarray(gap) / float(run.diameter.min())


def draw_velocity(results: StudyResults, folder: Path) -> list[Picture]:
    """Settling velocity of both spheres against time."""
    sweep, curves, between = sweep_of(results), [], []
    runs = sweep.runs()
    for run, label, color in zip(runs, sweep.labels, sweep.colors, strict=True):
        tracks, down = _pair(run), run.gravity / np.linalg.norm(run.gravity)
        upper, lower = _order(run)
        difference = 100.0 * (tracks.velocity[:, upper] - tracks.velocity[:, lower]) @ down
        between.append(Curve("", tracks.times, difference, color))
        for n, look in zip(_order(run), ("line", "dashed"), strict=True):
            text = label if look == "line" else ""
            curves.append(Curve(text, tracks.times, 100.0 * tracks.velocity[:, n] @ down, color, look))  # type: ignore[arg-type]
    path = chart(
        folder / "settling_velocity.png",
        [Panel("settling velocity [cm/s]", curves), Panel("upper less lower [cm/s]", between)], "time [s]",
        "Settling velocity of both spheres", f"{sweep.about(runs[0])} Of each run {_SPHERES}.", height=5.2,
    )  # fmt: skip
    return [Picture(path, f"Settling velocity of both spheres: {_SPHERES}.")]


def draw_trajectory(results: StudyResults, folder: Path) -> list[Picture]:
    """Paths of both spheres in the plane they move in, to scale."""
    sweep, pairs = sweep_of(results), []
    runs = sweep.runs()
    plane = viewing_plane(runs[0].tracks, runs[0].box, runs[0].gravity, runs[0].period, runs[0].walls)
    chosen = np.unique(np.linspace(0, len(runs) - 1, min(len(runs), _PANELS)).round().astype(int))
    for n in chosen:
        run, tracks = runs[n], _pair(runs[n])
        upper, lower = (tracks.position[:, sphere][:, [plane.across, plane.up]] for sphere in _order(run))
        phases = run.phases
        instants = [0.0, *(t for t in ((phases.kiss_time_s, phases.tumble_time_s) if phases else ()) if t is not None)]
        at = [int(np.argmin(np.abs(tracks.times - t))) for t in instants] + [len(tracks.times) - 1]
        pairs.append(PairPath(sweep.labels[n], upper, lower, at))
    axes = "xyz"[plane.across], "xyz"[plane.up]
    what = "Spheres at the start, the first kiss, the tumble and the end."
    path = path_chart(
        folder / "trajectory.png", pairs, float(runs[0].diameter.max()), axes, "Paths of both spheres, to scale",
        f"{sweep.about(runs[0])} {what}",
    )  # fmt: skip
    return [Picture(path, f"Settling trajectories seen from the side, to scale. {what}")]


def draw_relative(results: StudyResults, folder: Path) -> list[Picture]:
    """Where the trailing sphere is as seen from the leading one: the phase portrait of the pair."""
    sweep, curves = sweep_of(results), []
    runs = sweep.runs()
    for run, label, color in zip(runs, sweep.labels, sweep.colors, strict=True):
        tracks, (upper, lower) = _pair(run), _order(run)
        down = run.gravity / np.linalg.norm(run.gravity)
        between = (tracks.position[:, upper] - tracks.position[:, lower]) / float(run.diameter.mean())
        height = -between @ down
        across = np.linalg.norm(between + height[:, None] * down, axis=1)
        curves.append(Curve(label, across, height, color))
    angle = np.linspace(-0.1 * np.pi, 0.5 * np.pi, 109)
    curves.append(Curve("contact", np.cos(angle), np.sin(angle), "#7a7a7a", "dashed"))
    path = chart(
        folder / "relative_position.png", [Panel("height above the other sphere [d]", curves)],
        "horizontal distance of the centres [d]", "The pair from inside: the upper sphere as seen from the lower",
        f"{sweep.about(runs[0])} The pair starts at the top, touches on the dashed circle and turns along it.",
        height=4.4, to_scale=True,
    )  # fmt: skip
    return [Picture(path, "Relative position of the spheres: approach, roll along the circle of contact, separation.")]


def draw_gap(results: StudyResults, folder: Path) -> list[Picture]:
    """Gap of the pair against time, whole and near contact."""
    sweep = sweep_of(results)
    runs = sweep.runs()
    whole, near = [], []
    for run, label, color in zip(runs, sweep.labels, sweep.colors, strict=True):
        t, gap = _pair(run).times, 100.0 * _gap(run)
        whole.append(Curve(label, t, np.where(gap >= 1.0, gap, np.nan), color))
        near.append(Curve("", t, np.where(gap <= 5.0, gap, np.nan), color))
    panels = [
        Panel("gap [% d]", whole, log=True, limits=((2.0, "a kiss by gap: 2 % d"),)),
        Panel("near contact [% d]", near, limits=((2.0, ""), (0.0, ""))),
    ]
    path = chart(
        folder / "gap.png", panels, "time [s]", "Gap between the spheres",
        f"{sweep.about(runs[0])} Negative: overlap. Top: logarithmic.", height=5.2,
    )  # fmt: skip
    return [Picture(path, "Gap in % of the diameter against time; below, the same near contact: negative is overlap.")]


def draw_kisses(results: StudyResults, folder: Path) -> list[Picture]:
    """Kisses by both definitions on a time line."""
    sweep, rows = sweep_of(results), []
    runs = sweep.runs()
    for run, label in zip(runs, sweep.labels, strict=True):
        last = run.summary.contact.contact_time_s or 0.0
        by_gap = gap_kisses(_pair(run).times, _gap(run), last)
        touched = contact_kisses(run.contacts, last) if run.contacts is not None else ()
        marks: dict[str, Any] = {"line of centres past 45°": getattr(run.phases, "tumble_time_s", None)}
        rows.append(Bars(
            label, [(kiss.start_s, kiss.duration_s) for kiss in by_gap],
            [(kiss.start_s, kiss.duration_s) for kiss in touched], {k: v for k, v in marks.items() if v is not None},
        ))  # fmt: skip
    path = bar_chart(folder / "kisses.png", rows, "Kisses", sweep.about(runs[0]))
    return [Picture(path, "Kisses by both definitions: a gap of at most 2 % d, and mechanical contact.")]
