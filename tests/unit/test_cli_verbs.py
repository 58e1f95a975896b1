"""The verbs of the command line, with a stand-in for the solver."""

import errno
import json
import os
import re
import signal
import subprocess
import sys
import time
import types
from dataclasses import dataclass
from pathlib import Path

import pytest

from rdpm.cases import shipped_names, shipped_text
from rdpm.cli import main as cli
from rdpm.errors import CaseError, OverlapError
from rdpm.results.summary import Summary

SUMMARY = Summary.from_dict({
    "steps": 40,
    "wall_s": 1.25,
    "ns_per_cell_step": 31.4159,
    "status": "done",
    "bodies": [{"id": 0, "max_speed_m_s": 0.0871}, {"id": 1, "max_speed_m_s": None}],
    "contact": {"pairs": [{"kind": "body-body", "stiffness_N_m": 160.2, "damping_N_s_m": 0.1}]},
    "contacts": {"count": 3, "max_overlap_fraction": 0.0042},
    "dkt": {"kiss_time_s": 1.6, "kiss_duration_s": 0.7, "kisses": 2, "tumble_time_s": None,
            "final_angle_deg": 12.0},
})


@dataclass
class Row:
    name: str
    value: str
    verdict: str = ""
    note: str = ""
    severity: str = ""


@dataclass
class Plan:
    sections: list

    def to_dict(self):
        return {title: {row.name: row.value for row in rows} for title, rows in self.sections}


class Solver(types.ModuleType):
    """Stands where the solver will."""

    def __init__(self):
        super().__init__("rdpm.setup")
        self.ran = []
        self.fails = None

    def plan(self, case):
        return Plan(
            [
                (
                    "Grid",
                    [
                        Row("cells", "53 x 53 x 265", "ok", "[bold] of what was asked"),
                        Row("step", "1 ms", "warning", "viscous"),
                    ],
                )
            ]
        )

    def run_case(self, case, folder, *, threads, reporter, **_):
        self.ran.append((case, folder, threads))
        if self.fails is not None:
            raise self.fails
        (folder / "case.toml").write_text("")
        (folder / "report.html").write_text("")
        reporter.start(self.plan(case))
        for step in range(1, 41):
            reporter.update(step, step * case.time.end / 40, case.time.end, "kissing")
        reporter.note("overlap [above] 0.5 %")
        reporter.finish(SUMMARY)
        return SUMMARY


@pytest.fixture
def solver(monkeypatch, tmp_path):
    stand_in = Solver()
    pictures = types.ModuleType("rdpm.figures.report")
    pictures.make_report = lambda folder, *, video, figure_format, progress: [folder / "report.html"]
    runner = types.ModuleType("rdpm.runs.runner")
    runner.run_case = stand_in.run_case
    monkeypatch.setitem(sys.modules, "rdpm.setup", stand_in)
    monkeypatch.setitem(sys.modules, "rdpm.runs.runner", runner)
    monkeypatch.setitem(sys.modules, "rdpm.figures", types.ModuleType("rdpm.figures"))
    monkeypatch.setitem(sys.modules, "rdpm.figures.report", pictures)
    for name in list(os.environ):
        if name.startswith(("OMPI_", "PMI", "SLURM_", "MV2_", "MPI_")):
            monkeypatch.delenv(name)
    monkeypatch.setattr("signal.signal", lambda *_: None)
    monkeypatch.chdir(tmp_path)
    return stand_in


def test_run_writes_to_the_next_free_folder(solver, capsys):
    assert cli.main(["run", "dkt"]) == 0
    assert (
        cli.main(["run", "dkt", "--set", "time.end=1", "--set", "contact.friction=0.2", "--threads", "1"])
        == 0
    )
    assert [folder.name for _, folder, _ in solver.ran] == ["dkt", "dkt-2"]
    assert solver.ran[1][0].time.end == 1.0
    assert solver.ran[1][0].contact.friction == 0.2
    assert solver.ran[1][2] == 1
    shown = capsys.readouterr()
    for said in (
        "greatest speed 0.0871 m/s",
        "at 1.6 s, 2 in all, together 0.7 s",
        "none",
        "greatest overlap 0.42 % d",
        "k_n 160.2 N/m, eta_n 0.1 N s/m",
        "31.4 ns a cell and step",
        "Results are in dkt-2",
        "open dkt-2/report.html in a browser",
    ):
        assert said in shown.out
    assert "t = 0.1 of 4 s, step 1" in shown.err  # the first line at once
    assert "t = 4 of 4 s, step 40" in shown.err  # and the last
    assert shown.err.count("of 4 s") == 2
    assert "[bold] of what was asked" in shown.err
    assert "overlap [above] 0.5 %" in shown.err
    assert "40 steps in 1.2 s" in shown.err


def test_quiet_run_says_nothing(solver, capsys):
    assert cli.main(["run", "dkt", "--quiet", "--out", "here"]) == 0
    shown = capsys.readouterr()
    assert shown.out == shown.err == ""
    assert solver.ran[0][1] == Path("here")


def test_check(solver, capsys):
    assert cli.main(["check", "dkt"]) == 0
    assert re.search(r"step +1 ms +warning +viscous", capsys.readouterr().out)
    assert cli.main(["check", "dkt", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["Grid"]["step"] == "1 ms"
    assert not solver.ran


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["run", "dktt"], "dktt: there is no such file. Did you mean"),
        (["run", "dkt", "--set", "fluid.density=0"], "--set fluid.density = 0: must be positive."),
        (["run", "dkt", "--set", "fluid.density"], "--set fluid.density: must be key=value."),
        (["run", "dkt", "--threads", "0"], "--threads = 0: must lie between 1 and "),
        (["run", "dkt", "--threads", "two"], "two"),
        (["run", "dkt", "--out", "full"], "--out full: must be new or empty"),
        (["run", "dkt", "--out", "file"], "--out file: must be a folder"),
        (["run", "dkt", "--out", "no/where"], "--out no/where: must lie in a folder that is there"),
        (["run", "dkt", "--out", "/proc/rdpm"], "--out /proc/rdpm: must be a place to write to"),
        (["run", "dkt", "--at", "1"], "--at = 1: needs --from"),
        (["run"], "CASE"),
        (["rnu"], "rnu"),
        (["check", "full"], "full: must be a file (it is a folder)."),
        (["report", "nowhere"], "nowhere: there is no such folder."),
        (["report", "full"], "full: must hold a run's results"),
        (["new", "dktt"], 'NAME = "dktt": must be a shipped case. Did you mean "dkt"?'),
        (["new", "dkt", "no/where"], "no/where/dkt.toml: must be a place to write to"),
    ],
)
def test_bad_input_ends_with_2_and_writes_nothing(solver, capsys, words, said):
    Path("full").mkdir()
    Path("full/notes").write_text("mine")
    Path("file").write_text("mine")
    assert cli.main(words) == 2
    shown = capsys.readouterr()
    assert said in shown.err
    assert shown.err.count("\n") == 1
    assert "Traceback" not in shown.err
    assert shown.out == ""
    assert sorted(os.listdir()) == ["file", "full"]
    assert os.listdir("full") == ["notes"]
    assert not solver.ran


@pytest.mark.parametrize(
    ("failure", "code", "said"),
    [
        (OverlapError("step 12", 0.3, "must stay below 0.2"), 3, "rdpm: step 12 = 0.3: must stay below 0.2."),
        (KeyboardInterrupt(), 130, "rdpm: interrupted"),
        (
            OSError(errno.ENOSPC, "No space left on device", "dkt/particles.csv"),
            3,
            "the disk is full (dkt/particles",
        ),
        (
            ZeroDivisionError("division by zero"),
            1,
            "internal error, ZeroDivisionError: division by zero. Please report it with dkt/run.log",
        ),
    ],
)
def test_how_a_run_ends(solver, capsys, failure, code, said):
    solver.fails = failure
    assert cli.main(["run", "dkt"]) == code
    shown = capsys.readouterr()
    assert said in shown.err
    assert "Traceback" not in shown.err
    if code == 1:
        assert "ZeroDivisionError" in Path("dkt/run.log").read_text()


def test_a_case_refused_late_leaves_no_empty_folder(solver, capsys):
    solver.fails = CaseError("time.step", 1, "must be smaller")
    assert cli.main(["run", "dkt"]) == 2
    assert not Path("dkt").exists()


def test_internal_error_without_a_run_logs_aside(solver, capsys, monkeypatch, tmp_path):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setattr(solver, "plan", lambda case: 1 / 0)
    assert cli.main(["check", "dkt"]) == 1
    log = capsys.readouterr().err.split()[-1]
    assert "ZeroDivisionError" in Path(log).read_text()


def test_report(solver, capsys):
    assert cli.main(["run", "dkt", "--quiet"]) == 0
    assert cli.main(["report", "dkt", "--no-video"]) == 0
    assert capsys.readouterr().out.strip() == "dkt/report.html"


def test_new(solver, capsys):
    assert cli.main(["new"]) == 0
    listed = capsys.readouterr().out
    for name in shipped_names():
        assert f"{name} " in listed
    assert "drafting, kissing, tumbling" in listed
    assert cli.main(["new", "dkt", "mine"]) == 0
    assert Path("mine/dkt.toml").read_text() == shipped_text("dkt")
    assert os.listdir("mine") == ["dkt.toml"]
    Path("mine/dkt.toml").write_text("changed")
    assert cli.main(["new", "dkt", "mine"]) == 2
    assert "must not be there yet" in capsys.readouterr().err
    assert Path("mine/dkt.toml").read_text() == "changed"


def test_help_lists_only_what_is_there(solver, capsys):
    assert cli.main(["--help"]) == 0
    shown = capsys.readouterr().out
    assert all(f" {verb} " in shown for verb in cli.VERBS)
    assert cli.main(["run", "--help"]) == 0
    shown = capsys.readouterr().out
    assert "--set" in shown
    assert "--workers" not in shown
    assert "Raises" not in shown


def process(*words, **options):
    environment = {name: value for name, value in os.environ.items() if name != "OMP_WAIT_POLICY"}
    return subprocess.run(
        [sys.executable, "-m", "rdpm.cli.main", *words],
        capture_output=True,
        text=True,
        env=environment,
        timeout=60,
        check=False,
        **options,
    )


def test_as_a_process(tmp_path):
    shown = process("info", cwd=tmp_path)
    assert shown.returncode == 0
    assert "OMP_NUM_THREADS" in shown.stdout
    assert "waiting passive" in shown.stdout
    shown = process("check", "missing.toml", cwd=tmp_path)
    assert shown.returncode == 2
    assert shown.stderr.startswith("rdpm: missing.toml: there is no such file")
    assert shown.stdout == ""
    assert process("--version").stdout.strip().count(".") == 2


def test_heavy_libraries_wait_until_needed():
    code = (
        "import sys, rdpm.cli.main as m; m.main(['--help']); "
        "print([n for n in ('pint', 'scipy', 'matplotlib', 'pyvista', 'h5py', 'numpy') if n in sys.modules])"
    )
    shown = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60
    )
    assert shown.stdout.splitlines()[-1] == "[]"


def test_closed_pipe_is_no_error():
    code = "import sys, rdpm.cli.main as m; sys.stdin.read(); sys.exit(m.main(['new']))"
    with subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as writer:
        writer.stdout.close()
        writer.stdin.close()  # now it may write
        assert writer.stderr.read() == b""
    assert writer.returncode == 0


def test_sigterm_ends_like_an_interrupt(tmp_path):
    code = """
import sys, time, types
setup = types.ModuleType("rdpm.setup")
setup.plan = lambda case: None
def run_case(case, folder, **_):
    print("running", flush=True)
    time.sleep(30)
runner = types.ModuleType("rdpm.runs.runner")
runner.run_case = run_case
sys.modules["rdpm.setup"] = setup
sys.modules["rdpm.runs.runner"] = runner
from rdpm.cli.main import main
sys.exit(main(["run", "dkt"]))
"""
    with subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=tmp_path
    ) as running:
        assert running.stdout.readline() == "running\n"
        time.sleep(0.1)
        running.send_signal(signal.SIGTERM)
        _, said = running.communicate(timeout=20)
    assert running.returncode == 130
    assert said == "rdpm: interrupted\n"
