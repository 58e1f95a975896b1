"""Files whole or absent, refusals in one message, JSON any program reads."""

from __future__ import annotations

import errno
import json
import os

import numpy as np
import pytest

from rdpm.errors import CaseError, OutputError
from rdpm.io.files import replacing, reporting
from rdpm.io.provenance import environment, peak_memory_bytes, read_json, write_json


def test_replacing_leaves_only_the_file(tmp_path):
    with replacing(tmp_path / "a.txt") as temporary:
        temporary.write_text("new")
        assert temporary.parent == tmp_path
        assert temporary.suffix == ".txt"
    assert [p.name for p in tmp_path.iterdir()] == ["a.txt"]
    assert (tmp_path / "a.txt").read_text() == "new"


def test_replacing_keeps_the_older_file_when_the_block_raises(tmp_path):
    (tmp_path / "a.txt").write_text("old")
    with pytest.raises(KeyError), replacing(tmp_path / "a.txt") as temporary:
        raise KeyError(temporary.write_text("half"))
    assert [p.name for p in tmp_path.iterdir()] == ["a.txt"]
    assert (tmp_path / "a.txt").read_text() == "old"


def test_replacing_gives_ordinary_permissions(tmp_path):
    (tmp_path / "plain").touch()
    with replacing(tmp_path / "a.txt") as temporary:
        temporary.write_text("x")
    assert (tmp_path / "a.txt").stat().st_mode == (tmp_path / "plain").stat().st_mode


def test_missing_folder_is_one_message(tmp_path):
    refused = pytest.raises(OutputError, match=r"gone/a\.txt: cannot be written \(No such file")
    with refused, replacing(tmp_path / "gone" / "a.txt"):
        pass


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EACCES, errno.EROFS, errno.EIO])
def test_every_refusal_names_place_reason_and_cure(number):
    with pytest.raises(OutputError) as caught, reporting("out/particles.csv"):
        raise OSError(number, os.strerror(number))
    message = str(caught.value)
    assert message.startswith("out/particles.csv: cannot be written (")
    assert os.strerror(number) in message
    assert "--out" in message
    assert caught.value.exit_code == 3


def test_refusals_of_hdf5_are_recognised_by_their_text():
    with pytest.raises(OutputError, match="Free some space"), reporting("fields.vtkhdf"):
        raise OSError("Can't write (errno = 28, error message = 'No space left on device')")


def test_json_has_no_nan_and_takes_numpy(tmp_path):
    content = {"n": np.int64(3), "x": np.float32(0.5), "v": np.array([1.0, np.inf]), "t": (1, None)}
    content["ok"] = np.True_
    write_json(tmp_path / "summary.json", content)
    assert json.loads((tmp_path / "summary.json").read_text()) == {
        "n": 3, "x": 0.5, "v": [1.0, None], "t": [1, None], "ok": True,
    }


@pytest.mark.parametrize("text", ["", "{", "[1]", "\xff"])
def test_broken_json_is_refused(tmp_path, text):
    (tmp_path / "summary.json").write_bytes(text.encode("latin-1"))
    with pytest.raises(CaseError, match=r"summary\.json"):
        read_json(tmp_path / "summary.json")


def test_environment_and_memory():
    here = environment()
    assert here["date_utc"].endswith("+00:00")
    assert peak_memory_bytes() > 10_000_000   # the interpreter with NumPy alone holds more
