"""Coefficients of lubrication against exact series, and bodies that approach through it against quadrature."""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad

from rdpm.contacts import Contacts, Lubrication, SoftSphere
from rdpm.grid import Box
from rdpm.particles.state import Bodies

DATA = Path(__file__).parents[1] / "data"
VISCOSITY, RADIUS = 0.1, 5e-3
ROOM = Box((1.0, 1.0, 1.0))
LAW = SoftSphere.from_contact_time(0.5, 8e-3)


def table(name):
    return np.genfromtxt(DATA / f"contact_{name}.csv", delimiter=",", names=True, skip_header=1)


def correction_model(cutoff, roughness=1e-5):
    return Lubrication(VISCOSITY, cutoff * RADIUS, roughness)


def exact_relative_resistance(kind):
    """Force/(6 pi mu a) per relative velocity of the surfaces, at gaps over a."""
    data = table({"wall": "film_wall", "approach": "film_approach", "pair": "film_pair"}[kind])
    if kind == "wall":
        return data["gap_over_a"], data["resistance"]
    if kind == "approach":
        return data["gap_over_a"], 0.5 * data["resistance"]
    return data["gap_over_a"], 0.5 * (data["XA11"] - data["XA12"])


@pytest.mark.parametrize("kind", ["wall", "approach", "pair"])
def test_correction_is_what_the_exact_series_adds_below_the_cutoff(kind):
    gap, exact = exact_relative_resistance(kind)
    cut = gap.max()
    correction = correction_model(cut).resistance(gap * RADIUS, RADIUS, np.inf if kind == "wall" else RADIUS)
    correction /= 6.0 * np.pi * VISCOSITY * RADIUS
    added = exact - exact[gap == cut]
    # What is left out is of order gap ln(1/gap): at most 0.06 at 0.2 a.
    np.testing.assert_allclose(correction, added, atol=0.06)
    near = gap <= 0.02
    np.testing.assert_allclose(correction[near], added[near], rtol=3e-3)


def test_unequal_spheres_feel_the_same_lubrication_and_a_huge_one_is_a_wall():
    gap = np.array([1e-3, 1e-2, 0.1]) * RADIUS
    one = correction_model(0.2).resistance(gap, RADIUS, 3.0 * RADIUS)
    other = correction_model(0.2).resistance(gap, 3.0 * RADIUS, RADIUS)
    np.testing.assert_allclose(one, other, rtol=1e-12)
    # The coefficients of 1/gap and ln(1/gap) differ from the wall's by two and three times a_i/a_j.
    huge = correction_model(0.2).resistance(gap, RADIUS, 1e6 * RADIUS)
    np.testing.assert_allclose(huge, correction_model(0.2).resistance(gap, RADIUS, np.inf), rtol=1e-5)


def test_lubrication_is_constant_below_the_roughness_and_ends_at_contact():
    gap = np.array([1e-3, 1e-4, 1e-9]) * RADIUS
    at = correction_model(0.2, roughness=1e-3).resistance(gap, RADIUS, np.inf)
    assert np.all(correction_model(0.2).resistance(np.array([0.0, -0.1]), RADIUS, np.inf) == 0.0)
    assert np.all(at == at[0])
    assert at[0] > 0.0
    assert np.all(correction_model(0.2).resistance(np.array([0.2, 1.0]) * RADIUS, RADIUS, np.inf) == 0.0)


def ball(gap, velocity):
    place = [[0.5, 0.5, RADIUS + gap]]
    speed = np.array([[0.0, 0.0, velocity]])
    return Bodies(np.array([2 * RADIUS]), np.array([7800.0]), np.array(place), speed)


@pytest.mark.parametrize("dt", [2e-4, 1e-3, 2e-3])
def test_speed_lost_to_lubrication_is_its_integral_over_the_gap(dt):
    """Without other forces m dv = -lambda(g) dg: the speed depends on the gap alone."""
    lubrication = correction_model(0.2, roughness=1e-3)
    sphere = ball(0.19 * RADIUS, -0.03)
    contacts, none, time = Contacts(sphere, ROOM, LAW, lubrication), np.zeros((1, 3)), 0.0
    while sphere.position[0, 2] - RADIUS > 0.02 * RADIUS:
        contacts.advance(time, dt, none, none)
        time += dt
    gap = sphere.position[0, 2] - RADIUS
    assert gap > 0.0
    resistance = lambda g: float(lubrication.resistance(np.array([g]), RADIUS, np.inf)[0])  # noqa: E731
    lost = quad(resistance, gap, 0.19 * RADIUS)[0] / sphere.mass[0]
    assert 0.3 < lost / 0.03 < 0.9   # lubrication matters, the sphere still moves
    # First order in the sub-step, 1 % of a contact, in which the gap changes by little.
    assert 0.03 + sphere.velocity[0, 2] == pytest.approx(lost, rel=1e-2)


def test_sinking_through_a_narrow_gap_has_the_speed_of_its_balance():
    """At a gap where lambda h/m is 1e3, the speed is still F/lambda."""
    lubrication = Lubrication(1e3, 0.2 * RADIUS)
    gap = 2e-3 * RADIUS
    sphere = ball(gap, 0.0)
    weight = -9.81 * sphere.mass[:, None] * [[0.0, 0.0, 1.0]]
    contacts = Contacts(sphere, ROOM, LAW, lubrication)
    for step in range(10):
        contacts.advance(step * 1e-3, 1e-3, weight, np.zeros((1, 3)))
    at = lubrication.resistance(np.array([gap]), RADIUS, np.inf)[0]
    assert sphere.velocity[0, 2] == pytest.approx(weight[0, 2] / at, rel=1e-3)
    # It starts from rest: half the first of 120 sub-steps is missing.
    sunk = gap - (sphere.position[0, 2] - RADIUS)
    assert sunk == pytest.approx(-0.01 * weight[0, 2] / at, rel=1.0 / 120)


def test_wet_rebound_loses_energy_and_its_contact_does_no_net_work():
    sphere = ball(0.1 * RADIUS, -0.5)
    law = SoftSphere.from_contact_time(0.97, 8e-4)
    contacts = Contacts(sphere, ROOM, law, Lubrication(1e-2, 0.2 * RADIUS))
    none, dt = np.zeros((1, 3)), 1e-4
    for step in range(60):
        contacts.advance(step * dt, dt, none, none)
    (episode,) = contacts.take_episodes()
    assert 0.0 < sphere.velocity[0, 2] < 0.97 * 0.5
    assert episode["work_J"] < 0.0
    assert episode["impact_speed_m_s"] < 0.5
    # rho_p v d/(9 mu) against a wall.
    expected = 7800.0 * episode["impact_speed_m_s"] * 2 * RADIUS / (9.0 * 1e-2)
    assert episode["stokes_number"] == pytest.approx(expected, rel=1e-12)
