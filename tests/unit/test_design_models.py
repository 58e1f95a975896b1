"""`rdpm design --model`: a Hertz contact and a repulsive force, as text and JSON."""

import json

import pytest

from rdpm import design
from rdpm.cli.main import main

HERTZ = ["design", "--model", "hertz", "--diameter", "2 cm", "--density", "2800", "--youngs-modulus", "48 GPa",
         "--poisson-ratio", "0.2", "--restitution", "1", "--impact-speed", "20"]  # fmt: skip
REPULSIVE = ["design", "--model", "repulsive", "--diameter", "1 cm", "--density", "2500", "--repulsion-range", "1 mm",
             "--impact-speed", "0.1"]  # fmt: skip


def test_hertz_design_of_glass_spheres(capsys) -> None:
    assert main([*HERTZ, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["contact_time_s"] == pytest.approx(4.03384e-5, rel=1e-4)  # Chung and Ooi, test 1, with 2.9432
    assert found["max_overlap_m"] == pytest.approx(2.74113e-4, rel=1e-5)
    assert found["largest_time_step_s"] == pytest.approx(found["contact_time_s"] / 4.0)
    assert main(HERTZ) == 0
    assert "contact time               4.03395e-05 s" in capsys.readouterr().out


def test_repulsive_design_keeps_the_gap_at_speed_and_under_the_weight(capsys) -> None:
    assert main([*REPULSIVE, "--gap", "0.2 mm", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    gaps = found["closest_gap_m"], found["resting_gap_m"]
    assert min(gaps) == pytest.approx(2e-4, rel=1e-9)
    assert max(gaps) > 2e-4
    assert main([*REPULSIVE, "--repulsion-stiffness", "1e-4"]) == 0
    assert "FAIL closest gap" in capsys.readouterr().out


HARD = ["design", "--model", "hard-sphere", "--diameter", "1 cm", "--density", "2500", "--restitution", "0.9",
        "--time-step", "0.1 ms", "--impact-speed", "0.1"]  # fmt: skip


def test_hard_sphere_design_gives_the_error_of_a_soft_one(capsys) -> None:
    """Lag and overlap of eight steps: e v t_c and more, and half of it at four."""
    lags = []
    for steps in ("8", "4"):
        assert main([*HARD, "--contact-steps", steps, "--json"]) == 0
        found = json.loads(capsys.readouterr().out)
        error = design.finite_contact_error(float(steps) * 1e-4, 0.9, 0.01, 0.1)
        assert (found["soft_time_fraction"], found["soft_overlap_fraction"]) == (error.time_ratio, error.overlap)
        lags.append(found["soft_lag_fraction"])
    assert lags[0] == pytest.approx(2.0 * lags[1])
    assert lags[0] > 0.9 * 0.1 * 8e-4 / 0.01
    assert main(HARD) == 0
    assert "of a soft one of 8 steps" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([*HARD, "--gap", "1 mm"], "--gap: belongs to --model repulsive"),
        (HARD[:-4], "--time-step: must be given with --model hard-sphere"),
        ([*HERTZ, "--stiffness", "5"], "--stiffness: belongs to --model soft-sphere"),
        ([*REPULSIVE, "--gap", "1e-4", "--restitution", "0.5"], "--restitution: belongs to --model hertz"),
        ([*HERTZ[:-2], "--gap", "1e-4"], "--gap: belongs to --model repulsive"),
        (HERTZ[:-2], "impact_speed: must be given"),
        (HERTZ[:5], "--density: must be given with --model hertz"),
        ([*HERTZ, "--export", "lammps"], "--export: cannot go with --model hertz"),
        (REPULSIVE, "stiffness: give either stiffness or gap"),
        (["design", "--gap", "1e-4", "--mass", "1"], "--gap: belongs to --model repulsive"),
    ],
)
def test_what_does_not_belong_is_refused(words, message, capsys) -> None:
    assert main(words) == 2
    assert message in capsys.readouterr().err


def test_static_overlap_of_a_hertz_contact_carries_the_weight() -> None:
    found = design.hertz_design(diameter=0.01, density=2500.0, youngs_modulus=1e7, poisson_ratio=0.3, restitution=0.8,
                                impact_speed=0.1, wall=True)  # fmt: skip
    sink = found.static_overlap_fraction * 0.01
    assert found.stiffness_N_m32 * sink**1.5 == pytest.approx(9.81 * design.sphere_mass(0.01, 2500.0))
