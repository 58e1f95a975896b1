"""Warnings of a run are one list: terminal, log, summary and report say the same, each once."""

import json
import re
from pathlib import Path

import pytest

import rdpm
from rdpm.cases import shipped_text
from rdpm.cli import main as cli
from rdpm.cli.source import case_source
from rdpm.errors import CaseError
from rdpm.parallel.threads import available_threads, checked_threads, processors
from rdpm.results.contacts import is_pressed
from rdpm.results.summary import ContactTotals, read_summary
from rdpm.results.warnings import RunWarning
from rdpm.runs.runner import run_case
from rdpm.runs.warnings import happened
from rdpm.setup import plan

SOFT = {
    "domain": {"size": [0.05, 0.05, 0.05]},
    "bodies": [{"diameter": 0.01, "density": 2500.0, "centers": [[0.025, 0.025, 0.0055]], "velocity": [0, 0, -0.3]}],
    "contact": {"stiffness": 50.0, "restitution": 0.9},
    "time": {"end": 0.05},
}


class Teller:
    """Remembers what a terminal would show."""

    def __init__(self):
        self.notes = []

    def start(self, plan):
        pass

    def update(self, *_):
        pass

    def note(self, text):
        self.notes.append(text)

    def finish(self, summary):
        pass


def test_one_list_everywhere(tmp_path):
    terminal = Teller()
    case = rdpm.load_case(SOFT)
    (tmp_path / "run").mkdir()
    summary = run_case(case, tmp_path / "run", reporter=terminal, threads=1)
    told = [note.removeprefix("warning: ") for note in terminal.notes if note.startswith("warning: ")]
    log = (tmp_path / "run" / "run.log").read_text()
    logged = [line.removeprefix("warning: ") for line in log.splitlines() if line.startswith("warning: ")]
    stored = json.loads((tmp_path / "run" / "summary.json").read_text())["warnings"]
    page = (tmp_path / "run" / "report.html").read_text()
    shown = re.findall("<li>(.*?)</li>", page.split('class="warnings"')[1].split("</ul>")[0])
    assert told == logged == stored == list(summary.warnings) == [
        text.replace("&gt;", ">").replace("&lt;", "<").replace("&#x27;", "'") for text in shown
    ]
    assert len(set(told)) == len(told) >= 2
    # Before it started, and at its end.
    assert any(re.match(r"overlap \S+ % d > 0.5 % \(at 30 cm/s\): raise contact.stiffness", text) for text in told)
    deepest = r"largest overlap \S+ % d > 0.5 % \(of the run\): raise contact.stiffness"
    assert any(re.match(deepest, text) for text in told)
    details = read_summary(tmp_path / "run" / "summary.json").warning_details
    assert [str(detail) for detail in details] == told
    first = next(detail for detail in details if detail.quantity == "overlap")
    assert (first.sign, first.limit, first.condition) == (">", "0.5 %", "at 30 cm/s")
    assert first.value.endswith("% d")
    assert first.cure == "raise contact.stiffness"


def test_overlaps_beyond_the_design_are_named():
    made = plan(rdpm.load_case("settling"))
    assert happened(ContactTotals(1, 0.004, 0.1), made) == ()
    found = happened(ContactTotals(1, 0.03, 0.1), made)
    assert [(w.value, w.sign, w.limit[:5]) for w in found] == [("3 % d", ">", "2.5 %"), ("3 % d", ">", "2.5 %")]


def test_shipped_cases_are_planned_without_a_warning():
    for name in ("dkt", "dkt-small", "settling", "cloud", "rebound"):
        assert plan(rdpm.load_case(name)).warnings == []


@pytest.mark.parametrize(
    "text", ["contact resolved by 3 steps < 4", "overlap 1.31 % d > 0.5 % (at 4.1 cm/s)", "no numbers here"]
)
def test_a_verdict_taken_apart_reads_as_before(text):
    assert str(RunWarning.from_verdict(text)) == text


def test_a_verdict_has_its_parts():
    assert RunWarning.from_verdict("contact time 1.2 ms < 3 ms (Hertz, at 1 m/s)") == RunWarning(
        "contact time", "1.2 ms", "<", "3 ms", "Hertz, at 1 m/s"
    )


def test_pressed_contacts_are_no_impacts():
    nan = float("nan")
    kinds = ["sphere-sphere", "sphere-wall", "sphere-wall", "sphere-wall"]
    found = is_pressed(kinds, [0.013, nan, nan, 50.0], [0.01, 0.031, 0.029, 9.0], {"sphere-wall": 0.01})
    assert found.tolist() == [True, True, False, True]
    assert is_pressed(["sphere-wall"], [5.0], [9.0], {}).tolist() == [False]


def test_more_threads_than_processors_are_warned_of(tmp_path):
    (tmp_path / "run").mkdir()
    case = rdpm.load_case({
        "domain": {"size": [1, 1, 1], "gravity": [0, 0, 0]}, "fluid": {"density": 1.0, "viscosity": 1.0},
        "resolution": {"cells": [8, 8, 8]}, "time": {"end": 0.01, "step": 0.001},
    })  # fmt: skip
    summary = run_case(case, tmp_path / "run", threads=processors() + 1)
    said = f"threads {processors() + 1} > {processors()} processors here (they slow each other): leave --threads out"
    assert said in summary.warnings


def test_a_run_without_bodies_writes_its_last_row_once(tmp_path):
    (tmp_path / "run").mkdir()
    case = rdpm.load_case({
        "domain": {"size": [1, 1, 1], "gravity": [0, 0, 0]}, "fluid": {"density": 1.0, "viscosity": 1.0},
        "resolution": {"cells": [8, 8, 8]}, "time": {"end": 0.01, "step": 0.001},
        "output": {"table_every": 0.005, "report": False},
    })  # fmt: skip
    run_case(case, tmp_path / "run")
    rows = (tmp_path / "run" / "history.csv").read_text().splitlines()
    assert [row.split(",")[0] for row in rows] == ["step", "0", "5", "10"]


def test_absurd_numbers_of_threads_are_refused(monkeypatch):
    for given in ("abc", "0", "-2", "1000", "²"):
        monkeypatch.setenv("OMP_NUM_THREADS", given)
        with pytest.raises(CaseError, match="OMP_NUM_THREADS = "):
            available_threads()
    monkeypatch.setenv("OMP_NUM_THREADS", "2,1")
    assert available_threads() == 2
    with pytest.raises(CaseError, match=f"--threads = 1000: must lie between 1 and {4 * processors()} "):
        checked_threads(1000, "--threads")


def test_a_local_file_goes_before_the_shipped_case(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert case_source("dkt") == ("dkt", None, "")
    (tmp_path / "dkt.toml").write_text(shipped_text("dkt").replace("cells_per_diameter = 8", "cells_per_diameter = 9"))
    source, folder, note = case_source("dkt")
    assert (source, folder) == ("dkt.toml", None)
    assert note == "note: dkt is the file dkt.toml here, not the shipped case of that name"
    assert cli.main(["check", "dkt", "--json"]) == 0
    shown = capsys.readouterr()
    assert shown.err.strip() == note
    assert json.loads(shown.out)["cells"] == list(plan(rdpm.load_case("dkt.toml")).cells)
    (tmp_path / "settling").mkdir()
    assert cli.main(["check", "./settling"]) == 2
    assert "must be a file (it is a folder)" in capsys.readouterr().err
    (tmp_path / "settling" / "case.toml").write_text(shipped_text("settling"))
    assert case_source("./settling") == ("settling/case.toml", Path("settling"), "")


def test_a_warning_of_a_plan_names_what_it_is_about_once():
    changes = ["contact={stiffness=1, damping=0.1, overlap_warning=0.001}", "resolution.cells_per_diameter=4"]
    found = plan(rdpm.load_case("dkt", changes)).warnings
    assert "cells a diameter = 4.05: below 8 the drag is several per cent off" in found
    assert any(text.startswith("damping ratio 1.59 > 1 (overdamped") for text in found)
    assert not any(text.startswith(("max_overlap", "static_overlap", "regime")) for text in found)
