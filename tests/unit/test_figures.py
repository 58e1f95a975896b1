"""Figures, video and report of made-up runs: a pair, one body, many, none; with and without a fluid."""

from __future__ import annotations

import re
import subprocess
import sys
from html.parser import HTMLParser

import numpy as np
import pytest

from builders import cloud_motion, made_up_run, pair_motion
from rdpm.errors import CaseError, OutputError
from rdpm.figures import report
from rdpm.figures.bodies_3d import finish_rendering
from rdpm.figures.flow import body_positions, load_slices, periodic_copies
from rdpm.figures.plane import Plane, viewing_plane
from rdpm.figures.report import make_report
from rdpm.figures.style import case_text
from rdpm.figures.video import Scene, make_video, orientations
from rdpm.io.provenance import write_json
from rdpm.io.vtkhdf import FieldWriter
from rdpm.results.run import load_run
from rdpm.results.summary import Summary
from rdpm.results.tracks import Tracks


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    root = tmp_path_factory.mktemp("runs")
    return {
        "pair": made_up_run(root / "pair", pair_motion, 2),
        "one": made_up_run(root / "one", lambda t: pair_motion(t)[:, :1], 1),
        "cloud": made_up_run(root / "cloud", cloud_motion, 27, boundary="periodic"),
        "dry": made_up_run(root / "dry", pair_motion, 2, fluid=False),
        "none": made_up_run(root / "none", pair_motion, 0),
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
    charts = {"flow", "settling_velocity", "trajectory", "positions", "gap", "angle", "contacts", "history"}
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
                  "restitution  0.5  0.08", "A contact is pressed where", "k_n  40.1 N/m", "tumbling (45° passed)"):
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


def test_video_has_its_frames(runs, tmp_path):
    import imageio_ffmpeg

    for name in ("pair", "cloud"):
        run = load_run(runs[name])
        plane = viewing_plane(run.tracks, run.box, run.gravity)
        scene = Scene(run.title, run.box, run.period, plane, run.diameter, run.tracks, None)
        make_video(tmp_path / "a.mp4", scene, frames=7, rate=5)
        frames, seconds = imageio_ffmpeg.count_frames_and_secs(tmp_path / "a.mp4")
        assert (frames, round(seconds, 2)) == (7, 1.4)
    with pytest.raises(OutputError, match="cannot be written"):
        make_video(tmp_path / "nowhere" / "a.mp4", scene)


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


def test_a_pair_across_a_seam_is_cut_by_its_plane():
    """Half a diameter on either side of y = 0 in a box of 1 m: the plane lies between them, not in the middle."""
    position = np.zeros((2, 2, 3))
    position[:, 0, 1], position[:, 1, 1], position[1, :, 2] = 0.97, 0.05, -0.4
    position[:, :, 0] = 0.5
    still = np.zeros_like(position)
    tracks = Tracks(np.array([0.0, 1.0]), position, still, still, still[..., 0])
    plane = viewing_plane(tracks, (1.0, 1.0, 2.0), (0, 0, -9.81), (1.0, 1.0, 0.0))
    if plane.normal == 1:
        assert plane.position == pytest.approx(0.01)
    assert plane.across == 0 or plane.position == pytest.approx(0.5)


def test_copies_beside_both_periodic_sides():
    assert len(periodic_copies(np.zeros((1, 2)), np.array([1.0, 2.0]))) == 9
    assert periodic_copies(np.array([[5.0, 6.0]]), np.zeros(2))[0].tolist() == [[5.0, 6.0]]


def test_text_of_a_case_with_what_is_known():
    assert case_text("A", {}, Summary(), []) == "A"
    case = {"fluid": {"density": 1000.0, "kinematic_viscosity": 1e-6}}
    assert case_text("", case, Summary(), [1e-3, 2e-3]) == "2 spheres of 1 to 2 mm in 1000 kg/m³, 1e-06 m²/s"
