"""``rdpm run`` with --resume, --from and --at."""

import json

import pytest
from restart_cases import StopsAt, case_of, new_folder, run_case

from rdpm.cli.main import main
from rdpm.config.write import case_to_toml
from rdpm.io.tables import read_table


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("rdpm.cli.run._end_on_signals", lambda: None)
    case = case_of("periodic cloud", "output.checkpoint_every=0.009")
    (tmp_path / "cloud.toml").write_text(case_to_toml(case))
    run_case(case, new_folder(tmp_path / "cloud"), reporter=StopsAt(25))
    return tmp_path


@pytest.mark.parametrize("words", [["cloud"], ["cloud.toml"], ["cloud.toml", "--out", "cloud"], ["./cloud"]])
def test_resume(words, here, capsys):
    assert main(["run", *words, "--resume"]) == 0
    assert "continued from cloud/checkpoints/step-000000026.checkpoint, t = 0.039 s" in capsys.readouterr().err
    assert json.loads((here / "cloud" / "summary.json").read_text())["steps"] == 50
    assert main(["run", *words, "--resume"]) == 0
    assert "cloud: the run is done, at t = 0.075 s" in capsys.readouterr().err
    assert sorted(path.name for path in here.iterdir()) == ["cloud", "cloud.toml"]


def test_resume_keeps_the_case_of_the_folder(here):
    """Named as a folder, a run needs none of its --set again."""
    case = case_of("periodic cloud", "contact.friction=0.05")
    run_case(case, new_folder(here / "dkt"), reporter=StopsAt(25))
    assert main(["run", "dkt", "--resume", "--quiet"]) == 0  # ./dkt, not the shipped case of that name


def test_from_makes_a_new_folder(here, capsys):
    words = ["run", "cloud", "--from", "cloud", "--at", "36.3 ms", "--set", "contact.restitution=0.3"]
    assert main([*words, "--set", "time.end=45 ms"]) == 0
    assert "started from cloud/checkpoints/step-000000024.checkpoint, t = 0.036 s" in capsys.readouterr().err
    first = read_table(here / "cloud-2" / "particles.csv")["time_s"][0]
    assert first == pytest.approx(0.036, rel=1e-12)  # a sum of 24 steps


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["cloud", "--from", "cloud", "--resume"], "--from = cloud: must not stand beside --resume"),
        (["cloud", "--from", "cloud", "--at", "3 kg"], "--at = 3 kg: must be a time"),
        (
            ["cloud", "--from", "cloud", "--at", "-1"],
            "--at = -1 s: must be the time of a checkpoint, or at most 0 s after it (there are those at 0.036, ",
        ),
        (["cloud", "--from", "nowhere"], "nowhere: must hold a good checkpoint (there is none)."),
        (["cloud", "--from", "cloud", "--set", "fluid.density=900"], "fluid.density was 960 and is 900"),
        (["cloud", "--resume", "--set", "contact.friction=0"], "contact.friction was 0.3 and is 0"),
        (["cloud.toml", "--out", "other", "--resume"], "other: must be the folder of a run"),
        (["cloud.toml", "--out", "cloud"], "or continue the run in it with --resume."),
    ],
)
def test_refusals(words, said, here, capsys):
    (here / "other").mkdir()
    (here / "other" / "letter.txt").write_text("mine")
    before = {path: path.stat().st_mtime_ns for path in here.rglob("*") if path.is_file()}
    assert main(["run", *words]) == 2
    shown = capsys.readouterr().err
    *notes, last = shown.splitlines()
    assert all(line.startswith("note: cloud is the file cloud.toml here") for line in notes)
    assert said in last
    assert {path: path.stat().st_mtime_ns for path in here.rglob("*") if path.is_file()} == before
    assert sorted(path.name for path in here.iterdir()) == ["cloud", "cloud.toml", "other"]


