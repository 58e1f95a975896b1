"""Tables: bit for bit there and back, and continued from a noted position."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from rdpm.errors import CaseError, OutputError
from rdpm.io.tables import CONTACT_COLUMNS, PARTICLE_COLUMNS, TableWriter, read_table


def test_numbers_read_back_bit_for_bit(tmp_path):
    rng = np.random.default_rng(3)
    rows = rng.standard_normal((50, len(PARTICLE_COLUMNS))) * 10.0 ** rng.integers(-300, 300, (50, 1))
    rows[:, 1], rows[:, PARTICLE_COLUMNS.index("neighbour")] = np.arange(50), -7
    with TableWriter(tmp_path / "particles.csv", PARTICLE_COLUMNS) as table:
        table.write(rows)
    back = read_table(tmp_path / "particles.csv")
    assert tuple(back) == PARTICLE_COLUMNS
    for n, name in enumerate(PARTICLE_COLUMNS):
        assert np.array_equal(back[name], rows[:, n])
    assert back["id"].dtype == back["neighbour"].dtype == np.int64


def test_words_and_missing_numbers(tmp_path):
    row = (0, -1, "sphere-wall", 0.1, 0.02, 8.5, 0.004, 0.1, np.nan, np.nan, np.float64(2.0), -1e-9, "no")
    with TableWriter(tmp_path / "contacts.csv", CONTACT_COLUMNS) as table:
        table.write([row])
    text = (tmp_path / "contacts.csv").read_text().splitlines()
    assert text[1] == "0,-1,sphere-wall,0.1,0.02,8.5,0.004,0.1,nan,nan,2.0,-1e-09,no"
    back = read_table(tmp_path / "contacts.csv")
    assert back["kind"][0] == "sphere-wall"
    assert np.isnan(back["restitution"][0])


def test_header_alone_is_an_empty_table(tmp_path):
    TableWriter(tmp_path / "contacts.csv", CONTACT_COLUMNS).close()
    assert all(len(column) == 0 for column in read_table(tmp_path / "contacts.csv").values())


def test_continued_table_equals_the_unbroken_one(tmp_path):
    columns = ("time_s", "id", "x_m")
    rows = [(0.1 * n, n, n / 7) for n in range(9)]
    with TableWriter(tmp_path / "whole.csv", columns) as table:
        table.write(rows)
    with TableWriter(tmp_path / "broken.csv", columns) as table:
        table.write(rows[:4])
        position = table.tell()
        table.write([(9.0, 9, 9.0)])   # written after the checkpoint, lost with the process
    with TableWriter(tmp_path / "broken.csv", columns, append_at=position) as table:
        table.write(rows[4:])
    assert (tmp_path / "broken.csv").read_bytes() == (tmp_path / "whole.csv").read_bytes()


def test_another_table_is_not_continued(tmp_path):
    TableWriter(tmp_path / "a.csv", ("time_s", "x_m")).close()
    for columns, position in ((("time_s", "y_m"), 11), (("time_s", "x_m"), 99), (("time_s", "x_m"), 2)):
        with pytest.raises(OutputError, match="cannot be continued"):
            TableWriter(tmp_path / "a.csv", columns, append_at=position)


def test_wrong_rows_are_refused(tmp_path):
    with TableWriter(tmp_path / "a.csv", ("time_s", "id")) as table:
        with pytest.raises(ValueError, match="shorter"):
            table.write([(0.1,)])
        with pytest.raises(ValueError, match="whole number"):
            table.write([(0.1, 0.5)])


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs the device that is always full")
def test_full_disk_is_one_message():
    with pytest.raises(OutputError, match="Free some space"), TableWriter("/dev/full", ("time_s",)) as table:
        table.write([(0.5,)])


def test_last_line_without_its_end_is_left_out(tmp_path):
    (tmp_path / "a.csv").write_text("time_s,id\n0.5,1\n0.75,2")
    assert read_table(tmp_path / "a.csv")["time_s"].tolist() == [0.5]


@pytest.mark.parametrize("text", [b"", b"time_s,id\n0.5\n", b"time_s,id\n0.5,x\n", b"\xff\xfe\n"])
def test_broken_tables_are_refused(tmp_path, text):
    (tmp_path / "a.csv").write_bytes(text)
    with pytest.raises(CaseError, match=r"a\.csv"):
        read_table(tmp_path / "a.csv")


def test_tables_are_light_to_import():
    heavy = "{'h5py', 'matplotlib', 'scipy', 'pyvista'}"
    code = "import sys, rdpm.io.tables, rdpm.io.vtkhdf, rdpm.io.provenance;"
    code += f"sys.exit(bool({heavy} & set(sys.modules)))"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
