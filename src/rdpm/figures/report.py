"""Everything to look at from a run's folder: pictures, video, and one page that holds them all."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from rdpm.errors import OutputError
from rdpm.figures import page, run_charts
from rdpm.figures.bodies_3d import finish_rendering, start_rendering
from rdpm.figures.contact_chart import contact_chart
from rdpm.figures.contact_tables import contact_parts, number_text, range_text
from rdpm.figures.flow import Slices, flow_chart, load_slices
from rdpm.figures.marks import FEW
from rdpm.figures.paths import trajectory_chart
from rdpm.figures.plane import Plane, viewing_plane
from rdpm.figures.style import case_text, save
from rdpm.figures.video import Scene, make_video
from rdpm.io.files import replacing
from rdpm.results.dkt import KISS_GAP, TUMBLE_ANGLE
from rdpm.results.run import Run, load_run
from rdpm.results.summary import Summary

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["make_report"]

FigureFormat = Literal["png", "pdf", "svg"]

def make_report(
    folder: str | Path,
    *,
    video: bool = True,
    figure_format: FigureFormat | None = None,
    progress: Callable[[str], None] | None = None,
) -> list[Path]:
    """Make ``figures/*.png``, ``video.mp4`` and ``report.html`` of a run's folder, anew each time.

    What the folder does not hold (fields, contacts, bodies) is left out of the page; a video or a
    three-dimensional picture that this machine cannot make costs one line of `progress`.

    Parameters
    ----------
    folder : path
        Of a run: with ``case.toml`` and ``summary.json`` at least.
    video : bool
        Whether to make the video, which takes longest.
    figure_format : {"png", "pdf", "svg"}, optional
        Beside the PNG files, which the page holds, the charts are written in this format for print; that of the case
        (``output.figure_format``) when left out.
    progress : callable, optional
        Told in a line what is being made.

    Returns
    -------
    list of pathlib.Path
        The files made, the page last.

    Raises
    ------
    CaseError
        The folder is not a run's, or a file of it is broken.
    OutputError
        A file cannot be written.
    """
    say = progress or (lambda _: None)
    run = load_run(folder)
    plane = viewing_plane(run.tracks, run.box, run.gravity, run.period, run.walls)
    figures = run.folder.figures
    try:
        figures.mkdir(exist_ok=True)
    except OSError as error:
        raise OutputError(str(figures), None, "cannot be made", str(error.strerror)) from error
    has_bodies = run.tracks is not None and run.tracks.count > 0
    still = figures / "bodies_3d.png"
    renderer = start_rendering(run.folder.path, still) if has_bodies else None   # meanwhile the charts are drawn
    kinds = dict.fromkeys(("png", figure_format or run.case.get("output", {}).get("figure_format", "png")))
    try:
        say("figures")
        slices = _moving(load_slices(run.fields, plane)) if run.fields else None
        drawn, extra, shown = [], [], None
        about = case_text(run.title, run.case, run.summary, run.diameter)
        for name, caption, figure in _charts(run, plane, slices):
            for kind in kinds:
                path = save(figure, figures / f"{name}.{kind}", f"{about}. {caption}")
                (drawn.append((path, caption)) if kind == "png" else extra.append(path))
        if video:
            say("video")
            shown = _video(run, plane, slices, say)
    finally:
        refused = finish_rendering(renderer) if renderer else ""
    if refused:
        say(f"figures/bodies_3d.png: not drawn ({refused})")
    elif renderer:
        drawn.append((still, "Bodies and their paths; the latest time is the strongest."))
    say("report.html")
    _page(run, drawn, shown)
    return [path for path, _ in drawn] + extra + ([shown] if shown else []) + [run.folder.report]


def _charts(run: Run, plane: Plane, slices: Slices | None) -> Iterator[tuple[str, str, Figure]]:
    """Draw what the folder has data for: name, caption and figure."""
    tracks = run.tracks
    if slices is not None:
        at = _telling_times(run)
        chart = flow_chart(slices, tracks, run.diameter, run.box, run.period, plane, run.gravity, at)
        where = f"Plane {'xyz'[plane.normal]} = {1e3 * plane.position:.4g} mm"
        near = "; spheres it cuts are filled, those within half a diameter of it dotted" if tracks is not None else ""
        yield "flow", f"{where}{near}.", chart
    if tracks is not None and tracks.count:
        chart = run_charts.velocity_chart(tracks, run.gravity, run.phases)
        yield "settling_velocity", "Velocity along gravity." if run.gravity.any() else "Velocity along -z.", chart
        chart = trajectory_chart(tracks, run.diameter, run.box, run.period, plane, run.gravity)
        numbered = " and numbered" if 1 < tracks.count <= FEW else ""
        yield "trajectory", f"Spheres to scale at a few times, the latest the strongest{numbered}.", chart
        beyond = " Continued beyond the box where it is periodic." if run.periodic.any() else ""
        yield "positions", f"Centres.{beyond}", run_charts.positions_chart(tracks, run.box, run.period)
        if tracks.count == 2 or np.isfinite(tracks.gap).any():
            chart = run_charts.gap_chart(tracks, run.diameter, run.phases, run.period)
            yield "gap", "Logarithmic above 2 % of the diameter, linear below.", chart
        if tracks.count == 2 and run.gravity.any():
            chart = run_charts.angle_chart(tracks, run.gravity, run.phases, run.period)
            yield "angle", "Angle between the line of centres and gravity.", chart
    if run.contacts is not None:
        chart = contact_chart(run.contacts, run.pressed, run.summary.contact)
        yield "contacts", "Each contact from touch to end.", chart
    if run.history is not None:
        chart = run_charts.history_chart(run.history, tracks)
        yield "history", "Energies, CFL number, divergence, slip and overlap.", chart


def _telling_times(run: Run) -> list[float] | None:
    """Drafting, kiss, turning, tumble, and two later times of a pair that does all that."""
    kiss, tumble = (run.phases.kiss_time_s, run.phases.tumble_time_s) if run.phases else (None, None)
    if kiss is None or tumble is None or run.tracks is None:
        return None
    end = float(run.tracks.times[-1])
    return [0.6 * kiss, kiss, 0.5 * (kiss + tumble), tumble, 0.5 * (tumble + end), end]


def _moving(slices: Slices) -> Slices | None:
    """The slices, or None of a fluid that never moves."""
    return slices if slices.top_speed > 0.0 else None


def _video(run: Run, plane: Plane, slices: Slices | None, say: Callable[[str], None]) -> Path | None:
    if run.tracks is None and slices is None:
        return None
    scene = Scene(run.title, run.box, run.period, plane, run.diameter, run.tracks, slices)
    if scene.span[0] == scene.span[1]:
        return None
    try:
        return make_video(run.folder.video, scene)
    except (RuntimeError, ImportError, OutputError) as error:
        say(f"{run.folder.video.name}: not made ({str(error).splitlines()[0]})")
        return None


def _page(run: Run, drawn: Sequence[tuple[Path, str]], video: Path | None) -> None:
    pictures = {path.name: page.picture(path, text) for path, text in drawn}
    shown = [pictures.pop(name) for name in ("flow.png", "trajectory.png") if name in pictures]
    if video is not None:
        shown.insert(0, page.video(video, "The run: flow in a vertical plane, and the turning spheres."))
    parts = [
        page.paragraph("rdpm", soft=True),
        page.heading(run.title),
        page.paragraph(case_text("", run.case, run.summary, run.diameter)),
        page.note_list(run.summary.warnings),
        page.section("What it shows", [page.pairs(shown)]),
        page.section("Drafting, kissing, tumbling", [page.table(_phase_rows(run))]),
        page.section("Key numbers", [page.table(_key_rows(run))]),
        page.section("Contacts", contact_parts(run)),
        page.section("Figures", [page.pairs(list(pictures.values()))]),
        page.section("Where it comes from", [page.table(_origin_rows(run)), _case_file(run)]),
    ]
    with replacing(run.folder.report) as temporary:
        temporary.write_text(page.document(run.title, parts), encoding="utf-8")


def _case_file(run: Run) -> str:
    return page.folded("case.toml", run.folder.case.read_text(encoding="utf-8"))


def _phase_rows(run: Run) -> list[tuple[str, str]]:
    found = run.summary.dkt or run.phases
    if found is None:
        return []
    return [
        ("drafting begins", number_text(found.drafting_time_s, "s")),
        (f"first kiss (gap of {100 * KISS_GAP:g} % d)", number_text(found.kiss_time_s, "s")),
        ("kisses", number_text(found.kisses)),
        ("kissing in all", number_text(found.kiss_duration_s, "s")),
        (f"tumbling ({TUMBLE_ANGLE:g}° passed)", number_text(found.tumble_time_s, "s")),
        ("line of centres at the end", number_text(found.final_angle_deg, "° from gravity")),
    ]


def _longest(summary: Summary) -> float | None:
    """Of adaptive steps [s]; None where all were equal."""
    shortest, longest = summary.dt_shortest_s, summary.dt_longest_s
    return longest if shortest and longest and longest > 1.001 * shortest else None


def _key_rows(run: Run) -> list[tuple[str, str]]:
    s = run.summary
    limit = f", set by the {s.dt_limit} limit" if s.dt_limit else ""
    speeds = [body.max_speed_m_s for body in s.bodies]
    rows = [
        ("status", number_text(s.status)),
        ("simulated time", number_text(s.time_s, "s")),
        ("time step", number_text(s.dt_s, "ms", 1e3) + limit),
        ("longest time step", number_text(_longest(s), "ms", 1e3)),
        ("steps", number_text(s.steps)),
        ("greatest speed of a body", range_text(speeds, "m/s")),
        ("Reynolds number at it", range_text(_reynolds(run, speeds))),
        ("largest divergence", number_text(s.max_divergence, "1/s")),
        ("wall time", number_text(s.wall_s, "s")),
        ("cost of a cell and step", number_text(s.ns_per_cell_step, "ns")),
        ("threads", number_text(s.threads)),
        ("peak memory", number_text(s.peak_memory_bytes, "MB", 1e-6)),
    ]
    if s.cells:
        count = f"{int(np.prod(s.cells)):,}".replace(",", " ")
        spacing = " × ".join(f"{1e3 * d:.4g}" for d in s.spacing_m or ())
        rows.insert(1, ("grid", f"{' × '.join(map(str, s.cells))} = {count} cells of {spacing} mm"))
        rows.insert(2, ("cells a diameter", number_text(s.cells_per_diameter)))
    return [(name, value) for name, value in rows if not value.startswith("–")]


def _reynolds(run: Run, speeds: Sequence[float | None]) -> list[float]:
    fluid = run.case.get("fluid") or {}
    nu = fluid.get("kinematic_viscosity")
    if nu is None and fluid.get("viscosity") and fluid.get("density"):
        nu = fluid["viscosity"] / fluid["density"]
    if not nu or len(speeds) != len(run.diameter):
        return []
    return [u * d / nu for u, d in zip(speeds, run.diameter, strict=True) if u is not None]


def _origin_rows(run: Run) -> list[tuple[str, str]]:
    s = run.summary
    rows = (
        ("rdpm version", s.rdpm_version),
        ("python", s.python),
        ("numpy", s.numpy),
        ("platform", s.platform),
        ("cpu", s.cpu),
        ("simd", s.simd),
        ("ranks", s.ranks),
        ("date utc", s.date_utc),
    )
    return [(name, number_text(value)) for name, value in rows if value is not None]
