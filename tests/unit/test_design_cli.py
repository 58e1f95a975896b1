"""rdpm design: text, JSON, CSV, sweeps, approaches, units, exports, charts, refusals."""

import csv
import io
import json
from itertools import pairwise

import pytest
from cyclopts import App

from rdpm.cli.design import design
from rdpm.design import soft_sphere
from rdpm.design.export import PROGRAMS, export
from rdpm.design.programs import step_there
from rdpm.errors import CaseError

KEYS = [
    "stiffness_N_m", "damping_N_s_m", "restitution", "contact_time_s", "contact_steps", "damping_ratio",
    "regime", "max_overlap_fraction", "static_overlap_fraction", "hertz_contact_time_s", "stokes_number",
    "tangential", "verdicts",
]  # fmt: skip
CONTACT = ["--mass", "1e-3", "--restitution", "0.5", "--contact-time", "0.008", "--time-step", "1e-3"]


@pytest.fixture
def run(capsys):
    app = App(name="design")
    app.default(design)

    def call(*words: str) -> str:
        command, bound, *_ = app.parse_args(list(words), exit_on_error=False, print_error=False)
        assert command(*bound.args, **bound.kwargs) == 0
        return capsys.readouterr().out

    return call


def test_json_has_the_promised_keys(run):
    found = json.loads(run(*CONTACT, "--json"))
    assert set(KEYS) <= set(found)
    assert found["contact_steps"] == pytest.approx(8.0)
    assert set(found["verdicts"][0]) >= {"name", "value", "limit", "ok", "reason", "source"}
    assert found["verdicts"][1]["text"] == "contact resolved by 8 steps >= 4"
    assert found["programs"]["lammps"]["contact_steps"] == 50


def test_units_in_and_out(run):
    si = json.loads(run("--mass", "0.001", "--stiffness", "100", "--damping", "0.1", "--json"))
    cgs = json.loads(run("--mass", "1 g", "--stiffness", "1e5 dyn/cm", "--damping", "100 dyn s/cm", "--json"))
    assert cgs == si
    text = run("--mass", "1 g", "--stiffness", "1e5 dyn/cm", "--damping", "100 dyn s/cm", "--units", "cgs")
    assert "100000 dyn/cm" in text
    assert "100 dyn s/cm" in text


def test_overdamped_is_nulls_and_a_verdict(run):
    words = ["--mass", "1e-3", "--stiffness", "1", "--damping", "0.1", "--ending", "zero-overlap"]
    found = json.loads(run(*words, "--json"))
    assert found["restitution"] is None
    assert found["contact_time_s"] is None
    assert found["regime"] == "overdamped"
    assert not found["verdicts"][0]["ok"]
    assert "undefined" in run(*words)


def test_sweep_gives_a_table(run, tmp_path):
    words = ["--mass", "1e-3", "--restitution", "0.1:0.9:9", "--stiffness", "100"]
    rows = list(csv.DictReader(io.StringIO(run(*words))))
    assert len(rows) == 9
    assert [float(r["restitution"]) for r in rows][-1] == pytest.approx(0.9)
    assert run(*words, "--csv", str(tmp_path / "sweep.csv")) == ""
    assert len((tmp_path / "sweep.csv").read_text().splitlines()) == 10
    assert len(json.loads(run(*words, "--json"))) == 9
    logged = list(
        csv.DictReader(
            io.StringIO(run("--mass", "1e-3", "--restitution", "0.5", "--stiffness", "1:100:3:log"))
        )
    )
    assert [float(r["stiffness_N_m"]) for r in logged] == pytest.approx([1.0, 10.0, 100.0])


def test_three_approaches(run):
    bodies = ["--diameter", "0.015", "--density", "1120", "--impact-speed", "0.03", "--time-step", "1e-3"]
    graphical = run("--mass", "1e-3", "--restitution", "0.8", "--stiffness", "0.1:1e4:6:log",
                    "--time-step", "1e-3", "--approach", "graphical")  # fmt: skip
    assert len(graphical.splitlines()) == 7
    trial = run(*bodies, "--damping", "0.15", "--stiffness", "5:1000:5:log", "--approach", "trial")
    assert trial.splitlines()[1].endswith("False")  # 5 N/m is overdamped beside 0.15 N s/m
    steps = run(*bodies, "--restitution", "0.5", "--contact-steps", "4:20:17", "--approach", "contact-steps")
    assert [row.rsplit(",", 1)[1] for row in steps.splitlines()[1:]].count("True") == 6  # 4 to 9


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--mass", "-1", "--restitution", "0.5"], "mass = -1"),
        (["--mass", "1 mm"], "--mass"),
        (["--mass", "heavy"], "--mass"),
        (["--mass", "1", "--restitution", "0.1:0.9"], "FROM:TO:COUNT"),
        (["--mass", "1", "--restitution", "0.1:0.9:1"], "count of 2"),
        (["--mass", "1", "--restitution", "0:0.9:3:log", "--stiffness", "1"], "above 0"),
        (["--mass", "1", "--restitution", "0.1:0.9:3", "--stiffness", "1:2:3"], "only one"),
        (["--mass", "1", "--restitution", "0.1:0.9:3", "--stiffness", "1", "--figures", "x"], "--figures"),
        (
            ["--mass", "1", "--restitution", "0.5", "--stiffness", "1", "--json", "--export", "yade"],
            "--export",
        ),
        (["--mass", "1", "--restitution", "0.5", "--stiffness", "1", "--figures", "x"], "--figures"),
        (["--mass", "1", "--approach", "graphical"], "--stiffness"),
        (["--mass", "1", "--approach", "graphical", "--stiffness", "1:2:3"], "time_step"),
    ],
)
def test_wrong_words_are_refused(run, words, message):
    with pytest.raises(CaseError) as caught:
        run(*words)
    assert message in str(caught.value)
    assert caught.value.exit_code == 2


def test_charts_are_written(run, tmp_path):
    run(*CONTACT, "--diameter", "0.015", "--impact-speed", "0.04", "--figures", str(tmp_path / "charts"))
    names = sorted(p.name for p in (tmp_path / "charts").iterdir())
    assert len(names) == 8
    assert all((tmp_path / "charts" / n).read_bytes().startswith(b"\x89PNG") for n in names)


def test_charts_of_an_undamped_contact(run, tmp_path):
    """A damping of zero is on no logarithmic axis; matplotlib's warnings are errors here."""
    words = ["--mass", "1e-3", "--restitution", "1", "--stiffness", "100", "--time-step", "1e-3"]
    run(*words, "--figures", str(tmp_path))
    assert len(list(tmp_path.iterdir())) == 6


@pytest.mark.parametrize(("kind", "start"), [("pdf", b"%PDF"), ("svg", b"<?xml")])
def test_charts_in_other_formats(run, tmp_path, kind, start):
    run(*CONTACT, "--figures", str(tmp_path), "--figure-format", kind)
    files = list(tmp_path.iterdir())
    assert len(files) == 6
    assert all(f.suffix == f".{kind}" and f.read_bytes().startswith(start) for f in files)


def test_every_chart_has_a_title_and_the_design_in_each_of_its_axes(monkeypatch, tmp_path):
    """At a column's width, with no two ticks of an axis in each other."""
    from rdpm.figures import design_charts

    drawn = {}
    monkeypatch.setattr(design_charts, "save", lambda figure, path, caption: drawn.setdefault(path.stem, figure))
    given = {"reduced_mass": 1e-3, "restitution": 0.5, "stiffness": 138.0, "damping": 0.1733, "time_step": 1e-3}
    design_charts.save_charts(tmp_path, **given, diameter=0.015, impact_speed=0.04, hertz_time=2e-3)
    assert len(drawn) == 8
    for name, figure in drawn.items():
        assert figure.get_figwidth() * 25.4 == pytest.approx(85.0)
        assert figure.get_suptitle(), name
        figure.canvas.draw()
        for axes in figure.axes:
            own = [line for line in axes.get_lines() if line.get_label() == "this design"]
            assert len(own) == 1, name
            x, y = own[0].get_xydata()[0]
            assert axes.get_xlim()[0] <= x <= axes.get_xlim()[1]
            assert axes.get_ylim()[0] <= y <= axes.get_ylim()[1]
            for axis, low, high in ((axes.xaxis, "x0", "x1"), (axes.yaxis, "y0", "y1")):
                boxes = [t.get_window_extent() for t in axis.get_ticklabels(which="both") if t.get_text()]
                ends = sorted((getattr(b, low), getattr(b, high)) for b in boxes)
                assert all(a[1] <= b[0] for a, b in pairwise(ends)), name


@pytest.mark.parametrize("program", PROGRAMS)
def test_exports_say_what_their_numbers_mean(run, program):
    text = run(*CONTACT, "--export", program)
    assert "Source:" in text
    assert "reduced mass" in text
    assert "A contact ends at" in text
    # the time step of this spring for the program's integrator, the wall, what was run and what only read
    there = step_there(soft_sphere(mass=1e-3, restitution=0.5, contact_time=8e-3, time_step=1e-3), program)
    assert f"{there.contact_steps} steps a contact" in text
    assert f"{there.time_step:.12g}" in text or f"DTSOLID_FACTOR = {there.contact_steps}\n" in text
    assert there.time_step < there.contact_time / 20 * (1 + 1e-12)
    assert "Against a wall" in text
    assert ("Run with" in text) != ("Not run; read against" in text)


def test_a_contact_that_never_ends_is_no_input():
    endless = soft_sphere(mass=1e-3, stiffness=1.0, damping=0.1, ending="zero-overlap")
    for program in PROGRAMS:
        if program != "yade":  # which ends it at zero force
            with pytest.raises(CaseError, match="damping ratio below 1"):
                export(endless, program)
    assert "A contact ends at zero-force" in export(endless, "yade")


def test_text_says_the_time_step_of_every_program(run):
    lines = run(*CONTACT).splitlines()
    titles = ("LAMMPS", "LIGGGHTS", "MFIX-DEM", "YADE", "MercuryDPM")
    found = [next(line for line in lines if line.startswith(f"  {title}")) for title in titles]
    assert "dt = 160 us     (50 steps); e_n 0.498" in found[0]
    assert "it ends a contact at zero-overlap" in found[2]


def test_exports_carry_the_right_numbers():
    d = soft_sphere(mass=1e-3, restitution=0.5, contact_time=8e-3, friction=0.1, ending="zero-overlap")
    assert "DES_EN_INPUT(1) = 0.5\n" in export(d, "mfix")
    assert f"kn={2 * d.stiffness_N_m:.12g}, cn={2 * d.damping_N_s_m:.12g}" in export(d, "yade")
    assert f"setDissipation({d.damping_N_s_m:.12g})" in export(d, "mercurydpm")
    assert "limitForce off" in export(d, "liggghts")
    assert "limit_damping\n" not in export(d, "lammps")
    # YADE cuts attraction off: the input says what comes out there
    assert "this program gives the former" in export(d, "yade")
    assert "# A contact ends at zero-force here: e_n = 0.550283, t_c = 0.00689403 s.\n" in export(d, "yade")
    assert "this program gives" not in export(d, "mfix")
    stiff = soft_sphere(mass=1e-3, stiffness=1.0, damping=0.1)
    with pytest.raises(CaseError, match="damping ratio below 1"):
        export(stiff, "mfix")
