"""The rules by which a tuning chooses, on made-up tables; options that are refused."""

import math

import pytest

from rdpm.errors import CaseError
from rdpm.studies.spread import Spread
from rdpm.studies.tuning.choice import choose_step, choose_window, differs
from rdpm.studies.tuning.options import TuneOptions


def steps(*values, status="done"):
    """A table of steps of 8, 4, 2, 1 ms."""
    return [{"dt_s": dt, "status": status if value is None else "done", "value": value}
            for dt, value in zip((8e-3, 4e-3, 2e-3, 1e-3), values, strict=True)]  # fmt: skip


def test_the_longest_step_that_agrees_with_all_finer_ones_is_taken():
    choice = choose_step(steps(1.30, 1.02, 1.005, 1.0), 0.01)
    assert (choice.dt_s, choice.is_converged, choice.has_room) == (2e-3, True, True)
    assert choice.change == pytest.approx(0.005)


def test_a_step_that_agrees_by_chance_is_not_taken():
    # 8 ms has the value of the finest; 4 ms shows that this means nothing.
    assert choose_step(steps(1.0, 1.2, 1.005, 1.0), 0.01).dt_s == 2e-3


def test_an_unstable_step_is_passed_over():
    assert choose_step(steps(None, 1.002, 1.001, 1.0, status="stopped"), 0.01).dt_s == 4e-3
    assert choose_step(steps(1.0, 1.0, None, None, status="stopped"), 0.01).dt_s == 8e-3
    assert choose_step(steps(None, None, None, None, status="stopped"), 0.01) is None


def test_a_run_without_the_event_has_no_say():
    assert choose_step(steps(None, 1.0, 1.0, 1.0), 0.01).dt_s == 4e-3


def test_nothing_converged_gives_the_finest_and_says_so():
    choice = choose_step(steps(1.6, 1.4, 1.2, 1.0), 0.01)
    assert (choice.dt_s, choice.change, choice.is_converged) == (1e-3, None, False)
    alone = choose_step([{"dt_s": 1e-3, "status": "done", "value": 1.0}], 0.01)
    assert (alone.dt_s, alone.is_converged) == (1e-3, False)


def test_the_overlap_must_have_room():
    table = steps(1.0, 1.0, 1.0, 1.0)
    assert choose_step(table, 0.01, room=2e-3).dt_s == 2e-3
    choice = choose_step(table, 0.01, room=0.5e-3)
    assert (choice.dt_s, choice.is_converged, choice.has_room) == (1e-3, True, False)


def test_a_measure_of_zero():
    assert choose_step(steps(1e-3, 0.0, 0.0, 0.0), 0.01).dt_s == 4e-3


N_C = (4.0, 6.0, 8.0, 10.0, 12.0, 15.0, 20.0)


def table(overlaps=None, works=None, outcomes=None, status=None):
    """A row a value of N_c; what is not given keeps to all rules."""
    return [
        {
            "contact_steps": n, "status": (status or {}).get(n, "done"),
            "overlap_fraction": (overlaps or {}).get(n, 1e-3), "work_fraction": (works or {}).get(n, -0.75),
            "outcome": (outcomes or {}).get(n, 2.7),
        }
        for n in N_C
    ]  # fmt: skip


def window(rows, is_other=differs(None, 0.01)):  # noqa: B008
    return choose_window(rows, 0.005, 0.01, is_other)


def test_all_that_were_tried():
    found = window(table())
    assert found.members == N_C
    assert found.chosen == 8.0   # nearest to sqrt(80) = 8.94 in ratio: 10 is farther
    assert found.reaches_lowest
    assert found.reaches_highest


def test_too_soft_ones_overlap_too_much():
    found = window(table(overlaps={12.0: 0.0051, 15.0: 0.007, 20.0: 0.01}))
    assert found.members == (4.0, 6.0, 8.0, 10.0)
    assert found.reaches_lowest
    assert not found.reaches_highest


def test_an_overlap_at_the_limit_keeps_to_it():
    assert window(table(overlaps={20.0: 0.005})).members == N_C


def test_a_contact_that_makes_energy_splits_the_range():
    assert window(table(works={4.0: 0.2})).members == N_C[1:]
    assert window(table(works={10.0: 0.02})).members == (4.0, 6.0, 8.0)   # of two of three, the stiffer
    assert window(table(works={8.0: 0.02})).members == (10.0, 12.0, 15.0, 20.0)
    assert window(table(works={8.0: 0.009})).members == N_C


def test_a_run_that_was_stopped_splits_the_range():
    assert window(table(status={6.0: "stopped"})).members == (8.0, 10.0, 12.0, 15.0, 20.0)


def test_the_plateau_of_the_outcome():
    drift = {4.0: 2.0, 6.0: 2.3, 8.0: 2.69, 10.0: 2.70, 12.0: 2.71, 15.0: 2.9, 20.0: 3.2}
    assert window(table(outcomes=drift)).members == (8.0, 10.0, 12.0)


def test_a_slow_drift_is_no_plateau():
    # Each agrees with its neighbours, but not the first with the last.
    drift = {n: 2.7 * 1.006**k for k, n in enumerate(N_C)}
    assert window(table(outcomes=drift)).members == (4.0, 6.0)


def test_numerics_alone_decide_what_differs():
    drift = {n: 2.7 + 0.02 * k for k, n in enumerate(N_C)}
    assert len(window(table(outcomes=drift), differs(Spread("tumble_start_s", 2.7, 0.05, 4), 0.01)).members) == 4
    assert window(table(outcomes=drift), differs(Spread("tumble_start_s", 2.7, 0.1, 4), 0.01)).members == N_C


def test_an_event_that_does_not_happen_is_another_outcome():
    gone = {15.0: None, 20.0: None}
    assert window(table(outcomes=gone)).members == (4.0, 6.0, 8.0, 10.0, 12.0)
    assert window(table(outcomes=dict.fromkeys(N_C))).members == N_C


def test_an_event_that_numerics_decide_on_leaves_the_tolerance():
    is_other = differs(Spread("tumble_start_s", 2.7, math.inf, 4), 0.01)
    assert is_other(2.7, 2.8)
    assert not is_other(2.7, 2.71)


def test_no_range():
    assert window(table(overlaps=dict.fromkeys(N_C, 0.1))) is None
    assert window(table(overlaps=dict.fromkeys(N_C[1:], 0.1))) is None   # one value is no range


def test_rows_need_no_order():
    assert window(table()[::-1]).members == N_C


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"contact_steps": (3.0, 8.0)}, "--contact-steps = 3: must lie between 4 and 1000"),
        ({"contact_steps": (8.0, 2000.0)}, "--contact-steps = 2000: must lie between 4 and 1000"),
        ({"contact_steps": (8.0, 8.0)}, "--contact-steps = 8: must be at least two different values"),
        ({"contact_steps": (math.nan, 8.0)}, "--contact-steps = nan: must lie between 4 and 1000"),
        ({"tolerance": 1.0}, "--tolerance = 1: must be above 0 and at most 0.5"),
        ({"outcome_tolerance": 0.0}, "--outcome-tolerance = 0: must be above 0"),
        ({"measure": "kiss_tme_s"}, '--measure = "kiss_tme_s": must be a measure. Did you mean "kiss_time_s"?'),
        ({"outcome": "x"}, '--outcome = "x": must be a measure. There are: '),
        ({"time_steps": (0.0,)}, "--time-steps = 0 s: must be above 0"),
    ],
)  # fmt: skip
def test_an_option_that_cannot_be(given, said):
    with pytest.raises(CaseError) as error:
        TuneOptions(**given)
    assert str(error.value).startswith(said)


def test_options_are_sorted_and_filled():
    options = TuneOptions(contact_steps=(12.0, 4.0, 8.0, 8.0), time_steps=(1e-3, 4e-3))
    assert options.contact_steps == (4.0, 8.0, 12.0)
    assert options.time_steps == (4e-3, 1e-3)
    assert TuneOptions().contact_steps == N_C
    assert TuneOptions(quick=True).contact_steps == (6.0, 10.0, 15.0)
