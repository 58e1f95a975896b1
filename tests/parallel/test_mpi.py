"""Runs under mpiexec: one message, one exit code, the same results."""

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import rdpm
from builders import oil_case
from rdpm.config.write import case_to_toml
from rdpm.io.tables import read_table

pytest.importorskip("mpi4py")
MPIEXEC = shutil.which("mpiexec", path=f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
if MPIEXEC is None:
    pytest.skip("there is no mpiexec", allow_module_level=True)

RDPM = [sys.executable, "-c", "import sys; from rdpm.cli.main import main; sys.exit(main())"]
DRY = {
    "domain": {"size": [0.1, 0.1, 0.1]},
    "bodies": [{"diameter": 0.01, "density": 2500.0, "centers": [[0.05, 0.05, 0.02], [0.052, 0.05, 0.035]]}],
    "time": {"end": 0.03, "step": 1e-4},
    "output": {"table_every": 5e-3, "report": False},
}


def command(count: int, *words: str) -> list[str]:
    return [MPIEXEC, "-n", str(count), *RDPM, *words]


def call(count: int, *words: str, folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(command(count, *words), cwd=folder, capture_output=True, text=True, timeout=120)


def case_file(folder: Path, case: dict) -> str:
    (folder / "case.toml").write_text(case_to_toml(rdpm.load_case(case)))
    return "case.toml"


def test_a_dry_case_on_three_ranks_is_byte_identical(tmp_path) -> None:
    name = case_file(tmp_path, DRY)
    subprocess.run([*RDPM, "run", name, "--out", "one", "--quiet"], cwd=tmp_path, check=True)
    done = call(3, "run", name, "--out", "three", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("Results are in three") == 1
    for table in ("particles.csv", "contacts.csv", "history.csv"):
        assert (tmp_path / "three" / table).read_bytes() == (tmp_path / "one" / table).read_bytes()


def test_a_wet_case_on_two_ranks_and_a_killed_one(tmp_path) -> None:
    """A rank is killed: the other ends in seconds, and the run resumes to the results of one that was not."""
    output = {"table_every": 4e-3, "checkpoint_every": 4e-3, "report": False}
    name = case_file(
        tmp_path, oil_case(resolution__cells_per_diameter=4, time__end=0.03, time__step=1e-3, output=output)
    )
    done = call(2, "run", name, "--out", "whole", "--quiet", "--threads", "1", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    run = subprocess.Popen(
        command(2, "run", name, "--out", "killed", "--quiet", "--threads", "1"), cwd=tmp_path, stderr=subprocess.DEVNULL
    )
    checkpoints, end = tmp_path / "killed/checkpoints", time.monotonic() + 60.0
    while not (checkpoints.is_dir() and len(list(checkpoints.iterdir())) > 1) and time.monotonic() < end:
        time.sleep(0.02)
    os.kill(int((tmp_path / "killed/run.lock").read_text()), signal.SIGKILL)
    assert run.wait(timeout=20) != 0
    done = call(2, "run", "killed", "--resume", "--quiet", "--threads", "1", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    for kind in ("particles", "history"):
        table = f"{kind}.csv"
        assert (tmp_path / "killed" / table).read_bytes() == (tmp_path / "whole" / table).read_bytes()
    one = rdpm.run(tmp_path / name, tmp_path / "one", threads=1)
    found = read_table(tmp_path / "whole/particles.csv")
    np.testing.assert_allclose(found["w_m_s"], one.particles["w_m_s"], rtol=1e-9)


def test_what_is_wrong_is_said_once(tmp_path) -> None:
    done = call(2, "run", "nowhere.toml", folder=tmp_path)
    assert (done.returncode, done.stderr.count("nowhere.toml")) == (2, 1)
    done = call(2, "tune", "rebound", folder=tmp_path)
    assert done.returncode == 2
    assert done.stderr.count("rdpm tune = 2 MPI ranks") == 1
    done = call(2, "info", folder=tmp_path)
    assert done.stdout.count("2 ranks") == 1


def test_a_launcher_of_another_mpi_is_named(tmp_path) -> None:
    """Each process would do the whole work."""
    name = case_file(tmp_path, DRY)
    done = subprocess.run(
        [*RDPM, "run", name],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        env=os.environ | {"OMPI_COMM_WORLD_SIZE": "4"},
    )
    assert done.returncode == 2
    assert "run = 4 MPI ranks (OMPI_COMM_WORLD_SIZE): must be as many as MPI sees, 1" in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["case.toml"]
