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


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    """A folder with a wet case, and `whole`, its run on two ranks that nothing disturbed."""
    folder = tmp_path_factory.mktemp("wet")
    output = {"table_every": 4e-3, "checkpoint_every": 4e-3, "report": False}
    name = case_file(folder, oil_case(resolution__cells_per_diameter=4, time__end=0.06, time__step=1e-3, output=output))
    begin = time.monotonic()
    done = call(2, "run", name, "--out", "whole", "--quiet", "--threads", "1", folder=folder)
    assert done.returncode == 0, done.stderr
    (folder / "seconds").write_text(str(time.monotonic() - begin))
    return folder


def test_a_wet_case_on_two_ranks_is_that_on_one(whole) -> None:
    one = rdpm.run(whole / "case.toml", whole / "one", threads=1)
    found = read_table(whole / "whole/particles.csv")
    np.testing.assert_allclose(found["w_m_s"], one.particles["w_m_s"], rtol=1e-9)


def ranks_under(launcher: int) -> list[int]:
    """Processes that a launcher started, those of its helpers left out."""
    parents, names = {}, {}
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            name, _, rest = path.read_text().partition("(")[2].rpartition(")")
            parents[int(path.parent.name)], names[int(path.parent.name)] = int(rest.split()[1]), name
        except OSError:  # it has just ended
            continue
    found, level = [], [launcher]
    while level:
        level = [process for process, parent in parents.items() if parent in level]
        found += [process for process in level if names[process].startswith("python")]
    return found


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="processes are found in /proc")
@pytest.mark.parametrize("seed", [pytest.param(n, marks=[pytest.mark.full] if n > 1 else []) for n in range(20)])
def test_a_rank_is_killed_at_any_moment(seed: int, whole) -> None:
    """The others end within seconds, and the run resumes to the bytes of one that nothing disturbed."""
    random, folder = np.random.default_rng(seed), f"killed-{seed}"
    words = ("run", "case.toml", "--out", folder, "--resume", "--quiet", "--threads", "1")
    run = subprocess.Popen(command(2, *words), cwd=whole, stderr=subprocess.DEVNULL)
    moment = time.monotonic() + random.uniform(0.2, 1.0) * float((whole / "seconds").read_text())
    ranks: list[int] = []
    while len(ranks) < 2 and run.poll() is None:
        ranks = ranks_under(run.pid)
    time.sleep(max(0.0, moment - time.monotonic()))
    victim = ranks[int(random.integers(2))]
    try:
        os.kill(victim, signal.SIGKILL)
    except ProcessLookupError:
        assert run.wait(timeout=10) == 0, f"seed {seed}: it had ended before"
    else:
        begin = time.monotonic()
        code = run.wait(timeout=10)
        while any(Path(f"/proc/{rank}").exists() for rank in ranks):
            assert time.monotonic() < begin + 10.0, f"seed {seed}: a rank goes on"
            time.sleep(0.05)
        assert code != 0 or (whole / folder / "summary.json").exists()
    done = call(2, *words, folder=whole)
    assert done.returncode == 0, done.stderr
    for kind in ("particles", "history"):
        table = f"{kind}.csv"
        assert (whole / folder / table).read_bytes() == (whole / "whole" / table).read_bytes(), f"seed {seed}"


#: Spoils something on the last rank in its fifth step, then runs the command line.
SPOILED = """
import resource, sys
from rdpm.cli.main import main
from rdpm.errors import OverlapError
from rdpm.parallel.ranks import world
from rdpm.simulation import time_loop
what, rank, plain = sys.argv.pop(1), world().rank, time_loop.check_step
def spoiled(system, dt):
    if system.steps == 5 and what == "overlap" and rank == 2:
        raise OverlapError("overlap guard", "9 %", "must stay below 1 %")
    plain(system, dt)
    if system.steps == 4 and what == "nan" and rank == 2:
        system.fluid.u[3, 3, 3] = float("nan")
    if system.steps == 4 and what == "disk" and rank == 0:
        resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))
time_loop.check_step = spoiled
sys.exit(main())
"""


@pytest.mark.parametrize(
    ("what", "code", "said"),
    [("nan", 3, "nan guard, step 5"), ("overlap", 3, "overlap guard = 9 %"), ("disk", 3, "cannot be written")],
)
def test_what_fails_on_one_rank_is_said_once_by_all(what: str, code: int, said: str, whole) -> None:
    words = [MPIEXEC, "-n", "3", sys.executable, "-c", SPOILED, what, "run", "case.toml", "--out", what, "--quiet"]
    done = subprocess.run([*words, "--threads", "1"], cwd=whole, capture_output=True, text=True, timeout=120)
    assert done.returncode == code, done.stderr
    assert done.stderr.count(said) == 1, done.stderr
    assert "Traceback" not in done.stderr


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
