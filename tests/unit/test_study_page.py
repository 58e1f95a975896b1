"""A miniature of a shipped study from its runs to table, verdicts, figures and page."""

from __future__ import annotations

import json
import re

import pytest

from rdpm.cases import shipped_studies
from rdpm.studies import names
from rdpm.studies.claims import CLAIMS, DESIGN_CLAIMS
from rdpm.studies.page import Block, write_markdown
from rdpm.studies.results import read_results
from rdpm.studies.study import run_study
from rdpm.studies.study_file import load_study


@pytest.fixture(scope="module")
def quick(tmp_path_factory):
    told = []
    path = tmp_path_factory.mktemp("study") / "s"
    run_study(load_study("dkt-window"), path, quick=True, tell=told.append, command="rdpm study dkt-window --quick")
    return read_results(path), told


def test_every_figure_is_drawn_and_every_claim_judged(quick):
    results, told = quick
    assert told == []
    drawn = {path.name for path in (results.folder.figures / "dkt-window").iterdir()}
    assert {"settling_velocity.png", "trajectory.png", "relative_position.png", "gap.png", "kisses.png",
            "contacts.png"} <= drawn  # fmt: skip
    (claim,) = json.loads((results.folder.path / "claims.json").read_text())["claims"]
    assert claim["claim"] == "insensitive-in-window"
    assert claim["verdict"] == "not judged"   # the miniature has no repeated runs
    assert "spread" in claim["sentence"]


def test_the_page_is_whole_and_refers_to_nothing_elsewhere(quick):
    results, _ = quick
    page = (results.folder.path / "page.html").read_text()
    assert page.count("data:image/png;base64,") == len(list(results.folder.figures.rglob("*.png")))
    assert "rdpm study dkt-window --quick" in page
    assert results.question in page
    assert not re.search(r'(src|href)="(?!data:|videos/)', page)
    for row in results.table.itertuples():
        assert f"<th>{row.run}</th>" in page
    assert len(page) < 1_000_000


def test_markdown_has_the_pictures_beside_it(tmp_path):
    picture = tmp_path / "in" / "gap.png"
    picture.parent.mkdir()
    picture.write_bytes(b"png")
    blocks = [Block("title", "T"), Block("picture", "A gap.", picture), Block("table", heads=("a",), rows=(("1|2",),))]
    text = write_markdown(blocks, tmp_path / "t.md", tmp_path / "images", "seed").read_text()
    assert (tmp_path / "images/seed_in_gap.png").read_bytes() == b"png"
    assert "![A gap.](images/seed_in_gap.png)" in text
    assert "| 1\\|2 |" in text


def test_all_claims_are_named_by_a_shipped_study():
    named = {name for study in shipped_studies() for name in load_study(study).file.claims}
    assert named == set(CLAIMS)
    assert set(load_study("seed").file.claims) == {claim.id for claim in DESIGN_CLAIMS}


def test_sentences_have_words_and_units():
    said = names.in_words("max_overlap_fraction is 0.02, 1e-3 at contact.stiffness = 1, 50; the spread is 0.1")
    assert said == "largest overlap: 0.02, 1e-3 at k_n = 1, 50 N/m; the spread is 0.1"
