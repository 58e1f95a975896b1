"""`rdpm bench` on a case small enough for a test: what it reports, not how fast it is."""

import json

import pytest

from rdpm.cli.main import main
from rdpm.studies import bench, bench_ranks, dry_bed
from thread_ranks import on_ranks


@pytest.fixture
def small_case(monkeypatch: pytest.MonkeyPatch) -> str:
    def box() -> dict:
        return {
            "domain": {"size": [0.04, 0.04, 0.05]},
            "fluid": {"density": 962.0, "viscosity": 0.113},
            "bodies": [{"diameter": 0.015, "density": 1120.0, "centers": [[0.02, 0.02, 0.032]]}],
            "resolution": {"cells_per_diameter": 6},
            "time": {"end": 1.0},
        }

    monkeypatch.setattr(bench, "CASES", {"small": (box, 1)})
    monkeypatch.setattr(bench, "SECONDS", 0.0)
    return "small"


def test_bench_reports_speed_beside_the_bandwidth_of_the_same_run(small_case, capsys) -> None:
    assert main(["bench", small_case, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    (case,) = found["cases"]
    assert case["name"] == "small"
    assert case["threads"] == 1
    assert case["bodies"] == 1
    one_thread = 1e9 * found["triad_one_thread_GB_s"]
    assert case["bytes_per_cell_step"] == pytest.approx(1e-9 * case["ns_per_cell_step"] * one_thread)
    assert set(case["parts"]) >= {"momentum", "bodies", "poisson", "contacts"}
    # Three passes are part of what bodies cost in a step.
    assert 0.0 < 3.0 * case["us_per_marker_pass"] < case["us_per_marker_step"]


def test_bench_prints_a_line_a_case(small_case, capsys) -> None:
    assert main(["bench", small_case]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert "GB/s" in lines[0]
    assert lines[-1].startswith("small")
    assert "us a marker" in lines[-1]


@pytest.fixture
def tiny_bed(monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.setattr(dry_bed, "BEDS", {"tiny": 4})
    monkeypatch.setattr(bench, "BEDS", dry_bed.BEDS)
    monkeypatch.setattr(dry_bed, "FEW", {10: 1, 32: 4})
    monkeypatch.setattr(dry_bed, "FEW_LAMMPS", (28, 112))
    monkeypatch.setattr(dry_bed, "SECONDS", 0.0)
    monkeypatch.setattr(dry_bed, "available_threads", lambda: 1)
    return "tiny"


def test_a_dry_bed_is_timed_beside_lammps_at_equal_substep_and_at_equal_error(tiny_bed, capsys) -> None:
    assert main(["bench", tiny_bed, "--quick", "--json"]) == 0
    (bed,) = json.loads(capsys.readouterr().out)["beds"]
    programs = ["rdpm", "LAMMPS"] if bed["lammps"] else ["rdpm"]
    assert [row["program"] for row in bed["rows"]] == programs
    assert all(row["substeps_per_contact"] == dry_bed.SUBSTEPS for row in bed["rows"])
    assert all(row["bodies"] == 64 and row["us"] > 0.0 and row["cpu_us"] > 0.0 for row in bed["rows"])
    assert bed["growth"] == []
    errors = {(row["program"], row["substeps_per_contact"]): row for row in bed["errors"]}
    assert all(0.0 < row["rms"] <= row["worst"] for row in errors.values())
    # The sub-steps here locate touch and end: an error of second order, below 0.1 % from the fewest on.
    assert errors["rdpm", 32]["worst"] < 0.2 * errors["rdpm", 10]["worst"] < 2e-4
    assert {row["substeps_per_contact"] for row in bed["equal_error"] if row["program"] == "rdpm"} == {10}
    if bed["lammps"]:
        assert errors["LAMMPS", 112]["worst"] > errors["rdpm", 10]["worst"]
        fewest = {row["error"]: row["substeps_per_contact"] for row in bed["equal_error"] if row["program"] == "LAMMPS"}
        assert fewest == {0.01: 28, 0.002: 112}


def test_a_dry_bed_is_printed_as_tables_and_its_growth_with_the_memory(tiny_bed, monkeypatch, capsys) -> None:
    monkeypatch.setattr(dry_bed, "GROWTH", (3,))
    monkeypatch.setattr(dry_bed, "find_lammps", lambda: None)
    assert main(["bench", tiny_bed]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert {"at equal sub-step", "error of the restitution", "at equal error of the restitution"} < set(lines)
    growth = lines[-1].split()
    assert growth[:3] == ["rdpm", "27", "1"]
    assert float(growth[-1]) > 100.0  # bytes: a row of a body alone is 256


def test_without_lammps_the_bed_is_timed_alone_and_says_so(tiny_bed, monkeypatch) -> None:
    monkeypatch.setattr(dry_bed, "find_lammps", lambda: None)
    told: list[str] = []
    bed = dry_bed.dry_bed(tiny_bed, told.append, is_quick=True)
    assert not bed["lammps"]
    assert {row["program"] for row in bed["rows"]} == {"rdpm"}
    assert any("LAMMPS is not installed" in line for line in told)


def test_quick_is_of_beds_alone(small_case, capsys) -> None:
    assert main(["bench", small_case, "--quick"]) == 2
    assert "bench --quick" in capsys.readouterr().err


def test_ranks_are_timed_beside_one_in_turns(monkeypatch, capsys) -> None:
    """What is timed runs in processes of its own; here they are made up."""
    asked: list[tuple[int, int]] = []

    def measured(name: str, launcher: list[str], threads: int) -> dict:
        ranks = 2 if launcher else 1
        asked.append((ranks, threads))
        speed = 9.0 if launcher else 10.0
        case = {"name": name, "ranks": ranks, "threads": threads, "ns_per_cell_step": speed}
        sent = {"message_ns_per_cell_step": 1.8, "messages": 14, "sent_bytes": 250_000, "sent_as_told": True}
        return case | (sent if launcher else {})

    monkeypatch.setattr(bench_ranks, "_measured", measured)
    monkeypatch.setattr(bench_ranks, "find_mpiexec", lambda: "mpiexec")
    monkeypatch.setattr(bench_ranks, "processors", lambda: 8)
    assert main(["bench", "ranks", "cube-64"]) == 0
    assert asked == [(1, 8), (2, 4)] * 3
    head, one, two = capsys.readouterr().out.splitlines()[-3:]
    assert "in messages" in head
    assert one.split() == ["cube-64", "1", "x", "8", "10.0"]
    assert two.split("x 4")[1].split() == ["9.0", "14", "0.25", "MB", "20.0", "%", "1.11", "of", "one", "rank's"]


def test_without_a_launcher_ranks_are_not_timed(monkeypatch, capsys) -> None:
    monkeypatch.setattr(bench_ranks, "find_mpiexec", lambda: None)
    assert main(["bench", "ranks"]) == 2
    assert "needs mpiexec" in capsys.readouterr().err


def test_a_step_on_ranks_sends_what_check_tells(small_case) -> None:
    first, _ = on_ranks(2, lambda ranks: bench.measure(small_case, 1e10, ranks))
    assert (first["ranks"], first["sent_as_told"]) == (2, True)
    assert first["messages"] > 0
    assert 0.0 <= first["message_ns_per_cell_step"] < first["ns_per_cell_step"]
