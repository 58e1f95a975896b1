"""Killed, asked to stop, without a terminal, without a disk: nothing is lost."""

import errno
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time

import pytest
from restart_cases import TABLES, StopsAt, assert_equal_runs, case_of, new_folder, newest, run_whole

from rdpm.config.write import case_to_toml
from rdpm.errors import OutputError
from rdpm.io import checkpoint, files
from rdpm.io.checkpoint import read_checkpoint
from rdpm.io.tables import read_table
from rdpm.io.vtkhdf import field_times
from rdpm.runs.runner import run_case

LONG = ("time.end=0.6", "output.checkpoint_every=0.02", "output.fields_every=0.2")


def hear_hangups():
    """Whoever started the tests may ignore them (nohup), which a child inherits and a run respects."""
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


def command(folder, *words, **options):
    arguments = [sys.executable, "-m", "rdpm.cli.main", "run", *words]
    return subprocess.Popen(
        arguments,
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=hear_hangups,
        **options,
    )


def wait_for_step(folder, step, running):
    """Until a checkpoint of that step or a later one is there."""
    end = time.monotonic() + 60.0
    while not any(int(path.stem[5:]) >= step for path in folder.glob("checkpoints/step-*")):
        assert time.monotonic() < end
        assert running.poll() is None, running.communicate()
        time.sleep(0.01)


@pytest.fixture
def long_case(tmp_path):
    (tmp_path / "cloud.toml").write_text(case_to_toml(case_of("periodic cloud", *LONG)))
    return tmp_path


def kill_and_resume(folder, kills, seed):
    """Run a case by the command line, killed again and again, and the same one unbroken."""
    print(f"seed {seed}")
    chance = random.Random(seed)
    whole = timed(folder, "cloud.toml", "--out", "whole", "--threads", "1")
    start = timed(folder, "whole", "--resume")  # it is done: the time of loading
    share = 2.0 * (whole - start) / kills  # so that the kills are spread over the run
    killed = 0
    for n in range(kills):
        threads = str(1 + n % 2)
        with command(folder, "cloud.toml", "--out", "run", "--resume", "--quiet", "--threads", threads) as running:
            time.sleep(chance.uniform(0.5 * start, start + share))
            running.kill()
            running.communicate()
            assert running.returncode in (-signal.SIGKILL, 0)
            killed += running.returncode != 0
    timed(folder, "cloud.toml", "--out", "run", "--resume")
    print(f"{killed} of {kills} met the run")
    for name in TABLES:
        assert (folder / "whole" / name).read_bytes() == (folder / "run" / name).read_bytes(), name
    assert not list((folder / "run" / "checkpoints").glob(".*"))
    if not list((folder / "run").glob("*.broken")):  # HDF5 can be killed in the middle of its index
        assert_equal_runs(folder / "whole", folder / "run")


def timed(folder, *words):
    begin = time.monotonic()
    with command(folder, *words, "--quiet") as running:
        _, said = running.communicate()
    assert running.returncode == 0, said
    return time.monotonic() - begin


def test_killed_at_random_moments(long_case):
    kill_and_resume(long_case, 3, seed=random.randrange(10**6))


@pytest.mark.full
def test_killed_at_many_random_moments(long_case):
    kill_and_resume(long_case, 30, seed=random.randrange(10**6))


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_leaves_a_checkpoint_and_130(number, long_case):
    endless = "time.end=60"   # no machine is done before the signal comes
    with command(long_case, "cloud.toml", "--out", "run", "--set", endless) as running:
        wait_for_step(long_case / "run", 20, running)
        running.send_signal(number)
        _, said = running.communicate(timeout=60)
    assert running.returncode == 130
    _, facts = read_checkpoint(newest(long_case / "run"))
    last = said.splitlines()[-1]
    assert last == f"rdpm: interrupted at t = {facts['time_s']:.6g} s. To continue: rdpm run run --resume"
    assert read_table(long_case / "run" / "history.csv")["step"][-1] == facts["steps"]  # a row of the end
    assert '"status": "interrupted"' in (long_case / "run" / "summary.json").read_text()
    with command(long_case, "run", "--resume", "--set", f"time.end={facts['time_s'] + 0.003!r}", "--quiet") as running:
        assert running.wait() == 0, running.stderr.read()
    assert '"status": "done"' in (long_case / "run" / "summary.json").read_text()


def test_a_second_signal_stops_at_once(tmp_path):
    class Twice(StopsAt):
        def update(self, step, time, end, message=""):
            super().update(step, time, end)
            super().update(step, time, end)

    case = case_of("periodic cloud", "output.checkpoint_every=0.009")
    folder = new_folder(tmp_path / "run")
    with pytest.raises(KeyboardInterrupt):
        run_case(case, folder, reporter=Twice(20))
    run_case(case, folder, resume=True)
    run_whole(case, tmp_path / "whole")
    assert_equal_runs(tmp_path / "whole", folder)


def test_handlers_are_as_before(tmp_path):
    before = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)]
    run_whole(case_of("released body"), tmp_path / "run")
    assert [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)] == before


@pytest.mark.parametrize("closed", [(2,), (0, 1, 2)])
def test_streams_closed_from_the_start(closed, long_case):
    redirect = " ".join(f"{number}>&-" for number in closed)
    words = f"{sys.executable} -m rdpm.cli.main run cloud.toml --out run --set time.end=0.03 {redirect}"
    done = subprocess.run(["sh", "-c", words], cwd=long_case, check=False, timeout=60)
    assert done.returncode == 0
    assert len(read_table(long_case / "run" / "history.csv")["step"]) == 3


def test_nobody_listens(long_case):
    """The reader of the error stream leaves, as a terminal that is closed."""
    with command(long_case, "cloud.toml", "--out", "run") as running:
        running.stderr.close()
        assert running.wait() == 0
    assert '"status": "done"' in (long_case / "run" / "summary.json").read_text()


def full(*_):
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def check_stopped_by_the_disk(case, folder, place, tmp_path):
    """One message, whole rows, no half file; and the run goes on once there is room."""
    before = {path: path.read_bytes() for path in folder.glob("checkpoints/*")}
    with pytest.raises(OutputError) as refused:
        run_case(case, folder, reporter=None, resume=True)
    assert re.fullmatch(
        rf"{re.escape(str(folder))}/{place}: cannot be written \(No space left on device\). Free some space, .*",
        str(refused.value),
    )
    assert refused.value.exit_code == 3
    assert {path: path.read_bytes() for path in folder.glob("checkpoints/*")} == before
    assert not [path for path in folder.rglob(".*")]
    for name in TABLES:
        assert (folder / name).read_bytes().endswith(b"\n")
    return before


@pytest.mark.parametrize("write", [1, 2, 3, 4, 5, 9])
def test_disk_full_while_a_checkpoint_is_written(write, tmp_path, monkeypatch):
    case = case_of("periodic cloud")
    folder = new_folder(tmp_path / "run")
    run_case(case, folder, reporter=StopsAt(25))
    count = 0
    plain = checkpoint._write

    def write_until_full(file, content):
        nonlocal count
        count += 1
        if count == write:
            file.write(memoryview(content)[: len(content) // 2])
            full()
        plain(file, content)

    with monkeypatch.context() as disk:
        disk.setattr(checkpoint, "_write", write_until_full)
        check_stopped_by_the_disk(case, folder, r"checkpoints/step-\d+\.checkpoint", tmp_path)
    run_case(case, folder, resume=True)
    run_whole(case, tmp_path / "whole")
    assert_equal_runs(tmp_path / "whole", folder)


def test_disk_full_before_the_first_step(tmp_path, monkeypatch):
    case = case_of("periodic cloud")
    folder = new_folder(tmp_path / "run")
    with monkeypatch.context() as disk:
        disk.setattr(files, "_sync", full)
        with pytest.raises(OutputError, match=r"case\.toml: cannot be written"):
            run_case(case, folder)
    assert run_case(case, folder, resume=True).status == "done"


class FullDisk:
    """A file on a disk with room for so many more bytes."""

    def __init__(self, file, room):
        self._file, self._room = file, room

    def write(self, rows):
        written = self._file.write(rows[: self._room])
        self._room -= written
        return written or full()

    def __getattr__(self, name):
        return getattr(self._file, name)


@pytest.mark.parametrize("name", ["particles", "history", "timing"])
@pytest.mark.parametrize("room", [0, 50])
def test_disk_full_while_a_table_is_written(name, room, tmp_path):
    class Fills(StopsAt):
        def update(self, step, time, end, message=""):
            if step == 30:
                writers[name]._file = FullDisk(writers[name]._file, room)

    writers = {}
    case = case_of("periodic cloud", "output.checkpoint_every=0.009")
    folder = new_folder(tmp_path / "run")
    from rdpm.runs import recorder

    class Spied(recorder.TableWriter):
        def __init__(self, path, *arguments):
            super().__init__(path, *arguments)
            writers[path.stem] = self

    with pytest.MonkeyPatch.context() as spy:
        spy.setattr(recorder, "TableWriter", Spied)
        with pytest.raises(OutputError, match=rf"{name}.csv: cannot be written \(No space left on device\)"):
            run_case(case, folder, reporter=Fills())
    for path in folder.glob("*.csv"):
        assert path.read_bytes().endswith(b"\n")
    run_case(case, folder, resume=True)
    run_whole(case, tmp_path / "whole")
    assert_equal_runs(tmp_path / "whole", folder)


@pytest.mark.skipif(not hasattr(os, "posix_fallocate"), reason="no room can be reserved here")
@pytest.mark.parametrize("write", [3, 5, 6])
def test_disk_full_while_fields_are_written(write, tmp_path, monkeypatch):
    """Room is reserved for two new files, then for their first and second steps."""
    case = case_of("periodic cloud", "output.checkpoint_every=0.009")
    folder = new_folder(tmp_path / "run")
    count = 0

    def reserve_until_full(handle, end, size):
        nonlocal count
        count += 1
        if count >= write:
            os.ftruncate(handle, end + size // 2)
            full()

    with monkeypatch.context() as disk:
        disk.setattr(os, "posix_fallocate", reserve_until_full)
        with pytest.raises(OutputError, match=r"(fields|bodies).vtkhdf: cannot be written \(No space left on device\)"):
            run_case(case, folder)
    times = field_times(folder / "fields.vtkhdf")
    assert len(times) == (write - 1) // 2 - 1 + (write % 2 == 0)
    run_case(case, folder, resume=True)
    run_whole(case, tmp_path / "whole")
    assert_equal_runs(tmp_path / "whole", folder)


def test_the_folder_is_removed(tmp_path):
    class Removes(StopsAt):
        def update(self, step, time, end, message=""):
            if step == self.step:
                shutil.rmtree(tmp_path / "run")

    with pytest.raises(OutputError) as refused:
        run_case(case_of("periodic cloud"), new_folder(tmp_path / "run"), reporter=Removes(10))
    assert "The folder was removed or never made" in str(refused.value)
    assert not (tmp_path / "run").exists()


@pytest.mark.skipif(os.geteuid() == 0, reason="permissions do not bind the superuser")
def test_a_folder_that_cannot_be_written_to(tmp_path, capsys):
    from rdpm.cli.main import main

    folder = new_folder(tmp_path / "run")
    run_case(case_of("released body"), folder, reporter=StopsAt(20))
    folder.chmod(0o500)
    try:
        assert main(["run", str(folder), "--resume"]) == 2
        assert "must be a place to write to" in capsys.readouterr().err
    finally:
        folder.chmod(0o700)


