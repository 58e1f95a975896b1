"""Contact models by `contact.model`: keys of another model, missing ones, and what a plan makes of them."""

import json

import pytest

from rdpm.config.case import Case
from rdpm.config.load import load_case
from rdpm.contacts import ExtendedContact, Hertz
from rdpm.errors import CaseError
from rdpm.setup.plan import plan

HERTZ = {"model": "hertz", "youngs_modulus": "10 MPa", "poisson_ratio": 0.3, "restitution": 0.8}
REPULSIVE = {"model": "repulsive", "repulsion_stiffness": "1 mN"}


def text(contact, fluid=True):
    lines = ["[domain]", 'size = ["4 cm", "4 cm", "8 cm"]', "gravity = [0, 0, -9.81]", "[[bodies]]",
             'diameter = "1 cm"', "density = 1200", 'centers = [["2 cm", "2 cm", "2 cm"], ["2 cm", "2 cm", "5 cm"]]',
             "[time]", "end = 0.1", "[contact]"]  # fmt: skip
    lines += [f"{key} = {json.dumps(value)}" for key, value in contact.items()]
    if fluid:
        lines += ["[fluid]", "density = 1000", "viscosity = 0.1", "[resolution]", "cells_per_diameter = 8"]
    return "\n".join(lines) + "\n"


@pytest.fixture
def read(tmp_path):
    def load(contact, fluid=True) -> Case:
        file = tmp_path / "case.toml"
        file.write_text(text(contact, fluid), encoding="utf-8")
        return load_case(file)

    return load


@pytest.mark.parametrize(
    ("contact", "message"),
    [
        (HERTZ | {"stiffness": "5 N/m"}, 'contact.stiffness = 5.0: belongs to model = "soft-sphere"'),
        (HERTZ | {"repulsion_range": "1 mm"}, 'contact.repulsion_range = 0.001: belongs to model = "repulsive"'),
        (REPULSIVE | {"friction": 0.2}, 'contact.friction = 0.2: belongs to model = "soft-sphere" or "hertz"'),
        (REPULSIVE | {"restitution": 0.5}, 'contact.restitution = 0.5: belongs to model = "soft-sphere" or "hertz"'),
        (REPULSIVE | {"rolling_friction": 0.1},
         'contact.rolling_friction = 0.1: belongs to model = "soft-sphere" or "hertz"'),
        ({"model": "hard-sphere", "twisting_friction": 0.1},
         'contact.twisting_friction = 0.1: belongs to model = "soft-sphere" or "hertz"'),
        (REPULSIVE | {"cohesion": "50 mJ/m^2"},
         'contact.cohesion = 0.05: belongs to model = "soft-sphere" or "hertz"'),
        (HERTZ | {"cohesion": "50 mJ/m^2"}, "contact.cohesion_range: is missing with cohesion"),
        (HERTZ | {"cohesion_range": "1 um"}, "contact.cohesion_range = 1e-06: is meant for cohesion"),
        (HERTZ | {"cohesion": "50 mN"}, 'contact.cohesion = "50 mN": must be a surface energy'),
        (HERTZ | {"rolling_friction": 2}, "contact.rolling_friction = 2: must be at most 1"),
        ({"contact_steps": 8, "restitution": 0.9, "rolling_friction": 0.1, "adaptive_collision_time": True},
         "contact.adaptive_collision_time = true: must be false with rolling_friction"),
        ({"model": "hertz", "poisson_ratio": 0.3, "restitution": 0.8},
         'contact.youngs_modulus: is missing for model = "hertz"'),
        ({"model": "repulsive"}, 'contact.repulsion_stiffness: is missing for model = "repulsive"'),
    ],
)  # fmt: skip
def test_a_key_of_another_model_or_a_missing_one_is_refused(read, contact, message) -> None:
    with pytest.raises(CaseError) as error:
        read(contact)
    assert message in str(error.value)
    assert str(error.value).endswith(".")


def test_a_dry_case_needs_the_range_of_the_force(read) -> None:
    with pytest.raises(CaseError, match=r"contact\.repulsion_range: is missing in a case without \[fluid\]"):
        read(REPULSIVE, fluid=False)


def test_a_hertz_contact_has_four_steps_at_the_speed_of_the_bodies(read) -> None:
    found = plan(read(HERTZ))
    assert found.scales.fall > 0.0
    for pair in found.pairs:
        assert pair.design.impact_speed_m_s == found.scales.fall
        assert pair.design.contact_steps >= 4.0
        assert pair.design.restitution == 0.8
    assert found.step.limits["contact"] == pytest.approx(
        min(pair.design.contact_time_s for pair in found.pairs) / 4.0, rel=0.01
    )
    assert "peak overlap" in [row.name for title, rows in found.sections if "Contact" in title for row in rows]


def test_a_hertz_step_above_the_limit_is_refused(read, tmp_path) -> None:
    case = read(HERTZ)
    limit = plan(case).step.limits["contact"]
    with pytest.raises(CaseError, match=r"time\.step = .*: must be at most"):
        plan(load_case(tmp_path / "case.toml", [f"time.step={1.5 * limit}"]))


def test_the_default_range_is_two_cells(read) -> None:
    found = plan(read(REPULSIVE))
    assert found.pairs[0].design.range_m == pytest.approx(2.0 * 0.01 / 8.0, rel=0.05)
    assert found.law.interaction_range == found.pairs[0].design.range_m


def test_cohesion_is_judged_for_each_kind_of_pair(read) -> None:
    sticky = HERTZ | {"friction": 0.3, "rolling_friction": 0.1, "cohesion": "50 mJ/m^2", "cohesion_range": "10 um"}
    weak, strong = (plan(read(sticky | {"cohesion_range": well})) for well in ("10 um", "10 mm"))
    assert isinstance(weak.law, ExtendedContact)
    (rows,) = (rows for title, rows in weak.sections if title == "Contact, cohesion")
    # 3/2 pi 0.05 J/m2 times half the radius, and the radius against a wall.
    assert [row.value for row in rows if "pull-off" in row.name] == ["0.000589 N", "0.001178 N"]
    assert [row.verdict for row in rows] == [""] * 4
    (rows,) = (rows for title, rows in strong.sections if title == "Contact, cohesion")
    assert [row.verdict for row in rows if "sticking" in row.name] == ["warning"] * 2
    assert "slower impacts do not part" in rows[-1].note


def test_without_additions_a_law_is_itself(read) -> None:
    assert isinstance(plan(read(HERTZ)).law, Hertz)
