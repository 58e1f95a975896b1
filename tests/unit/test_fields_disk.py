"""What the fields of a run take is told before it starts."""

from __future__ import annotations

import json

import pytest

import rdpm
from rdpm.cli.main import main
from rdpm.setup import plan
from rdpm.setup.disk import fields_disk

CHANGES = ["resolution.cells_per_diameter=4", "time.end=0.06", "output.fields_every=0.01", "output.report=false"]
HEADER = 40_000   # of the file and the first chunk of its indices [bytes]


def told(changes):
    made = plan(rdpm.load_case("dkt", changes))
    return fields_disk(made.case, made.cells, made.steps)


def written(tmp_path, changes):
    sets = [word for change in changes for word in ("--set", change)]
    assert main(["run", "dkt", "--out", str(tmp_path / "run"), "--quiet", *sets]) == 0
    return (tmp_path / "run" / "fields.vtkhdf").stat().st_size


def test_unrounded_fields_take_what_was_told(tmp_path):
    changes = [*CHANGES, "output.fields_tolerance=0"]
    disk = told(changes)
    assert disk.count == 7
    assert disk.least == disk.most
    assert written(tmp_path, changes) == pytest.approx(disk.most, rel=0.02)


def test_rounded_fields_keep_within_what_was_told(tmp_path):
    disk = told(CHANGES)
    assert disk.most < 7 * 98415 * 6
    # the spheres have just begun to move: less than the least is possible, more than the most is not
    assert written(tmp_path, CHANGES) < disk.most + HEADER


def test_more_quantities_take_more():
    plain, more = told(CHANGES), told([*CHANGES, "output.vorticity=true", "output.q_criterion=true"])
    assert more.most == pytest.approx(2 * plain.most)


def test_first_run_leaves_less_than_100_mb_of_fields():
    """As measured with the shipped case: 42.7 MB for 41 pictures of 787320 cells, so 1.33 bytes a cell."""
    disk = told([])
    assert disk.least == pytest.approx(42.7e6, rel=0.2)
    assert disk.least < 100e6


def test_check_says_it(capsys):
    assert main(["check", "dkt", "--json"]) == 0
    rows = {row["name"]: row for row in json.loads(capsys.readouterr().out)["sections"]["Disk"]}
    assert (rows["fields.vtkhdf"]["value"], rows["fields.vtkhdf"]["note"]) == ("44.2 MB to 177 MB", "41 pictures")
    assert main(["check", "dkt", "--set", "output.fields_every=0"]) == 0
    assert "pictures" not in capsys.readouterr().out
