"""Drawings of measures against what is varied, of the design, and videos."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from rdpm import design
from rdpm.figures import design_charts
from rdpm.figures.design_limits import limits_map
from rdpm.figures.plane import viewing_plane
from rdpm.figures.study_charts import Curve, Panel, chart
from rdpm.figures.style import PALETTE, save
from rdpm.figures.video import Scene, make_video, side_by_side
from rdpm.results.run_folder import RunFolder
from rdpm.studies.claims.talk_design import DIAMETER, TALK_MASS, TIME_STEP
from rdpm.studies.kept_flow import load_flow
from rdpm.studies.names import parameter
from rdpm.studies.pictures import Picture, Sweep, spread_rows, sweep_of
from rdpm.studies.results import StudyResults

__all__ = [
    "draw_contacts", "draw_convergence", "draw_design", "draw_restitution", "draw_videos", "draw_wet_restitution",
]  # fmt: skip

_FRAMES, _RATE = 68, 12
_STEPS_BAND = (8.0, 15.0, "$8 < N_c < 15$")


def _against(sweep: Sweep, quantity: str, factor: float, label: str, color: str) -> Curve:
    """A measure against the parameter, with the spread of numerics as error bars."""
    values = sweep.column(quantity)
    spread, bars = spread_rows(sweep.results, quantity), None
    if spread is not None and np.isfinite(spread.half_width) and spread.half_width > 0.0:
        width: Any = values * np.expm1(spread.half_width) if spread.scale == "log" else spread.half_width
        bars = factor * np.broadcast_to(width, values.shape)
    return Curve(label, sweep.values, factor * values, color, "both", bars)


def _swept(results: StudyResults) -> Sweep:
    sweep = sweep_of(results)
    if not sweep.key:
        names = sorted({str(row["run"]) for row in sweep.rows})
        raise ValueError(f"the runs do not differ in one number: {', '.join(names)}")
    return sweep


def draw_contacts(results: StudyResults, folder: Path) -> list[Picture]:
    """Overlap, contact time and number of kisses against the parameter."""
    try:
        sweep = _swept(results)
    except ValueError:
        return []   # runs that differ in several ways are in the table
    panels = [
        Panel("largest overlap [% d]", [_against(sweep, "max_overlap_fraction", 100.0, "", PALETTE[0])], log=True,
              limits=((0.5, "0.5 % d"),)),
        Panel("time [s]", [_against(sweep, "contact_kiss_total_s", 1.0, "in contact", PALETTE[0]),
                           _against(sweep, "gap_kiss_total_s", 1.0, "gap at most 2 % d", PALETTE[5])]),
        Panel("number of kisses", [_against(sweep, "contact_kisses", 1.0, "by contact", PALETTE[0]),
                                   _against(sweep, "gap_kisses", 1.0, "by gap", PALETTE[5])]),
    ]  # fmt: skip
    band = _STEPS_BAND if sweep.key == "contact.contact_steps" else None
    caption = sweep.about(sweep.runs()[0])
    if spread_rows(results, "max_overlap_fraction") is not None:
        caption += " Bars: spread that numerics alone give."
    path = chart(
        folder / "contacts.png", panels, sweep.x_label, "Overlap, contact time and kisses", caption,
        log_x=sweep.is_log, ticks=sweep.values, band=band,
    )  # fmt: skip
    return [Picture(path, f"Overlap, contact time and number of kisses against {sweep.name.plain}.")]


def draw_restitution(results: StudyResults, folder: Path) -> list[Picture]:
    """Restitution of the first contact beside the designed one."""
    sweep = _swept_or_named(results)
    got, wanted = sweep.column("first_restitution"), sweep.column("designed_restitution")
    if not np.isfinite(got).any():
        return []
    x = sweep.values if sweep.key else np.arange(1.0, len(sweep.rows) + 1)
    curves = [
        Curve("designed, dry", x, wanted, PALETTE[1], "points"),
        Curve("achieved, first contact", x, got, PALETTE[0], "both"),
    ]
    overdamped = int(np.isnan(wanted).sum())
    caption = sweep.about(sweep.runs()[0])
    if sweep.key == "fluid.viscosity":
        caption += " Viscosity varied."
    if overdamped:
        caption += f" {overdamped} of {len(x)} runs have no designed restitution: their contact is overdamped."
    path = chart(
        folder / "restitution.png", [Panel("restitution [-]", curves)], sweep.x_label if sweep.key else "run",
        "Restitution, designed and achieved", caption, log_x=bool(sweep.key) and sweep.is_log, ticks=x,
    )  # fmt: skip
    return [Picture(path, "Achieved against designed restitution: the fluid takes what the dashpot leaves.")]


def _swept_or_named(results: StudyResults) -> Sweep:
    sweep = sweep_of(results)
    if sweep.key or len(sweep.rows) < 2:
        return sweep
    wet = [row for row in sweep.rows if np.isfinite(_number(row.get("fluid.viscosity")))]
    wet = [row for row in wet if row.get("contact.lubrication") not in (False, "False")]
    if len(wet) > 1 and len({row["fluid.viscosity"] for row in wet}) == len(wet):
        return Sweep(sorted(wet, key=lambda row: float(row["fluid.viscosity"])), "fluid.viscosity", [], [], results)
    return sweep


def _number(value: Any) -> float:
    return float(value) if isinstance(value, (int, float)) and not isinstance(value, bool) else float("nan")


def draw_wet_restitution(results: StudyResults, folder: Path) -> list[Picture]:
    """Rebound from a wall against the Stokes number, with Legendre's curve, and dry."""
    sweep = sweep_of(results)
    stokes, wet = sweep.column("approach_stokes_number"), sweep.column("wet_restitution")
    first = sweep.column("first_restitution")
    is_dry = ~np.isfinite(stokes)
    seen = np.isfinite(stokes) & np.isfinite(wet)
    if not seen.any():
        raise ValueError("no run rebounds")
    bare = np.array([row.get("contact.lubrication") in (False, "False") for row in sweep.rows])
    dry = next((value for value in first[is_dry] if np.isfinite(value)), None)
    target = dry if dry is not None else float(np.nanmax(sweep.column("designed_restitution")))
    line = np.geomspace(min(3.0, stokes[seen].min()), max(1500.0, stokes[seen].max()), 200)
    curves = [
        Curve("with lubrication", stokes[seen & ~bare], wet[seen & ~bare], PALETTE[0], "points"),
        Curve("Legendre et al. 2005", line, np.asarray(design.legendre(target, line)), PALETTE[1]),
    ]
    if (seen & bare).any():
        label = "without: the grid alone"
        curves.insert(1, Curve(label, stokes[seen & bare], wet[seen & bare], PALETTE[2], "points"))
    limits = ((dry, "dry, simulated"),) if dry is not None else ()
    wet_run = sweep.runs()[int(np.flatnonzero(seen)[0])]
    path = chart(
        folder / "wet_restitution.png", [Panel("restitution [-]", curves, limits=limits)],
        "Stokes number of the impact [-]",
        "Rebound from a wall, wet and dry", f"{sweep.about(wet_run)} Viscosity varied; the curve is e exp(-35/St).",
        log_x=True,
    )  # fmt: skip
    return [Picture(path, "Restitution in the fluid against the Stokes number, beside the dry one.")]


def draw_convergence(results: StudyResults, folder: Path) -> list[Picture]:
    """Difference to the run with the smallest time step."""
    sweep = _swept(results)
    dt, panels = sweep.values, []
    compared = {
        "end_height_m": "height at the end", "settling_speed_max_m_s": "largest settling speed",
        "end_gap_m": "gap at the end",
    }  # fmt: skip
    for n, (quantity, label) in enumerate(compared.items()):
        values = sweep.column(quantity)
        error = 100.0 * np.abs(values[1:] / values[0] - 1.0)
        seen = np.where(error > 0, error, np.nan)
        panels.append(Curve(label, dt[1:], seen, PALETTE[n], "both"))
    base = float(np.nanmax([np.nanmax(np.asarray(curve.y)) for curve in panels]))
    for power, look in ((1, "dashed"), (2, "line")):
        guide = base * (dt[1:] / dt[-1]) ** power
        panels.append(Curve(f"order {power}", dt[1:], guide, "#b5b5b5", look))  # type: ignore[arg-type]
    lost = results.table[(results.table["status"] != "done")]
    caption = f"{sweep.about(sweep.runs()[0])} Before the first kiss; reference dt = {dt[0]:g} s."
    if len(lost):
        caption += f" Not stable: {', '.join(lost['run'])}."
    path = chart(
        folder / "convergence.png", [Panel("difference [%]", panels, log=True)], sweep.x_label,
        "Convergence with the time step", caption, log_x=True, ticks=dt[1:],
    )  # fmt: skip
    return [Picture(path, "Difference to the shortest time step, until just before the first kiss.")]


def draw_design(results: StudyResults, folder: Path) -> list[Picture]:
    """The talk's charts of k_n, eta_n, contact time, time step, N_c and e_n."""
    ending: Literal["zero-overlap"] = "zero-overlap"
    k, m, dt = np.geomspace(0.1, 1e4, 121), TALK_MASS, TIME_STEP
    radius = design.reduced_radius(0.5 * DIAMETER, 0.5 * DIAMETER)
    hertz = float(design.hertz_contact_time(m, radius, design.effective_modulus(1e7, 0.3), 0.05))
    v = np.geomspace(1e-3, 1.0, 121)
    drawn = (
        ("damping_stiffness", design_charts.damping_chart(m, k, (0.1, 0.3, 0.5, 0.7, 0.9), ending),
         "Damping against stiffness for e_n from 0 (critical) to 0.9."),
        ("contact_time_stiffness", design_charts.contact_time_chart(m, k, (0.1, 0.5, 0.9), ending, hertz),
         "Contact time against stiffness; Hertz's time of soft rubber (E = 1e7 Pa, 5 cm/s) is the lower limit."),
        ("time_step_stiffness", design_charts.time_step_chart(m, 0.5, k, ending=ending),
         "Time step against stiffness at e_n = 0.5."),
        ("contact_steps", design_charts.contact_steps_chart(m, 0.5, (dt, 0.5 * dt, 0.25 * dt), range(4, 31), ending),
         "Stiffness and damping against N_c for several time steps, e_n = 0.5."),
        ("restitution_design", design_charts.restitution_chart(m, dt, (8, 10, 12, 15), None, ending),
         "Stiffness and damping against e_n for several N_c, dt = 1 ms."),
        ("limits", limits_map(0.5, dt, DIAMETER, v, hertz=(hertz, 0.05), ending=ending),
         "N_c between Hertz's lower limit and the upper limit of an overlap of 0.5 % d, e_n = 0.5, dt = 1 ms."),
    )  # fmt: skip
    what = f"Linear contact ending at zero overlap, m_ij = {1e3 * m:.4g} g."
    return [Picture(save(figure, folder / f"{name}.png", f"{what} {title}"), title) for name, figure, title in drawn]


def draw_videos(results: StudyResults, folder: Path) -> list[Picture]:
    """One video a run, and one of all side by side in step."""
    sweep, scenes = sweep_of(results), []
    starts = {results.folder.work(job).path: job for job in results.folder.jobs()}
    by_name = {job.name: job for job in starts.values()}
    for run, row in zip(sweep.runs(), sweep.rows, strict=True):
        own = results.run_folder(str(row["run"]), str(row["study"]))
        start = by_name.get(starts[own].start)
        flow = load_flow(own, results.folder.work(start).path if start else None)
        plane = viewing_plane(run.tracks, run.box, run.gravity, run.period, run.walls)
        if flow:
            plane = replace(flow[0], walls=run.walls)
        title = (f"{parameter(sweep.key).plain} = {row[sweep.key]:g} {parameter(sweep.key).unit}" if sweep.key
                 else str(row["run"]))  # fmt: skip
        scenes.append(Scene(title, run.box, run.period, plane, run.diameter, run.tracks, flow[1] if flow else None))
    top = max((scene.slices.top_speed for scene in scenes if scene.slices is not None), default=None)
    scenes = [Scene(s.title, s.box, s.period, s.plane, s.diameter, s.tracks, s.slices, top) for s in scenes]
    target = results.folder.path / "videos" / results.name
    target.mkdir(parents=True, exist_ok=True)
    found = []
    if len(scenes) > 1:
        path = side_by_side(target / "side_by_side.mp4", scenes, _FRAMES, _RATE)
        found.append(Picture(path, f"The runs side by side, in step: {', '.join(scene.title for scene in scenes)}."))
    for scene, row in zip(scenes, sweep.rows, strict=True):
        name = RunFolder(Path(str(row["run"]))).path.name
        found.append(Picture(make_video(target / f"{name}.mp4", scene, _FRAMES, _RATE), f"{scene.title}."))
    return found
