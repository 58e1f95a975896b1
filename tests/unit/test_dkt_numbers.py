"""Numbers of a pair whose motion is made up: noise, coarse rows, periodic boundaries, no kiss, several kisses."""

from __future__ import annotations

import numpy as np
import pytest

from rdpm.results.dkt import contact_kisses, gap_kisses, pair_numbers, phases

D, GRAVITY = 0.015, (0.0, 0.0, -9.81)
# Times are interpolated linearly between rows: exact for motion that is linear there.
EXACT = 1e-9

# Gap over d and angle against time, linear between the corners.
GAP = ([0.0, 1.0, 2.0, 3.0, 4.0], [1.0, 1.0, 0.0, 0.0, 1.0])
ANGLE = ([0.0, 2.5, 3.5, 4.0], [0.0, 0.0, 90.0, 120.0])
TOUCH = {
    "i": np.array([0, 1, 0]), "j": np.array([1, 0, -5]), "start_s": np.array([2.0, 2.6, 0.5]),
    "duration_s": np.array([0.4, 0.3, 0.1]), "max_overlap_fraction": np.array([0.001, 0.004, 0.01]),
}  # fmt: skip


def pair(times, gap, angle, drift=0.0, d_0=D, d_1=D):
    """The lower sphere falls and drifts along y; the upper one at a gap (of the smaller d) and angle from it."""
    t = np.asarray(times)
    lower = np.stack([0.05 + 0 * t, 0.05 + drift * t, 0.4 - 0.1 * t], axis=1)
    theta = np.radians(angle)
    line = np.stack([np.sin(theta), 0 * t, np.cos(theta)], axis=1)
    return t, lower, lower + (0.5 * (d_0 + d_1) + min(d_0, d_1) * np.asarray(gap))[:, None] * line


def standard(times, drift=0.0, d_0=D, d_1=D):
    return pair(times, np.interp(times, *GAP), np.interp(times, *ANGLE), drift, d_0, d_1)


def test_every_number_of_a_smooth_motion():
    found = pair_numbers(*standard(np.linspace(0.0, 4.0, 401), 0.002), D, D, GRAVITY, 1e-3, contacts=TOUCH)
    assert found.drafting_start_s == pytest.approx(1.05, abs=EXACT)
    assert found.gap_kisses == (pytest.approx((1.98, 3.02), abs=EXACT),)
    assert found.contact_kisses == (pytest.approx((2.0, 2.4)), pytest.approx((2.6, 2.9)))
    assert found.contact_episodes == 2
    assert found.first_kiss_s == found.gap_kisses[0].start_s
    assert found.min_gap_fraction == -0.004
    assert found.tumble_start_s == pytest.approx(3.0, abs=EXACT)
    assert found.final_angle_deg == pytest.approx(120.0)
    # One diameter a second from 3.0 s on.
    assert found.separation_rate_m_s == pytest.approx(D)
    # The lower sphere drifts 8 mm along y with the upper, which moves by 2 d sin(120 deg) along x besides.
    across = np.array([0.5 * 2.0 * D * np.sin(np.radians(120.0)), 0.008])
    assert found.lateral_drift_m == pytest.approx(np.linalg.norm(across))


@pytest.mark.parametrize("rows", [4001, 401, 81, 41])
def test_the_sampling_interval_does_not_matter(rows):
    """Rows at the corners of the motion: 1, 10, 50 and 100 ms."""
    fine = pair_numbers(*standard(np.linspace(0.0, 4.0, 4001)), D, D, GRAVITY)
    found = pair_numbers(*standard(np.linspace(0.0, 4.0, rows)), D, D, GRAVITY)
    assert found.drafting_start_s == pytest.approx(fine.drafting_start_s, abs=EXACT)
    assert found.gap_kisses == (pytest.approx(fine.gap_kisses[0], abs=EXACT),)
    assert found.tumble_start_s == pytest.approx(fine.tumble_start_s, abs=EXACT)
    assert found.separation_rate_m_s == pytest.approx(fine.separation_rate_m_s)


@pytest.mark.parametrize("seed", range(5))
def test_noise_moves_times_by_no_more_than_it_takes_to_cross_it(seed):
    """Noise of 0.2 % d (standard deviation) on the gap and 1 degree on the angle, rows of 0.5 ms."""
    rng = np.random.default_rng(seed)
    times = np.linspace(0.0, 4.0, 8001)
    gap = np.interp(times, *GAP) + 0.002 * rng.standard_normal(times.size)
    angle = np.interp(times, *ANGLE) + rng.standard_normal(times.size)
    found = pair_numbers(*pair(times, gap, angle), D, D, GRAVITY)
    smooth = pair_numbers(*standard(times), D, D, GRAVITY)
    # The gap rises and falls by d, the angle by 90 degrees a second; 4 standard deviations, twice for a largest value.
    assert len(found.gap_kisses) == 1
    assert found.gap_kisses[0] == pytest.approx(smooth.gap_kisses[0], abs=4 * 0.002)
    assert found.drafting_start_s == pytest.approx(smooth.drafting_start_s, abs=8 * 0.002)
    assert found.tumble_start_s == pytest.approx(smooth.tumble_start_s, abs=4.0 / 90.0)
    # Slope of 960 rows over 0.48 s: standard error 0.002 * sqrt(12 / 960) / 0.48 = 0.0005 d/s.
    assert found.separation_rate_m_s == pytest.approx(D, rel=4 * 0.0005)
    # Without hysteresis noise of this size makes kisses of its own.
    assert phases(*pair(times, gap, angle), D, D, GRAVITY, 0.0).kisses > 1


def test_several_kisses_are_several():
    times = np.linspace(0.0, 5.0, 501)
    gap = np.interp(times, [0, 1, 1.5, 2, 2.5, 3, 3.5, 4, 5], [1, 0, 0.1, 0, 0.025, 0, 0.1, 0, 1])
    found = pair_numbers(*pair(times, gap, 0 * times), D, D, GRAVITY)
    # The rise to 2.5 % at 2.5 s ends no kiss; those to 10 % do.
    assert [kiss.duration_s for kiss in found.gap_kisses] == pytest.approx([0.12, 1.2, 0.12], abs=EXACT)
    assert found.tumble_start_s is None
    assert found.separation_rate_m_s is None
    assert len(gap_kisses(times, gap / 1.0, contact_time=1.0)) == 1


def test_no_kiss():
    times = np.linspace(0.0, 2.0, 201)
    found = pair_numbers(*pair(times, np.interp(times, [0, 1, 2], [1.0, 0.5, 1.0]), 60.0 + 0 * times), D, D, GRAVITY)
    assert (found.gap_kisses, found.contact_kisses, found.first_kiss_s, found.tumble_start_s) == ((), (), None, None)
    assert found.drafting_start_s == pytest.approx(0.1, abs=EXACT)
    assert found.min_gap_fraction == pytest.approx(0.5)
    apart = pair_numbers(*pair(times, 1.0 + 0.01 * times, 0 * times), D, D, GRAVITY)
    assert apart.drafting_start_s is None


def test_a_touch_between_two_rows_is_a_kiss_by_contact_only():
    times = np.linspace(0.0, 2.0, 21)
    touch = {name: column[:1] for name, column in TOUCH.items()} | {"start_s": np.array([1.04])}
    touch["duration_s"] = np.array([0.01])
    found = pair_numbers(*pair(times, 0.1 + 0 * times, 0 * times), D, D, GRAVITY, contacts=touch)
    assert (len(found.gap_kisses), len(found.contact_kisses), found.first_kiss_s) == (0, 1, 1.04)
    assert found.min_gap_fraction == -0.001


def test_a_pair_that_wavers_at_45_degrees_has_not_tumbled():
    times = np.linspace(0.0, 4.0, 401)
    touching = np.zeros(401)
    wavers = np.interp(times, [0, 1, 2, 3, 4], [0.0, 47.0, 30.0, 90.0, 90.0])
    found = pair_numbers(*pair(times, touching, wavers), D, D, GRAVITY)
    assert found.tumble_start_s == pytest.approx(2.25, abs=EXACT)
    ends = np.interp(times, [0, 4], [0.0, 48.0])
    assert pair_numbers(*pair(times, touching, ends), D, D, GRAVITY).tumble_start_s == pytest.approx(3.75, abs=EXACT)
    back = np.interp(times, [0, 2, 4], [0.0, 48.0, 0.0])
    assert pair_numbers(*pair(times, touching, back), D, D, GRAVITY).tumble_start_s is None


def test_contacts_closer_than_a_contact_time_are_one_kiss():
    assert len(contact_kisses(TOUCH | {"start_s": np.array([2.0, 2.41, 5.0])}, 0.02)) == 2
    assert len(contact_kisses(TOUCH | {"start_s": np.array([2.0, 2.41, 5.0])}, 0.005)) == 3


def test_unequal_spheres_count_by_the_smaller():
    found = pair_numbers(*standard(np.linspace(0.0, 4.0, 401), d_1=2 * D), D, 2 * D, GRAVITY)
    assert found.gap_kisses == (pytest.approx((1.98, 3.02), abs=EXACT),)
    assert found.drafting_start_s == pytest.approx(1.05, abs=EXACT)
    assert found.separation_rate_m_s == pytest.approx(D)


def test_periodic_boundaries_change_nothing():
    motion = standard(np.linspace(0.0, 4.0, 401), 0.03)
    box = np.array([0.08, 0.07, 0.0])
    wrapped = [np.where(box > 0.0, x % np.where(box > 0.0, box, 1.0), x) for x in motion[1:]]
    free = pair_numbers(*motion, D, D, GRAVITY)
    found = pair_numbers(motion[0], *wrapped, D, D, GRAVITY, period=box)
    assert found.gap_kisses == (pytest.approx(free.gap_kisses[0], abs=EXACT),)
    for name in ("drafting_start_s", "min_gap_fraction", "tumble_start_s", "separation_rate_m_s", "lateral_drift_m"):
        assert getattr(found, name) == pytest.approx(getattr(free, name), abs=EXACT)


def test_a_pair_still_kissing_has_no_separation_rate():
    times = np.linspace(0.0, 4.0, 401)
    found = pair_numbers(*pair(times, np.interp(times, [0, 1], [1, 0]), np.interp(times, *ANGLE)), D, D, GRAVITY)
    assert found.tumble_start_s == pytest.approx(3.0, abs=EXACT)
    assert found.separation_rate_m_s is None


@pytest.mark.parametrize("times", [[0.0], [0.0, 0.0]])
def test_times_must_increase(times):
    zero = np.zeros((len(times), 3))
    with pytest.raises(ValueError, match="two times"):
        pair_numbers(times, zero, zero + 1.0, D, D, GRAVITY)
