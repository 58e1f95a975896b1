"""The time step: which limit holds, which way of diffusion is cheaper, and when things come due."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

import rdpm
from rdpm.fluid.diffusion import explicit_limit, stages_for
from rdpm.fluid.timestep import MOST_STAGES, advective_limit, choose_step
from rdpm.setup import plan
from rdpm.simulation.schedule import Every

H = (1e-3, 1e-3, 1e-3)


def test_advective_limit_sums_over_the_directions() -> None:
    assert advective_limit((0.1, 0.2, 0.4), (1.0, 2.0, -4.0), 0.5) == pytest.approx(0.5 / 30.0)
    assert advective_limit(H, (0.0, 0.0, 0.0), 0.5) == math.inf


def test_explicit_limit_is_that_of_adams_bashforth() -> None:
    # 0.85 h^2 / (12 nu) on cubic cells; the worst direction weighs most elsewhere.
    assert explicit_limit(H, 1e-4) == pytest.approx(0.85 * 1e-6 / 12e-4)
    assert explicit_limit((1e-3, 1.0, 1.0), 1e-4) == pytest.approx(0.85 * 1e-6 / 4e-4, rel=1e-5)
    assert explicit_limit(H, 0.0) == math.inf


@pytest.mark.parametrize("name", ["advective", "contact", "output"])
def test_the_least_limit_is_named(name: str) -> None:
    limits = {"advective": 1e-4, "contact": 1e-4, "output": 1e-4, name: 1e-5}
    choice = choose_step(H, 1e-6, "auto", limits)
    assert (choice.limit, choice.dt, choice.is_explicit) == (name, 1e-5, True)


def test_viscous_steps_are_taken_in_stages_when_that_is_cheaper() -> None:
    choice = choose_step(H, 1e-3, "auto", {"advective": 1e-3})
    assert not choice.is_explicit
    assert choice.stages == stages_for(choice.dt, H, 1e-3) <= MOST_STAGES
    forced = choose_step(H, 1e-3, "explicit", {"advective": 1e-3})
    assert (forced.is_explicit, forced.limit) == (True, "viscous")
    assert forced.dt < choice.dt
    assert not choose_step(H, 1e-6, "stabilised", {"advective": 1e-5}).is_explicit
    assert choose_step(H, 0.0, "auto", {"advective": 1e-3}).is_explicit


@given(st.floats(1e-7, 1e-1), st.floats(1e-7, 1.0))
def test_a_choice_never_passes_a_limit(viscosity: float, other: float) -> None:
    for diffusion in ("auto", "explicit", "stabilised"):
        choice = choose_step(H, viscosity, diffusion, {"advective": other})
        assert choice.dt <= other
        if choice.is_explicit:
            assert choice.dt <= explicit_limit(H, viscosity)
        else:
            assert choice.stages <= MOST_STAGES


@pytest.mark.parametrize("name", ["settling", "dkt", "dkt-small", "rebound", "cloud"])
def test_shipped_cases_have_a_plan(name: str) -> None:
    found = plan(rdpm.load_case(name))
    assert found.steps * found.step.dt == pytest.approx(found.case.time.end, rel=1e-3)
    assert found.step.dt <= min(found.step.limits.values()) * (1.0 + 1e-9)
    for n, (cells, length) in enumerate(zip(found.cells, found.case.domain.size, strict=True)):
        h = found.case.bodies[0].diameter / found.case.resolution.cells_per_diameter
        assert length / cells == pytest.approx(h, rel=0.03), n
    for pair in found.pairs:
        assert pair.design.contact_steps >= 4.0 - 1e-9


def test_due_times_do_not_drift() -> None:
    """Due at the first step at or after each multiple, however the steps fall; never twice, none lost."""
    every, dt = Every(0.1), 0.007
    due = [step for step in range(1000) if every.is_due(step * dt)]
    assert due == [math.ceil(n * 0.1 / dt - 1e-9) for n in range(len(due))]
    assert len(due) == 70


def test_due_once_where_a_step_passes_several_multiples() -> None:
    every = Every(0.1)
    assert [every.is_due(t) for t in (0.0, 0.35, 0.38, 0.4, 1.0, 1.05)] == [True, True, False, True, True, False]
    assert not Every(0.0).is_due(0.0)


@pytest.mark.parametrize("step", ["auto", "adaptive"])
def test_automatic_steps_continue_with_the_step_they_began_with(step: str) -> None:
    """Another end would fit other steps; contacts are tied to those of the start."""
    case = rdpm.load_case("settling", [f'time.step="{step}"'])
    began = plan(case).step
    longer = rdpm.load_case("settling", [f'time.step="{step}"', f"time.end={case.time.end * 1.013}"])
    assert plan(longer).step.dt != began.dt
    assert plan(longer, began.dt).step.dt == began.dt
    assert plan(longer, began.dt).pairs == plan(case).pairs
