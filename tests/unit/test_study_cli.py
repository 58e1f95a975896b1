"""``rdpm study``: the list, a copy, what a study costs."""

import sys
from types import SimpleNamespace

import pytest

from rdpm.cases import shipped_studies
from rdpm.cli.main import main
from rdpm.studies.display import Display
from rdpm.studies.folder import Job


def test_the_list_has_a_line_for_each(capsys):
    assert main(["study"]) == 0
    out = capsys.readouterr().out
    assert [line.split()[0] for line in out.splitlines()[: len(shipped_studies())]] == shipped_studies()


@pytest.mark.parametrize("folder", [(), ("mine",)])
def test_a_copy_can_be_checked_and_is_not_replaced(folder, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["study", "dkt-damping", "--copy", *folder]) == 0
    path = "/".join((*folder, "dkt-damping.toml"))
    assert f"rdpm study {path}" in capsys.readouterr().out
    assert main(["study", "check", path]) == 0
    assert main(["study", "dkt-damping", "--copy", *folder]) == 2
    assert "must not be there yet" in capsys.readouterr().err


def test_check_says_runs_cells_steps_time_memory_disk(capsys):
    assert main(["study", "check", "dkt-damping", "--workers", "2"]) == 0
    out = capsys.readouterr().out
    assert [line.split()[:4] for line in out.splitlines() if line.startswith("damping-50")] == [
        ["damping-50dyns_cm", "start-1", "787320", "2100"]
    ]
    assert "7 rows of the table" in out  # three, and four that repeat one of them
    assert "2 at once: about " in out
    assert "MB of memory, at most" in out
    assert "contact.contact_steps gives way to damping, stiffness" in out


def test_lines_without_a_terminal_tell_ends_and_reasons(capsys):
    jobs = [Job("a", "1", steps=100, cells=10), Job("b", "2", steps=100, cells=10)]
    with Display() as display:
        display.begin(jobs, 2)
        display.update(jobs[0], {"phase": "stepping", "step": 50, "time": 0.5, "end": 1.0})
        display.update(jobs[0], {"phase": "done", "reason": ""})
        display.update(jobs[1], {"phase": "failed", "reason": "no room"})
    said = capsys.readouterr().err.splitlines()
    assert said[0] == "2 runs, 2 at once"
    assert said[1].startswith("a: done (1 of 2 runs ended")
    assert said[2].startswith("b: failed: no room (2 of 2 runs ended")


def test_a_notebook_shows_one_output_that_is_renewed(monkeypatch):
    shown = []
    handle = SimpleNamespace(update=shown.append)
    screen = SimpleNamespace(HTML=str, display=lambda text, display_id: shown.append(text) or handle)
    shell = SimpleNamespace(kernel=object())
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell, display=screen))
    monkeypatch.setitem(sys.modules, "IPython.display", screen)
    jobs = [Job("first", "1", steps=100, cells=10), Job("second", "2", steps=100, cells=10)]
    with Display() as display:
        display.begin(jobs, 1)
        display.note("one & all")
        display.update(jobs[0], {"phase": "stepping", "step": 50, "time": 0.5, "end": 1.0})
        bar = display._bar.html()
        display.update(jobs[0], {"phase": "done", "reason": ""})
        display.update(jobs[1], {"phase": "failed", "reason": "no room"})
    assert "first" in bar
    assert "25 %" in bar   # half of one of two
    assert shown[0].count("<progress") == 1
    assert "one &amp; all" in shown[-1]
    assert "second: failed: no room" in shown[-1]
    assert "2 of 2 runs ended" in shown[-1]
    assert "first" not in shown[-1]


def test_a_terminal_shows_each_run_at_work(monkeypatch, capsys):
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    monkeypatch.setenv("TERM", "xterm")
    jobs = [Job("first", "1", steps=100, cells=10), Job("second", "2", steps=100, cells=10)]
    with Display() as display:
        display.begin(jobs, 1)
        display.update(jobs[0], {"phase": "stepping", "step": 50, "time": 0.5, "end": 1.0})
        shown = [task.description for task in display._bar.tasks]
        said = display._bar.tasks[1].fields["said"]
        display.update(jobs[0], {"phase": "done"})
        left = [task.description for task in display._bar.tasks]
    assert (shown, said, left) == (["study", "first"], "t = 0.5 of 1 s", ["study"])
