"""Values that are possible but hardly meant are warned of, with the figure that makes them absurd and a hint."""

import re

import pytest

import rdpm
from rdpm.cases import shipped_names
from rdpm.setup import plan

ABSURD = [
    ("settling", ["domain.gravity=[0, 0, -981]"], r"domain\.gravity = 981 m/s\^2: 100 times .*meant in cm/s\^2\?"),
    ("settling", ["domain.gravity=[0, 0, -9810]"], r"domain\.gravity = 9810 m/s\^2: 1000 times .*in mm/s\^2\?"),
    ("settling", ["domain.gravity=[0, 0, -500]"], r"domain\.gravity = 500 m/s\^2: 50\.97 times .*; is it in m/s\^2\?"),
    ("settling", ["domain.gravity=[0, 0, -9.81e-3]"], r"domain\.gravity = 0\.00981 m/s\^2: 0\.001 times .*km/s\^2\?"),
    (
        "cloud",
        ["domain.size=[90, 90, 90]", "bodies[0].diameter=15", "bodies[0].lattice.spacing=[30, 30, 30]",
         "bodies[0].lattice.jitter=0"],
        r"bodies\[0\]\.diameter = 15 m: a sphere of metres; was it meant in mm or cm\?",
    ),
    (
        "settling",
        ["output.fields_every=1e-9"],
        r"output\.fields_every = 1e-09 s: \S+ pictures, of which a run of \S+ steps makes one a step, up to \S+ GB; ",
    ),
    ("settling", ["output.table_every=1e-9"], r"output\.table_every = 1e-09 s: \S+ rows, of which .*another unit"),
    ("settling", ["output.checkpoint_every=1e-6"], r"output\.checkpoint_every = 1e-06 s: \S+ files"),
    ("settling", ["time.end=1e9"], r"time\.end = 1e\+09 s: \S+ steps, about \S+ years on one thread; was it meant"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "changes", "message"), ABSURD)
def test_absurd_value_is_warned_of_with_its_figure(name, changes, message) -> None:
    warnings = plan(rdpm.load_case(name, changes)).warnings
    assert any(re.match(message, warning) for warning in warnings), warnings


def test_figures_are_those_of_the_case() -> None:
    found = plan(rdpm.load_case("settling", ["output.fields_every=1e-9", "output.fields_tolerance=0"]))
    warning = next(text for text in found.warnings if text.startswith("output.fields_every"))
    count, steps, size = (float(text) for text in re.findall(r"(\S+) (?:pictures|steps|GB)", warning))
    nx, ny, nz = found.cells
    assert count == pytest.approx(found.case.time.end * 1e9, rel=1e-2)
    assert steps == pytest.approx(found.steps, rel=1e-2)
    assert size == pytest.approx(found.steps * 16e-9 * nx * ny * nz, rel=1e-2)


@pytest.mark.parametrize("name", shipped_names())
def test_shipped_cases_have_no_such_value(name) -> None:
    assert "Values hardly meant" not in dict(plan(rdpm.load_case(name)).sections)


@pytest.mark.parametrize("gravity", [0.0, -1.62, -24.8])
def test_other_places_are_no_mistake(gravity) -> None:
    made = plan(rdpm.load_case("settling", [f"domain.gravity=[0, 0, {gravity}]"]))
    assert not any(text.startswith("domain.gravity") for text in made.warnings)
