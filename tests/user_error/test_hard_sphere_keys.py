"""Keys of one contact model in a case of another, and what a dry case of hard spheres needs."""

import pytest

from rdpm.config.load import load_case
from rdpm.config.write import case_to_toml
from rdpm.contacts import HardSphere
from rdpm.errors import CaseError
from rdpm.setup import plan


def case(step="1 ms", **contact):
    ball = {"diameter": 0.01, "density": 2500.0, "centers": [[0.05, 0.05, 0.05]]}
    return load_case({
        "title": "ball", "domain": {"size": [0.1, 0.1, 0.1]}, "bodies": [ball], "contact": contact,
        "time": {"end": 0.1, "step": step},
    })  # fmt: skip


@pytest.mark.parametrize(
    "given",
    [{"stiffness": 1e4}, {"contact_steps": 8}, {"ending": "zero-overlap"}, {"tangential_ratio": 0.5}, {"substeps": 9}],
)
def test_keys_of_the_soft_sphere_are_refused(given):
    (name,) = given
    with pytest.raises(CaseError, match=rf'contact.{name} = .*: belongs to model = "soft-sphere".*"hard-sphere"'):
        case(model="hard-sphere", **given)


@pytest.mark.parametrize("given", [{"rest_speed": 0.1}, {"most_events": 3}, {"tangential_restitution": 0.4}])
def test_keys_of_the_hard_sphere_are_refused(given):
    with pytest.raises(CaseError, match=r"belongs to .*hard-sphere"):
        case(contact_steps=8, restitution=0.9, **given)


def test_a_dry_case_of_hard_spheres_needs_a_step():
    with pytest.raises(CaseError, match=r"time.step = .*collisions of hard spheres set no step"):
        case("auto", model="hard-sphere")


@pytest.mark.parametrize(
    ("name", "value"), [("restitution", 1.1), ("friction", -0.1), ("rest_speed", -1.0), ("most_events", 0)]
)
def test_arguments_out_of_range_are_refused(name, value):
    with pytest.raises(CaseError, match=f"contact.{name} = "):
        HardSphere(**{"restitution": 0.5, name: value})


def test_a_written_case_loads_again_and_the_plan_says_that_contacts_do_not_limit_the_step():
    import tomllib

    one = case(model="hard-sphere", restitution=0.8, rest_speed="1 mm/s")
    assert load_case(tomllib.loads(case_to_toml(one))) == one
    made = plan(one)
    assert made.step.dt == 1e-3
    assert made.law == HardSphere(0.8, rest_speed=1e-3)
    rows = dict(made.sections)["Contact, hard spheres"]
    assert any(row.value == "not limited by contacts" for row in rows)
