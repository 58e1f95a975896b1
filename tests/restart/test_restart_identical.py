"""N steps are N/2 steps, a restart, and N/2 steps, to the last bit."""

import numpy as np
import pytest
from restart_cases import assert_equal_runs, case_of, run_until, run_whole

from rdpm.contacts.rows import TOUCHING
from rdpm.io.checkpoint import read_checkpoint
from rdpm.runs.runner import run_case


@pytest.mark.parametrize(
    ("name", "stop"),
    [
        ("wet contact", 20),
        ("wet contact", 75),
        ("adaptive steps", 4),
        ("adaptive steps", 60),
        ("adaptive steps", 100),
        ("stabilised diffusion", 12),
        ("released body", 12),
        ("released body", 24),
        ("released body", 37),
        ("periodic cloud", 25),
        ("dry heap", 250),
        ("walls", 20),
        ("hertz", 34),
        ("repulsive", 15),
        ("adaptive collision time", 27),
        ("stream", 12),
        ("stream", 40),
    ],
)
def test_restart_is_bit_identical(name, stop, tmp_path):
    case = case_of(name)
    run_whole(case, tmp_path / "whole", threads=1)
    path = run_until(case, tmp_path / "broken", stop, threads=2)
    arrays, facts = read_checkpoint(path)
    assert facts["steps"] == stop + 1
    if name == "walls":
        assert np.abs(arrays["immersed/wall_force"]).max() > 0.0
    if name == "repulsive":  # a force that acts before the touch leaves no contact under way
        assert "contacts/history/xi" not in arrays
    if name in ("wet contact", "dry heap", "hertz", "adaptive collision time"):
        # The subject is a contact under way, its spring stretched.
        assert (arrays["contacts/state/phase"] == TOUCHING).any()
        assert np.abs(arrays["contacts/history/xi"]).max() > 0.0
    if name == "released body":
        assert arrays["prescription/held"].size == (1 if stop < 24 else 0)
    assert run_case(case, tmp_path / "broken", threads=1, resume=True).status == "done"
    assert_equal_runs(tmp_path / "whole", tmp_path / "broken")


def test_restart_after_every_few_steps(tmp_path):
    case = case_of("wet contact")
    run_whole(case, tmp_path / "whole")
    run_until(case, tmp_path / "broken", 6)
    from restart_cases import StopsAt

    for stop in range(17, 80, 11):
        run_case(case, tmp_path / "broken", threads=1 + stop % 2, resume=True, reporter=StopsAt(stop))
    run_case(case, tmp_path / "broken", resume=True)
    assert_equal_runs(tmp_path / "whole", tmp_path / "broken")


def test_a_finished_run_goes_on_to_a_later_end(tmp_path):
    """What is extended equals a run of the same step that always had that end."""
    whole = case_of("periodic cloud")
    run_whole(whole, tmp_path / "whole")
    run_whole(case_of("periodic cloud", "time.end=0.045"), tmp_path / "extended")
    summary = run_case(whole, tmp_path / "extended", resume=True)
    assert (summary.status, summary.steps) == ("done", 50)
    for name in ("particles.csv", "contacts.csv", "history.csv"):
        assert (tmp_path / "whole" / name).read_bytes() == (tmp_path / "extended" / name).read_bytes()


def test_an_automatic_step_stays_when_the_end_moves(tmp_path):
    first = case_of("periodic cloud", "time={end=0.03}")
    dt = run_whole(first, tmp_path / "run").dt_s
    later = case_of("periodic cloud", "time={end=0.04}")
    for _ in range(2):  # again: the step is then given, and the case asked for still says "auto"
        assert run_case(later, tmp_path / "run", resume=True).dt_s == dt


def test_adaptive_steps_keep_their_contact_when_the_end_moves(tmp_path):
    """The shortest step, and with it the contact, are those the run began with, also when it is extended again."""
    first = run_whole(case_of("adaptive steps", "time.end=0.0301"), tmp_path / "run")
    assert first.time_s == pytest.approx(0.0301, abs=1e-12)
    for end in (0.04, 0.0507):
        later = run_case(case_of("adaptive steps", f"time.end={end}"), tmp_path / "run", resume=True)
        assert later.status == "done"
        assert later.dt_s == first.dt_s
        assert later.contact == first.contact
        # The last step reaches the end, but for less than the shortest.
        assert end - 1e-9 <= later.time_s < end + first.dt_s
