"""The Python interface: what a script or a notebook relies on."""

import subprocess
import sys

import numpy as np
import pytest

import rdpm
import rdpm.errors
from rdpm.fluid.diffusion import stages_for

SMALL = [
    "resolution.cells_per_diameter=4",
    "domain.size=['6 cm', '6 cm', '10 cm']",
    "bodies[0].centers=[['30.15 mm', '3 cm', '8 cm'], ['29.85 mm', '3 cm', '5 cm']]",
    "time.end=0.1",
]


def small() -> rdpm.Simulation:
    return rdpm.Simulation(rdpm.load_case("dkt", SMALL), threads=1)


def test_a_case_becomes_a_simulation_that_runs(capsys) -> None:
    case = rdpm.load_case("dkt", SMALL)
    sim = rdpm.Simulation(case)
    assert (sim.time, sim.steps) == (0.0, 0)
    sim.run(until=0.03, progress=True)
    assert sim.time == pytest.approx(0.03, abs=1.001 * sim.dt)
    assert "left" in capsys.readouterr().out
    assert sim.bodies.velocity.shape == (2, 3)
    assert (sim.bodies.velocity[:, 2] < 0.0).all()
    sim.run(until=0.03)  # nothing is left to do
    steps = sim.steps
    sim.run(until=0.05)
    assert sim.steps > steps


def test_cases_come_from_a_name_a_path_and_a_dict(tmp_path) -> None:
    case = rdpm.load_case("settling")
    path = tmp_path / "mine.toml"
    from rdpm.cases import shipped_text

    path.write_text(shipped_text("settling"))
    assert rdpm.load_case(path) == rdpm.load_case(str(path)) == case
    assert rdpm.load_case({"domain": {"size": [1, 1, 1]}, "fluid": {"density": 1.0, "viscosity": 1.0},
                           "resolution": {"cells": [4, 4, 4]}, "time": {"end": 1.0}}).fluid.nu == 1.0  # fmt: skip


def test_fields_are_the_arrays_of_the_kernels_all_of_one_shape() -> None:
    sim = small()
    fields = {name: getattr(sim.fluid, name) for name in "uvwp"}
    nx, ny, nz = sim.fluid.grid.cells
    assert {q.shape for q in fields.values()} == {(nz + 2, ny + 2, nx + 2)}
    pointers = {name: q.ctypes.data for name, q in fields.items()}
    before = fields["w"].copy()
    position, velocity = sim.bodies.position, sim.bodies.velocity
    sim.run(until=0.02)
    # The same memory after steps, and what is written into it is what the next step starts from.
    assert pointers == {name: getattr(sim.fluid, name).ctypes.data for name in "uvwp"}
    assert sim.bodies.position is position
    assert sim.bodies.velocity is velocity
    assert (fields["w"] != before).any()
    sim.fluid.u[...] = 0.0
    sim.fluid.v[...] = 0.0
    sim.fluid.w[...] = 0.0
    sim.bodies.velocity[0, 0] = 1e-3
    x = position[0, 0]
    sim.advance()
    assert position[0, 0] > x


def test_bodies_have_the_shapes_promised() -> None:
    b = small().bodies
    assert b.position.shape == b.velocity.shape == b.angular_velocity.shape == (2, 3)
    assert b.orientation.shape == (2, 4)
    assert b.diameter.shape == b.density.shape == b.mass.shape == (2,)
    assert b.mass[0] == pytest.approx(1120.0 * np.pi / 6.0 * 0.015**3)


def test_callbacks_are_called_every_so_many_steps_in_their_order() -> None:
    sim = small()
    called = []
    sim.on_step(lambda s: called.append(("each", s.steps)))
    sim.on_step(lambda s: called.append(("third", s.steps)), every=3)
    for _ in range(6):
        sim.advance()
    assert called == [("each", 1), ("each", 2), ("each", 3), ("third", 3),
                      ("each", 4), ("each", 5), ("each", 6), ("third", 6)]  # fmt: skip
    with pytest.raises(ValueError, match="every = 0: must be at least 1"):
        sim.on_step(print, every=0)


def test_progress_may_be_a_function() -> None:
    sim, told = small(), []
    sim.run(until=0.02, progress=lambda step, time, until: told.append((step, time, until)))
    assert [step for step, _, _ in told] == list(range(1, sim.steps + 1))
    assert told[-1][1:] == (sim.time, 0.02)


def test_a_run_in_two_parts_is_the_run_in_one() -> None:
    whole, parts = small(), small()
    steps = round(0.06 / whole.dt)
    whole.run(until=steps * whole.dt)
    for n in (steps // 5, steps // 2, steps):  # after whole steps: a run ends at the time it is given
        parts.run(until=n * parts.dt)
    assert parts.steps == whole.steps
    np.testing.assert_array_equal(parts.bodies.position, whole.bodies.position)
    np.testing.assert_array_equal(parts.fluid.w, whole.fluid.w)


def test_design_is_there_and_agrees_with_the_plan() -> None:
    sim = small()
    pair = sim.plan.pairs[0].design
    again = rdpm.design.soft_sphere(
        mass=float(sim.bodies.mass[0]) / 2.0, restitution=0.5, contact_steps=8, time_step=sim.dt
    )
    assert pair.stiffness_N_m == pytest.approx(again.stiffness_N_m, rel=1e-9)
    assert rdpm.design.soft_sphere(mass=1e-3, restitution=0.8, stiffness=1e2).contact_time_s > 0.0


def test_the_public_names_are_those_promised() -> None:
    assert set(rdpm.__all__) == {"Simulation", "Study", "design", "load_case", "results", "run"}
    with pytest.raises(AttributeError, match="has no attribute 'Simulatoin'"):
        rdpm.Simulatoin  # noqa: B018


def test_importing_is_light() -> None:
    """What a script does not use is not loaded."""
    code = (
        "import sys, rdpm, rdpm.cli.main\n"
        "heavy = {'numpy', 'matplotlib', 'pyvista', 'vtk', 'pint', 'scipy', 'h5py', 'pydantic'} & set(sys.modules)\n"
        "assert not heavy - {'numpy'}, heavy"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_a_dry_case_has_no_fluid() -> None:
    sim = rdpm.Simulation(
        rdpm.load_case(
            {
                "domain": {"size": [0.1, 0.1, 0.1]},
                "bodies": [{"diameter": 0.01, "density": 2500.0, "centers": [[0.05, 0.05, 0.05]]}],
                "contact": {"restitution": 0.9, "contact_steps": 10},
                "time": {"end": 0.05, "step": 1e-3},
            }
        )
    )
    assert sim.fluid is None
    sim.run(until=0.05)
    # Free fall, held force and mid-point drift: exact.
    assert sim.bodies.position[0, 2] == pytest.approx(0.05 - 0.5 * 9.81 * 0.05**2, rel=1e-12)


def test_stages_grow_with_the_root_of_the_step() -> None:
    h, nu = (1e-3,) * 3, 1e-4
    euler = 1e-6 / (6.0 * nu)
    for stages in range(2, 12):
        longest = 0.85 * euler * (stages**2 + stages - 2) / 4.0
        assert stages_for(0.999 * longest, h, nu) == stages
        assert stages_for(1.001 * longest, h, nu) == stages + 1


BEAD = {
    "domain": {"size": [0.1, 0.1, 0.1]},
    "bodies": [{"diameter": 0.01, "density": 2500.0, "centers": [[0.05, 0.05, 0.006]]}],
    "contact": {"restitution": 0.9, "contact_steps": 10},
    "time": {"end": 0.1, "step": 1e-3},
    "output": {"report": False},
}


def test_a_run_from_python_makes_the_folder_of_the_command(tmp_path) -> None:
    times: list[float] = []
    found = rdpm.run(rdpm.load_case(BEAD), tmp_path / "made" / "here", on_step=lambda sim: times.append(sim.time))
    assert len(times) == found.summary.steps == 100
    from rdpm.config.load import case_to_toml

    (tmp_path / "bead.toml").write_text(case_to_toml(rdpm.load_case(BEAD)))
    from rdpm.cli import main as cli

    assert cli.main(["run", str(tmp_path / "bead.toml"), "--out", str(tmp_path / "other"), "--quiet"]) == 0
    here, other = ({p.relative_to(f).as_posix() for p in f.rglob("*")} for f in (found.folder.path, tmp_path / "other"))
    assert here == other
    for name in ("particles.csv", "contacts.csv", "history.csv", "case.toml"):
        assert (found.folder.path / name).read_bytes() == (tmp_path / "other" / name).read_bytes()
    with pytest.raises(rdpm.errors.CaseError, match="must be new or empty"):
        rdpm.run(BEAD, found.folder.path)


def test_results_are_pandas_and_xarray(tmp_path) -> None:
    changes = ["time.end=0.02", "output.fields_every=0.01", "output.report=false"]
    rdpm.run(rdpm.load_case("dkt", [*SMALL, *changes]), tmp_path / "run")
    found = rdpm.results.open(tmp_path / "run")
    assert list(found.particles["id"].iloc[:2]) == [0, 1]
    assert found.history["time_s"].iloc[-1] == pytest.approx(0.02)
    assert found.fields.sizes["time"] > 1
    last = found.fields.isel(time=-1)
    assert last["velocity"].dims == ("z", "y", "x", "component")
    assert last["pressure"].sizes == {"z": len(last.z), "y": len(last.y), "x": len(last.x)}
    assert float(last.x[0]) == pytest.approx(0.5 * float(last.x[1] - last.x[0]))
    assert float(last["velocity"].sel(component="z").min()) < 0.0
    with pytest.raises(rdpm.errors.CaseError, match="must be the folder of a run"):
        rdpm.results.open(tmp_path)


def test_cases_are_changed_by_keys_and_tables() -> None:
    case = rdpm.load_case("dkt", {"contact.restitution": 0.8, "bodies[0].density": "1200 kg/m^3"})
    assert (case.contact.restitution, case.bodies[0].density) == (0.8, 1200.0)
    other = case.replace({"fluid.viscosity": "0.2 Pa s"}, title="thicker")
    assert (other.fluid.viscosity, other.title, other.contact) == (0.2, "thicker", case.contact)
    assert case.fluid.viscosity == 0.113
    with pytest.raises(rdpm.errors.CaseError, match=r"contact\.restitution = 1\.5"):
        case.replace({"contact.restitution": 1.5})
    with pytest.raises(rdpm.errors.CaseError, match=r"fluid\.viscosty"):
        rdpm.load_case("dkt", {"fluid.viscosty": 1.0})


def test_a_path_where_a_case_is_wanted(tmp_path) -> None:
    from rdpm.config.load import case_to_toml

    path = tmp_path / "bead.toml"
    path.write_text(case_to_toml(rdpm.load_case(BEAD)))
    assert rdpm.Simulation(path).case == rdpm.Simulation(str(path)).case == rdpm.Simulation(BEAD).case
