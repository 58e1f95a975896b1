"""rdpm design: text, JSON, CSV, sweeps, approaches, units, exports, charts, refusals."""

import csv
import io
import json

import pytest
from cyclopts import App

from rdpm.cli.design import design
from rdpm.design import soft_sphere
from rdpm.design.export import PROGRAMS, export
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
    assert set(found["verdicts"][0]) == {"name", "value", "limit", "ok", "reason", "source"}


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


@pytest.mark.parametrize("program", PROGRAMS)
def test_exports_say_what_their_numbers_mean(run, program):
    text = run(*CONTACT, "--export", program)
    assert "Source:" in text
    assert "reduced mass" in text
    assert "A contact ends at" in text


def test_exports_carry_the_right_numbers():
    d = soft_sphere(mass=1e-3, restitution=0.5, contact_time=8e-3, friction=0.1, ending="zero-overlap")
    assert "DES_EN_INPUT(1) = 0.5\n" in export(d, "mfix")
    assert f"kn={2 * d.stiffness_N_m:.12g}, cn={2 * d.damping_N_s_m:.12g}" in export(d, "yade")
    assert f"setDissipation({d.damping_N_s_m:.12g})" in export(d, "mercurydpm")
    assert "limitForce off" in export(d, "liggghts")
    assert "limit_damping\n" not in export(d, "lammps")
    # YADE cuts attraction off, and the fragment says so
    assert "design with that of this program" in export(d, "yade")
    stiff = soft_sphere(mass=1e-3, stiffness=1.0, damping=0.1)
    with pytest.raises(CaseError, match="damping ratio below 1"):
        export(stiff, "mfix")
