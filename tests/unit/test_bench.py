"""`rdpm bench` on a case small enough for a test: what it reports, not how fast it is."""

import json

import pytest

from rdpm.cli.main import main
from rdpm.studies import bench


@pytest.fixture
def small_case(monkeypatch: pytest.MonkeyPatch) -> str:
    def box() -> dict:
        return {
            "domain": {"size": [0.04, 0.04, 0.05]},
            "fluid": {"density": 962.0, "viscosity": 0.113},
            "bodies": [{"diameter": 0.015, "density": 1120.0, "centers": [[0.02, 0.02, 0.03]]}],
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
