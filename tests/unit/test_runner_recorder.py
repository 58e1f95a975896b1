"""A run's folder: tables that agree with the simulation, a summary as promised, the same bytes on any threads."""

import json

import numpy as np
import pytest

import rdpm
from rdpm.io.tables import read_table
from rdpm.results.summary import read_summary
from rdpm.runs.runner import run_case

D = 0.015
CASE = {
    "title": "A sphere falls on another",
    "domain": {"size": [0.045, 0.045, 0.06]},
    "fluid": {"density": 962.0, "viscosity": 0.113},
    "bodies": [
        {"diameter": D, "density": 1120.0, "centers": [[0.0225, 0.0225, 0.008]]},
        {"diameter": D, "density": 3000.0, "centers": [[0.0235, 0.0225, 0.03]]},
    ],
    "contact": {"restitution": 0.7, "contact_steps": 8, "friction": 0.2},
    "resolution": {"cells_per_diameter": 6},
    "time": {"end": 0.3},
    "output": {"table_every": 0.01, "fields_every": 0.1, "report": False},
}
DRY = {
    "domain": {"size": [0.03, 0.03, 0.03]},
    "bodies": [{"diameter": 0.01, "density": 2500.0, "centers": [[0.015, 0.015, 0.01]]}],
    "contact": {"stiffness": 1e3, "restitution": 0.5},
    "time": {"end": 0.02},
    "output": {"report": False},
}
PROMISED = {
    "rdpm_version", "status", "cells", "spacing_m", "cells_per_diameter", "steps", "time_s", "dt_s", "dt_limit",
    "wall_s", "ns_per_cell_step", "threads", "ranks", "peak_memory_bytes", "max_divergence", "bodies", "contact",
    "contacts", "dkt",
}  # fmt: skip


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """The same case on one and on two threads."""
    made = []
    for threads in (1, 2):
        folder = tmp_path_factory.mktemp(f"threads{threads}")
        made.append((folder, run_case(rdpm.load_case(CASE), folder, threads=threads)))
    return made


def test_tables_and_fields_are_the_same_bytes_on_one_and_two_threads(runs) -> None:
    (one, _), (two, _) = runs
    for name in ("particles.csv", "contacts.csv", "history.csv", "case.toml"):
        assert (one / name).read_bytes() == (two / name).read_bytes()


def test_summary_holds_what_is_promised(runs) -> None:
    folder, summary = runs[0]
    written = json.loads((folder / "summary.json").read_text())
    assert written == json.loads(json.dumps(summary.to_dict()))
    assert read_summary(folder / "summary.json") == summary
    assert set(written) >= PROMISED
    assert summary.status == "done"
    assert summary.time_s == pytest.approx(0.3)
    assert summary.steps == round(0.3 / summary.dt_s)
    assert (summary.threads, summary.ranks) == (1, 1)
    assert set(written["contact"]) >= {"model", "ending", "contact_time_s", "contact_steps", "restitution", "pairs"}
    for pair in written["contact"]["pairs"]:
        assert set(pair) >= {"kind", "reduced_mass_kg", "stiffness_N_m", "damping_N_s_m"}
        assert pair["stiffness_N_m"] > 0.0
    assert set(written["contacts"]) >= {"count", "max_overlap_fraction", "total_time_s"}
    keys = {"kiss_time_s", "kiss_duration_s", "kisses", "tumble_time_s", "final_angle_deg"}
    assert set(written["dkt"]) >= keys
    assert summary.max_divergence < 1e-9


class Listener:
    """A reporter that keeps what it is told."""

    def __init__(self):
        self.told = []

    def start(self, plan):
        self.told.append("start")

    def update(self, step, time, end, message=""):
        pass

    def note(self, text):
        self.told.append(text)

    def finish(self, summary):
        self.told.append(summary.status)


def test_a_run_makes_its_report_once(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("rdpm.figures.report.start_rendering", lambda *_: None)
    case = rdpm.load_case(DRY, ["output.report=true", "output.video=false"])
    first, again = Listener(), Listener()
    run_case(case, tmp_path, reporter=first)
    assert first.told == ["start", "done", "figures", "report.html"]
    assert (tmp_path / "figures" / "trajectory.png").is_file()
    before = (tmp_path / "report.html").stat().st_mtime_ns
    run_case(case, tmp_path, resume=True, reporter=again)
    assert again.told == [f"{tmp_path}: the run is done, at t = 0.02 s"]
    assert (tmp_path / "report.html").stat().st_mtime_ns == before
    (tmp_path / "report.html").unlink()
    run_case(case, tmp_path, resume=True, reporter=again)
    assert again.told[-2:] == ["figures", "report.html"]


def test_particle_rows_follow_the_bodies(runs) -> None:
    folder, summary = runs[0]
    rows = read_table(folder / "particles.csv")
    assert len(rows["time_s"]) % 2 == 0
    np.testing.assert_array_equal(rows["id"], np.tile([0, 1], len(rows["time_s"]) // 2))
    times = rows["time_s"][::2]
    np.testing.assert_array_equal(times, rows["time_s"][1::2])
    # A row at the first step at or after each multiple of 10 ms, and one at the end.
    assert times[0] == 0.0
    assert times[-1] == summary.time_s
    np.testing.assert_array_less(times[:-1] - 0.01 * np.arange(len(times) - 1), summary.dt_s)
    for n, body in enumerate(summary.bodies):
        assert body.id == n
        last = [rows[name][n - 2] for name in ("x_m", "y_m", "z_m")]
        np.testing.assert_array_equal(last, body.final_position_m)
        speed = np.sqrt(sum(rows[name][n::2] ** 2 for name in ("u_m_s", "v_m_s", "w_m_s")))
        assert speed.max() <= body.max_speed_m_s * (1.0 + 1e-12)


def test_forces_in_the_rows_make_the_motion(runs) -> None:
    """Newton's law between two rows: momentum gained is the impulse of weight, fluid and contact; the fluid's force is
    that of the last step only, so it is compared where it varies slowly."""
    folder, _ = runs[0]
    rows = read_table(folder / "particles.csv")
    upper = {name: rows[name][1::2] for name in ("time_s", "w_m_s", "force_z_N", "contact_force_z_N", "gap_m")}
    mass = 3000.0 * np.pi / 6.0 * D**3
    weight = -9.81 * mass * (1.0 - 962.0 / 3000.0)
    span = np.diff(upper["time_s"])
    fluid = 0.5 * (upper["force_z_N"][1:] + upper["force_z_N"][:-1])
    gained = mass * np.diff(upper["w_m_s"]) / span
    calm = (upper["gap_m"][:-1] > 0.2 * D) & (upper["gap_m"][1:] > 0.2 * D)
    calm[0] = False
    assert calm.sum() >= 2
    np.testing.assert_allclose((gained - fluid)[calm], weight, rtol=0.05)
    assert not upper["contact_force_z_N"][1:][calm].any()


def test_the_split_of_forces_and_torques_in_the_rows_is_exact(runs) -> None:
    """m dU/dt between two rows is the sum of the means since the row before and of weight less buoyancy."""
    folder, _ = runs[0]
    rows = read_table(folder / "particles.csv")
    for n, density in enumerate((1120.0, 3000.0)):
        mass = density * np.pi / 6.0 * D**3
        span = np.diff(rows["time_s"][n::2])
        for axis, (speed, spin) in enumerate(zip(("u_m_s", "v_m_s", "w_m_s"), "xyz", strict=True)):
            weight = -9.81 * mass * (1.0 - 962.0 / density) if axis == 2 else 0.0
            parts = ("hydrodynamic", "lubrication", "collision")
            force = [rows[f"{part}_force_{spin}_N"][n::2][1:] for part in parts]
            torque = [rows[f"{part}_torque_{spin}_N_m"][n::2][1:] for part in parts]
            gained = mass * np.diff(rows[speed][n::2]) / span
            turned = 0.1 * mass * D**2 * np.diff(rows[f"omega_{spin}_rad_s"][n::2]) / span
            # Sums of some 20 steps of terms that cancel: 1e-12 of the largest.
            np.testing.assert_allclose(sum(force) + weight, gained, rtol=0, atol=1e-12 * max(np.abs(force).max(), mass))
            np.testing.assert_allclose(sum(torque), turned, rtol=0, atol=1e-12 * max(np.abs(torque).max(), mass * D))
            both = rows[f"contact_force_{spin}_N"][n::2][1:]
            np.testing.assert_allclose(force[1] + force[2], both, rtol=0, atol=1e-12 * max(np.abs(both).max(), mass))
    touching = np.abs(rows["collision_force_z_N"]) > 0.0
    assert touching.any()
    assert np.abs(rows["lubrication_force_z_N"])[~touching].max() > 0.0


def test_history_and_contacts_agree_with_the_summary(runs) -> None:
    folder, summary = runs[0]
    history, contacts = read_table(folder / "history.csv"), read_table(folder / "contacts.csv")
    assert history["step"][-1] == summary.steps
    assert (np.diff(history["time_s"]) > 0.0).all()
    assert (history["cfl"] < 1.0).all()
    assert history["divergence"].max() <= summary.max_divergence
    assert history["max_overlap_fraction"].max() == summary.contacts.max_overlap_fraction
    assert len(contacts["i"]) == summary.contacts.count >= 2
    assert contacts["duration_s"].sum() == pytest.approx(summary.contacts.total_time_s)
    assert set(contacts["kind"]) <= {"sphere-sphere", "sphere-wall"}
    assert (contacts["work_J"] <= 0.0).all()
    assert (contacts["j"] < 0).any()  # the floor
    assert (contacts["j"] >= 0).any()
    rows = read_table(folder / "particles.csv")
    energy = sum(
        0.5 * density * np.pi / 6.0 * D**3
        * (sum(rows[name][n - 2] ** 2 for name in ("u_m_s", "v_m_s", "w_m_s"))
           + 0.1 * D**2 * sum(rows[f"omega_{a}_rad_s"][n - 2] ** 2 for a in "xyz"))
        for n, density in enumerate((1120.0, 3000.0))
    )  # fmt: skip
    assert history["kinetic_energy_bodies_J"][-1] == pytest.approx(energy, rel=1e-12)


def test_timing_adds_up(runs) -> None:
    folder, summary = runs[0]
    timing = read_table(folder / "timing.csv")
    parts = sum(timing[name][-1] for name in ("momentum_s", "bodies_s", "poisson_s", "contacts_s"))
    assert 0.0 < parts <= timing["wall_s"][-1] <= summary.wall_s * (1.0 + 1e-9)
