"""From a study file to its runs: ranges, combinations, common starts, what is shared."""

import tomllib

import pytest

from rdpm.cases import shipped_studies, shipped_text
from rdpm.cli.main import main
from rdpm.studies.cases import changed
from rdpm.studies.expand import expand, parameters
from rdpm.studies.pictures import Drawing
from rdpm.studies.prepare import prepare
from rdpm.studies.registry import DRAWINGS
from rdpm.studies.study_file import load_study
from rdpm.studies.values import to_values
from rdpm.studies.write import study_to_toml
from studies import MEETING, sweep


def runs_of(**content):
    return expand(load_study({"base": {"case": MEETING}, **content}))


@pytest.mark.parametrize(
    ("given", "values"),
    [
        ("0.1:0.9:9", (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)),
        ("2:1:3", (2.0, 1.5, 1.0)),
        ("1:2:3 ms", ("1 ms", "1.5 ms", "2 ms")),
        ("log 5e3:5e5:3 dyn/cm", ("5000 dyn/cm", "50000 dyn/cm", "500000 dyn/cm")),
        ({"log": [1, 100, 3]}, (1.0, 10.0, 100.0)),
        ({"linear": ["0 mm", "1 mm", 3]}, ("0 mm", "0.5 mm", "1 mm")),
        ([1, "2 ms", [3]], (1, "2 ms", [3])),
    ],
)
def test_ranges_list_round_values_and_meet_both_ends(given, values):
    assert to_values(given) == values


def test_runs_are_all_combinations_then_the_rows():
    found = runs_of(
        vary={"contact.restitution": [0.5, 0.9]},
        linked=[{"name": ["soft", "hard"], "contact.contact_steps": [30, 10], "contact.friction": [0.0, 0.2]}],
        runs=[{"name": "thin", "set": {"fluid.viscosity": "10 mPa s"}}],
    )
    assert [run.name for run in found] == [
        "restitution-0.5_soft", "restitution-0.5_hard", "restitution-0.9_soft", "restitution-0.9_hard", "thin",
    ]
    contact = found[3].case.contact
    assert (contact.restitution, contact.contact_steps, contact.friction) == (0.9, 10.0, 0.2)
    assert found[4].case.fluid.viscosity == 0.01
    assert list(parameters(found)[0]) == [
        "fluid.viscosity", "contact.contact_steps", "contact.restitution", "contact.friction",
    ]


def test_dotted_and_nested_keys_are_the_same():
    nested = runs_of(vary={"contact": {"friction": [0.1, 0.2]}}, base={"case": MEETING, "set": {"time": {"end": 0.02}}})
    dotted = runs_of(vary={"contact.friction": [0.1, 0.2]}, base={"case": MEETING, "set": {"time.end": 0.02}})
    assert [run.case for run in nested] == [run.case for run in dotted]
    assert nested[0].case.time.step == 0.0005   # a table that is set keeps its other keys


def test_a_contact_parameter_that_is_set_replaces_what_it_cannot_stand_beside():
    (run,) = runs_of(runs=[{"name": "a", "set": {"contact.stiffness": 50}}])
    assert run.case.contact.way == "stiffness-restitution"
    assert run.case.contact.restitution == 0.7
    assert run.notes == ("contact.contact_steps gives way to stiffness",)
    base = {"case": MEETING, "set": {"contact.stiffness": 50, "contact.damping": 0.1}}
    (run,) = runs_of(base=base, runs=[{"name": "a", "set": {"contact.contact_steps": 9, "contact.restitution": 0.5}}])
    assert run.case.contact.way == "contact-steps"


def test_runs_write_tables_alone_unless_the_study_says_or_draws(monkeypatch):
    (run,) = runs_of()
    assert (run.case.output.fields_every, run.case.output.report, run.case.output.video) == (0.0, False, False)
    (run,) = runs_of(base={"case": MEETING, "set": {"output.fields_every": 0.01, "output.report": True}})
    assert (run.case.output.fields_every, run.case.output.report) == (0.01, True)
    monkeypatch.setitem(DRAWINGS, "flow", Drawing(lambda results, folder: [], needs_fields=True))
    (run,) = runs_of(draw=["flow"])
    assert run.case.output.fields_every == pytest.approx(0.04 / 50)


def test_one_start_serves_runs_that_differ_in_contact_end_and_output():
    made = prepare(load_study(sweep(
        vary={"contact.contact_steps": [12, 20], "time.end": [0.03, 0.04], "contact.lubrication": [False, True]},
    )))
    starts = [job for job in made.jobs if job.is_start]
    assert len(starts) == 2   # lubrication acts before the contact
    for run, name in zip(made.runs, made.names, strict=True):
        (job,) = (job for job in made.jobs if job.name == name)
        start = made.cases[job.start]
        assert start.time.end == 0.0015
        assert start.contact.lubrication == run.case.contact.lubrication
        assert start.contact.contact_steps == 20   # the base's
        assert job.steps == round((run.case.time.end - 0.0015) / 0.0005)


def test_spread_moves_turns_and_changes_the_step_alone():
    found = runs_of(
        runs=[{"name": "a"}, {"name": "b"}],
        spread={"of": ["a"], "shifts": [[0.5, 0, 0]], "orientation_seeds": [4], "time_steps": ["0.25 ms"]},
    )
    assert [(run.name, run.spread_of) for run in found[2:]] == [
        ("a~shift-1", "a"), ("a~seed-4", "a"), ("a~step-0.00025s", "a"),
    ]
    moved, turned, stepped = (run.case for run in found[2:])
    assert moved.bodies[0].centers[0] == pytest.approx((0.0095 + 0.5 * 0.03 / 15, 0.015, 0.0252))
    assert turned.bodies[0].orientation_seed == 4
    assert (stepped.time.step, stepped.contact.contact_steps) == (0.00025, 40.0)   # the same contact time


def test_runs_that_parts_share_are_made_once():
    parts = [sweep(name="one"), sweep(name="two", vary={"contact.contact_steps": [20, 30]})]
    made = prepare(load_study({"include": parts}))
    assert made.names == [
        "one/contact_steps-12", "one/contact_steps-20", "one/contact_steps-20", "two/contact_steps-30",
    ]
    assert len(made.jobs) == 4   # with the start, which they share too
    assert [run.study for run in made.runs] == ["one", "one", "two", "two"]


def test_runs_that_differ_in_the_fields_they_write_are_made_once_with_most_of_them():
    parts = [sweep(name=f"every-{n}", base={"case": MEETING, "set": {"output.fields_every": every}})
             for n, every in enumerate((0.0, 0.01, 0.02))]
    made = prepare(load_study({"include": parts}))
    assert made.names == ["every-0/contact_steps-12", "every-0/contact_steps-20"] * 3
    assert [job.is_start for job in made.jobs] == [True, False, False]
    assert {case.output.fields_every for case in made.cases.values()} == {0.01}


def test_quick_takes_some_runs_evenly_and_leaves_the_spread_out():
    study = load_study(sweep(
        vary={"contact.contact_steps": [10, 12, 14, 16, 18]},
        spread={"shifts": [[0.1, 0, 0]]},
        quick={"set": {"time.end": 0.002}, "start_at": 0, "most_runs": 3},
    ))
    found = expand(study, quick=True)
    assert [run.name for run in found] == ["contact_steps-10", "contact_steps-14", "contact_steps-18"]
    assert {(run.case.time.end, run.start) for run in found} == {(0.002, None)}


def test_a_study_written_as_toml_gives_the_same_runs():
    content = sweep(linked=[{"name": ["a", "b"], "contact.friction": [0.0, 0.1]}], title='a "b" \\ c')
    again = tomllib.loads(study_to_toml(content))
    assert again == content
    assert expand(load_study(again)) == expand(load_study(content))


@pytest.mark.parametrize("name", shipped_studies())
def test_shipped_studies_can_be_run(name):
    made = prepare(load_study(name))
    quick = prepare(load_study(name), quick=True)
    assert made.study.file.title
    assert made.study.file.question
    assert quick.cell_steps < 0.05 * made.cell_steps
    assert made.expected_seconds(2) < 18 * 60   # at the rate of one thread that the plan of a run expects


def test_the_talks_runs_are_those_of_its_slides():
    slides = {
        "dkt-stiffness": [(1.0, 0.1), (50.0, 0.1), (500.0, 0.1)],
        "dkt-damping": [(50.0, 0.0), (50.0, 0.05), (50.0, 0.1)],
        "dkt-window": [(k, 0.15) for k in (5.0, 10.0, 20.0, 50.0, 100.0)],
    }
    for name, pairs in slides.items():
        runs = [run for run in expand(load_study(name)) if not run.spread_of]
        assert [(run.case.contact.stiffness, run.case.contact.damping) for run in runs] == pairs
        _have_the_talks_contacts(runs)


def _have_the_talks_contacts(runs):
    for run in runs:
        assert run.case.time.step == 1e-3
        assert run.case.contact.ending == "zero-overlap"
        assert not run.case.contact.lubrication


def test_a_case_beside_the_study_file_goes_before_the_shipped_one(tmp_path, monkeypatch, capsys):
    text = shipped_text("dkt")
    (tmp_path / "dkt.toml").write_text(text.replace("restitution = 0.5 ", "restitution = 0.25 "))
    (tmp_path / "mine.toml").write_text('[base]\ncase = "dkt"\n')
    (run,) = expand(load_study(tmp_path / "mine.toml"))
    assert run.case.contact.restitution == 0.25
    assert run.notes == (f"note: dkt is the file {tmp_path / 'dkt.toml'} here, not the shipped case of that name",)
    # what is no file, or shipped, is whole by itself, wherever it is run
    monkeypatch.chdir(tmp_path)
    assert [run.case.contact.restitution for run in expand(load_study({"base": {"case": "dkt"}}))] == [0.5]
    assert {run.case.contact.restitution for run in expand(load_study("time-step"))} == {0.5}
    assert main(["study", "check", "mine.toml"]) == 0
    assert "note: dkt is the file dkt.toml here" in capsys.readouterr().out


def test_a_local_study_goes_before_the_shipped_one(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["study", "time-step", "--copy"]) == 0
    (tmp_path / "time-step.toml").write_text('title = "My own"\n[base]\ncase = "dkt"\n')
    assert main(["study", "check", "time-step"]) == 0
    said = capsys.readouterr()
    assert "My own" in said.out
    assert "note: time-step is the file time-step.toml here, not the shipped study of that name" in said.err


def test_another_model_takes_the_place_of_what_it_does_not_know():
    raw = {"contact": {"stiffness": 50, "damping": 0.1, "friction": 0.2, "lubrication": False}}
    made, notes = changed(raw, [{"contact.model": "hard-sphere", "contact.restitution": 0.5}], (), "study")
    assert made["contact"] == {"model": "hard-sphere", "restitution": 0.5, "friction": 0.2, "lubrication": False}
    assert notes == [f"contact.{key} gives way to model = hard-sphere" for key in ("damping", "stiffness")]
    # what is set beside the model stays, for the case to refuse
    made, _ = changed(raw, [{"contact.model": "hard-sphere", "contact.stiffness": 9}], (), "study")
    assert made["contact"]["stiffness"] == 9
