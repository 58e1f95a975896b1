"""What new users typed and stumbled over, as they typed it: refused with the cure, or taken and said so."""

import json
from pathlib import Path

import pytest

from rdpm.cases import shipped_text
from rdpm.cli import main as cli

GLASS = ["--diameter", "1 mm", "--density", "2500", "--restitution", "0.97"]
OIL = ["--diameter", "15 mm", "--density", "1120", "--fluid-density", "962", "--viscosity", "0.113 Pa s"]


@pytest.fixture
def run(tmp_path, monkeypatch, capsys):
    """Gives exit code, and all that is said, of a command in an empty folder; one that is refused writes nothing."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "400")

    def command(*words):
        before = set(Path().iterdir())
        code = cli.main(list(words))
        if code == 2:
            assert set(Path().iterdir()) == before, "something was written"
        shown = capsys.readouterr()
        return code, shown.out + shown.err

    return command


REFUSED = {
    "a fraction given as per cent": (
        ["design", *GLASS, "--max-overlap", "0.5", "--impact-speed", "1 cm/s", "--contact-steps", "8"],
        'max_overlap = 0.5: must be at most 0.05, a fraction of the diameter (a contact that deep is no sphere\'s). '
        'For 0.5 % write 0.005, or "0.5 %".',
    ),
    "the same in a case": (
        ["check", "dkt", "--set", 'contact={max_overlap=0.5, impact_speed="4 cm/s"}'],
        '--set contact.max_overlap = 0.5: must be at most 0.05, a fraction of the diameter (a contact that deep is no '
        'sphere\'s). For 0.5 % write 0.005, or "0.5 %".',
    ),
    "a step above a given spring's": (
        ["check", "dkt", "--set", "contact={stiffness=5, damping=0.1}", "--set", 'time.step="9 ms"'],
        'time.step = 0.009 s: must be at most 0.0078 s (the shortest contact of this stiffness lasts 0.0312 s and '
        'needs 4 steps). Lower it, use "auto", or give a softer contact.',
    ),
    "threads": (["run", "settling", "--threads", "1000"], "--threads = 1000: must lie between 1 and "),
    "a time without a folder": (["run", "settling", "--at", "3"], "--at = 3: needs --from"),
    "another model's key": (
        ["check", "dkt", "--set", "contact.youngs_modulus='63 GPa'"],
        'contact.youngs_modulus = 63000000000.0: belongs to model = "hertz" (this contact has model = "soft-sphere").',
    ),
    "a word misspelled": (
        ["check", "settling", "--set", "fluid.viscocity=0.1"],
        '--set fluid.viscocity: unknown key. Did you mean "viscosity"?',
    ),
    "a unit of something else": (
        ["check", "settling", "--set", "fluid.viscosity='1 mm'"],
        '--set fluid.viscosity = "1 mm": must be a dynamic viscosity (mm is not one). Write a number in Pa s',
    ),
    "not a number": (["check", "settling", "--set", "time.step=nan"], "--set time.step = nan: must be a finite"),
    "a case that is not": (["check", "setling"], 'setling: there is no such file. Did you mean "settling"?'),
    "a folder as a case": (["check", "."], ".: must be a file (it is a folder). Name a file in it."),
    "a sphere in the floor": (
        ["check", "settling", "--set", "bodies[0].centers=[[0.05, 0.05, 0.005]]"],
        "must lie inside the box: body 0 reaches z = -0.0025 m",
    ),
    "spheres in one another": (
        ["check", "settling", "--set", "bodies[0].centers=[[0.05, 0.05, 0.1], [0.05, 0.05, 0.11]]"],
        "must not overlap: bodies 0 and 1 have a gap of -0.005 m (a contact must start with a touch).",
    ),
    "a grid that fits no machine": (
        ["check", "settling", "--set", "resolution.cells_per_diameter=500"],
        "resolution.cells_per_diameter = 500.0: must lead to a grid of at most ",
    ),
    "energy out of a contact": (
        ["design", *GLASS[:4], "--restitution", "1.2", "--contact-steps", "8", "--time-step", "1 ms"],
        "restitution = 1.2: must be in 0 <= e_n <= 1 (a contact adds no energy).",
    ),
    "another program": (
        ["design", *GLASS, "--stiffness", "100", "--export", "lamps"], 'Did you mean "lammps"?',
    ),
    "a report of nothing": (["report", "."], "must hold a run's results (neither summary.json nor case.toml is there)"),
    "a folder with results": (["run", "settling", "--out", "."], "must be new or empty"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_refused_with_the_reason_and_the_cure(name, run):
    words, said = REFUSED[name]
    if name == "a folder with results":
        Path("particles.csv").touch()
    code, shown = run(*words)
    assert code == 2
    assert shown.startswith("rdpm: ")
    assert said in shown
    assert len(shown.splitlines()) == 1


WARNED = {
    "gravity in cm/s^2": ("domain.gravity=[0, 0, -981]", "domain.gravity", "100 times the Earth's; was it meant in cm"),
    "an end of thirty years": ("time.end=1e9", "time.end", "years on one thread; was it meant in another unit than s?"),
    "a picture a nanosecond": ("output.fields_every=1e-9", "output.fields_every", "makes one a step"),
}  # fmt: skip


@pytest.mark.parametrize("name", WARNED)
def test_possible_but_hardly_meant(name, run):
    given, key, said = WARNED[name]
    code, shown = run("check", "settling", "--set", given)
    assert code == 0
    line = next(line for line in shown.splitlines() if line.startswith(key))
    assert "warning" in line
    assert said in line


def test_a_step_that_is_asked_for_is_kept(run):
    """Stiffness and damping given, and a step that resolves them: neither is replaced."""
    code, shown = run(
        "check", "dkt", "--json", "--set", "contact={stiffness=5, damping=0.1}", "--set", 'time.step="1.5 ms"'
    )
    assert code == 0
    told = json.loads(shown)
    assert (told["dt_s"], told["dt_limit"]) == (1.5e-3, "user")
    assert {pair["stiffness_N_m"] for pair in told["pairs"]} == {5.0}


def test_advice_is_of_the_spring_that_is_given(run):
    """Not of another: no step above a quarter of its contact time."""
    code, shown = run("design", *GLASS, "--stiffness", "1e5", "--impact-speed", "1 cm/s", "--json")
    told = json.loads(shown)
    assert code == 0
    assert told["advice"]["time_step_s"] <= told["contact_time_s"] / 4.0
    stiff, shown = run("design", *GLASS, "--stiffness", "1e5", "--youngs-modulus", "63 GPa", "--poisson-ratio", "0.22",
                       "--impact-speed", "1 cm/s", "--json")  # fmt: skip
    assert stiff == 0
    assert json.loads(shown)["advice"]["time_step_s"] <= told["contact_time_s"] / 4.0


def test_a_limit_given_is_judged_by_the_usual_one(run):
    words = ["design", *GLASS, "--max-overlap", "3 %", "--overlap-limit", "3 %", "--impact-speed", "1 cm/s"]
    code, shown = run(*words, "--contact-steps", "8")
    assert code == 0
    assert "note: overlap 3 % d > 0.5 %, the usual limit (at 1 cm/s); within the 3 % allowed here" in shown


def test_the_order_of_two_bodies_does_not_matter(run):
    """A wet pair of a light and a heavy sphere, either first."""
    wet = ["--fluid-density", "962", "--viscosity", "0.113 Pa s", "--restitution", "0.9", "--contact-steps", "8",
           "--time-step", "1 ms", "--impact-speed", "0.5 m/s", "--json"]  # fmt: skip
    one, other = (["15 mm", "1120"], ["4 mm", "7800"])
    found = []
    for (d1, rho1), (d2, rho2) in ((one, other), (other, one)):
        words = ["--diameter", d1, "--density", rho1, "--diameter2", d2, "--density2", rho2]
        found.append(json.loads(run("design", *words, *wet)[1])["wet_restitution"])
    assert found[0] == pytest.approx(found[1], rel=1e-12)


def test_an_overdamped_design_is_an_answer(run):
    code, shown = run("design", "--mass", "1 g", "--stiffness", "1e5 dyn/cm", "--damping", "1e6 dyn s/cm",
                      "--ending", "zero-overlap", "--json")  # fmt: skip
    told = json.loads(shown)
    assert (code, told["regime"], told["restitution"], told["contact_time_s"]) == (0, "overdamped", None, None)


def test_the_edited_copy_is_the_one_that_is_checked(run):
    Path("dkt.toml").write_text(shipped_text("dkt").replace("cells_per_diameter = 8", "cells_per_diameter = 9"))
    code, shown = run("check", "dkt")
    assert code == 0
    assert "note: dkt is the file dkt.toml here, not the shipped case of that name" in shown


def test_verdicts_read_alike_in_check_and_design(run):
    """Quantity, value, sign, limit, condition: the same line of the same contact."""
    told = run("check", "settling", "--set", "contact.overlap_warning=0.005")[1].splitlines()
    judged = [line for line in told if line.startswith(("ok   ", "note: ", "FAIL "))]
    spring = next(line for line in told if line.startswith("stiffness k_n")).split()
    dashpot = next(line for line in told if line.startswith("damping eta_n")).split()
    step = next(line for line in told if line.startswith("time step")).split()
    shown = run("design", *OIL, "--wall", "--stiffness", spring[2], "--damping", dashpot[2], "--time-step", step[2])[1]
    there = [line.strip() for line in shown.splitlines()]
    assert "FAIL overlap 2.5 % d > 0.5 % (at 9.44 cm/s)" in judged
    assert len(judged) >= 4
    assert all(line in there for line in judged)
