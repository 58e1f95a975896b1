"""A study killed at any moment, its main process or a worker, ends with the same table when it is started again."""

import os
import random
import signal
import subprocess
import time

import pandas
import pytest

from rdpm.studies import load
from rdpm.studies.folder import StudyFolder
from rdpm.studies.study import run_study
from rdpm.studies.study_file import load_study
from rdpm.studies.write import study_to_toml
from studies import MEETING, command, run_bytes, without_time

pytestmark = pytest.mark.slow

LONG = {
    "name": "long",
    "base": {"case": MEETING, "set": {"time.end": 0.15, "output.checkpoint_every": 0.01}},
    "start": {"at": 0.0015},
    "vary": {"contact.contact_steps": [12, 16, 20]},
    "measure": ["contacts", "end"],
}


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The study unbroken."""
    folder = tmp_path_factory.mktemp("whole") / "long"
    run_study(load_study(LONG), folder, workers=1)
    return folder


def same(folder, whole):
    pandas.testing.assert_frame_equal(without_time(load(folder)), without_time(load(whole)), check_exact=True)
    assert run_bytes(folder) == run_bytes(whole)


def processes_of(folder):
    """Processes that work on a job of the folder, by their command lines."""
    found = []
    listed = subprocess.run(["ps", "-eww", "-o", "pid=,args="], capture_output=True, text=True, check=True).stdout
    for line in listed.splitlines():
        pid, _, words = line.strip().partition(" ")
        if "rdpm.studies.one_job" in words and str(folder) in words:
            found.append(int(pid))
    return found


def wait_until(true, seconds=60.0):
    end = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < end
        time.sleep(0.02)


def is_under_way(folder):
    return lambda: any((folder / "runs").glob("*/checkpoints/step-*")) and bool(processes_of(folder))


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT, signal.SIGTERM])
def test_the_main_process_is_ended(number, whole, tmp_path):
    (tmp_path / "long.toml").write_text(study_to_toml(LONG))
    folder = tmp_path / "long"
    with command("long.toml", "--workers", "2", "--out", folder, cwd=tmp_path) as process:
        wait_until(is_under_way(folder))
        time.sleep(random.uniform(0.0, 0.5))
        process.send_signal(number)
        _, said = process.communicate(timeout=90)
    assert process.returncode == (-signal.SIGKILL if number == signal.SIGKILL else 130)
    if number != signal.SIGKILL:
        assert "To continue: rdpm study long.toml --out" in said
    wait_until(lambda: not processes_of(folder))   # none works on alone
    with command("long.toml", "--out", folder, cwd=tmp_path) as process:
        _, said = process.communicate()
    assert process.returncode == 0, said
    same(folder, whole)


def test_a_worker_is_killed(whole, tmp_path):
    (tmp_path / "long.toml").write_text(study_to_toml(LONG))
    folder = tmp_path / "long"
    with command("long.toml", "--workers", "1", "--out", folder, cwd=tmp_path) as process:
        wait_until(is_under_way(folder))
        os.kill(processes_of(folder)[0], signal.SIGKILL)
        out, said = process.communicate()
    assert process.returncode == 3
    assert "2 of 3 runs are done" in out
    assert said.count("its process was killed by signal 9") == 2   # as it happened, and at the end
    table = load(folder)
    assert sorted(table["status"]) == ["done", "done", "failed"]
    run_study(load_study(LONG), folder, workers=2)
    same(folder, whole)


def test_spoiled_checkpoints_begin_the_run_anew(whole, tmp_path):
    folder = tmp_path / "long"
    (tmp_path / "long.toml").write_text(study_to_toml(LONG))
    with command("long.toml", "--workers", "1", "--out", folder, cwd=tmp_path) as process:
        wait_until(is_under_way(folder))
        process.kill()
        process.communicate()
    wait_until(lambda: not processes_of(folder))
    for job in StudyFolder(folder).jobs():
        if not job.is_start:
            for path in StudyFolder(folder).work(job).checkpoint_files():
                path.write_bytes(b"spoiled")
    run_study(load_study(LONG), folder, workers=2)
    same(folder, whole)
