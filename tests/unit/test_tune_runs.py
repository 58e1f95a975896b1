"""`rdpm tune` on miniatures: a sphere dropped onto a floor, dry; a pair in a small box at four cells a diameter."""

import csv
import json
import shutil
import tomllib
from dataclasses import replace

import numpy as np
import pytest

from rdpm import design
from rdpm.cases import shipped_names, shipped_text
from rdpm.cli import main as cli
from rdpm.config.load import load_case
from rdpm.config.source import parse_toml
from rdpm.results.run import load_run
from rdpm.setup import plan
from rdpm.studies.tuning.choice import differs
from rdpm.studies.tuning.confirm import measured
from rdpm.studies.tuning.reading import probed, work_fraction
from rdpm.studies.write import study_to_toml

DROP = """title = "Dropped"  # onto the floor
[domain]
size = ["20 mm", "20 mm", "30 mm"]
[[bodies]]
diameter = "3 mm"
density = "2500 kg/m^3"
centers = [["10 mm", "10 mm", "5 mm"]]
[contact]
contact_steps = 8
restitution = 0.8
[time]
end = "80 ms"
step = "0.1 ms"
[output]
table_every = "1 ms"
"""

PAIR = """title = "A pair"
[domain]
size = ["24 mm", "24 mm", "40 mm"]
boundary = { x = "periodic", y = "periodic", z = "wall" }
[fluid]
density = "962 kg/m^3"
viscosity = "0.113 Pa s"
[[bodies]]
diameter = "8 mm"
density = "5000 kg/m^3"
centers = [["12.2 mm", "12 mm", "34 mm"]]
[[bodies]]
diameter = "8 mm"
density = "1000 kg/m^3"
centers = [["12 mm", "12 mm", "25.5 mm"]]
[contact]
contact_steps = 8
restitution = 0.5
lubrication = false
overlap_warning = 0.05
[resolution]
cells_per_diameter = 4
[time]
end = "96 ms"
[output]
table_every = "1 ms"
"""


DROP_WORDS = ("--time-steps", "0.1 ms, 0.05 ms", "--set", "contact.overlap_warning=0.03", "--tolerance", "5 %")


def tuned(case, *words, out="out"):
    return cli.main(["tune", str(case), "--out", str(out), "--quiet", *words])


@pytest.fixture(scope="module")
def drop(tmp_path_factory):
    """A tuning of the dropped sphere, as its file and the folder."""
    folder = tmp_path_factory.mktemp("drop")
    (folder / "drop.toml").write_text(DROP)
    code = tuned(folder / "drop.toml", *DROP_WORDS, "--contact-steps", "4,8", out=folder / "out")
    return code, folder / "out"


def test_what_is_said_of_a_dropped_sphere(drop):
    code, out = drop
    said = json.loads((out / "tune.json").read_text())
    assert code == 0
    assert (said["kind"], said["measure"], said["outcome"]) == ("wall", "rebound_height_m", "rebound_height_m")
    assert said["window"] == [4.0, 8.0]
    assert said["outcome_spread"] is None   # a dry body has no cell to be moved in
    # It falls 3.5 mm and rises to 0.8^2 of that.
    for row in said["contact_steps"]:
        assert row["outcome"] == pytest.approx(0.64 * 3.5e-3, rel=0.03)
        assert row["max_impact_speed_m_s"] == pytest.approx(np.sqrt(2 * 9.81 * 3.5e-3), rel=0.01)
        assert row["work_fraction"] == pytest.approx(0.8**2 - 1, abs=0.03)
    assert said["first_contact_s"] == pytest.approx(np.sqrt(2 * 3.5e-3 / 9.81), rel=0.01)


def test_the_contact_of_each_row_is_the_designed_one(drop):
    _, out = drop
    said = json.loads((out / "tune.json").read_text())
    mass, dt = float(design.sphere_mass(3e-3, 2500.0)), said["time_step"]["dt_s"]
    for row in said["contact_steps"]:
        k, eta = design.contact_parameters(mass, 0.8, row["contact_steps"] * dt, "zero-force")
        assert (row["stiffness_N_m"], row["damping_N_s_m"]) == (pytest.approx(k), pytest.approx(eta))


def test_the_tuned_case_has_the_chosen_values(drop):
    _, out = drop
    said = json.loads((out / "tune.json").read_text())
    case = load_case(out / "drop-tuned.toml")
    assert said["case_file"] == str(out / "drop-tuned.toml")
    assert case.contact.contact_steps == said["chosen"]["contact_steps"]
    assert case.time.step == pytest.approx(said["time_step"]["dt_s"])
    made = plan(case).pairs[0].design
    assert made.stiffness_N_m == pytest.approx(said["chosen"]["stiffness_N_m"])
    # Nothing else is changed, and the user's units stay.
    before = load_case(out.parent / "drop.toml", ["contact.overlap_warning=0.03"])
    assert case.model_copy(update={"time": before.time, "contact": before.contact}) == before
    assert '"20 mm"' in (out / "drop-tuned.toml").read_text()


@pytest.mark.parametrize("name", shipped_names())
def test_an_edited_copy_of_a_shipped_case_is_that_case(name):
    raw = parse_toml(shipped_text(name), name)
    assert load_case(tomllib.loads(study_to_toml(raw))) == load_case(name)


def test_tables_and_figure(drop):
    _, out = drop
    with open(out / "contact_steps.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["contact_steps"]) for row in rows] == [4.0, 8.0]
    assert [row["in_window"] for row in rows] == ["True", "True"]
    with open(out / "time_steps.csv", newline="") as file:
        assert [float(row["dt_s"]) for row in csv.DictReader(file)] == [1e-4, 5e-5]
    assert (out / "tune.png").read_bytes().startswith(b"\x89PNG")


def test_a_tuning_goes_on_where_it_was(drop, capsys):
    _, out = drop
    times = {path: path.stat().st_mtime_ns for path in out.rglob("particles.csv")}
    assert times
    (out / "contact-steps" / "jobs" / "N_c-8.json").unlink()
    code = tuned(out.parent / "drop.toml", *DROP_WORDS, "--contact-steps", "4,8", "--json", out=out)
    assert code == 0
    assert json.loads(capsys.readouterr().out)["window"] == [4.0, 8.0]
    again = [path.parent.name for path, time in times.items() if path.stat().st_mtime_ns != time]
    assert again == ["N_c-8"]


def test_no_range_is_said_and_leaves_no_case(drop, capsys):
    _, out = drop
    soft = out.parent / "soft"
    shutil.copytree(out, soft)   # with its runs of time steps
    code = tuned(out.parent / "drop.toml", *DROP_WORDS, "--contact-steps", "60,90", out=soft)
    said = capsys.readouterr().out
    assert code == 1
    assert "No two neighbouring N_c keep the overlap below 3 % d" in " ".join(said.split())
    assert "60: overlap; 90: overlap" in " ".join(said.split())
    assert not (soft / "drop-tuned.toml").exists()


def test_a_pair_at_four_cells_a_diameter(tmp_path):
    (tmp_path / "pair.toml").write_text(PAIR)
    code = tuned(tmp_path / "pair.toml", "--time-steps", "0.5 ms", "--contact-steps", "4,6",
                 "--outcome-tolerance", "20 %", out=tmp_path / "out")  # fmt: skip
    said = json.loads((tmp_path / "out" / "tune.json").read_text())
    assert code == 0, said["verdict"]
    assert (said["kind"], said["measure"], said["time_steps"]) == ("kiss", "kiss_time_s", [])
    assert "its convergence was not tried" in said["verdict"]
    assert [row["status"] for row in said["contact_steps"]] == ["done", "done"]
    # Both go on from one start, which ends before the first contact.
    starts = list((tmp_path / "out" / "contact-steps" / "starts").iterdir())
    assert [start.name for start in starts] == ["start-1"]
    assert load_run(starts[0]).summary.time_s < said["first_contact_s"]
    assert said["dry_design"]["impact_speed_m_s"] > said["chosen"]["max_impact_speed_m_s"]


def test_what_a_run_shows(tmp_path):
    from builders import made_up_run, pair_motion

    run = load_run(made_up_run(tmp_path / "pair", pair_motion, 2))
    seen = probed(run)
    assert (seen.kind, seen.measure, seen.outcome) == ("kiss", "kiss_time_s", "tumble_start_s")
    assert seen.contact_s == 1.2
    assert seen.judged_s == 3.0   # the wall contact ends at 2.816 s
    assert probed(replace(run, contacts=None)) is None


def test_work_is_told_against_the_energy_that_a_contact_turned_over(tmp_path):
    from builders import made_up_run, pair_motion
    from rdpm.results.summary import BodySummary

    run = load_run(made_up_run(tmp_path / "pair", pair_motion, 2))
    bodies = (BodySummary(0, 0.015, 1120.0), BodySummary(1, 0.015, 1120.0))
    run = replace(run, summary=replace(run.summary, bodies=bodies))
    # The pair touches at 12 mm/s and is pressed to 0.3 % d; the wall is hit at 50 mm/s, which loses 1e-6 J.
    k, m = 40.1, 9.9e-4
    own = float(design.sphere_mass(0.015, 1120.0))
    reduced = 0.5 * own
    impact, spring = 0.5 * reduced * 0.012**2, 0.5 * k / m * reduced * (0.003 * 0.015) ** 2
    assert impact > spring
    assert work_fraction(run) == pytest.approx(max(-1e-7 / impact, -1e-6 / (0.5 * own * 0.05**2)))
    pushed = {**run.contacts, "work_J": np.array([2e-8, -1e-6])}
    assert work_fraction(replace(run, contacts=pushed)) == pytest.approx(2e-8 / impact)
    pressed = pushed | {"max_overlap_fraction": np.array([0.03, 0.006])}
    assert work_fraction(replace(run, contacts=pressed)) == pytest.approx(2e-8 / (100.0 * spring))


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["dkt", "--contact-steps", "2,8"], "--contact-steps = 2: must lie between 4 and 1000"),
        (["dkt", "--contact-steps", "many"], "--contact-steps = many: "),
        (["dkt", "--tolerance", "1 mm"], "--tolerance = 1 mm: "),
        (["dkt", "--measure", "speed"], '--measure = "speed": must be a measure'),
        (["dkt", "--workers", "0"], "--workers = 0: must lie between 1 and 1024"),
        (["dtk"], "dtk: there is no such file"),
        (["dkt", "--set", "contact.contact_step=8"], "--set contact.contact_step: unknown key"),
        (["dkt", "--set", "contact={stiffness=50, damping=9, ending='zero-overlap'}"], "contact.restitution"),
    ],
)  # fmt: skip
def test_a_user_error(words, said, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert cli.main(["tune", *words]) == 2
    assert said in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_case_in_which_nothing_can_touch(tmp_path, capsys):
    case = DROP.replace('size = ["20', 'boundary = { x = "periodic", y = "periodic", z = "periodic" }\nsize = ["20')
    (tmp_path / "alone.toml").write_text(case)
    assert tuned(tmp_path / "alone.toml", out=tmp_path / "out") == 2
    assert "alone: must have bodies that can touch" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_case_in_which_nothing_touches(tmp_path, capsys):
    (tmp_path / "early.toml").write_text(DROP.replace("80 ms", "20 ms"))
    assert tuned(tmp_path / "early.toml", out=tmp_path / "out") == 2
    said = capsys.readouterr().err
    assert "early: time.end = 0.02 s: must be after the first contact (nothing touches, the smallest gap is 1.5" in said


def test_a_folder_with_something_else_is_left_alone(tmp_path, capsys):
    (tmp_path / "drop.toml").write_text(DROP)
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "thesis.tex").write_text("x")
    assert tuned(tmp_path / "drop.toml", out=tmp_path / "out") == 2
    assert "must be new, empty, or the folder of a tuning" in capsys.readouterr().err
    assert tuned(tmp_path / "drop.toml", out=tmp_path / "a" / "b") == 2
    assert "must lie in a folder that is there" in capsys.readouterr().err


def test_the_choice_is_confirmed_on_a_finer_grid(tmp_path, capsys):
    (tmp_path / "pair.toml").write_text(PAIR)
    words = ("--quick", "--time-steps", "1 ms", "--contact-steps", "4,8", "--outcome-tolerance", "5 %", "--confirm",
             "--set", "time.end=50 ms")  # fmt: skip
    assert tuned(tmp_path / "pair.toml", *words, out=tmp_path / "out") == 0
    shown = capsys.readouterr().out
    said = json.loads((tmp_path / "out" / "tune.json").read_text())
    found = said["confirmation"]
    assert found["holds"]
    assert found["cells_per_diameter"] == [4.0, 8.0]
    assert found["dt_s"] == [1e-3, 5e-4]
    with open(tmp_path / "out" / "confirmation.csv", newline="") as file:
        rows = {row["quantity"]: row for row in csv.DictReader(file)}
    assert float(rows["overlap_fraction"]["coarse"]) == said["chosen"]["overlap_fraction"]
    fine = load_run(tmp_path / "out" / "confirm" / "runs" / "fine")
    assert fine.summary.cells == (24, 24, 40)
    # the same spring and dashpot: twice the steps of half the length
    assert fine.summary.contact.pairs[0].stiffness_N_m == pytest.approx(said["chosen"]["stiffness_N_m"])
    assert float(rows["overlap_fraction"]["fine"]) == pytest.approx(float(fine.contacts["max_overlap_fraction"].max()))
    assert "Confirmed at 8 cells a diameter" in said["verdict"]
    assert "4 cells a diameter" in shown


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"max_overlap_fraction": 0.02}, "the overlap is above its limit"),
        ({"final_angle_deg": None}, "final_angle_deg is not there in both"),
        ({}, "final_angle_deg differs by 1 %"),
    ],
)
def test_what_a_finer_run_may_say(monkeypatch, changes, said):
    coarse = {"overlap_fraction": 0.004, "outcome": 50.0, "kiss_time_s": 1.0, "work_fraction": -0.5}
    fine = {"max_overlap_fraction": 0.004, "final_angle_deg": 50.5, "kiss_time_s": 1.1} | changes
    monkeypatch.setattr("rdpm.studies.tuning.confirm.columns", lambda run: fine)
    monkeypatch.setattr("rdpm.studies.tuning.confirm.work_fraction", lambda run: -0.4)
    found = measured(coarse, object(), ("kiss_time_s", "final_angle_deg"), ("done", ""), (0.005, 0.01),
                     differs(None, 0.05), (8.0, 16.0), (1e-3, 5e-4))  # fmt: skip
    assert found.holds == (not changes)
    assert said in found.sentence()
    lost = measured(coarse, None, ("kiss_time_s", "final_angle_deg"), ("stopped", "it blew up"), (0.005, 0.01),
                    differs(None, 0.05), (8.0, 16.0), (1e-3, 5e-4))  # fmt: skip
    assert not lost.holds
    assert "it blew up" in lost.sentence()


def test_a_dry_case_has_no_finer_grid(tmp_path, capsys):
    (tmp_path / "drop.toml").write_text(DROP)
    assert tuned(tmp_path / "drop.toml", "--confirm", out=tmp_path / "out") == 2
    assert "--confirm: must have a case with a fluid" in capsys.readouterr().err
