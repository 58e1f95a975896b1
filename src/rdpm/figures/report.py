"""Everything to look at from a run's folder: pictures, film, and one page that holds them all."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from rdpm.conventions import OVERLAP_WARNING
from rdpm.errors import OutputError
from rdpm.figures import page, plots
from rdpm.figures.bodies_3d import finish_rendering, start_rendering
from rdpm.figures.flow import Slices, load_slices, plot_flow
from rdpm.figures.run_folder import RunFolder, load_run
from rdpm.figures.style import case_text
from rdpm.figures.video import Film, make_video
from rdpm.io.files import replacing

__all__ = ["make_report"]

_DRY = "The restitution asked for is that of a dry contact; in a fluid it falls with the Stokes number."


def make_report(
    folder: str | Path, *, video: bool = True, progress: Callable[[str], None] | None = None
) -> list[Path]:
    """Make ``figures/*.png``, ``video.mp4`` and ``report.html`` of a run's folder, anew each time.

    What the folder does not hold (fields, contacts, bodies) is left out of the page; a film or a
    three-dimensional picture that this machine cannot make costs one line of `progress`.

    Parameters
    ----------
    folder : path
        Of a run: with ``case.toml`` and ``summary.json`` at least.
    video : bool
        Whether to make the film, which takes longest.
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
    figures = run.folder / "figures"
    try:
        figures.mkdir(exist_ok=True)
    except OSError as error:
        raise OutputError(str(figures), None, "cannot be made", str(error.strerror)) from error
    has_bodies = run.tracks is not None and run.tracks.count > 0
    still = figures / "bodies_3d.png"
    renderer = start_rendering(run.folder, still) if has_bodies else None   # meanwhile the charts are drawn
    try:
        say("figures")
        slices = _moving(load_slices(run.fields, run.plane)) if run.fields else None
        drawn, film = _draw(run, slices, figures), None
        if video:
            say("video")
            film = _film(run, slices, run.folder / "video.mp4", say)
    finally:
        refused = finish_rendering(renderer) if renderer else ""
    if refused:
        say(f"figures/bodies_3d.png: not drawn ({refused})")
    elif renderer:
        drawn.append((still, "Bodies and their paths; the latest time is the strongest."))
    say("report.html")
    made = _page(run, drawn, film)
    return [path for path, _ in drawn] + ([film] if film else []) + [made]


def _draw(run: RunFolder, slices: Slices | None, figures: Path) -> list[tuple[Path, str]]:
    """Draw what the folder has data for: files and captions."""
    about = case_text(run.title, run.case, run.summary, run.diameter)
    drawn = []
    tracks = run.tracks
    if slices is not None:
        path = figures / "flow.png"
        at = _telling_times(run)
        plot_flow(path, slices, tracks, run.diameter, run.box, run.period, run.plane, about, at)
        drawn.append((path, "Speed of the fluid (colour) and velocity in the plane (arrows) at a few times."))
    if tracks is not None and tracks.count:
        path = figures / "settling_velocity.png"
        plots.plot_velocity(path, tracks, run.gravity, about, run.phases)
        drawn.append((path, "Velocity along gravity against time."))
        path = plots.plot_trajectory(
            figures / "trajectory.png", tracks, run.diameter, run.box, run.plane, about
        )
        drawn.append((path, "Paths, with the bodies to scale at a few times, and coordinates against time."))
        if tracks.count == 2 or np.isfinite(tracks.gap).any():
            path = plots.plot_gap(figures / "gap.png", tracks, run.diameter, about, run.phases, run.period)
            drawn.append((path, "Gap in % of the diameter; logarithmic above 2 %, linear below."))
        if tracks.count == 2 and run.gravity.any():
            path = figures / "angle.png"
            plots.plot_angle(path, tracks, run.gravity, about, run.phases, run.period)
            drawn.append((path, "Angle between the line of centres and gravity."))
    if run.contacts is not None:
        asked = (run.summary.get("contact") or {}).get("restitution")
        path = plots.plot_contacts(figures / "contacts.png", run.contacts, asked, about)
        drawn.append((path, f"Each contact from touch to end. {_DRY}"))
    if run.history is not None:
        path = plots.plot_history(figures / "history.png", run.history, about)
        drawn.append((path, "Energies, CFL number, divergence, slip and overlap: the health of the run."))
    return drawn


def _telling_times(run: RunFolder) -> list[float] | None:
    """Drafting, kiss, turning, tumble and end of a pair that does all that."""
    kiss, tumble = (run.phases.kiss_time_s, run.phases.tumble_time_s) if run.phases else (None, None)
    if kiss is None or tumble is None or run.tracks is None:
        return None
    return [0.6 * kiss, kiss, 0.5 * (kiss + tumble), tumble, float(run.tracks.times[-1])]


def _moving(slices: Slices) -> Slices | None:
    """The slices, or None of a fluid that never moves."""
    return slices if slices.top_speed > 0.0 else None


def _film(run: RunFolder, slices: Slices | None, path: Path, say: Callable[[str], None]) -> Path | None:
    if run.tracks is None and slices is None:
        return None
    film = Film(run.title, run.box, run.period, run.plane, run.diameter, run.tracks, slices)
    if film.span[0] == film.span[1]:
        return None
    try:
        return make_video(path, film)
    except (RuntimeError, ImportError, OutputError) as error:
        say(f"video.mp4: not made ({str(error).splitlines()[0]})")
        return None


def _page(run: RunFolder, drawn: Sequence[tuple[Path, str]], film: Path | None) -> Path:
    pictures = {path.name: page.picture(path, text, tall=path.stem == "bodies_3d") for path, text in drawn}
    shown = [pictures.pop(name) for name in ("flow.png",) if name in pictures]
    if film is not None:
        shown.insert(0, page.film(film, "The run: flow in a vertical plane, and the turning spheres."))
    parts = [
        page.paragraph("rdpm", soft=True),
        page.heading(run.title),
        page.paragraph(case_text("", run.case, run.summary, run.diameter)),
        page.note_list(_warnings(run)),
        page.section("What it shows", shown),
        page.section("Drafting, kissing, tumbling", [page.table(_phase_rows(run))]),
        page.section("Key numbers", [page.table(_key_rows(run))]),
        page.section("Contacts", _contact_parts(run)),
        page.section("Figures", list(pictures.values())),
        page.section("Where it comes from", [page.table(_origin_rows(run)), _case_file(run)]),
    ]
    path = run.folder / "report.html"
    with replacing(path) as temporary:
        temporary.write_text(page.document(run.title, parts), encoding="utf-8")
    return path


def _case_file(run: RunFolder) -> str:
    return page.folded("case.toml", (run.folder / "case.toml").read_text(encoding="utf-8"))


def _warnings(run: RunFolder) -> list[str]:
    warnings = [str(text) for text in run.summary.get("warnings") or []]
    overlap = (run.summary.get("contacts") or {}).get("max_overlap_fraction") or 0.0
    if overlap > OVERLAP_WARNING and not any("overlap" in text for text in warnings):
        found = f"The largest overlap was {100 * overlap:.2g} % of a diameter"
        warnings.append(f"{found}; a design keeps it below 0.5 %.")
    return warnings


def _text(value: Any, unit: str = "", factor: float = 1.0) -> str:
    if value is None:
        return "–"
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return str(value)
    is_count = isinstance(value, int) and factor == 1.0
    number = f"{value:,}".replace(",", " ") if is_count else f"{factor * value:.4g}"
    return f"{number} {unit}".rstrip()


def _range(values: Any, unit: str = "", factor: float = 1.0) -> str:
    """One value, or the smallest to the largest of those that are known."""
    known = np.array([v for v in values if v is not None], np.float64)
    known = factor * known[np.isfinite(known)]
    if known.size == 0:
        return "–"
    low, high = f"{known.min():.3g}", f"{known.max():.3g}"
    return f"{low if low == high else f'{low} to {high}'} {unit}".rstrip()


def _phase_rows(run: RunFolder) -> list[tuple[str, str]]:
    found = (run.phases.to_dict() if run.phases else {}) | (run.summary.get("dkt") or {})
    names = (
        ("drafting_time_s", "drafting begins", "s"),
        ("kiss_time_s", "first kiss (gap of 2 % d)", "s"),
        ("kisses", "kisses", ""),
        ("kiss_duration_s", "kissing in all", "s"),
        ("tumble_time_s", "tumbling (45° passed)", "s"),
        ("final_angle_deg", "line of centres at the end", "° from gravity"),
    )
    return [(name, _text(found[key], unit)) for key, name, unit in names if key in found]


def _longest(summary: dict[str, Any]) -> float | None:
    """Of adaptive steps [s]; None where all were equal."""
    shortest, longest = summary.get("dt_shortest_s"), summary.get("dt_longest_s")
    return longest if shortest and longest and longest > 1.001 * shortest else None


def _key_rows(run: RunFolder) -> list[tuple[str, str]]:
    s = run.summary
    limit = f", set by the {s['dt_limit']} limit" if s.get("dt_limit") else ""
    speeds = [body.get("max_speed_m_s") for body in s.get("bodies") or []]
    rows = [
        ("status", _text(s.get("status"))),
        ("simulated time", _text(s.get("time_s"), "s")),
        ("time step", _text(s.get("dt_s"), "ms", 1e3) + limit),
        ("longest time step", _text(_longest(s), "ms", 1e3)),
        ("steps", _text(s.get("steps"))),
        ("greatest speed of a body", _range(speeds, "m/s")),
        ("Reynolds number at it", _range(_reynolds(run, speeds))),
        ("largest divergence", _text(s.get("max_divergence"), "1/s")),
        ("wall time", _text(s.get("wall_s"), "s")),
        ("cost of a cell and step", _text(s.get("ns_per_cell_step"), "ns")),
        ("threads", _text(s.get("threads"))),
        ("peak memory", _text(s.get("peak_memory_bytes"), "MB", 1e-6)),
    ]
    if s.get("cells"):
        count = f"{int(np.prod(s['cells'])):,}".replace(",", " ")
        spacing = " × ".join(f"{1e3 * d:.4g}" for d in s.get("spacing_m") or [])
        rows.insert(1, ("grid", f"{' × '.join(map(str, s['cells']))} = {count} cells of {spacing} mm"))
        rows.insert(2, ("cells a diameter", _text(s.get("cells_per_diameter"))))
    return [(name, value) for name, value in rows if not value.startswith("–")]


def _reynolds(run: RunFolder, speeds: Sequence[float | None]) -> list[float]:
    fluid = run.case.get("fluid") or {}
    nu = fluid.get("kinematic_viscosity")
    if nu is None and fluid.get("viscosity") and fluid.get("density"):
        nu = fluid["viscosity"] / fluid["density"]
    if not nu or len(speeds) != len(run.diameter):
        return []
    return [u * d / nu for u, d in zip(speeds, run.diameter, strict=True) if u is not None]


def _contact_parts(run: RunFolder) -> list[str]:
    """What was designed beside what was obtained, a table for each kind of contact."""
    design = run.summary.get("contact") or {}
    rows = run.contacts
    kinds = {str(pair.get("kind")) for pair in design.get("pairs") or []}
    kinds |= set(rows["kind"].tolist()) if rows else set()
    parts = []
    if design:
        asked = f"{design.get('model')}, ending at {str(design.get('ending')).replace('-', ' ')}"
        parts.append(page.paragraph(f"Law: {asked}. {_DRY if run.case.get('fluid') else ''}"))
    for kind in sorted(kinds):
        pairs = [pair for pair in design.get("pairs") or [] if pair.get("kind") == kind]
        found = {name: column[rows["kind"] == kind] for name, column in rows.items()} if rows else {}
        parts.append(page.section(kind, [_contact_table(design, pairs, found)], level=3))
    return parts


def _contact_table(design: dict[str, Any], pairs: list[dict[str, Any]], found: dict[str, Any]) -> str:
    def got(name: str, unit: str = "", factor: float = 1.0) -> str:
        return _range(found.get(name, []), unit, factor)

    def given(name: str, unit: str) -> str:
        return _range([pair.get(name) for pair in pairs], unit)

    lines = [
        ("contacts", "", str(len(found.get("i", [])))),
        ("restitution", _text(design.get("restitution")), got("restitution")),
        ("contact time", _text(design.get("contact_time_s"), "ms", 1e3), got("duration_s", "ms", 1e3)),
        ("steps in a contact", _text(design.get("contact_steps")), got("steps")),
        ("largest overlap", "≤ 0.5 % d", got("max_overlap_fraction", "% d", 100.0)),
        ("impact speed", "", got("impact_speed_m_s", "m/s")),
        ("Stokes number", "", got("stokes_number")),
        ("work of the contact force", "≤ 0", got("work_J", "J")),
        ("stiffness k_n", given("stiffness_N_m", "N/m"), ""),
        ("damping η_n", given("damping_N_s_m", "N s/m"), ""),
        ("reduced mass", given("reduced_mass_kg", "kg"), ""),
    ]
    return page.table([line for line in lines if set(line[1:]) - {"", "–"}], ("", "design", "obtained"))


def _origin_rows(run: RunFolder) -> list[tuple[str, str]]:
    environment = run.summary.get("environment") or {}
    known = {"rdpm_version": run.summary.get("rdpm_version"), "ranks": run.summary.get("ranks")} | environment
    return [(name.replace("_", " "), _text(value)) for name, value in known.items() if value is not None]
