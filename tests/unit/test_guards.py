"""Guards stop a run on the step that went wrong, say which, where and what to do, and leave what was written."""

import json
import re

import numpy as np
import pytest

import rdpm
from builders import in_oil
from rdpm.cli import main as cli
from rdpm.errors import BodyLeftError, CflError, DivergenceError, GuardError, NanError, OverlapError
from rdpm.io.tables import read_table
from rdpm.simulation.guards import check_divergence, check_step

CASE = """
title = "A sphere that goes too far"
[domain]
size = ["6 cm", "6 cm", "6 cm"]
boundary = { x = "free-slip" }
[fluid]
density = "962 kg/m^3"
viscosity = "0.113 Pa s"
[[bodies]]
diameter = "15 mm"
density = "1120 kg/m^3"
centers = [["3 cm", "3 cm", "1.2 cm"]]
MOTION
[contact]
restitution = 0.9
stiffness = "1 N/m"          # the sphere's own weight would press it 18 % of its diameter into the floor
overlap_limit = 0.01
lubrication = false
[resolution]
cells_per_diameter = 6
[time]
end = "0.4 s"
step = "2 ms"
[output]
table_every = "10 ms"
fields_every = "20 ms"
report = false
"""


def running(**changes) -> rdpm.Simulation:
    """Ten Cate's sphere on a coarse grid, some steps on its way."""
    pair = [{"diameter": 0.015, "density": 1120.0, "centers": [[0.03, 0.03, 0.04], [0.03, 0.03, 0.02]]}]
    sim = in_oil(
        domain__size=[0.06] * 3, bodies=pair, resolution__cells_per_diameter=4, time={"end": 0.2, "step": 2e-3},
        contact={"restitution": 0.9, "contact_steps": 8, **changes},
    )  # fmt: skip
    sim.run(until=0.01)
    return sim


def stopped(sim: rdpm.Simulation, error: type[GuardError]) -> str:
    """The message of the guard, on the very next step."""
    step = sim.steps
    with pytest.raises(error) as caught:
        sim.advance()
    assert sim.steps == step + 1
    assert caught.value.exit_code == 3
    assert caught.value.cure
    assert f"step {sim.steps}, t = {sim.time:.6g} s" in str(caught.value)
    return str(caught.value)


def test_a_body_that_is_not_finite() -> None:
    sim = running()
    sim.bodies.velocity[1, 2] = np.nan
    assert stopped(sim, NanError).startswith("nan guard, step 6, t = 0.012 s: body ")


@pytest.mark.parametrize("value", [np.nan, np.inf])
@pytest.mark.parametrize("name", ["u", "v", "w"])
def test_a_velocity_that_is_not_finite(name: str, value: float) -> None:
    """Far from the bodies: the transforms of the pressure carry it everywhere at once."""
    sim = running()
    getattr(sim.fluid, name)[3, 3, 3] = value
    message = stopped(sim, NanError)
    assert message.startswith("nan guard, ")
    assert "must" in message


def test_a_velocity_that_is_not_finite_is_placed_without_bodies() -> None:
    sim = in_oil(domain__size=[0.06] * 3, bodies=None, resolution={"cells": [8, 8, 8]}, time__step=2e-3)
    sim.fluid.w[4, 4, 4] = np.nan
    message = stopped(sim, NanError)
    assert " near (" in message
    assert message.endswith("Lower time.step or time.cfl.")


def test_a_flow_that_is_too_fast_for_the_step() -> None:
    sim = running()
    sim.fluid.set_velocity(0.0, 0.0, 0.0)
    sim.fluid.u[5, 5, 3:9] = 3.0  # 1.6 cells a step
    message = stopped(sim, CflError)
    assert message.startswith("cfl guard, step 6, t = 0.012 s = ")
    longest = float(message.split("Set time.step to ")[1].split(" s")[0])
    assert longest == pytest.approx(0.5 / sim.fluid.cfl_rate, rel=0.05)


def test_bodies_that_overlap_too_much() -> None:
    sim = running(overlap_limit=0.1)
    sim.bodies.position[1] = sim.bodies.position[0] - [0.0, 0.0, 0.012]
    with pytest.raises(OverlapError) as caught:
        sim.advance()
    assert caught.value.exit_code == 3
    assert "contact.overlap_limit" in str(caught.value)


def test_a_body_that_left() -> None:
    sim = running()
    sim.bodies.position[0, 0] = 0.0601
    with pytest.raises((BodyLeftError, OverlapError)):
        sim.advance()
    with pytest.raises(BodyLeftError, match=r"^body guard, step \d+, t = .* s: body 0, x = 0\.06"):
        check_step(sim.system, sim.dt)


def test_divergence_above_round_off() -> None:
    sim = running()
    assert check_divergence(sim.system) < 1e-10
    sim.fluid.u[4, 4, 4] += 1e-6
    with pytest.raises(DivergenceError, match=r"^divergence guard, step 5, t = 0\.01 s = .* 1/s: must stay below"):
        check_divergence(sim.system)


def test_a_body_that_left_the_box() -> None:
    sim = running()
    sim.bodies.position[0, 0] = -1e-4
    with pytest.raises(BodyLeftError, match=r"^body guard, step 5, .*: body 0, x = -0\.0001: its centre must stay"):
        check_step(sim.system, sim.dt)


def test_a_sound_run_passes() -> None:
    sim = running()
    check_step(sim.system, sim.dt)
    sim.run(until=0.05)
    assert sim.check_divergence() == sim.max_divergence < 1e-10


@pytest.mark.parametrize(
    ("motion", "medium", "status", "message"),
    [
        ("motion = { velocity = [0.2, 0, 0] }", "dry", "overlap", "overlap guard, step"),
        ("motion = { velocity = [0.2, 0, 0] }", "wet", "overlap", "overlap guard, step"),
        ("velocity = [0, 0, -0.08]", "wet", "overlap", "contact.overlap_limit"),
    ],
)
def test_a_stopped_run_exits_with_3_and_its_files_can_be_read(
    motion, medium, status, message, tmp_path, monkeypatch, capsys
) -> None:
    monkeypatch.chdir(tmp_path)
    text = CASE.replace("MOTION", motion)
    if medium == "dry":
        text = re.sub(r"\[(fluid|resolution)\]\n(?:\w.*\n)+", "", text)
    (tmp_path / "case.toml").write_text(text)
    assert cli.main(["run", "case.toml", "--out", "out", "--threads", "1", "--quiet"]) == 3
    shown = " ".join(capsys.readouterr().err.split())
    assert message in shown
    assert "Traceback" not in shown
    folder = tmp_path / "out"
    summary = json.loads((folder / "summary.json").read_text())
    assert summary["status"] == status
    rows = read_table(folder / "particles.csv")
    # Rows every 10 ms up to the stop, all of them whole; the last is the state that was refused.
    assert rows["time_s"][0] == 0.0
    assert rows["time_s"][-1] == pytest.approx(summary["time_s"])
    assert len(rows["time_s"]) >= 5
    assert np.isfinite(rows["x_m"]).all()
    assert message in (folder / "run.log").read_text().replace("\n", " ")
    assert not list(folder.glob("*.tmp"))
    import vtk

    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(folder / ("bodies.vtkhdf" if medium == "dry" else "fields.vtkhdf")))
    reader.Update()
    assert reader.GetNumberOfSteps() >= 2


@pytest.mark.parametrize("other", ["wall", "body"])
def test_a_prescribed_body_driven_into_a_wall_or_a_fixed_body_stops_the_run(other: str) -> None:
    case = {
        "domain": {"size": [0.06, 0.06, 0.06], "gravity": [0, 0, 0]},
        "bodies": [
            {
                "diameter": 0.01,
                "density": 2500.0,
                "centers": [[0.03, 0.03, 0.02]],
                "motion": {"velocity": [0, 0, -0.1]},
            },
            {"diameter": 0.01, "density": 2500.0, "centers": [[0.03, 0.05, 0.03]]},
        ],
        "contact": {"restitution": 0.9, "contact_steps": 8},
        "time": {"end": 0.2, "step": 1e-3},
    }
    if other == "body":
        fixed = {"diameter": 0.01, "density": 2500.0, "centers": [[0.03, 0.03, 0.0051]], "motion": "fixed"}
        case["bodies"].append(fixed)
    sim = rdpm.Simulation(rdpm.load_case(case))
    with pytest.raises(OverlapError, match=r"overlap guard, .*: body 0 and ") as error:
        sim.run(until=0.2)
    assert ("the face z_lower" if other == "wall" else "body 2") in str(error.value)
    assert "must stay below 1 %" in str(error.value)
    travelled = 0.02 - sim.bodies.position[0, 2]
    assert travelled < (0.015 if other == "wall" else 0.0049) + 0.01 * 0.01 + 2e-4  # one step after the limit
