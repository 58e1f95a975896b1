"""A wrong study file is refused with file, line, value, rule and cure, before anything is written."""

import pytest

from rdpm.cli.main import main
from rdpm.config.write import case_to_toml
from rdpm.errors import CaseError
from rdpm.studies.expand import expand
from rdpm.studies.prepare import prepare, write_folder
from rdpm.studies.study import run_study
from rdpm.studies.study_file import load_study
from studies import MEETING, sweep

HEAD = '[base]\ncase = "dkt"\n'


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (HEAD + "[vray]\n", '3: vray: unknown key. Did you mean "vary"?'),
        (HEAD + "[start]\natt = 1\n", '4: start.att: unknown key. Did you mean "at"?'),
        ("title = 'a'\n", 'base: is missing. Add [base] with case = "dkt".'),
        ('measure = ["dkd"]\n' + HEAD, 'measure[0] = "dkd": must be one of "contacts", "cost", "design", "dkt", '),
        (HEAD + '[vary]\n"time.end" = "1:2"\n', '4: vary."time.end" = "1:2": must be a list of values or a range'),
        (HEAD + '[vary]\n"time.end" = "1:2:1 s"\n', "must have 2 to 1000 values (the range counts 1)"),
        (HEAD + '[vary]\n"time.end" = "log 0:2:5 s"\n', "must have positive ends"),
        (HEAD + '[vary]\n"time.end" = []\n', "must have at least one value"),
        (HEAD + '[[linked]]\n"a" = [1]\n"b" = [1, 2]\n', "must have columns of one length (a has 1, b has 2)"),
        (HEAD + "[linked]\na = [1]\n", "Write the header with two brackets"),
        (HEAD + '[[runs]]\nname = "a/b"\n', '4: runs[0].name = "a/b": must be a name of letters'),
        (HEAD + '[spread]\nof = ["a"]\n', 'must have "shifts", "orientation_seeds" or "time_steps"'),
        (HEAD + '[spread]\nof = ["a"]\nshifts = [[1,0,0]]\n', '4: spread.of[0] = "a": must be a run'),
        (HEAD + '[vary]\n"fluid.viscocity" = [1]\n', '4: run viscocity-1: fluid.viscocity: unknown key. Did you mean'),
        (HEAD + '[vary]\n"fluid.viscosity" = [1, -1]\n', "4: run viscosity--1: fluid.viscosity = -1: must be positive"),
        (HEAD + '[vary]\n"bodies[3].density" = [1]\n', "must be an item that is there, [0] to [0]"),
        (HEAD + '[vary]\n"time.end" = [1, 1]\n', "must give each run a name of its own (there are two of end-1)"),
        (HEAD + '[start]\nat = "9 s"\n', "4: start.at = 9 s: must be before the end of every run, as is 4 s"),
        (HEAD + 'unset = ["fluidd"]\n', 'must name a key of the case ("fluidd" is not there)'),
        (HEAD + '[base.set]\n"contact.damping" = 1\n', "must have contact_steps and restitution, stiffness and"),
        ('include = ["seedd"]\n', 'include[0]: seedd: there is no such study. Did you mean "seed"?'),
        ('include = ["seed"]\n' + HEAD, "base: must not stand beside include"),
        ("[base]\ncase = 'dtk'\n", 'there is no such file. Did you mean "dkt"?'),
        ("title = \n", "1: must be TOML"),
    ],
)
def test_each_problem_is_told_in_one_line(text, said, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.toml").write_text(text)
    assert main(["study", "check", "mine.toml"]) == 2
    told = capsys.readouterr().err
    assert told.startswith("rdpm: mine.toml") or "dtk" in told
    assert said in told
    assert told.count("\n") == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mine.toml"]


def test_a_study_that_includes_itself_is_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.toml").write_text('include = ["b.toml"]\n')
    (tmp_path / "b.toml").write_text('include = ["a.toml"]\n')
    with pytest.raises(CaseError, match=r"must not include itself \(a > b > a\)"):
        load_study("a.toml")


def test_paths_go_from_the_study_files_folder(tmp_path):
    from rdpm.config.load import load_case

    (tmp_path / "base.toml").write_text(case_to_toml(load_case(MEETING)))
    (tmp_path / "mine.toml").write_text('[base]\ncase = "base.toml"\n')
    (run,) = expand(load_study(tmp_path / "mine.toml"))
    assert run.case.fluid.viscosity == 0.05


def test_quick_needs_to_be_told(capsys):
    with pytest.raises(CaseError, match="study: quick: is missing"):
        prepare(load_study({"base": {"case": MEETING}}), quick=True)


def test_a_folder_that_holds_other_files_is_refused(tmp_path):
    (tmp_path / "thesis.tex").touch()
    with pytest.raises(CaseError, match="must be new, empty, or the folder of a study"):
        run_study(load_study(sweep()), tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]


def test_one_study_at_a_time_in_a_folder(tmp_path):
    from rdpm.io.lock import locked

    folder = write_folder(prepare(load_study(sweep())), tmp_path / "s", "")
    with locked(folder.lock), pytest.raises(CaseError, match="one run at a time"):
        run_study(load_study(sweep()), tmp_path / "s")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("nonsense",), "there is no such study"),
        (("check", "seed", "seed"), "must be STUDY, check STUDY or collect FOLDER"),
        (("collect", "."), "must be the folder of a study (study.json is missing)"),
        (("dkt", "--copy"), "must be a shipped study to be copied"),
        (("dkt-stiffness", "--workers", "0"), "must lie between 1 and 1024"),
    ],
)
def test_wrong_words(words, said, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["study", *words]) == 2
    assert said in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
