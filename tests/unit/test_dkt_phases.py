"""Phases of a pair whose motion is made up, so that every time is known."""

from __future__ import annotations

import numpy as np
import pytest

from rdpm.results.dkt import from_particles_table, line_of_centres, pair_gap, phases

D, GRAVITY = 0.015, (0.0, 0.0, -9.81)
# Times are interpolated linearly between rows: exact for motion that is linear there.
EXACT = 1e-9


def pair(times, gap, angle=None, fall=0.1):
    """The lower sphere falls; the upper one at a given gap and angle (degrees) from it."""
    t = np.asarray(times)
    lower = np.stack([0.05 + 0 * t, 0.05 + 0 * t, 0.4 - fall * t], axis=1)
    theta = np.radians(np.zeros_like(t) if angle is None else angle)
    line = np.stack([np.sin(theta), 0 * t, np.cos(theta)], axis=1)
    return t, lower, lower + (D + np.asarray(gap))[:, None] * line


def test_one_kiss_and_a_tumble():
    times = np.linspace(0.0, 4.0, 401)
    gap = np.interp(times, [0.0, 1.0, 2.0, 3.0, 4.0], [D, D, 0.0, 0.0, D])
    angle = np.interp(times, [0.0, 2.5, 3.5, 4.0], [0.0, 0.0, 90.0, 120.0])
    found = phases(*pair(times, gap, angle), D, D, GRAVITY, 1e-3)
    assert found.kiss_time_s == pytest.approx(1.98, abs=EXACT)
    assert found.kiss_duration_s == pytest.approx(3.02 - 1.98, abs=EXACT)
    assert found.kisses == 1
    assert found.tumble_time_s == pytest.approx(3.0, abs=EXACT)
    assert found.final_angle_deg == pytest.approx(120.0)
    # The derivative at a row is a central difference, so the start is known to one row.
    assert found.drafting_time_s == pytest.approx(1.0, abs=0.01)


def test_which_sphere_is_named_first_does_not_matter():
    times = np.linspace(0.0, 4.0, 401)
    gap = np.interp(times, [0.0, 2.0, 3.0, 4.0], [D, 0.0, 0.0, D])
    angle = np.interp(times, [0.0, 2.5, 3.5, 4.0], [10.0, 20.0, 90.0, 170.0])
    t, lower, upper = pair(times, gap, angle)
    one, other = phases(t, lower, upper, D, D, GRAVITY, 0.0), phases(t, upper, lower, D, D, GRAVITY, 0.0)
    assert one.to_dict() == pytest.approx(other.to_dict())


def test_kisses_closer_than_a_contact_time_are_one():
    times = np.arange(0.0, 1.0, 0.001)
    touching = ((times > 0.3) & (times < 0.4)) | ((times > 0.405) & (times < 0.5)) | (times > 0.7)
    gap = np.where(touching, 0.0, 0.04 * D)
    separate = phases(*pair(times, gap), D, D, GRAVITY, 1e-4)
    joined = phases(*pair(times, gap), D, D, GRAVITY, 0.01)
    assert (separate.kisses, joined.kisses) == (3, 2)
    # The pause of 5 ms counts; each of its ends is known to one row.
    assert joined.kiss_duration_s == pytest.approx(separate.kiss_duration_s + 0.005, abs=0.002)


def test_nothing_happens():
    found = phases(*pair(np.linspace(0, 1, 11), np.full(11, D)), D, D, GRAVITY, 1e-3)
    assert found.to_dict() == {
        "kiss_time_s": None, "kiss_duration_s": None, "kisses": 0, "tumble_time_s": None,
        "final_angle_deg": pytest.approx(0.0, abs=1e-6), "drafting_time_s": None,
    }


def test_tumbling_counts_from_the_first_kiss():
    times = np.linspace(0.0, 2.0, 201)
    side_by_side = np.full(201, 90.0)
    gap = np.interp(times, [0.0, 1.0, 2.0], [D, 0.0, 0.0])
    found = phases(*pair(times, gap, side_by_side), D, D, GRAVITY, 1e-3)
    assert found.tumble_time_s == pytest.approx(found.kiss_time_s)
    apart = phases(*pair(times, np.full(201, D), np.linspace(0, 90, 201)), D, D, GRAVITY, 1e-3)
    assert apart.tumble_time_s is None


def test_a_kiss_at_both_ends_of_the_record():
    found = phases(*pair([0.0, 1.0, 2.0], [0.0, 0.0, 0.0]), D, D, GRAVITY, 1e-3)
    assert (found.kiss_time_s, found.kiss_duration_s, found.drafting_time_s) == (0.0, 2.0, None)


def test_unequal_spheres_kiss_by_the_smaller_diameter():
    times = np.linspace(0.0, 1.0, 11)
    lower, upper = np.zeros((11, 3)), np.stack([0 * times, 0 * times, 2.5 - times], axis=1)
    # Gap 2.5 - t - 1.5 = 0.02 * 1 at t = 0.98.
    assert phases(times, lower, upper, 2.0, 1.0, GRAVITY, 0.0).kiss_time_s == pytest.approx(0.98, abs=EXACT)


def test_a_pair_that_meets_through_a_periodic_side():
    times = np.linspace(0.0, 1.0, 101)
    t, lower, upper = pair(times, np.interp(times, [0, 1], [D, 0.0]), np.full(101, 30.0), fall=0.3)
    box = np.array([0.06, 0.0, 0.1])
    wrapped = [np.where(box > 0.0, x % np.where(box > 0.0, box, 1.0), x) for x in (lower, upper)]
    free = phases(t, lower, upper, D, D, GRAVITY, 1e-3)
    assert phases(t, *wrapped, D, D, GRAVITY, 1e-3, period=box).to_dict() == pytest.approx(free.to_dict())
    assert np.allclose(pair_gap(*wrapped, D, D, box), pair_gap(lower, upper, D, D))
    assert np.allclose(line_of_centres(*wrapped, GRAVITY, box), 30.0)


def test_table_gives_what_arrays_give():
    times = np.linspace(0.0, 2.0, 21)
    t, lower, upper = pair(times, np.interp(times, [0, 1, 2], [D, 0, D]))
    table = {"time_s": np.repeat(t, 3), "id": np.tile([0, 1, 2], 21)}
    centres = np.stack([lower, upper, upper + 1.0], axis=1).reshape(-1, 3)
    table |= {name: centres[:, n] for n, name in enumerate(("x_m", "y_m", "z_m"))}
    assert from_particles_table(table, (D, D), GRAVITY, 1e-3) == phases(t, lower, upper, D, D, GRAVITY, 1e-3)


@pytest.mark.parametrize("times", [[0.0], [0.0, 0.0], [1.0, 0.5]])
def test_times_must_increase(times):
    zero = np.zeros((len(times), 3))
    with pytest.raises(ValueError, match="two times"):
        phases(times, zero, zero + 1.0, D, D, GRAVITY, 1e-3)
