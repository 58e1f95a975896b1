"""What is read from a run's folder: typed summary, tracks, and files of other versions or spoiled ones."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from builders import D, cloud_motion, made_up_run, pair_motion
from rdpm.errors import CaseError
from rdpm.io.provenance import write_json
from rdpm.io.tables import read_table
from rdpm.results.dkt import DktPhases
from rdpm.results.run import load_run
from rdpm.results.run_folder import TABLES, RunFolder
from rdpm.results.summary import (
    BodySummary,
    ContactDesign,
    ContactTotals,
    PairDesign,
    Summary,
    read_summary,
    write_summary,
)
from rdpm.results.tracks import tracks_from_table

PHASES = DktPhases(1.5, 0.25, 2, None, 12.0, 0.5)
FULL = Summary(
    title="A pair",
    status="done",
    cells=(4, 5, 6),
    spacing_m=(0.1, 0.2, 0.3),
    steps=7,
    dt_s=1 / 3,
    parts_s={"momentum": 0.1},
    bodies=(BodySummary(0, 0.015, 1120.0, 0.1, (0.0, 0.1, 0.2), (0.0, 0.0, -1e-3)),),
    contact=ContactDesign("soft-sphere", "zero-force", 0.016, 8.0, 0.9, 0.0, True, (PairDesign("sphere-wall", 1e-3),)),
    contacts=ContactTotals(1, 0.004, 0.02),
    dkt=PHASES,
    warnings=("overlap",),
)


def test_a_summary_survives_its_file(tmp_path):
    write_summary(tmp_path / "summary.json", FULL)
    assert read_summary(tmp_path / "summary.json") == FULL
    assert json.loads((tmp_path / "summary.json").read_text())["dkt"]["kiss_time_s"] == 1.5


def test_only_a_pair_has_phases_in_the_file():
    assert "dkt" not in Summary(status="done").to_dict()


def test_keys_of_other_versions():
    """Later ones are passed over, also in tables; what an earlier one did not write is not known."""
    newer = FULL.to_dict() | {"gpu": "none"}
    newer["contact"] = newer["contact"] | {"adhesion": 1.0, "pairs": [{"kind": "sphere-wall", "cohesion": 2}]}
    read = Summary.from_dict(newer)
    assert (read.contact.model, read.contact.pairs) == ("soft-sphere", (PairDesign("sphere-wall"),))
    older = FULL.to_dict()
    for key in ("contacts", "parts_s", "ranks", "warnings"):
        del older[key]
    del older["dkt"]["drafting_time_s"]
    read = Summary.from_dict(older)
    assert (read.contacts, read.parts_s, read.ranks, read.warnings) == (ContactTotals(), {}, None, ())
    assert read.dkt == DktPhases(1.5, 0.25, 2, None, 12.0)


def test_what_was_not_finite_is_not_known(tmp_path):
    """As a run leaves it that the nan guard stopped."""
    body = BodySummary(0, 0.015, 1120.0, float("nan"), (0.1, 0.1, float("nan")), (0.0, 0.0, 0.0))
    phases = DktPhases(None, None, 0, None, float("nan"))
    write_summary(tmp_path / "summary.json", Summary(status="nan", bodies=(body,), dkt=phases))
    read = read_summary(tmp_path / "summary.json")
    assert (read.bodies[0].max_speed_m_s, read.bodies[0].final_position_m) == (None, (0.1, 0.1, None))
    assert read.dkt.final_angle_deg is None


def test_a_summary_of_another_kind_is_refused(tmp_path):
    write_json(tmp_path / "summary.json", {"contact": {"pairs": [{"kind": "sphere-wall", "stiffness_N_m": "soft"}]}})
    with pytest.raises(CaseError, match=r"summary\.json: contact\.pairs\.0\.stiffness_N_m = 'soft': must be that of"):
        read_summary(tmp_path / "summary.json")


def test_a_folder_is_read_whole(tmp_path):
    run = load_run(made_up_run(tmp_path / "pair", pair_motion, 2))
    assert (run.title, run.summary.contact.restitution, run.diameter.tolist()) == (
        "Two spheres: drafting & kissing", 0.5, [D, D],
    )
    assert run.fields == run.folder.fields
    assert run.phases.kisses == 1
    assert (len(run.contacts["i"]), len(run.history["step"])) == (2, 61)


def test_box_and_diameters_without_the_usual_keys(tmp_path):
    """The box follows from the grid, diameters from the groups of the case."""
    folder = made_up_run(tmp_path / "pair", pair_motion, 2)
    files = RunFolder(folder)
    content = json.loads(files.summary.read_text())
    write_json(files.summary, content | {"bodies": []})
    files.case.write_text(files.case.read_text().replace("size = [0.06, 0.05, 0.24]\n", ""))
    run = load_run(folder)
    np.testing.assert_allclose(run.box, (0.06, 0.05, 0.24))
    assert run.diameter.tolist() == [D, D]


def test_names_are_those_of_the_reference():
    """A renamed file would be lost to every script that reads it."""
    files = RunFolder(Path("dkt"))
    assert sorted(TABLES) == ["contacts", "history", "particles", "timing"]
    names = [files.case, files.summary, *files.tables, files.fields, files.bodies, files.video, files.report, files.log]
    assert [path.name for path in names] == [
        "case.toml", "summary.json", "particles.csv", "contacts.csv", "history.csv", "timing.csv", "fields.vtkhdf",
        "bodies.vtkhdf", "video.mp4", "report.html", "run.log",
    ]


def test_tracks_continue_through_periodic_boundaries(tmp_path):
    cloud = made_up_run(tmp_path / "cloud", cloud_motion, 27, fluid=False, boundary="periodic")
    run = load_run(cloud)
    moved = cloud_motion(run.tracks.times) - cloud_motion(np.zeros(1))
    assert np.allclose(run.tracks.position - run.tracks.position[0], moved)
    table = read_table(run.folder.table("particles"))
    cut = tracks_from_table({name: column[:-1] for name, column in table.items()})
    assert len(cut.times) == len(run.tracks.times) - 1
