"""Names inside the folder, and none outside."""

import pytest

from rdpm.app.workspace import Workspace
from rdpm.errors import CaseError


@pytest.fixture
def work(tmp_path):
    root = tmp_path.resolve() / "work"
    root.mkdir()
    return Workspace(root)


@pytest.mark.parametrize(
    "name", ["..", "../x", "a/../../x", "/etc/passwd", "~", ".hidden", "a/.git/config", "a\0b", "a\\b", "x" * 2000]
)
def test_a_name_that_leads_out_is_refused(work, name):
    with pytest.raises(CaseError, match="must be a place inside the folder"):
        work.inside(name)


def test_a_link_that_leads_out_is_refused(work):
    (work.root / "out").symlink_to(work.root.parent)
    with pytest.raises(CaseError, match="must be a place inside"):
        work.inside("out/x.csv")
    (work.root / "in").mkdir()
    (work.root / "alias").symlink_to(work.root / "in")
    assert work.inside("alias") == work.root / "in"


@pytest.mark.parametrize("name", ["", " ", "a/b", "..", ".x", "-", "a" * 200, "a\n", 'a"b', "a;b"])
def test_a_name_that_is_none_is_refused(work, name):
    with pytest.raises(CaseError):
        work.new(name)


def test_runs_studies_and_cases_are_told_apart(work):
    for place in ("one", "study/runs/soft", "deep/er/two", "one/checkpoints/x", ".hidden/three"):
        (work.root / place).mkdir(parents=True)
        (work.root / place / "case.toml").touch()
    (work.root / "study" / "study.json").touch()
    (work.root / "study" / "study.toml").touch()
    (work.root / "own.toml").touch()
    (work.root / "deep" / "other.toml").touch()
    assert work.runs() == ["deep/er/two", "one", "study/runs/soft"]
    assert work.studies() == ["study"]
    assert work.cases() == ["deep/other.toml", "own.toml"]


def test_a_free_name_is_free_and_plain(work):
    assert work.free_name("dkt") == "dkt"
    (work.root / "dkt").mkdir()
    assert work.free_name("dkt") == "dkt-2"
    assert work.free_name("../a b") == "a-b"
    assert work.new(work.free_name("..")).parent == work.root
