"""Measures of made-up runs: a pair, a rebound from the floor, a run without bodies."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from builders import D, made_up_run, pair_motion
from rdpm.results.run import load_run
from rdpm.results.summary import BodySummary
from rdpm.studies.measures import MEASURES, QUANTITIES, at_times
from rdpm.studies.rebounds import first_rebound


def measured(run):
    return {name: value for group in MEASURES.values() for name, value in group(run).items()}


@pytest.fixture(scope="module")
def pair(tmp_path_factory):
    return load_run(made_up_run(tmp_path_factory.mktemp("runs") / "pair", pair_motion, 2))


def test_columns_are_those_that_are_described(pair, tmp_path):
    assert set(measured(pair)) == set(QUANTITIES)
    assert len(measured(pair)) == sum(len(group(pair)) for group in MEASURES.values())
    empty = load_run(made_up_run(tmp_path / "empty", None, 0))
    assert set(measured(empty)) == set(QUANTITIES)
    assert measured(empty)["kisses"] is None
    assert measured(empty)["contacts"] == 2.0   # as its summary says


def test_a_pair(pair):
    found = measured(pair)
    assert found["kiss_time_s"] == pair.phases.kiss_time_s
    assert (found["kisses"], found["gap_kisses"], found["contact_kisses"], found["contact_episodes"]) == (1, 1, 1, 1)
    assert found["gap_kiss_total_s"] == pytest.approx(found["kiss_duration_s"])
    assert found["contact_kiss_longest_s"] == pytest.approx(0.9)
    assert found["min_gap_fraction"] == pytest.approx(-0.003)
    assert found["tumble_start_s"] == pytest.approx(2.0, abs=0.05)
    # The wall contact counts among all contacts, not among the pair's.
    assert (found["contact_longest_time_s"], found["contact_total_time_s"]) == (0.9, pytest.approx(0.916))
    assert (found["max_impact_speed_m_s"], found["first_impact_speed_m_s"]) == (0.05, 0.012)
    assert found["max_contact_work_J"] == -1e-7
    # Both spheres' centre falls by 0.055 t - 0.01 (exp(-4 t) - 1) [m] until the kiss.
    t = found["kiss_time_s"]
    assert found["settling_speed_mean_m_s"] == pytest.approx((0.055 * t - 0.01 * (np.exp(-4 * t) - 1)) / t, rel=1e-2)
    assert found["damping_ratio"] == pytest.approx(0.5 * 0.086 / np.sqrt(9.9e-4 * 40.1))


def test_at_given_times(pair):
    found = at_times([2.0, 9.0])(pair)
    assert found["angle_deg@2"] == pytest.approx(45.0)
    assert found["settling_speed_m_s@2"] == pytest.approx(0.055, rel=0.01)
    assert found["angle_deg@9"] is None
    assert found["settling_speed_m_s@9"] is None


def falling(run, back, wall=-5, rows=1001):
    """A run with one body that meets a wall at 1 s with 0.1 m/s and leaves with `back` times that."""
    t = np.linspace(0.5, 2.0, rows)
    v = np.where(t < 1.0, -0.1, 0.1 * back - 0.2 * (t - 1.0) * back)
    z = np.where(t < 1.0, -0.1 * (t - 1.0), back * (0.1 * (t - 1.0) - 0.1 * (t - 1.0) ** 2))
    height, speed = (0.5 * D + z, v) if wall == -5 else (run.box[2] - 0.5 * D - z, -v)
    position, velocity = np.tile(0.5 * run.box, (rows, 1, 1)), np.zeros((rows, 1, 3))
    position[:, 0, 2], velocity[:, 0, 2] = height, speed
    tracks = replace(run.tracks, times=t, position=position, velocity=velocity, gap=z[:, None])
    contacts = {name: column[1:] for name, column in run.contacts.items()}
    contacts |= {"i": np.array([0]), "j": np.array([wall]), "start_s": np.array([1.0])}
    body = BodySummary(0, D, 1120.0)
    summary = replace(run.summary, bodies=(body,))
    return replace(run, tracks=tracks, contacts=contacts, diameter=np.array([D]), summary=summary, phases=None)


@pytest.mark.parametrize("wall", [-5, -6])
def test_a_rebound(pair, wall):
    found = first_rebound(falling(pair, 0.8, wall))
    # Read at a gap of one cell, 2.5 mm: on the way back 0.08 sqrt(1 - 4 * 0.0025 / 0.08) m/s.
    assert found["approach_speed_m_s"] == pytest.approx(0.1)
    assert found["rebound_speed_m_s"] == pytest.approx(0.1 * found["wet_restitution"])
    assert found["wet_restitution"] == pytest.approx(0.8 * np.sqrt(1.0 - 0.0025 / 0.02), rel=1e-3)
    # Highest half a second after the impact: 0.25 * 0.08 m.
    assert found["rebound_height_m"] == pytest.approx(0.02, rel=1e-6)
    assert found["approach_stokes_number"] == pytest.approx(1120.0 * 0.1 * D / (9.0 * 0.113))


def test_coarse_rows_give_the_height_all_the_same(pair):
    assert first_rebound(falling(pair, 0.8, rows=31))["rebound_height_m"] == pytest.approx(0.02, rel=1e-6)


def test_a_body_that_stays_at_the_wall_has_no_rebound(pair):
    found = first_rebound(falling(pair, 0.0))
    assert found["wet_restitution"] == 0.0
    assert found["rebound_height_m"] is None


def test_a_body_that_the_film_stops_has_no_rebound_either(pair):
    stopped = replace(falling(pair, 0.0), contacts=None)
    found = first_rebound(stopped)
    assert (found["approach_speed_m_s"], found["wet_restitution"]) == (pytest.approx(0.1), 0.0)
    # A record that ends during the approach says nothing.
    early = {name: getattr(stopped.tracks, name)[:300] for name in ("times", "position", "velocity", "gap")}
    assert set(first_rebound(replace(stopped, tracks=replace(stopped.tracks, **early))).values()) == {None}


def test_where_it_ended(pair):
    found = MEASURES["end"](falling(pair, 0.8))
    # One second after the impact it falls through the wall's height again: 0.08 (1 - 2) m/s.
    assert found["end_speed_m_s"] == pytest.approx(0.08)
    assert (found["end_gap_m"], found["end_height_m"]) == (pytest.approx(0.0), pytest.approx(0.5 * D))


def test_no_wall_no_rebound(pair):
    run = replace(pair, contacts=None)
    assert set(first_rebound(run).values()) == {None}
    assert measured(run)["contact_kisses"] == 0
