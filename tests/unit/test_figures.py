"""Figures, video and report of made-up runs: a pair, one body, many, none; with and without a fluid."""

from __future__ import annotations

import re
import subprocess
import sys
from html.parser import HTMLParser

import numpy as np
import pytest

from rdpm.errors import CaseError, OutputError
from rdpm.figures import report
from rdpm.figures.bodies_3d import finish_rendering
from rdpm.figures.flow import body_positions, load_slices, periodic_copies
from rdpm.figures.report import make_report
from rdpm.figures.style import case_text
from rdpm.figures.video import Film, make_video, orientations
from rdpm.io.provenance import environment, write_json
from rdpm.io.tables import CONTACT_COLUMNS, HISTORY_COLUMNS, PARTICLE_COLUMNS, TableWriter, read_table
from rdpm.io.vtkhdf import FieldWriter
from rdpm.results.run_folder import Plane, Tracks, load_run, tracks_from_table, viewing_plane

D = 0.015
BOX, CELLS, SPACING = (0.06, 0.05, 0.24), (24, 20, 96), (0.0025, 0.0025, 0.0025)


def pair_motion(times):
    """Two spheres: the upper one catches up (1.2 s), they turn (2 s) and part: (T, 2, 3)."""
    gap = np.interp(times, [0.0, 0.4, 1.2, 2.2, 3.0], [D, 0.97 * D, -0.003 * D, -0.003 * D, 0.8 * D])
    theta = np.radians(np.interp(times, [0.0, 1.2, 2.0, 3.0], [1.0, 3.0, 45.0, 85.0]))
    height = 0.20 - 0.055 * times + 0.01 * np.exp(-4 * times)
    middle = np.stack([0.03 + 0 * times, 0.025 + 0 * times, height], axis=1)
    line = 0.5 * (D + gap)[:, None] * np.stack([np.sin(theta), 0 * theta, np.cos(theta)], axis=1)
    return np.stack([middle + line, middle - line], axis=1)


def cloud_motion(times):
    """27 spheres that sink and drift through periodic sides: (T, 27, 3)."""
    rng = np.random.default_rng(1)
    grid = np.stack(np.meshgrid(*[np.arange(3)] * 3), -1).reshape(-1, 3) * np.array(BOX) / 3 + 0.01
    drift = rng.normal(0.0, 0.01, (27, 3)) + np.array([0.0, 0.0, -0.06])
    return grid + times[:, None, None] * drift


def write_particles(folder, times, position, periodic):
    velocity = np.gradient(position, times, axis=0)
    position = position % np.array(BOX) if periodic else position
    with TableWriter(folder / "particles.csv", PARTICLE_COLUMNS) as table:
        for n, time in enumerate(times):
            table.write(
                (time, b, *position[n, b], *velocity[n, b], 0.0, 6.0 - 12 * b, 0.0, *np.zeros(6), 0.01, -5)
                for b in range(position.shape[1])
            )


def write_flow(folder, times, position):
    """Each body drags its surroundings along: a smooth made-up field."""
    fields = FieldWriter(folder / "fields.vtkhdf", CELLS, SPACING)
    axes = [(np.arange(n) + 0.5) * b / n for b, n in zip(BOX, CELLS, strict=True)]
    z, y, x = np.meshgrid(*axes[::-1], indexing="ij")
    for time in times:
        u = np.zeros((*z.shape, 3))
        for body in position(np.array([time, time + 1e-3])).transpose(1, 0, 2):
            body = body - np.array(BOX) * np.floor(body[0] / np.array(BOX))
            wake = np.where(z > body[0, 2], 3.0, 1.0)
            r2 = (x - body[0, 0]) ** 2 + (y - body[0, 1]) ** 2 + ((z - body[0, 2]) / wake) ** 2
            u += np.exp(-r2 / D**2)[..., None] * (body[1] - body[0]) / 1e-3
        fields.write(time, u, u[..., 2])


CONTACTS = [
    (0, 1, "sphere-sphere", 1.2, 0.9, 430.0, 0.003, 0.012, 0.001, 0.08, 0.24, -1e-7),
    (1, -5, "sphere-wall", 2.8, 0.016, 8.0, 0.006, 0.05, np.nan, np.nan, 1.2, -1e-6),
]
CASE = """title = "Two spheres: drafting & kissing"
[domain]
size = [0.06, 0.05, 0.24]
boundary = {{ x = "{0}", y = "{0}", z = "{0}" }}
gravity = [0.0, 0.0, -9.81]
{1}
[[bodies]]
diameter = 0.015
density = 1120.0
"""
FLUID = "[fluid]\ndensity = 962.0\nviscosity = 0.113"
PAIR = {"kind": "sphere-sphere", "reduced_mass_kg": 9.9e-4, "stiffness_N_m": 40.1, "damping_N_s_m": 0.086}
SUMMARY = {
    "rdpm_version": "0.1.0", "status": "finished", "cells": CELLS, "spacing_m": SPACING,
    "cells_per_diameter": 6.0, "steps": 1500, "time_s": 3.0, "dt_s": 2e-3, "dt_limit": "contact",
    "wall_s": 21.4, "ns_per_cell_step": 24.0, "threads": 2, "ranks": 1, "peak_memory_bytes": 210_000_000,
    "max_divergence": 1e-12, "environment": environment(),
    "contact": {"model": "soft-sphere", "ending": "zero-force", "contact_time_s": 0.016,
                "contact_steps": 8, "restitution": 0.5, "pairs": [PAIR]},
    "contacts": {"count": 2, "max_overlap_fraction": 0.006, "total_time_s": 0.9},
}


def write_run(folder, motion, bodies, fluid=True, boundary="wall"):
    """The folder of a run of 3 s."""
    folder.mkdir()
    (folder / "case.toml").write_text(CASE.format(boundary, FLUID if fluid else ""))
    times = np.linspace(0.0, 3.0, 61)
    if bodies:
        write_particles(folder, times, motion(times), boundary == "periodic")
    with TableWriter(folder / "contacts.csv", CONTACT_COLUMNS) as table:
        table.write(CONTACTS[:bodies])
    with TableWriter(folder / "history.csv", HISTORY_COLUMNS) as table:
        table.write((n, t, 2e-3, 0.3, 1e-12, 1e-5 * t, 1e-6, 0.0, 0.01) for n, t in enumerate(times))
    if fluid:
        write_flow(folder, np.linspace(0.0, 3.0, 7), motion if bodies else lambda t: np.zeros((2, 0, 3)))
    each = [{"id": n, "diameter_m": D, "max_speed_m_s": 0.06} for n in range(bodies)]
    write_json(folder / "summary.json", SUMMARY | {"bodies": each})
    return folder


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    root = tmp_path_factory.mktemp("runs")
    return {
        "pair": write_run(root / "pair", pair_motion, 2),
        "one": write_run(root / "one", lambda t: pair_motion(t)[:, :1], 1),
        "cloud": write_run(root / "cloud", cloud_motion, 27, boundary="periodic"),
        "dry": write_run(root / "dry", pair_motion, 2, fluid=False),
        "none": write_run(root / "none", pair_motion, 0),
    }


@pytest.fixture
def no_renderer(monkeypatch):
    monkeypatch.setattr(report, "start_rendering", lambda *_: None)


class Balance(HTMLParser):
    """Refuses tags that are closed in another order than opened; collects addresses."""

    def __init__(self):
        super().__init__()
        self.open, self.sources = [], []

    def handle_starttag(self, tag, attrs):
        if tag not in ("meta", "img"):
            self.open.append(tag)
        self.sources += [value for name, value in attrs if name in ("src", "href")]

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def test_everything_of_a_pair(runs):
    said = []
    made = make_report(runs["pair"], progress=said.append)
    names = [path.relative_to(runs["pair"]).as_posix() for path in made]
    charts = {"flow", "settling_velocity", "trajectory", "gap", "angle", "contacts", "history"}
    assert {f"figures/{name}.png" for name in charts} | {"video.mp4", "report.html"} <= set(names)
    # Where nothing can be rendered one line says so; where it can, the picture is there.
    assert ("figures/bodies_3d.png" in names) != any("bodies_3d" in line for line in said)
    assert all(path.stat().st_size > 1000 for path in made)
    text = made[-1].read_text(encoding="utf-8")
    page = Balance()
    page.feed(text)
    assert page.open == []
    assert len(page.sources) == len(names) - 1
    assert all(source.startswith("data:") for source in page.sources)
    shown = re.sub(r"<[^>]+>", " ", re.sub(r"base64,[^\"]+", "", text))
    for words in ("drafting &amp; kissing", "1120 kg/m³ in 962 kg/m³", "46 080 cells", "7.66",
                  "restitution  0.5  0.08", "0.6 % of a diameter", "k_n  40.1 N/m", "tumbling (45° passed)"):
        assert words in shown
    assert not [path for path in runs["pair"].rglob(".*")]   # no temporary file is left
    again = make_report(runs["pair"], video=False)
    assert set(again) | {runs["pair"] / "video.mp4"} == set(made)


@pytest.mark.parametrize(
    ("name", "there", "absent"),
    [
        ("one", {"settling_velocity", "trajectory", "gap", "contacts", "flow"}, {"angle"}),
        ("cloud", {"settling_velocity", "trajectory", "gap", "contacts", "flow"}, {"angle"}),
        ("dry", {"settling_velocity", "trajectory", "gap", "angle", "contacts"}, {"flow"}),
        ("none", {"history"}, {"settling_velocity", "trajectory", "gap", "angle", "contacts", "flow"}),
    ],
)
@pytest.mark.usefixtures("no_renderer")
def test_what_is_absent_is_left_out(runs, name, there, absent):
    names = {path.stem for path in make_report(runs[name], video=False)}
    assert there | {"report"} <= names
    assert not absent & names


@pytest.mark.usefixtures("no_renderer")
def test_minimal_folder(tmp_path):
    (tmp_path / "case.toml").write_text("[domain]\nsize = [1.0, 1.0, 1.0]\n")
    write_json(tmp_path / "summary.json", {"status": "stopped"})
    assert [path.name for path in make_report(tmp_path)] == ["report.html"]


@pytest.mark.usefixtures("no_renderer")
def test_no_encoder_costs_one_line(runs, monkeypatch):
    def refused(*_):
        raise RuntimeError("No ffmpeg exe could be found\nmore")

    monkeypatch.setattr(report, "make_video", refused)
    said = []
    made = make_report(runs["one"], progress=said.append)
    assert "video.mp4: not made (No ffmpeg exe could be found)" in said
    assert made[-1].name == "report.html"


@pytest.mark.parametrize(
    ("code", "line"),
    [
        ("raise SystemExit('no GL')", "no GL"),
        ("import os; os.abort()", "code -6"),
        ("import time; time.sleep(60)", "did not answer"),
    ],
)
def test_a_renderer_that_fails_is_one_line(code, line):
    process = subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    )
    assert line in finish_rendering(process, timeout=1.0 if line.startswith("did") else 30.0)


def test_other_folders_are_refused(tmp_path):
    with pytest.raises(CaseError, match=r"case\.toml and summary\.json missing"):
        make_report(tmp_path)
    with pytest.raises(CaseError, match="no such folder"):
        make_report(tmp_path / "nowhere")
    (tmp_path / "case.toml").write_text("[domain]")
    write_json(tmp_path / "summary.json", {})
    with pytest.raises(CaseError, match=r"domain\.size"):
        make_report(tmp_path)
    (tmp_path / "case.toml").write_text("[domain")
    with pytest.raises(CaseError, match="readable case"):
        make_report(tmp_path)


def test_film_has_its_frames(runs, tmp_path):
    import imageio_ffmpeg

    for name in ("pair", "cloud"):
        run = load_run(runs[name])
        film = Film(run.title, run.box, run.period, run.plane, run.diameter, run.tracks, None)
        make_video(tmp_path / "a.mp4", film, frames=7, rate=5)
        frames, seconds = imageio_ffmpeg.count_frames_and_secs(tmp_path / "a.mp4")
        assert (frames, round(seconds, 2)) == (7, 1.4)
    with pytest.raises(OutputError, match="cannot be written"):
        make_video(tmp_path / "nowhere" / "a.mp4", film)


def test_slices_follow_the_axes_of_the_plane(tmp_path):
    fields = FieldWriter(tmp_path / "fields.vtkhdf", (4, 5, 6), (1.0, 1.0, 1.0))
    z, y, x = np.meshgrid(np.arange(6.0), np.arange(5.0), np.arange(4.0), indexing="ij")
    fields.write(0.0, np.stack([x, 10 * y, 100 * z], axis=-1), x)
    at = {0: np.arange(4.0), 1: 10 * np.arange(5.0), 2: 100 * np.arange(6.0)}
    for across, up in ((0, 2), (1, 2), (0, 1), (2, 0), (1, 0), (2, 1)):
        slices = load_slices(tmp_path / "fields.vtkhdf", Plane(across, up, 3 - across - up, 2.5))
        right, upward = np.meshgrid(at[across], at[up])
        assert np.array_equal(slices.across[0], right)
        assert np.array_equal(slices.up[0], upward)
        depth = at[3 - across - up][2]
        assert np.allclose(slices.speed[0], np.sqrt(right**2 + upward**2 + depth**2))


def test_tracks_continue_through_periodic_sides(runs):
    run = load_run(runs["cloud"])
    moved = cloud_motion(run.tracks.times) - cloud_motion(np.zeros(1))
    assert np.allclose(run.tracks.position - run.tracks.position[0], moved)
    table = read_table(runs["cloud"] / "particles.csv")
    cut = tracks_from_table({name: column[:-1] for name, column in table.items()})
    assert len(cut.times) == len(run.tracks.times) - 1


def test_positions_between_rows():
    still = np.zeros((2, 1, 3))
    position = np.array([[[0.0, 0.0, 0.0]], [[4.0, 0.0, 8.0]]])
    tracks = Tracks(np.array([1.0, 2.0]), position, still, still, still[..., 0])
    for time, expected in ((0.0, (0, 0, 0)), (1.25, (1, 0, 2)), (9.0, (4, 0, 8))):
        assert body_positions(tracks, time)[0].tolist() == list(expected)


def test_orientation_follows_the_angular_velocity():
    still = np.zeros((3, 2, 3))
    spin = np.tile([[0.0, 0.0, np.pi], [np.pi / 2, 0.0, 0.0]], (3, 1, 1))
    tracks = Tracks(np.array([0.0, 0.5, 1.0]), still, still, spin, still[..., 0])
    turned = orientations(tracks, np.linspace(0.0, 1.0, 5))
    assert np.allclose(turned[2, 0] @ [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])   # a quarter turn about z in 0.5 s
    assert np.allclose(turned[4, 0], np.diag([-1.0, -1.0, 1.0]))
    assert np.allclose(turned[4, 1] @ [0.0, 1.0, 0.0], [0.0, 0.0, 1.0])


def test_plane_is_the_one_bodies_move_in():
    position = np.zeros((2, 2, 3))
    position[1, 0] = (0.0, 0.3, -1.0)
    still = np.zeros_like(position)
    tracks = Tracks(np.array([0.0, 1.0]), position, still, still, still[..., 0])
    assert viewing_plane(tracks, (1.0, 1.0, 2.0), (0, 0, -9.81)) == Plane(1, 2, 0, 0.0)
    assert viewing_plane(tracks, (1.0, 1.0, 2.0), (0, -9.81, 0)).up == 1


def test_copies_beside_both_periodic_sides():
    assert len(periodic_copies(np.zeros((1, 2)), np.array([1.0, 2.0]))) == 9
    assert periodic_copies(np.array([[5.0, 6.0]]), np.zeros(2))[0].tolist() == [[5.0, 6.0]]


def test_text_of_a_case_with_what_is_known():
    assert case_text("A", {}, {}, []) == "A"
    case = {"fluid": {"density": 1000.0, "kinematic_viscosity": 1e-6}}
    assert case_text("", case, {}, [1e-3, 2e-3]) == "2 spheres of 1 to 2 mm in 1000 kg/m³, 1e-06 m²/s"
