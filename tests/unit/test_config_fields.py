"""What the keys of a case file are, as plain data: the same declaration checks a value and describes it."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from rdpm.config.bodies import BodyGroup, Motion
from rdpm.config.case import Case
from rdpm.config.contact import Contact
from rdpm.config.domain import Domain
from rdpm.config.fields import describe, table_of
from rdpm.config.load import load_case
from rdpm.config.numerics import Time
from rdpm.config.units import QUANTITIES

KEYS = {
    *("name", "kind", "unit", "gt", "ge", "le", "length", "count", "choices", "table", "required", "default"),
    *("left_out", "help"),
}
KINDS = {"number", "whole number", "choice", "true or false", "text", "file", "table"}


def models(model=Case):
    """The model of every table a case file may have, each once."""
    found = {model}
    for field in model.model_fields.values():
        inner = table_of(field)
        if inner is not None:
            found |= set(models(inner))
    return sorted(found, key=lambda one: one.__name__)


def keys(model):
    return {key["name"]: key for key in describe(model)}


def test_every_table_of_the_case_file_is_reached() -> None:
    assert [model.__name__ for model in models()] == [
        *("BodyGroup", "Boundary", "Case", "Contact", "Domain", "Fluid", "Gap", "Inflow", "Lattice", "Line", "Motion"),
        *("Output", "Packing", "Plane", "Resolution", "RotationTable", "Time", "VelocityTable", "Wall", "WallVelocity"),
    ]


@pytest.mark.parametrize("model", models(), ids=lambda model: model.__name__)
def test_every_key_has_kind_unit_limits_and_help(model) -> None:
    for key in describe(model):
        name = f"{model.__name__}.{key['name']}"
        assert set(key) == KEYS, name
        assert key["kind"] in KINDS, name
        assert key["help"].endswith("."), name
        if key["kind"] == "number":
            assert key["unit"] in QUANTITIES, name
        else:
            assert key["unit"] is None, name
        if key["kind"] == "choice":
            assert key["choices"], name
        if key["kind"] == "table":
            assert key["table"], name
        if key["kind"] == "whole number":
            assert key["ge"] is not None, name
            assert key["le"] is not None, name
        assert not (key["required"] and key["default"] is not None), name
        # Unit and limits are the declaration's to say, not the text's.
        assert not re.search(r"\[[\w^/ ]+\]|[<>]=?\s*\d|, optional", key["help"]), name


def test_the_description_is_plain_data() -> None:
    text = json.dumps(describe(Case), allow_nan=False)
    assert json.loads(text) == describe(Case)


@pytest.mark.parametrize("model", models(), ids=lambda model: model.__name__)
def test_what_is_described_is_what_is_checked(model) -> None:
    """A value beyond a limit that is described is refused, one at an inclusive limit passes."""
    for key in describe(model):
        field = model.model_fields[key["name"]]
        declared = next((one for one in field.metadata if hasattr(one, "check")), None)
        if key["kind"] not in ("number", "whole number") or declared is None:
            continue

        def made(value, key=key):
            value = [value] * key["length"] if key["length"] else value
            return [value] if key["count"] == "list" else value

        for limit, beyond in (("gt", 0.0), ("ge", -1), ("le", 1)):
            if key[limit] is None:
                continue
            with pytest.raises(ValueError, match="must"):
                declared.check(made(key[limit] + beyond))
            if limit != "gt":
                declared.check(made(key[limit]))


def test_kinds() -> None:
    domain, bodies, motion, time = keys(Domain), keys(BodyGroup), keys(Motion), keys(Time)
    assert domain["size"] == {
        **dict.fromkeys(("ge", "le", "table", "default")),
        **{"name": "size", "kind": "number", "unit": "m", "gt": 0.0, "length": 3, "count": "one", "choices": []},
        **{"required": True, "left_out": "", "help": "Lengths of the box; kept exactly."},
    }
    assert domain["gravity"]["default"] == [0.0, 0.0, -9.81]
    assert [key["name"] for key in domain["boundary"]["table"]] == ["x", "y", "z"]
    assert (bodies["diameter"]["count"], bodies["centers"]["count"]) == ("one or each", "list")
    assert bodies["file"]["kind"] == "file"
    assert (bodies["motion"]["choices"], len(bodies["motion"]["table"])) == (["free", "fixed"], 3)
    assert motion["rotation"]["table"][1]["unit"] == motion["rotation"]["unit"] == "rad/s"
    assert (time["step"]["choices"], time["step"]["unit"]) == (["auto", "adaptive"], "s")
    contact = keys(Contact)
    assert (contact["contact_steps"]["ge"], contact["contact_steps"]["le"]) == (4.0, 1000.0)
    assert contact["tangential_ratio"]["left_out"] == "2/7 without `poisson_ratio`"
    case = keys(Case)
    assert [name for name, key in case.items() if key["required"]] == ["domain", "time"]
    assert case["bodies"]["count"] == "list"


def test_what_holds_for_a_key_left_out_is_true() -> None:
    """The words of a default that is no constant, against a case."""
    case = load_case(
        {
            "domain": {"size": [1, 1, 1]},
            "fluid": {"density": 1, "viscosity": 1},
            "resolution": {"cells": [8, 8, 8]},
            "time": {"end": 100},
        }
    )
    said = {key["name"]: key["left_out"] for model in models() for key in describe(model)}
    assert case.output.table_every == 100 / int(said["table_every"].removeprefix("time.end / "))
    assert case.output.fields_every == 100 / int(said["fields_every"].removeprefix("time.end / "))
    for part in said["contact"].split(", "):
        name, value = part.split(" = ")
        assert getattr(case.contact, name) == float(value)
    assert case.contact.tangential_ratio == 2 / 7
    overlap = Contact(max_overlap=0.01, impact_speed=0.1)
    assert said["restitution"] == f"{overlap.restitution:g} beside `max_overlap`, and of hard spheres"
    assert said["restitution"].startswith(f"{Contact(model='hard-sphere').restitution:g} ")


def test_a_file_that_was_not_read_is_refused() -> None:
    with pytest.raises(ValueError, match="must be read first"):
        BodyGroup(diameter=1.0, density=1.0, file="bodies.csv")


def test_documented_table_has_unit_limits_and_default() -> None:
    """What the documentation writes, from its own code."""
    docs = Path(__file__).parents[2] / "docs"
    code = (
        "import from_the_code as f\n"
        "for model in ('contact.Contact', 'numerics.Time', 'output.Output', 'bodies.BodyGroup'):\n"
        "    for row in f.CaseKeys.rows(f.CaseKeys, f'rdpm.config.{model}'): print(*row, sep=' | ')\n"
    )
    pytest.importorskip("docutils")
    shown = subprocess.run([sys.executable, "-c", code], cwd=docs, capture_output=True, text=True, check=True).stdout
    for row in (
        "`stiffness` | number [N/m], > 0 |  | ",
        "`contact_steps` | number, 4 to 1000 |  | ",
        "`lubrication_roughness` | number, > 0, at most 0.1 | `0.001` | ",
        '`step` | `"auto"`, `"adaptive"` or number [s], > 0 | `"auto"` | ',
        "`table_every` | number [s], > 0 | time.end / 500 | ",
        "`diameter` | number [m], > 0, one or each | required | ",
    ):
        assert row in shown
