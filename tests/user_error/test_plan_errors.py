"""What a case alone cannot tell: time steps above their limits, grids that do not fit, contacts that are too short."""

import re
import sys

import pytest

import rdpm
from builders import oil_case
from rdpm.cli import main as cli
from rdpm.errors import CaseError
from rdpm.setup import plan, scales


def case(**changes):
    return rdpm.load_case(oil_case(**changes))



def test_step_over_which_the_flow_crosses_more_than_a_cell_is_refused() -> None:
    rule = r"^time\.step = 0\.4 s: must be at most 0\.0\d+ s \(the flow would cross more than a cell in a step\)"
    with pytest.raises(CaseError, match=rule) as error:
        plan(case(time__step=0.4))
    assert 'Lower it, or use "auto".' in str(error.value)


def test_step_above_the_limit_of_explicit_diffusion_is_refused_when_it_is_forced() -> None:
    rule = r"^time\.step = 0\.01 s: .* \(the limit of explicit diffusion on this grid\)"
    with pytest.raises(CaseError, match=rule) as error:
        plan(case(time__step=0.01, time__diffusion="explicit"))
    assert str(error.value).endswith('Lower it, or set time.diffusion = "auto".')
    limit = float(re.search(r"at most (\S+) s", str(error.value)).group(1))
    # The message's own number, three digits of it, is accepted.
    assert plan(case(time__step=0.99 * limit, time__diffusion="explicit")).step.is_explicit
    # Left to itself, the case takes the same step in stages.
    assert not plan(case(time__step=0.01)).step.is_explicit


def test_step_beyond_the_most_stages_is_refused() -> None:
    heavy_oil = {"fluid__viscosity": 100.0, "time__step": 1e-3}
    with pytest.raises(CaseError, match=r"\(the limit of stabilised diffusion on this grid\)\. Lower it\.$"):
        plan(case(**heavy_oil))


def test_step_between_the_share_and_the_whole_of_a_cell_is_taken() -> None:
    """time.cfl is for automatic steps."""
    thin = {"fluid__viscosity": 0.02, "time__cfl": 0.3}
    automatic = plan(case(**thin, contact__contact_steps=4))
    asked = automatic.step.limits["advective"] * 1.5
    assert plan(case(**thin, time__step=asked)).step.limit == "user"


@pytest.mark.parametrize(
    "way",
    [
        {"stiffness": 1e5, "damping": 0.0},
        {"stiffness": 1e5, "restitution": 0.9},
        {"max_overlap": 0.001, "impact_speed": 0.2, "restitution": 0.9},
    ],
)
def test_a_step_above_the_contact_limit_is_refused_and_an_automatic_one_has_four_a_contact(way) -> None:
    rule = r"^time\.step = 0\.005 s: must be at most .* s \(the shortest contact"
    with pytest.raises(CaseError, match=rule) as error:
        plan(case(contact=way, time__step=5e-3))
    assert str(error.value).endswith('needs 4 steps). Lower it, use "auto", or give a softer contact.')
    found = plan(case(contact=way))
    assert found.step.limit == "contact"
    shortest = min(pair.design.contact_time_s for pair in found.pairs)
    assert found.step.dt <= shortest / 4.0 * (1.0 + 1e-9)
    assert found.step.dt > shortest / 5.0


def test_a_step_below_the_contact_limit_stays_as_asked() -> None:
    found = plan(case(contact={"stiffness": 1e3, "restitution": 0.9}, time__step=1e-5))
    assert (found.step.dt, found.step.limit) == (1e-5, "user")


def test_grid_that_does_not_fit_the_memory_is_refused_before_anything_is_allocated() -> None:
    rule = r"^resolution\.cells_per_diameter = 900(\.0)?: must lead to a grid of at most .* GB \("
    with pytest.raises(CaseError, match=rule) as error:
        plan(case(resolution__cells_per_diameter=900))
    assert "cells need" in str(error.value)
    assert str(error.value).endswith("Lower it, or shorten the box.")
    with pytest.raises(CaseError, match=r"^resolution\.cells = \[20000, 20000, 20000\]: must lead to a grid"):
        plan(case(resolution={"cells": [20000, 20000, 20000]}))


def test_memory_is_judged_by_what_is_free(monkeypatch) -> None:
    module = sys.modules["rdpm.setup.plan"]  # the package's name `plan` is the function
    monkeypatch.setattr(module, "available_memory", lambda: 1_000_000)
    with pytest.raises(CaseError, match=r"at most 0\.0009 GB"):
        plan(case())


def test_memory_is_foreseen() -> None:
    """What a plan says is what the arrays take, for explicit and for stabilised diffusion."""
    for diffusion in ("explicit", "stabilised"):
        made = case(time__diffusion=diffusion, time__step=1e-3)
        sim = rdpm.Simulation(made, threads=1)
        sim.run(until=1e-3)
        fields = sim.fluid.bytes
        markers = scales.BYTES_PER_MARKER * len(sim.system.immersed.markers)
        # The estimate covers the buffers of a few threads: up to a fifth more than one thread takes of a small grid.
        assert 0.0 <= (sim.plan.memory - markers) / fields - 1.0 < 0.2


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--set", "time.step=0.4"], "time.step = 0.4 s: must be at most"),
        (["--set", "resolution.cells_per_diameter=900"], "resolution.cells_per_diameter = 900"),
    ],
)
@pytest.mark.parametrize("verb", ["run", "check"])
def test_command_refuses_with_one_line_and_writes_nothing(verb, words, message, tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    assert cli.main([verb, "settling", *words]) == 2
    shown = capsys.readouterr()
    assert message in " ".join(shown.err.split())
    assert "Traceback" not in shown.err
    assert list(tmp_path.iterdir()) == []
