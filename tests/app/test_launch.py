"""Runs as processes: queued, paused, resumed, stopped, and found again by their files."""

import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest

from rdpm.app.launch import Launcher
from rdpm.app.status import QUEUED, status_of
from rdpm.app.workspace import Workspace
from rdpm.config.load import load_case
from rdpm.errors import CaseError
from rdpm.io.lock import holder, locked
from rdpm.results.run_folder import RunFolder

#: A bead that would bounce for hours, in small steps.
LONG = {
    "domain": {"size": [0.1, 0.1, 0.1]},
    "bodies": [{"diameter": 0.01, "density": 2500, "centers": [[0.05, 0.05, 0.05]]}],
    "time": {"end": 1000.0, "step": 1e-4},
    "output": {"report": False, "table_every": 0.05},
}
WAIT = 60.0  # s, for a process to be where it should, on a busy machine


@pytest.fixture
def work(tmp_path):
    root = tmp_path.resolve() / "work"
    root.mkdir()
    return Workspace(root)


def state(work, name):
    return status_of(name, RunFolder(work.root / name)).state


def until(launcher, test):
    end = time.monotonic() + WAIT
    while time.monotonic() < end:
        launcher.dispatch()
        if test():
            return
        time.sleep(0.05)
    pytest.fail("it did not come to that in time")


@pytest.fixture
def launcher(work):
    made = Launcher(work, at_once=1, threads=1)
    yield made
    for process in processes_of(work.root):  # those too that another launcher began a moment ago
        os.kill(process, signal.SIGKILL)


def processes_of(root):
    for words in Path("/proc").glob("[0-9]*/cmdline"):
        with suppress(OSError):
            if os.fsencode(root) in words.read_bytes():
                yield int(words.parent.name)


def test_runs_take_turns_pause_go_on_and_stop(work, launcher):
    case = load_case(LONG)
    assert launcher.add(case, "first") == "first"
    launcher.add(case, "second")
    with pytest.raises(CaseError, match="must be new"):
        launcher.add(case, "first")
    until(launcher, lambda: (status_of("first", RunFolder(work.root / "first")).time or 0.0) > 0.1)
    assert (state(work, "first"), state(work, "second")) == ("running", "queued")
    with pytest.raises(CaseError, match="must not be running"):
        launcher.resume("first")

    later = Launcher(work, at_once=1, threads=1)  # the page was closed and opened anew: all is in the files
    later.pause("first")
    until(launcher, lambda: state(work, "first") == "paused")
    reached = status_of("first", RunFolder(work.root / "first")).time
    assert RunFolder(work.root / "first").checkpoint_files()
    until(later, lambda: state(work, "second") == "running" and not (work.root / "second" / QUEUED).exists())

    later.resume("first")
    later.dispatch()
    assert state(work, "first") == "queued"
    later.stop("second")
    until(later, lambda: state(work, "second") == "stopped")
    until(later, lambda: (status_of("first", RunFolder(work.root / "first")).time or 0.0) > reached)
    assert state(work, "first") == "running"
    later.stop("first")
    until(later, lambda: later.process("first") is None)


def test_a_run_of_the_command_line_is_seen_and_counts(work, launcher):
    path = work.root / "own.toml"
    launcher.add(load_case(LONG), "waits")
    (work.root / "waits" / "case.toml").rename(path)
    (work.root / "waits" / QUEUED).unlink()
    (work.root / "waits").rmdir()
    command = [
        sys.executable,
        "-m",
        "rdpm.cli.main",
        "run",
        str(path),
        "--out",
        str(work.root / "typed"),
        "--threads",
        "1",
        "--quiet",
    ]
    process = subprocess.Popen(command, start_new_session=True)
    try:
        until(launcher, lambda: work.runs() == ["typed"] and status_of("typed", RunFolder(work.root / "typed")).time)
        assert holder(work.root / "typed" / "run.lock") == process.pid
        launcher.add(load_case(LONG), "waits")
        launcher.dispatch()
        assert (state(work, "typed"), state(work, "waits")) == ("running", "queued")
        assert launcher.withdraw("waits")
        assert not (work.root / "waits").exists()
        launcher.pause("typed")
        assert process.wait(WAIT) == 130
        assert state(work, "typed") == "paused"
    finally:
        process.kill()


def test_a_case_that_cannot_run_says_why(work, launcher):
    launcher.add(load_case(LONG), "broken")
    (work.root / "broken" / "case.toml").write_text("[domain]\nsize = 1\n")
    until(launcher, lambda: state(work, "broken") == "failed")
    assert "must be a list" in status_of("broken", RunFolder(work.root / "broken")).message


def test_two_pages_on_one_folder_start_a_run_once(work, launcher):
    launcher.add(load_case(LONG), "one")
    other = Launcher(work, at_once=1, threads=1)
    with locked(work.root / ".rdpm-app.lock"):
        assert launcher.dispatch() == []  # the other one is at it
    assert launcher.dispatch() == ["one"]
    assert other.dispatch() == []  # it is started, though it has not locked its folder yet
    until(other, lambda: holder(work.root / "one" / "run.lock") is not None)
    assert other.dispatch() == []
    launcher.stop("one")
    until(launcher, lambda: launcher.process("one") is None)


def test_only_a_run_that_goes_on_here_is_told_to_end(work, launcher):
    launcher.add(load_case(LONG), "idle")
    for act in (launcher.pause, launcher.stop):
        with pytest.raises(CaseError, match="must be running"):
            act("idle")
    with locked(work.root / "idle" / "run.lock"):
        assert holder(work.root / "idle" / "run.lock") == os.getpid()
    (work.root / "idle" / "run.lock").write_text("1\n")  # left by one that was killed; the number is another's now
    assert holder(work.root / "idle" / "run.lock") is None
    with pytest.raises(CaseError, match="must be running"):
        launcher.stop("idle")


def test_a_start_that_came_to_nothing_does_not_wait_for_ever(work, launcher):
    launcher.add(load_case(LONG), "one")
    mark = work.root / "one" / QUEUED
    mark.write_text('{"asked_ns": 1, "process": 999999999}')  # it ended before it began, and so did its page
    assert state(work, "one") == "stopped"
    assert launcher.dispatch() == []
    assert not mark.exists()
