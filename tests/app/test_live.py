"""Tables that are read while they are written."""

import subprocess
import sys

import numpy as np
import pytest

from builders import made_up_run, pair_motion
from rdpm.app.live import Follower, LiveRun, numbers
from rdpm.io.vtkhdf import FieldWriter, _reading, field_times
from rdpm.results.run import load_run
from rdpm.results.run_folder import RunFolder


def test_only_whole_new_lines_are_given(tmp_path):
    path = tmp_path / "t.csv"
    new = Follower(path)
    assert new.lines() == b""
    path.write_bytes(b"a,b\n1,2\n3")
    assert new.lines() == b"1,2\n"
    assert new.lines() == b""
    with path.open("ab") as file:
        file.write(b",4\n5,6\n")
    assert new.lines() == b"3,4\n5,6\n"
    path.write_bytes(b"a,b\n7,8\n")  # set back, as by a run that goes on from a checkpoint
    assert new.lines() == b"7,8\n"


def test_lines_that_do_not_fit_are_left_out():
    assert numbers(b"1,2\n3,nan\n", 2).tolist()[0] == [1.0, 2.0]
    assert len(numbers(b"1,2\n3\n4,5\n", 2)) == 2
    assert np.isnan(numbers(b"1,x\n3,4,5\n", 2)).all()
    assert numbers(b"", 3).shape == (0, 3)


@pytest.mark.parametrize("pieces", [1, 7, 50])
def test_a_table_read_in_pieces_is_that_read_at_once(tmp_path, pieces):
    whole = load_run(made_up_run(tmp_path / "run", pair_motion, 2))
    files = RunFolder(tmp_path / "live")
    files.path.mkdir()
    files.case.write_bytes(whole.folder.case.read_bytes())
    data = whole.folder.table("particles").read_bytes()
    live = LiveRun(files)
    for n in range(pieces):
        files.table("particles").write_bytes(data[: len(data) * (n + 1) // pieces])
        live.read()
    assert live.count == 2
    assert len(live.times) == len(whole.tracks.times)
    along = whole.gravity / np.linalg.norm(whole.gravity)
    at = {round(t, 9): n for n, t in enumerate(whole.tracks.times)}
    expected = [(whole.tracks.velocity[at[round(t, 9)]] @ along).tolist() for t in live.times]
    np.testing.assert_allclose(live.settling, expected)
    np.testing.assert_allclose(live.frame.position, whole.tracks.position[-1])
    # Turned by 6 and -6 rad/s about y: 3 s of it, in the rows that were seen.
    angle = 2.0 * np.arctan2(live.frame.rotation[:, 1], live.frame.rotation[:, 3])
    np.testing.assert_allclose(np.cos(angle), np.cos([18.0, -18.0]), atol=1e-6)


def test_a_picture_of_the_flow_is_given_once(tmp_path):
    live = LiveRun(RunFolder(made_up_run(tmp_path / "run", pair_motion, 2)))
    live.read()
    found = live.new_slice()
    assert found.time == pytest.approx(3.0)
    assert found.normal == 1
    assert live.new_slice() is None
    live.look_again()
    assert live.new_slice() is not None


WRITE = """
import sys, numpy as np
from rdpm.io.vtkhdf import FieldWriter
fields = FieldWriter(sys.argv[1], (4, 4, 4), (0.1, 0.1, 0.1), keep_until=9.0)
fields.write(0.5, np.ones((4, 4, 4, 3)), np.zeros((4, 4, 4)))
"""


def test_a_reader_does_not_stop_the_writer_of_fields(tmp_path):
    path = tmp_path / "fields.vtkhdf"
    FieldWriter(path, (4, 4, 4), (0.1, 0.1, 0.1))
    with _reading(path):  # held open, as by a page that reads a slice
        subprocess.run([sys.executable, "-c", WRITE, str(path)], check=True)
    assert field_times(path).tolist() == [0.5]
