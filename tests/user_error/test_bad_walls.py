"""Walls within the box: what is refused, with place, rule and cure."""

import pytest

from rdpm.config.load import load_case
from rdpm.errors import CaseError
from rdpm.setup.plan import plan

PLANE = {"shape": "plane", "point": [0, 0, 0.01], "normal": [1, 0, 2]}
TUBE = {"shape": "cylinder", "point": [0.02, 0.02, 0], "axis": [0, 0, 1], "diameter": 0.03}


def case(wall, model="soft-sphere", boundary=None, wet=False):
    contact = {"model": model, "restitution": 0.8} | ({} if model == "hard-sphere" else {"stiffness": 100.0})
    fluid = {"fluid": {"density": 1000, "viscosity": 0.1}, "resolution": {"cells_per_diameter": 8}} if wet else {}
    return {
        "domain": {"size": [0.04, 0.04, 0.08], "boundary": boundary or {}},
        "walls": [wall],
        "bodies": [{"diameter": 0.01, "density": 1200, "centers": [[0.02, 0.02, 0.05]]}],
        "contact": contact,
        "time": {"end": 0.1, "step": 1e-4},
        **fluid,
    }


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (case(PLANE | {"shape": "cone"}), 'walls[0].shape = "cone": must be "plane" or "cylinder"'),
        (case(PLANE | {"diameter": 0.1}), 'walls[0].diameter = 0.1: belongs to shape = "cylinder"'),
        (case(TUBE | {"normal": [0, 0, 1]}), 'walls[0].normal = [0.0, 0.0, 1.0]: belongs to shape = "plane"'),
        (case({"shape": "plane", "point": [0, 0, 0]}), 'walls[0].normal: is missing for shape = "plane"'),
        (case(PLANE | {"normal": [0, 0, 0]}), "walls[0].normal = [0.0, 0.0, 0.0]: must not be zero"),
        (
            case(PLANE | {"velocity": [0, 0, 1]}),
            "walls[0].velocity = [0.0, 0.0, 1.0]: must have no part along the normal",
        ),
        (case(TUBE | {"velocity": [1, 0, 0]}), "walls[0].velocity = [1.0, 0.0, 0.0]: must be along the axis"),
        (case(PLANE, boundary={"x": "periodic"}), "must be at right angles to the periodic direction x"),
        (case(TUBE | {"axis": [0, 1, 2]}, boundary={"z": "periodic"}), "must be along, or at right angles to,"),
        (case(TUBE | {"diameter": 0.008}), "must not overlap wall 0: body 0 has a gap of -0.001 m"),
        (case(PLANE | {"normal": [-1, 0, -2]}), "must not overlap wall 0"),
        (case(TUBE, model="hard-sphere"), 'walls[0].side = "inside": must be "outside" with contact.model'),
    ],
)
def test_a_wrong_wall_is_refused(given, message) -> None:
    with pytest.raises(CaseError) as caught:
        load_case(given)
    assert message in str(caught.value)


def test_walls_are_a_list() -> None:
    with pytest.raises(CaseError, match=r"Write \[\[walls\]\]"):
        load_case(case(PLANE) | {"walls": PLANE})


def test_a_turning_tube_needs_room_for_the_fluid_behind_it() -> None:
    """Four cells of 1.25 mm behind 15 mm do not fit into 20 mm; a tube at rest may be that near, and a dry one."""
    turning = TUBE | {"angular_velocity": 1.0, "diameter": 0.035}
    with pytest.raises(CaseError, match=r"walls\[0\].diameter = 0.035: must leave 4 cells"):
        plan(load_case(case(turning, wet=True)))
    plan(load_case(case(turning)))
    plan(load_case(case(turning | {"angular_velocity": 0.0}, wet=True)))


def test_a_packing_leaves_the_walls_free() -> None:
    given = case(TUBE)
    given["bodies"] = [{"diameter": 0.004, "density": 1200, "packing": {"count": 60, "seed": 3}}]
    bodies = load_case(given).expanded_bodies()
    from_axis = ((bodies.position[:, :2] - 0.02) ** 2).sum(axis=1) ** 0.5
    assert from_axis.max() < 0.015 - 0.002
