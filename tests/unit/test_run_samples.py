"""What a case asks to sample: its files, on any threads, through a restart, and at the times asked."""

import numpy as np
import pandas as pd
import pytest

import rdpm
from rdpm.errors import CaseError
from rdpm.io.vtkhdf import read_fields

D = 0.01
CASE = {
    "domain": {"size": [0.03, 0.03, 0.05]},
    "fluid": {"density": 960.0, "viscosity": 0.1},
    "bodies": [{"diameter": D, "density": 2500.0, "centers": [[0.015, 0.014, 0.035]]}],
    "contact": {"restitution": 0.7, "contact_steps": 8},
    "resolution": {"cells_per_diameter": 4},
    "time": {"end": 0.05, "step": 0.001},
    "output": {
        "report": False,
        "table_every": 0.01,
        "fields_every": 0.025,
        "fields_tolerance": 0,
        "checkpoint_every": 0.02,
        "points": [[0.015, 0.014, 0.02], [0.0, 0.01, 0.01]],
        "lines": [{"start": [0.015, 0.014, 0.0], "end": [0.015, 0.014, 0.02], "count": 5}],
        "planes": [{"normal": "y", "position": 0.014}, {"normal": "z", "position": 0.02}],
        "sample_every": 0.004,
        "planes_every": 0.02,
        "average_from": 0.01,
        "average_every": 0.003,
        "vorticity": True,
        "q_criterion": True,
    },
}
FILES = ("points.csv", "lines.csv")


class Stop(Exception):  # noqa: N818
    pass


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """On one thread, on two, and broken off after a checkpoint."""
    folder = tmp_path_factory.mktemp("samples")
    whole = rdpm.run(CASE, folder / "one", threads=1)
    two = rdpm.run(CASE, folder / "two", threads=2)

    def stop(sim):
        if sim.steps == 33:
            raise Stop

    with pytest.raises(Stop):
        rdpm.run(CASE, folder / "parts", on_step=stop, threads=1)
    return whole, two, rdpm.run(CASE, folder / "parts", resume=True, threads=1)


def test_samples_do_not_depend_on_threads_and_restarts(runs) -> None:
    one, *others = runs
    for other in others:
        for name in FILES:
            assert (one.folder.path / name).read_bytes() == (other.folder.path / name).read_bytes()
        here, there = ([*run.planes, run.averages, run.fields] for run in (one, other))
        assert [a.identical(b) for a, b in zip(here, there, strict=True)] == [True] * 4


def test_samples_are_the_flow(runs) -> None:
    run = runs[0]
    assert list(run.points) == ["time_s", "point", "x_m", "y_m", "z_m", "u_m_s", "v_m_s", "w_m_s", "pressure_Pa"]
    first = run.points[run.points["point"] == 0]
    np.testing.assert_allclose(first["time_s"], 0.004 * np.arange(13), atol=1e-9)
    assert first["w_m_s"].iloc[-1] < -1e-3
    on_wall = run.points[run.points["point"] == 1]
    np.testing.assert_allclose(on_wall[["u_m_s", "v_m_s", "w_m_s"]], 0.0, atol=1e-15)
    np.testing.assert_allclose(run.lines["along_m"].iloc[:5], [0.0, 0.005, 0.01, 0.015, 0.02])
    # The line ends at the first point.
    last = run.lines.groupby("time_s").tail(1)
    np.testing.assert_array_equal(last["w_m_s"], first["w_m_s"])
    plane, layer = run.planes
    assert plane.velocity.sizes == {"time": 3, "z": 20, "y": 1, "x": 12, "component": 3}
    assert float(plane.y[0]) == pytest.approx(0.014)
    # Layers of cells are 2.5 mm thick: z = 20 mm lies between two of them.
    assert float(layer.z[0]) == pytest.approx(0.02)
    fastest = layer.velocity.isel(time=-1, z=0).sel(component="z").min()
    np.testing.assert_allclose(fastest, last["w_m_s"].iloc[-1], rtol=0.3)


def test_fields_hold_vorticity_and_q(runs) -> None:
    run = runs[0]
    assert set(run.fields.data_vars) == {"velocity", "pressure", "vorticity", "q_criterion"}
    flow = run.fields.isel(time=-1)
    u, h = flow.velocity.sel(component="x").values.astype(float), 0.0025
    w = flow.velocity.sel(component="z").values.astype(float)
    inner = (slice(1, -1),) * 3
    curl = (u[2:, 1:-1, 1:-1] - u[:-2, 1:-1, 1:-1] - w[1:-1, 1:-1, 2:] + w[1:-1, 1:-1, :-2]) / (2 * h)
    np.testing.assert_allclose(flow.vorticity.sel(component="y").values[inner], curl, atol=1e-4)
    time, velocity, _ = read_fields(run.folder.fields, -1)
    assert time == float(flow.time)
    np.testing.assert_array_equal(velocity, flow.velocity)


def test_averages_lie_between_what_is_averaged(runs) -> None:
    averages, fields = runs[0].averages, runs[0].fields
    assert float(averages.time) == pytest.approx(0.048)
    w = averages.mean_velocity.sel(component="z")
    assert float(fields.velocity.sel(component="z").min()) < float(w.min()) < -0.01
    assert float(averages.velocity_variance.min()) >= 0.0
    assert float(averages.velocity_variance.max()) > 0.0


def test_what_is_not_asked_for_is_not_there(tmp_path) -> None:
    output = {"report": False, "fields_every": 0.0}
    run = rdpm.run(CASE | {"output": output, "time": {"end": 0.002, "step": 0.001}}, tmp_path)
    assert len(run.fields.data_vars) == len(run.averages.data_vars) == len(run.planes) == len(run.records) == 0
    with pytest.raises(CaseError, match=r"points\.csv: must be a table of a run"):
        _ = run.points


def line(end, count=3):
    return {"lines": [{"start": [0, 0, 0], "end": end, "count": count}]}


@pytest.mark.parametrize(
    ("output", "message"),
    [
        ({"points": [[1, 0, 0]]}, r"points\[0\] = \[1\.0, 0\.0, 0\.0\]: must lie in the box, between 0 and 0\.03 m"),
        ({"points": [0, 0, 0]}, r"output\.points\[0\] = 0: must be a list"),
        ({"lines": {"count": 3}}, r"must be a list of tables\. Write \[\[output\.lines\]\]"),
        (line([0, 0, 0]), r"lines\[0\]\.end .*must differ from the start"),
        (line([0, 0, 1]), r"lines\[0\]\.end .*must lie in the box"),
        (line([0, 0, 0.01], 1), r"lines\[0\]\.count = 1: must lie between"),
        ({"planes": [{"normal": "y", "position": 0.04}]}, r"planes\[0\]\.position = 0\.04: must be at most 0\.03 m"),
        ({"planes": [{"normal": "up", "position": 0.04}]}, r'planes\[0\]\.normal = "up": must be "x" or "y" or "z"'),
        ({"average_from": 0.05}, r"output\.average_from = 0\.05: must be before time\.end = 0\.05 s"),
        ({"sample_evry": 0.05}, r'output\.sample_evry: unknown key\. Did you mean "sample_every"'),
    ],
)
def test_wrong_samples_are_refused(output, message) -> None:
    with pytest.raises(CaseError, match=message):
        rdpm.load_case(CASE | {"output": output})


def test_a_dry_case_has_no_flow_to_sample() -> None:
    dry = {key: value for key, value in CASE.items() if key not in ("fluid", "resolution")}
    with pytest.raises(CaseError, match=r"output\.points: must be left out of a case without \[fluid\]"):
        rdpm.load_case(dry)


def test_adaptive_steps_end_at_the_times_asked(tmp_path) -> None:
    """Tables, fields, samples and records; a fixed step is not changed for them."""
    output = {"report": False, "table_every": 0.01, "fields_every": 0.03, "points": [[0.01, 0.01, 0.01]]}
    case = rdpm.load_case(CASE | {"output": output | {"sample_every": 0.007}, "time": {"end": 0.1, "step": "adaptive"}})
    run = rdpm.run(case, tmp_path, record={"z": (lambda sim: sim.bodies.position[0, 2], "13 ms")}, threads=1)
    assert run.summary.dt_longest_s > 1.5 * run.summary.dt_s
    np.testing.assert_allclose(run.history["time_s"], 0.01 * np.arange(11), atol=1e-12)
    np.testing.assert_allclose(run.fields.time, 0.03 * np.arange(4), atol=1e-12)
    np.testing.assert_allclose(run.points["time_s"], 0.007 * np.arange(15), atol=1e-12)
    np.testing.assert_allclose(run.records["z"]["time_s"], 0.013 * np.arange(8), atol=1e-12)
    assert isinstance(run.records["z"], pd.DataFrame)


def test_an_interval_below_the_contact_step_shortens_no_step() -> None:
    case = rdpm.load_case(CASE | {"output": {"report": False}, "time": {"end": 0.1, "step": "adaptive"}})
    sim, plain = rdpm.Simulation(case, threads=1), rdpm.Simulation(case, threads=1)
    often = sim.record("t", lambda s: s.time, every=0.1 * sim.plan.step.dt)
    for _ in range(6):
        sim.advance()
        plain.advance()
    assert sim.time == plain.time
    assert len(often.values["t"]) == 7
