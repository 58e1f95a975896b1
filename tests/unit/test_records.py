"""Own columns and tables: what they hold, in a simulation and in a run's folder, and how bad functions are refused."""

import numpy as np
import pandas as pd
import pytest

import rdpm
from rdpm.errors import CaseError

BEADS = {
    "domain": {"size": [0.1, 0.1, 0.1]},
    "bodies": [{"diameter": 0.01, "density": 2500.0, "centers": [[0.05, 0.05, 0.06], [0.02, 0.05, 0.08]]}],
    "contact": {"restitution": 0.9, "contact_steps": 10},
    "time": {"end": 0.1, "step": 1e-3},
    "output": {"report": False, "table_every": 0.01},
}


def gap(sim):
    return sim.bodies.position[0, 2] - 0.005


def test_a_record_is_kept_in_a_simulation() -> None:
    sim = rdpm.Simulation(BEADS)
    one = sim.record("gap", gap, every="5 ms")
    often = sim.record("speed", lambda s: s.bodies.velocity[0], every=0.002)
    rows = sim.record("bodies", lambda s: {"id": np.arange(2), "z_m": s.bodies.position[:, 2]})
    sim.run(until=0.02)
    np.testing.assert_allclose(one.values["time_s"], [0.0, 0.005, 0.01, 0.015, 0.02], atol=1e-12)
    np.testing.assert_allclose(one.values["gap"], 0.055 - 0.5 * 9.81 * one.values["time_s"] ** 2)
    assert often.columns == ("time_s", "speed_0", "speed_1", "speed_2")
    assert len(often.values["time_s"]) == 11
    # As often as the tables where it is not said; a row a body.
    np.testing.assert_allclose(rows.values["time_s"], [0.0, 0.0, 0.01, 0.01, 0.02, 0.02], atol=1e-12)
    np.testing.assert_array_equal(rows.values["id"], [0, 1, 0, 1, 0, 1])
    assert sim.records == {"gap": one, "speed": often, "bodies": rows}


def test_records_of_a_run_are_tables_of_its_folder(tmp_path) -> None:
    found = rdpm.run(BEADS, tmp_path, record={"gap": gap, "energy": (lambda s: {"a": 1.0, "b": [2.0]}, "50 ms")})
    table = found.records["gap"]
    assert isinstance(table, pd.DataFrame)
    upper = found.particles[found.particles["id"] == 0]
    np.testing.assert_array_equal(table["time_s"], upper["time_s"])
    np.testing.assert_array_equal(table["gap"], upper["z_m"].to_numpy() - 0.005)
    assert (tmp_path / "records" / "energy.csv").read_text() == (
        "time_s,a,b\n0.0,1.0,2.0\n0.05000000000000004,1.0,2.0\n0.10000000000000007,1.0,2.0\n"
    )


class Stop(Exception):  # noqa: N818
    pass


def test_records_survive_a_restart(tmp_path) -> None:
    """Broken off after a checkpoint, and continued: the bytes of a whole run; a function not given again ends."""
    case = rdpm.load_case(BEADS, {"output.checkpoint_every": 0.02})
    record = {"gap": (gap, "3 ms"), "twice": (lambda s: [s.time, s.time], "7 ms")}
    whole = rdpm.run(case, tmp_path / "whole", record=record)

    def stop(sim):
        if sim.steps == 55:
            raise Stop

    with pytest.raises(Stop):
        rdpm.run(case, tmp_path / "parts", record=record, on_step=stop)
    before = (tmp_path / "parts" / "records" / "twice.csv").read_text()
    rdpm.run(case, tmp_path / "parts", record={"gap": (gap, "3 ms"), "late": gap}, resume=True)
    one, other = (tmp_path / name / "records" for name in ("whole", "parts"))
    assert (one / "gap.csv").read_bytes() == (other / "gap.csv").read_bytes()
    assert (other / "twice.csv").read_text() == before
    assert "record 'twice' ends here" in (tmp_path / "parts" / "run.log").read_text()
    late = pd.read_csv(other / "late.csv")["time_s"]
    np.testing.assert_allclose(late, [0.04, 0.05, 0.06, 0.07, 0.08, 0.09, 0.1], atol=1e-9)
    assert list(whole.records) == ["gap", "twice"]


@pytest.mark.parametrize(
    ("record", "message"),
    [
        ({"gap": lambda s: 1 / 0}, r"record 'gap': must not fail \(ZeroDivisionError at t = 0 s: division by zero\)"),
        ({"gap": lambda s: "wide"}, r"record 'gap': must give a number, a list .*it gave str at t = 0 s"),
        ({"gap": lambda s: None}, r"record 'gap': must give a number, a list .*it gave NoneType at t = 0 s: no value"),
        ({"gap": lambda s: s.bodies.position}, r"record 'gap': must give a number, a list .*it gave ndarray"),
        ({"gap": lambda s: {}}, r"record 'gap': must give .*it gave dict at t = 0 s: no columns"),
        ({"gap": lambda s: {"a": [1, 2], "b": 3}}, r"columns of different lengths"),
        ({"gap": lambda s: {"time_s": 1}}, r"record 'gap' = time_s: must name its columns without commas"),
        ({"gap": 3.0}, r"record 'gap' = 3\.0: must be a function of the simulation"),
        ({"a/b": gap}, r"record 'a/b': must have a name of letters"),
        ({"gap": (gap, "3 kg")}, r"record 'gap', every = 3 kg: must be a time"),
        ({"gap": (gap, 0.0)}, r"record 'gap', every = 0\.0: must be positive"),
    ],
)
def test_bad_records_are_refused_before_anything_is_written(record, message, tmp_path) -> None:
    with pytest.raises(CaseError, match=message):
        rdpm.run(BEADS, tmp_path, record=record)
    assert not any(path.is_file() for path in tmp_path.rglob("*"))
    sim = rdpm.Simulation(BEADS)
    ((name, given),) = record.items()
    function, every = given if isinstance(given, tuple) else (given, None)
    with pytest.raises(CaseError, match=message):
        sim.record(name, function, every)
    assert sim.records == {}


def test_a_record_that_fails_later_stops_the_run_with_the_time(tmp_path) -> None:
    with pytest.raises(CaseError, match=r"record 'x': must give the same columns each time \(x_0, x_1 at t = 0\.02 s"):
        rdpm.run(BEADS, tmp_path, record={"x": (lambda s: s.time if s.time < 0.015 else [1, 2], 0.01)})
    assert '"status": "failed"' in (tmp_path / "summary.json").read_text()
    sim = rdpm.Simulation(BEADS)
    sim.record("gap", gap)
    with pytest.raises(CaseError, match="record 'gap': must have a name of its own"):
        sim.record("gap", gap)
