"""Cases: loading, defaults, alternatives, overrides, and writing back."""

import tomllib

import numpy as np
import pytest

import rdpm
from rdpm.cases import shipped_names, shipped_text
from rdpm.config.bodies import Gap, VectorTable
from rdpm.config.load import case_name, case_to_toml, load_case
from rdpm.errors import CaseError

DRY = {
    "domain": {"size": [1, 1, 1]},
    "bodies": [{"diameter": "10 cm", "density": 2500, "centers": [[0.5, 0.5, 0.2]]}],
    "contact": {"stiffness": 1000, "restitution": 0.9},
    "time": {"end": 1},
}


@pytest.mark.parametrize("name", shipped_names())
def test_shipped_case_loads_and_survives_writing(name, tmp_path):
    case = rdpm.load_case(name)
    assert case.title
    text = case_to_toml(case)
    assert load_case(tomllib.loads(text)) == case
    (tmp_path / "again.toml").write_text(text)
    assert load_case(tmp_path / "again.toml") == case
    assert case_to_toml(load_case(tmp_path / "again.toml")) == text


def test_numbers_are_plain_si():
    case = load_case("dkt")
    assert case.domain.size == (0.1, 0.1, 0.5)
    assert case.fluid.mu == 0.113
    assert case.fluid.nu == 0.113 / 962
    assert case.bodies[0].centers[0] == (0.05015, 0.05, 0.47)
    assert case.contact.way == "contact-steps"
    assert type(case.contact.contact_steps) is float


def test_ten_cate_start():
    case = load_case("settling")
    bottom = case.bodies[0].centers[0][2] - case.bodies[0].diameter / 2
    assert abs(bottom - 0.120) < 1e-15


def test_rebound_is_released_by_a_gap_at_its_speed():
    motion = load_case("rebound").bodies[0].motion
    assert motion.until == Gap(gap=0.0015)
    fall, speed, dt = 0.0, 0.0, 1e-4
    time = 0.0
    while fall < 0.064:  # from 67 mm to the centre's height at a gap of one radius
        speed = -motion.velocity_at(time + dt / 2)[2]
        fall, time = fall + speed * dt, time + dt
    stokes = 7800 * 0.003 * speed / (9 * 0.010)
    assert abs(stokes - 152) < 0.01 * 152  # what the case says of its shorter box


def test_defaults():
    case = load_case({**DRY, "output": {}})
    assert case.fluid is None
    assert case.resolution is None
    assert case.contact.lubrication is False  # no film without a fluid
    assert case.contact.tangential_ratio == 2 / 7
    assert case.domain.gravity == (0.0, 0.0, -9.81)
    assert case.output.table_every == 1 / 500
    assert not case.zero_mean_flow
    wet = load_case(
        {
            **DRY,
            "contact": {"contact_steps": 8, "restitution": 0.5},
            "fluid": {"density": 1000, "viscosity": 1},
            "resolution": {"cells": [60, 60, 60]},
        }
    )
    assert wet.contact.lubrication is True
    del (silent := dict(DRY))["contact"]
    contact = load_case(silent, ["time.step=1 ms"]).contact
    assert (contact.contact_steps, contact.restitution) == (8.0, 0.9)


@pytest.mark.parametrize(
    ("contact", "way"),
    [
        ({"contact_steps": 8, "restitution": 0.5}, "contact-steps"),
        ({"stiffness": "5e4 dyn/cm", "damping": "100 dyn s/cm"}, "stiffness-damping"),
        ({"stiffness": 50, "restitution": 0.5}, "stiffness-restitution"),
        ({"max_overlap": "0.5 %", "impact_speed": "5 cm/s"}, "max-overlap"),
        ({"max_overlap": 0.005, "impact_speed": 0.05, "restitution": 0.8}, "max-overlap"),
    ],
)
def test_four_ways_to_a_contact(contact, way):
    case = load_case({**DRY, "contact": contact, "time": {"end": 1, "step": "1 ms"}})
    assert case.contact.way == way
    assert case.contact.restitution == contact.get("restitution", 0.9 if way == "max-overlap" else None)


def test_mean_flow_is_zero_where_bodies_settle_in_a_periodic_box():
    assert load_case("cloud", ["fluid={density=962, viscosity=0.113}"]).zero_mean_flow
    assert not load_case("cloud", ["fluid.zero_mean_flow=false"]).zero_mean_flow
    assert not load_case("cloud", ["fluid={density=962, viscosity=0.1, body_force=[0, 0, 1]}"]).zero_mean_flow
    assert not load_case("dkt").zero_mean_flow


def test_pressure_gradient_accelerates_against_itself():
    fluid = load_case("dkt", ['fluid={density=500, viscosity=1, pressure_gradient=["10 Pa/m", 0, 0]}']).fluid
    assert fluid.acceleration == (-0.02, 0.0, 0.0)


def test_overrides():
    case = load_case(
        "dkt",
        [
            "bodies[0].density=1150",
            "fluid.viscosity=100 mPa s",
            "time.end=2",
            "bodies[0].centers[1][2]='430 mm'",
            "output.video=false",
            "title=other",
        ],
    )
    assert case.bodies[0].density == 1150.0
    assert case.fluid.viscosity == 0.1
    assert case.time.end == 2.0
    assert case.bodies[0].centers[1][2] == 0.43
    assert case.output.video is False
    assert case.title == "other"


def test_a_dict_is_not_changed():
    before = {**DRY, "domain": {"size": [1, 1, 1]}}
    load_case(before, ["domain.size=[2, 2, 2]", "fluid.density=1"][:1])
    assert before["domain"]["size"] == [1, 1, 1]


def test_arrays_are_lists():
    case = load_case({**DRY, "domain": {"size": np.array([1.0, 2.0, 3.0])}})
    assert case.domain.size == (1.0, 2.0, 3.0)


def test_frozen():
    with pytest.raises(ValueError, match="frozen"):
        load_case("dkt").time.end = 3.0


def test_names():
    assert case_name("dkt") == "dkt"
    assert case_name("a/b.toml") == "b"
    with pytest.raises(KeyError):
        shipped_text("nothing")


def test_table_of_velocities_is_linear_and_constant_outside():
    table = VectorTable(times=(1.0, 2.0, 4.0), values=((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 0.0, -4.0)))
    assert table.at(0.0) == (0.0, 0.0, 0.0)
    assert table.at(1.5) == (0.5, 0.0, 0.0)
    assert table.at(3.0) == (1.0, 0.0, -2.0)
    assert table.at(9.0) == (1.0, 0.0, -4.0)


def test_title_with_any_character_survives():
    title = 'quote " back \\ tab \t newline \n bell \a é 漢 \U0001f600'
    case = load_case({**DRY, "title": title})
    assert tomllib.loads(case_to_toml(case))["title"] == title


def test_unknown_override_names_itself():
    with pytest.raises(
        CaseError, match=r'^--set fluid\.viscocity: unknown key\. Did you mean "viscosity"\?$'
    ):
        load_case("dkt", ["fluid.viscocity=1"])
