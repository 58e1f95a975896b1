"""What ranks say to each other: errors that all raise, what the root does, what is put together."""

import os
import pickle
import re
import shlex
import sys

import numpy as np
import pytest

import rdpm
from builders import in_oil, oil_case
from rdpm.cli.main import main
from rdpm.errors import CaseError, OutputError, OverlapError, RanksError
from rdpm.io.tables import read_table
from rdpm.parallel.agreement import OnRoot, agree, guarding, on_root, together
from rdpm.parallel.gather import Planes, rows_on_root, with_planes
from rdpm.parallel.launcher import launched, launched_here, launched_rank, single
from rdpm.parallel.ranks import world
from rdpm.parallel.threads import available_threads, processors
from rdpm.runs.runner import run_case
from rdpm.runs.stopping import Interrupted, StopRequest
from rdpm.setup import plan
from rdpm.setup.rank_plan import plan_ranks
from rdpm.simulation import time_loop
from thread_ranks import on_ranks


def caught(do):
    """The error it raises, and whether all know of it."""
    try:
        do()
    except Exception as error:
        return type(error), str(error), getattr(error, "is_agreed", False)
    return None


def test_an_error_of_the_root_is_raised_everywhere() -> None:
    def fail():
        raise OutputError("x", None, "must be writable")

    found = on_ranks(3, lambda ranks: caught(lambda: on_root(ranks, fail)))
    assert found == [(OutputError, "x: must be writable.", True)] * 3


def test_the_error_of_the_lowest_rank_is_raised_everywhere() -> None:
    def work(ranks):
        def do():
            if ranks.rank > 0:
                raise OverlapError("overlap guard", ranks.rank, "must stay below")

        return caught(lambda: together(ranks, do))

    assert on_ranks(3, work) == [(OverlapError, "overlap guard = 1: must stay below.", True)] * 3


def test_ranks_without_an_error_go_on() -> None:
    assert on_ranks(2, lambda ranks: (agree(ranks, None), together(ranks, lambda: ranks.rank))) == [
        (None, 0),
        (None, 1),
    ]


def test_an_error_that_others_do_not_know_of_ends_them(capsys) -> None:
    ended = []

    class Ranks:
        size, rank = 2, 1
        abort = ended.append

    with pytest.raises(CaseError), guarding(Ranks()):
        raise CaseError("x", 1, "must be 2")
    assert ended == [2]
    assert capsys.readouterr().err == "rdpm: rank 1: x = 1: must be 2.\n"
    with pytest.raises(ZeroDivisionError), guarding(Ranks()):
        _ = 1 / 0
    assert ended == [2, 1]
    known = CaseError("x", 1, "must be 2")
    vars(known)["is_agreed"] = True
    with pytest.raises(CaseError), guarding(Ranks()):
        raise known
    assert ended == [2, 1]


def test_errors_travel_with_all_their_parts() -> None:
    error = CaseError("fluid.viscosity", -1.0, "must be above 0", "a reason", "A cure.")
    copy = pickle.loads(pickle.dumps(error))
    assert (str(copy), copy.place, copy.value, copy.cure) == (str(error), error.place, error.value, error.cure)


def test_a_signal_to_one_rank_ends_all_at_the_same_step() -> None:
    def work(ranks):
        request = StopRequest(ranks)
        request.check(None)
        if ranks.rank == 1:
            request.ask(15, None)
        return caught(lambda: request.check(None))

    assert on_ranks(3, work) == [(Interrupted, "SIGTERM", False)] * 3


def test_planes_come_to_the_root_in_order() -> None:
    def work(ranks):
        planes = [Planes(ranks, np.full((ranks.rank + 1, 2), float(ranks.rank))) for _ in range(2)]
        got = []
        with_planes(ranks, planes, lambda: got.extend(np.concatenate(list(each)) for each in planes))
        return got, rows_on_root(ranks, np.full((ranks.rank, 1), 5.0)).shape

    (whole, rows), *others = on_ranks(3, work)
    assert [each[:, 0].tolist() for each in whole] == [[0.0, 1.0, 1.0, 2.0, 2.0, 2.0]] * 2
    assert rows == (3, 1)
    assert all(not got and shape == (0, 1) for got, shape in others)


def test_a_root_that_fails_still_takes_what_the_others_send() -> None:
    def work(ranks):
        planes = [Planes(ranks, np.zeros((2, 2))) for _ in range(2)]

        def fail():
            next(iter(planes[0]))
            raise OutputError("x", None, "must be writable")

        return caught(lambda: with_planes(ranks, planes, fail))

    assert on_ranks(3, work) == [(OutputError, "x: must be writable.", True)] * 3


def test_only_the_root_has_a_writer() -> None:
    def work(ranks):
        rows = OnRoot(ranks, list)
        rows.append(ranks.rank)
        return rows.inner

    assert on_ranks(2, work) == [[0], None]


def test_without_a_launcher_there_is_one_rank(monkeypatch) -> None:
    assert (launched(), launched_rank(), world().size) == ((1, ""), 0, 1)
    monkeypatch.setenv("PMI_SIZE", "3")
    monkeypatch.setenv("PMI_RANK", "2")
    assert (launched(), launched_rank()) == ((3, "PMI_SIZE"), 2)
    with pytest.raises(CaseError, match=r"rdpm tune = 3 MPI ranks \(PMI_SIZE\): must be one process"):
        single("rdpm tune")


def test_ranks_of_a_node_share_its_processors(monkeypatch) -> None:
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    assert available_threads(processors()) == 1
    assert available_threads(10 * processors()) == 1


def test_a_run_on_ranks_writes_what_one_rank_writes_and_resumes_on_any_number(tmp_path) -> None:
    """Wet, through an interface: tables, fields, checkpoints; then on from the middle on two, three and one."""
    output = {
        "table_every": 4e-3,
        "fields_every": 8e-3,
        "checkpoint_every": 8e-3,
        "checkpoints_kept": 9,
        "report": False,
    }
    ball = [{"diameter": 0.015, "density": 4000.0, "centers": [[0.027, 0.034, 0.05]], "velocity": [0.1, -0.1, -0.3]}]
    made = oil_case(bodies=ball, resolution__cells_per_diameter=4, time__end=0.024, time__step=1e-3, output=output)
    case = rdpm.load_case(made)

    def run(name: str, count: int, **how):
        folder = tmp_path / name
        folder.mkdir(exist_ok=True)
        if count == 1:
            return run_case(case, folder, threads=1, **how)
        return on_ranks(count, lambda ranks: run_case(case, folder, threads=1, ranks=ranks, **how))[0]

    def tables(name: str):
        return {kind: read_table(tmp_path / name / f"{kind}.csv") for kind in ("particles", "history")}

    run("one", 1)
    assert run("two", 2).ranks == 2
    whole = tables("one")
    for name, count in (("same", 2), ("three", 3), ("alone", 1)):
        os.system(f"cp -r {tmp_path}/two {tmp_path}/{name}")
        for last in sorted((tmp_path / name / "checkpoints").iterdir())[2:]:
            last.unlink()
        (tmp_path / name / "summary.json").unlink()
        assert run(name, count, resume=True).status == "done"
    for file in ("particles.csv", "history.csv", "contacts.csv", "fields.vtkhdf", "bodies.vtkhdf"):
        assert (tmp_path / "same" / file).read_bytes() == (tmp_path / "two" / file).read_bytes(), file
    for name in ("two", "three", "alone"):
        for kind, table in tables(name).items():
            for column, values in table.items():
                if column != "divergence":
                    expected = whole[kind][column]
                    scale = np.nanmax(np.abs(expected), initial=1e-4)
                    np.testing.assert_allclose(values, expected, rtol=0.0, atol=1e-9 * scale, err_msg=column)


def test_the_guard_of_one_slab_is_raised_by_all() -> None:
    def spoil(ranks):
        sim = in_oil(ranks=ranks, resolution__cells_per_diameter=4)
        if ranks.rank == 1:
            sim.fluid.u[3, 3, 3] = np.nan
        return caught(sim.advance)

    first, second = on_ranks(2, spoil)
    assert first == second
    assert "nan guard, step 1" in first[1]


def test_bodies_that_differ_between_ranks_stop_the_run(monkeypatch) -> None:
    monkeypatch.setattr(time_loop, "DIVERGENCE_EVERY", 2)

    def drift(ranks):
        sim = in_oil(ranks=ranks, resolution__cells_per_diameter=4)
        sim.advance()
        sim.advance()  # the same, and compared
        if ranks.rank == 1:
            sim.bodies.position[0, 0] *= 1.0 + 1e-15
        sim.advance()
        return caught(sim.advance)

    first, second = on_ranks(2, drift)
    assert first == second
    kind, said, is_agreed = first
    assert (kind, is_agreed) == (RanksError, True)
    assert "ranks guard, step 4" in said
    assert "ranks 1: must have the same bodies as rank 0" in said


def test_a_machine_must_hold_the_memory_of_its_own_ranks(monkeypatch) -> None:
    case = rdpm.load_case(oil_case(resolution__cells_per_diameter=32))
    monkeypatch.setattr(sys.modules["rdpm.setup.plan"], "available_memory", lambda: 200_000_000)
    with pytest.raises(CaseError, match="cells need"):
        plan(case)
    assert plan(case, machines=4).cells == (128, 128, 192)
    monkeypatch.setenv("SLURM_STEP_NUM_TASKS", "8")
    monkeypatch.setenv("SLURM_STEP_TASKS_PER_NODE", "2(x4)")
    assert (launched()[0], launched_here()) == (8, 2)
    assert plan(case).cells == (128, 128, 192)
    monkeypatch.delenv("SLURM_STEP_TASKS_PER_NODE")
    with pytest.raises(CaseError, match="cells need"):
        plan(case)


def test_a_job_of_slurm_starts_and_continues_a_run(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["run", "cloud", "--set", "time.end=2", "--out", "big cloud", "--slurm", "4", "--threads", "8"]) == 0
    assert capsys.readouterr().out == "sbatch big cloud.sbatch\n"
    text = (tmp_path / "big cloud.sbatch").read_text()
    lines = text.splitlines()
    assert "#SBATCH --ntasks=4" in lines
    assert "#SBATCH --cpus-per-task=8" in lines
    words = shlex.split(next(line for line in lines if line.startswith("srun")))
    assert words[words.index("run") :][:5] == ["run", "cloud", "--set", "time.end=2", "--out"]
    assert "--resume" in words
    memory = int(re.search(r"--mem-per-cpu=(\d+)M", text).group(1))
    told = plan_ranks(plan(rdpm.load_case("cloud")), 4, 8)
    assert 8e6 * memory > 1.4 * told.shares[0].memory
    assert main(["run", "cloud", "--slurm", "99"]) == 2
    assert "99 MPI ranks" in capsys.readouterr().err
    assert main(["run", "cloud", "--slurm", "2", "--resume"]) == 2
    assert "--slurm = 2: goes with neither" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["big cloud.sbatch"]
