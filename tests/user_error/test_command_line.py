"""What is easily mistyped on the command line: threads, names of cases, times of checkpoints."""

from pathlib import Path

import pytest

from rdpm.cases import shipped_text
from rdpm.cli.main import main
from rdpm.cli.source import case_source
from rdpm.errors import CaseError
from rdpm.parallel.threads import MOST_THREADS, available_threads, processors


def test_absurd_threads_are_refused_with_the_processors(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    assert main(["run", "dkt", "--threads", "100000"]) == 2
    said = capsys.readouterr().err
    assert f"--threads = 100000: must lie between 1 and {MOST_THREADS * processors()} " in said
    assert f"this process may use {processors()} processors" in said
    assert not any(tmp_path.iterdir())


@pytest.mark.parametrize("given", ["abc", "0", "-2", "2.5", "²", "100000"])
def test_threads_of_the_environment_are_judged_alike(given, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("OMP_NUM_THREADS", given)
    with pytest.raises(CaseError, match=f"OMP_NUM_THREADS = {given}: must"):
        available_threads()
    assert main(["run", "dkt"]) == 2
    assert f"OMP_NUM_THREADS = {given}: must" in capsys.readouterr().err
    assert not any(tmp_path.iterdir())


def test_threads_of_nested_regions_are_passed_over(monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "1,2")
    assert available_threads() == 1
    monkeypatch.setenv("OMP_NUM_THREADS", " ")
    assert available_threads() == processors()


def edited(folder: Path) -> Path:
    path = folder / "dkt.toml"
    path.write_text(shipped_text("dkt").replace('end = "4 s"', 'end = "3 s"'), encoding="utf-8")
    return path


def test_an_edited_copy_goes_before_the_shipped_case_and_says_so(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["check", "dkt", "--json"]) == 0
    shipped = capsys.readouterr()
    assert shipped.err == ""
    edited(tmp_path)
    assert main(["check", "dkt", "--json"]) == 0
    local = capsys.readouterr()
    assert local.err == "note: dkt is the file dkt.toml here, not the shipped case of that name\n"
    steps = [int(out.split('"steps": ')[1].split(",")[0]) for out in (shipped.out, local.out)]
    assert steps[1] == pytest.approx(0.75 * steps[0], abs=1)


def test_a_folder_of_the_name_is_meant_by_a_path_alone(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "dkt").mkdir()
    edited(tmp_path).rename(tmp_path / "dkt" / "case.toml")
    assert case_source("dkt") == ("dkt", None, "")
    assert case_source("dkt", prefers_folder=True) == ("dkt/case.toml", Path("dkt"), "")
    assert case_source("./dkt") == ("dkt/case.toml", Path("dkt"), "")
    assert main(["check", "./dkt"]) == 0
    assert "steps" in capsys.readouterr().out


def test_a_tolerance_needs_a_time(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["run", "dkt", "--from", "old", "--within", "1 s"]) == 2
    assert "--within = 1 s: needs --at" in capsys.readouterr().err
    assert main(["run", "dkt", "--from", "old", "--at", "1 s", "--within", "1 kg"]) == 2
    assert "--within = 1 kg: must" in capsys.readouterr().err
