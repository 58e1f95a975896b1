"""Inflow and outflow where they are wrong: place, value, rule, cure."""

import pytest

from rdpm.cases import shipped_text
from rdpm.config.load import load_case
from rdpm.errors import CaseError

BOUNDARY = 'boundary = { x = "inflow-outflow", y = "free-slip", z = "free-slip" }'
VELOCITY = 'velocity = "0.1 m/s" '

WRONG = [
    (BOUNDARY, "", ":11: domain.inflow: must be left out where no boundary is"),
    (
        BOUNDARY,
        BOUNDARY.replace("free-slip", "inflow-outflow"),
        ':8: domain.boundary.y = "inflow-outflow": must be "infl',
    ),
    ("[domain.inflow]", "[domain.inflow_]", ":11: domain.inflow_: unknown key. Did you mean"),
    (VELOCITY, "velocity = 0 #", ":12: domain.inflow.velocity = 0: must not be 0 (nothing would enter)."),
    (VELOCITY, 'velocity = "3 m" #', ':12: domain.inflow.velocity = "3 m": must be a velocity'),
    (VELOCITY, "#", ":11: domain.inflow.velocity: is missing."),
    (VELOCITY, "velocity = [0.1, 0, 0] #", ":12: domain.inflow.velocity = "),
    (
        '"uniform"',
        '"parabolic"',
        ':13: domain.inflow.profile = "parabolic": must not be parabolic without no-slip walls',
    ),
    ('"uniform"', '"flat"', ':13: domain.inflow.profile = "flat": must be "uniform" or "parabolic"'),
    ('"uniform"', "[]", ":13: domain.inflow.profile: must have rows of one length"),
    ('"uniform"', "[[1, 2], [1]]", ":13: domain.inflow.profile: must have rows of one length"),
    ('"uniform"', "[0, 0]", ":13: domain.inflow.profile: must not be 0 everywhere"),
    ('"uniform"', "[1, -1]", ":13: domain.inflow.profile[0][1] = -1: must not be negative."),
    ('"uniform"', '[[1, "2 m"]]', ':13: domain.inflow.profile[0][1] = "2 m": must be a plain number'),
    ('start_up = "0.1 s"', 'start_up = "-1 s"', ':14: domain.inflow.start_up = "-1 s": must not be negative.'),
    ("[fluid]", "[fluid]\nbody_force = [1, 0, 0]", ":17: fluid.body_force: must have no x component along the inflow"),
    ("[fluid]", "[fluid]\npressure_gradient = [1, 0, 0]", ":17: fluid.pressure_gradient: must have no x component"),
    (
        "[fluid]",
        "[fluid]\nzero_mean_flow = true",
        ":17: fluid.zero_mean_flow = true: must not be true where a boundary",
    ),
    (BOUNDARY, BOUNDARY.replace("outflow", "outlet"), ':8: domain.boundary.x = "inflow-outlet": must be "periodic" or'),
]


@pytest.mark.parametrize(("old", "new", "said"), WRONG)
def test_message(old, new, said, tmp_path):
    text = shipped_text("stream")
    assert old in text
    path = tmp_path / "case.toml"
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(CaseError) as refused:
        load_case(path)
    assert str(refused.value).startswith(f"{path}{said}")


def test_an_inflow_is_missing():
    case = {"domain": {"size": [1, 1, 1], "boundary": {"x": "inflow-outflow"}}, "time": {"end": 1}}
    with pytest.raises(CaseError, match=r"^domain\.inflow: is missing with boundary\.x .*Add \[domain\.inflow\]"):
        load_case(case)


def test_only_a_fluid_flows_in():
    case = {
        "domain": {"size": [1, 1, 1], "boundary": {"x": "inflow-outflow"}, "inflow": {"velocity": 1}},
        "bodies": [{"diameter": 0.1, "density": 1000, "centers": [[0.5, 0.5, 0.5]]}],
        "time": {"end": 1, "step": 0.01},
    }
    with pytest.raises(CaseError, match=r"^domain\.inflow: must be left out in a case without \[fluid\]"):
        load_case(case)


def test_walls_within_the_box_are_refused():
    wall = {"shape": "plane", "point": [0, 0, 0.002], "normal": [0, 0, 1]}
    said = r"^walls: (walls: )?must be left out with domain\.inflow .*Use the boundaries beside"
    with pytest.raises(CaseError, match=said):
        load_case("stream").replace({"walls": [wall]})


@pytest.mark.parametrize(
    ("given", "held"),
    [("uniform", "uniform"), ([1, 2, 1], ((1.0, 2.0, 1.0),)), ([[0, 1], [1, 2]], ((0.0, 1.0), (1.0, 2.0)))],
)
def test_profiles_that_are_taken(given, held):
    case = load_case("stream")
    changed = case.replace({"domain.inflow.profile": given})
    assert changed.domain.inflow.profile == held
