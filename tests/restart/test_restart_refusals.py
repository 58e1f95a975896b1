"""Spoiled checkpoints, other cases, other folders: what is passed over, and what is refused."""

import os
import shutil

import numpy as np
import pytest
from restart_cases import StopsAt, assert_equal_runs, case_of, new_folder, newest, run_until, run_whole

from rdpm.errors import CaseError, CheckpointError, OverlapError
from rdpm.io.checkpoint import read_checkpoint, read_facts, write_checkpoint
from rdpm.io.lock import locked
from rdpm.results.run_folder import RunFolder
from rdpm.runs.runner import run_case

EVERY = "output.checkpoint_every=0.009"


@pytest.fixture
def stopped(tmp_path):
    """A run stopped at half time, with two checkpoints."""
    case = case_of("periodic cloud", EVERY)
    run_until(case, tmp_path / "run", 25)
    assert len(list((tmp_path / "run" / "checkpoints").iterdir())) == 2
    return case, tmp_path / "run"


def cut_short(data):
    return data[: len(data) // 2]


def one_bit(data):
    place = 2 * len(data) // 3
    return data[:place] + bytes([data[place] ^ 1]) + data[place + 1 :]


@pytest.mark.parametrize(
    "spoil",
    [
        cut_short,
        one_bit,
        lambda data: b"",
        lambda data: b"rdpm checkpoint 4\n" + data[18:],
        lambda data: data[:90] + b"}" + data[91:],
        lambda data: b"\0" * len(data),
    ],
)
def test_a_spoiled_newest_one_falls_back_to_the_one_before(spoil, stopped, tmp_path):
    case, folder = stopped
    path = newest(folder)
    path.write_bytes(spoil(path.read_bytes()))
    (folder / "checkpoints" / ".step-000000099-abcdefgh.checkpoint").write_bytes(b"broken off")
    reporter = StopsAt()
    run_case(case, folder, resume=True, reporter=reporter)
    assert any(f"{path}: must be a whole checkpoint" in note for note in reporter.notes)
    run_whole(case, tmp_path / "whole")
    assert_equal_runs(tmp_path / "whole", folder)
    assert len(list((folder / "checkpoints").iterdir())) == 2


def test_none_left(stopped):
    case, folder = stopped
    before = {path: path.read_bytes() for path in folder.glob("*.csv")}
    for path in (folder / "checkpoints").iterdir():
        path.write_bytes(one_bit(path.read_bytes()))
    with pytest.raises(CheckpointError, match=r"must hold a good checkpoint \(all 2 are spoiled\). Start the run anew"):
        run_case(case, folder, resume=True)
    shutil.rmtree(folder / "checkpoints")
    with pytest.raises(CheckpointError, match="it holds files, but no checkpoint"):
        run_case(case, folder, resume=True)
    assert {path: path.read_bytes() for path in folder.glob("*.csv")} == before
    assert not (RunFolder(folder).lock).exists()


@pytest.mark.parametrize(
    ("override", "said"),
    [
        ("contact.friction=0.1", "contact.friction was 0.3 and is 0.1"),
        ("bodies[0].density=2600", "bodies[0].density was 2500 and is 2600"),
        ("resolution.cells_per_diameter=5", "resolution.cells_per_diameter was 4 and is 5"),
        ("time.step=0.001", "time.step was 0.0015 and is 0.001"),
        ("domain.gravity=[0,0,-1]", "domain.gravity was [0.0, 0.0, -9.81] and is [0.0, 0.0, -1.0]"),
    ],
)
def test_another_case_is_refused(override, said, stopped):
    _, folder = stopped
    before = (folder / "run.log").read_bytes()
    with pytest.raises(CheckpointError) as refused:
        run_case(case_of("periodic cloud", EVERY, override), folder, resume=True)
    assert said in str(refused.value)
    assert (folder / "run.log").read_bytes() == before


def test_what_may_change_and_what_stays(stopped):
    _, folder = stopped
    reporter = StopsAt()
    case = case_of("periodic cloud", "output.table_every=0.001", "title='other'", "output.checkpoints_kept=3")
    run_case(case, folder, resume=True, reporter=reporter)
    assert "note: output.table_every stays 0.02 s in a run that continues, not 0.001 s" in reporter.notes


def test_a_finished_run_says_so(tmp_path):
    case = case_of("periodic cloud")
    summary = run_whole(case, tmp_path / "run")
    before = {path: path.stat().st_mtime_ns for path in (tmp_path / "run").rglob("*") if path.is_file()}
    reporter = StopsAt()
    assert run_case(case, tmp_path / "run", resume=True, reporter=reporter) == summary
    assert reporter.notes == [f"{tmp_path / 'run'}: the run is done, at t = 0.075 s"]
    assert {path: path.stat().st_mtime_ns for path in (tmp_path / "run").rglob("*") if path.is_file()} == before


def test_a_run_without_a_step_begins_anew(tmp_path):
    """As after a kill before the first checkpoint; and in an empty folder, for one line in a queue's script."""
    case = case_of("periodic cloud")
    run_whole(case, tmp_path / "whole")
    folder = new_folder(tmp_path / "run")
    (folder / "checkpoints").mkdir()
    (folder / ".case-abc.toml").write_text("half")
    (folder / "particles.csv").write_text("time_")
    (RunFolder(folder).lock).write_text("999999999\n")
    assert run_case(case, folder, resume=True).status == "done"
    assert_equal_runs(tmp_path / "whole", folder)


def test_a_broken_field_file_is_set_aside(stopped, tmp_path):
    case, folder = stopped
    path = folder / "bodies.vtkhdf"
    path.write_bytes(path.read_bytes()[:500])
    reporter = StopsAt()
    run_case(case, folder, resume=True, reporter=reporter)
    assert any("was broken off while it was written" in note for note in reporter.notes)
    assert (folder / "bodies.broken").stat().st_size == 500
    run_whole(case, tmp_path / "whole")
    assert (tmp_path / "whole" / "particles.csv").read_bytes() == (folder / "particles.csv").read_bytes()


def test_one_run_at_a_time(stopped):
    case, folder = stopped
    with (
        locked(RunFolder(folder).lock),
        pytest.raises(CaseError, match=f"must be the folder of one run at a time \\(process {os.getpid()} runs in it"),
    ):
        run_case(case, folder, resume=True)
    assert not (RunFolder(folder).lock).exists()


def test_branch_with_a_changed_contact(stopped, tmp_path):
    _, folder = stopped
    times = sorted(read_facts(path)["time_s"] for path in (folder / "checkpoints").iterdir())
    case = case_of("periodic cloud", "contact.restitution=0.3", "time.step=0.001", "time.end=0.05")
    branch = new_folder(tmp_path / "branch")
    reporter = StopsAt()
    summary = run_case(case, branch, start=(folder, times[1] - 1e-4), within=0.01, reporter=reporter)
    assert summary.status == "done"
    assert summary.steps == np.ceil((0.05 - times[0]) / 0.001 - 1e-6)  # its own, from the older of the two
    assert any(note.startswith("started from") and f"t = {times[0]:.6g} s" in note for note in reporter.notes)
    first = np.loadtxt((branch / "particles.csv"), delimiter=",", skiprows=1)[0]
    assert first[0] == times[0]
    arrays, _ = read_checkpoint(min((folder / "checkpoints").iterdir()))
    np.testing.assert_array_equal(first[2:5], arrays["bodies/position"][0])


def test_branch_to_the_other_way_of_diffusion(tmp_path):
    run_until(case_of("stabilised diffusion"), tmp_path / "run", 12)
    case = case_of("stabilised diffusion", "time={end=0.06, step=0.0005, diffusion='explicit'}")
    summary = run_case(case, new_folder(tmp_path / "branch"), start=(tmp_path / "run", None))
    assert (summary.status, summary.diffusion) == ("done", "explicit")
    case = case_of("stabilised diffusion", "time={end=0.06, step=0.001, diffusion='stabilised'}")
    other = run_case(case, new_folder(tmp_path / "other"), start=(tmp_path / "run", None))
    # The two ways and steps agree as first-order starts of a step do: 1 % of the speed.
    one, two = (s.bodies[0].final_velocity_m_s[2] for s in (summary, other))
    assert one == pytest.approx(two, rel=0.01)


@pytest.mark.parametrize(
    ("overrides", "at", "error", "said"),
    [
        (["bodies[0].diameter=0.011"], None, CheckpointError, "bodies[0].diameter was 0.01 and is 0.011"),
        (["resolution.cells_per_diameter=6"], None, CheckpointError, "resolution.cells_per_diameter was 4 and is 6"),
        ([], 1e-3, CheckpointError, "or at most 1e-05 s after it (there are those at 0.0"),
        (["time.end=0.02", "time.step=0.001"], None, CaseError, "time.end = 0.02 s: must be later than the checkpoint"),
    ],
)
def test_a_branch_that_does_not_fit(overrides, at, error, said, stopped, tmp_path):
    _, folder = stopped
    branch = new_folder(tmp_path / "branch")
    with pytest.raises(error) as refused:
        run_case(case_of("periodic cloud", *overrides), branch, start=(folder, at))
    assert said in str(refused.value)
    assert not any(branch.iterdir())


def test_a_guard_leaves_the_last_good_checkpoint(tmp_path):
    """The pair is pressed beyond the limit; the checkpoint before leads to the same stop, or on with another limit."""
    case = case_of("wet contact", "output.checkpoint_every=0.001", "contact.overlap_limit=0.02")
    folder, reporter = new_folder(tmp_path / "run"), StopsAt()
    with pytest.raises(OverlapError) as first:
        run_case(case, folder, reporter=reporter)
    last = newest(folder)
    before = last.read_bytes()
    _, facts = read_checkpoint(last)
    assert any(f"the last good checkpoint is at t = {facts['time_s']:.6g} s" in note for note in reporter.notes)
    assert '"status": "overlap"' in (folder / "summary.json").read_text()
    assert str(first.value) in (folder / "run.log").read_text()
    with pytest.raises(OverlapError) as second:
        run_case(case, folder, resume=True)
    assert str(second.value) == str(first.value)
    assert last.read_bytes() == before
    case = case_of("wet contact", "contact.overlap_limit=0.5")
    assert run_case(case, new_folder(tmp_path / "branch"), start=(folder, None)).status == "done"


def test_two_are_kept_or_as_many_as_asked(tmp_path):
    run_whole(case_of("periodic cloud", EVERY, "output.checkpoints_kept=5"), tmp_path / "five")
    assert len(list((tmp_path / "five" / "checkpoints").iterdir())) == 5


def test_any_array_survives_the_file(tmp_path):
    arrays = {
        "none": np.zeros((0, 3)),
        "scalar": np.array(0.1),
        "truth": np.array(True),
        "strided": np.arange(24.0).reshape(4, 6)[:, ::2],
        "whole": np.array([-(2**62)]),
    }
    path = tmp_path / "a.checkpoint"
    write_checkpoint(path, arrays, {"third": 1 / 3, "far": float("inf"), "word": "Grad °"})
    read, facts = read_checkpoint(path)
    assert facts == read_facts(path) == {"third": 1 / 3, "far": float("inf"), "word": "Grad °"}
    for name, values in arrays.items():
        np.testing.assert_array_equal(read[name], values)
        assert (read[name].dtype, read[name].shape) == (values.dtype, values.shape)


def test_a_time_without_a_checkpoint_near_it_is_refused_with_the_times_there_are(stopped, tmp_path):
    _, folder = stopped
    times = sorted(read_facts(path)["time_s"] for path in (folder / "checkpoints").iterdir())
    case, branch = case_of("periodic cloud", "time.end=0.05"), new_folder(tmp_path / "branch")
    with pytest.raises(CheckpointError) as refused:
        run_case(case, branch, start=(folder, 1.2 * times[1]))
    listed = ", ".join(f"{time:.6g}" for time in times)
    assert f"(there are those at {listed} s). Ask for one of these times, allow more" in str(refused.value)
    assert not any(branch.iterdir())
    # Within 1 % it is taken as meant.
    run_case(case, branch, start=(folder, 1.005 * times[1]))
    assert np.loadtxt(branch / "particles.csv", delimiter=",", skiprows=1)[0, 0] == times[1]
