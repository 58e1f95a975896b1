"""Input that is too little, too much or impossible; verdicts, advice, inverse questions."""

import math

import numpy as np
import pytest

import rdpm
from rdpm.design import (
    contact_parameters,
    damping_ratio,
    largest_time_step,
    ratio_from_poisson,
    sliding_ratio,
    soft_sphere,
    softest_stiffness,
    stokes_number,
    submerged_weight,
    tangential_parameters,
    tangential_restitution,
    terminal_velocity,
    wet_restitution,
)
from rdpm.design.verdicts import advise
from rdpm.errors import CaseError

BEAD = {"diameter": 1e-3, "density": 2500.0, "fluid_density": 998.0, "viscosity": 1e-3}


@pytest.mark.parametrize(
    ("given", "place", "words"),
    [
        ({"mass": 1.0, "stiffness": 2.0}, "contact", "1 more is missing"),
        ({"mass": 1.0}, "contact", "Add stiffness or damping or restitution"),
        ({"restitution": 0.5, "contact_time": 1.0}, "contact", "Add mass"),
        ({"mass": 1.0, "stiffness": 2.0, "damping": 1.0, "restitution": 0.5}, "contact", "Take one away"),
        ({"mass": 1.0, "restitution": 0.5, "contact_time": 1.0, "contact_steps": 8.0, "time_step": 0.1},
         "contact_time", "product"),
        ({"mass": 1.0, "density": 2.0}, "diameter", "must be given"),
        ({"mass": 1.0, "diameter": 1.0, "density": 2.0}, "mass", "cannot go with"),
        ({"diameter": 1.0, "density": 2.0, "wall": True, "diameter2": 1.0}, "wall", "cannot go with"),
        ({"mass": -1.0, "restitution": 0.5}, "mass", "above 0"),
        ({"mass": math.nan, "restitution": 0.5}, "mass", "finite"),
        ({"mass": 1.0, "restitution": 1.5, "stiffness": 1.0}, "restitution", "0 <= e_n <= 1"),
        ({"mass": 1.0, "restitution": 0.0, "stiffness": 1.0}, "restitution", "no finite damping"),
        ({"mass": 1.0, "restitution": 0.0, "contact_time": 1.0, "ending": "zero-overlap"},
         "restitution", "never ends"),
        ({"mass": 1.0, "restitution": 0.5, "max_overlap": 0.01}, "impact_speed", "must be given"),
        ({"mass": 1.0, "restitution": 0.5, "max_overlap": 0.01, "impact_speed": 1.0}, "diameter", "be given"),
        ({"mass": 1.0, "stiffness": 1.0, "contact_time": 9.0}, "contact", "only shortens it"),
        ({"mass": 1.0, "stiffness": 1.0, "contact_time": 1.0, "ending": "zero-overlap"},
         "contact", "lengthens it"),
        ({"mass": 1.0, "damping": 0.0, "restitution": 1.0}, "damping", "any stiffness"),
        ({"mass": 1.0, "stiffness": 1.0, "restitution": 0.5, "youngs_modulus": 1e9},
         "poisson_ratio", "must be given"),
        ({"mass": 1.0, "stiffness": 1.0, "restitution": 0.5, "ending": "never"}, "ending", "Name one"),
        ({"stiffness": 1.0, "damping": 1.0, "contact_time": 1.0}, "mass", "Give the mass"),
        ({**BEAD, "stiffness": 1.0, "static_overlap": 0.01, "damping": 0.0}, "static_overlap", "Take one"),
    ],
)  # fmt: skip
def test_wrong_input_is_refused_with_its_name(given, place, words):
    with pytest.raises(CaseError) as caught:
        soft_sphere(**given)
    assert caught.value.place == place
    assert words in str(caught.value)


def test_the_front_door_is_a_function_and_the_module_stays():
    from rdpm.design.soft_sphere import contact_parameters as same

    assert callable(rdpm.design.soft_sphere)
    assert same is contact_parameters
    d = rdpm.design.soft_sphere(mass=1e-3, restitution=0.8, stiffness=1e2)
    assert d.damping_ratio == damping_ratio(0.8)


def test_scalars_in_scalars_out_arrays_broadcast():
    k, eta = contact_parameters(1e-3, 0.5, 1e-2)
    assert isinstance(k, float)
    assert isinstance(eta, float)
    k, eta = contact_parameters(np.full((3, 1), 1e-3), [0.5, 0.9], 1e-2)
    assert k.shape == (3, 2)
    assert eta[0, 1] == contact_parameters(1e-3, 0.9, 1e-2)[1]


@pytest.mark.parametrize("damping", [0.2, 0.1 * math.sqrt(1e-3 * 100.0) * 20])
def test_overdamped_at_zero_overlap_is_undefined_and_said(damping):
    d = soft_sphere(mass=1e-3, stiffness=1.0, damping=damping, contact_steps=8, ending="zero-overlap")
    plain = d.to_dict()
    for name in ("restitution", "contact_time_s", "contact_steps", "time_step_s"):
        assert plain[name] is None
    assert plain["tangential"]["restitution"] is None
    assert d.regime == "overdamped"
    assert not d.ok
    assert "no rebound" in d.verdicts[0].reason
    assert "undefined" in str(d)


def test_critical_is_named_and_exact():
    d = soft_sphere(mass=1e-3, stiffness=10.0, restitution=0.0, ending="zero-overlap")
    assert (d.regime, d.restitution, d.contact_time_s) == ("critical", 0.0, None)
    assert d.damping_N_s_m == pytest.approx(2.0 * math.sqrt(1e-2), rel=1e-15)


def test_material_sets_the_contact_where_nothing_else_does():
    d = soft_sphere(**BEAD, restitution=0.97, youngs_modulus=7e10, poisson_ratio=0.22)
    assert d.contact_time_s == d.hertz_contact_time_s
    assert d.rayleigh_time_s < d.hertz_contact_time_s
    assert d.tangential.ratio == ratio_from_poisson(0.22)
    assert d.impact_speed_source.startswith("terminal velocity")


def test_glass_beads_in_water():
    d = soft_sphere(**BEAD, restitution=0.97, contact_steps=8, time_step=1e-3)
    verdicts = {v.name: v.ok for v in d.verdicts}
    assert not verdicts["max_overlap"]
    assert d.advice.best_contact_steps is None
    assert d.advice.text.startswith("No N_c")
    # the advice, taken, passes every limit of overlap and resolution
    again = soft_sphere(**BEAD, restitution=0.97, contact_steps=4, time_step=d.advice.largest_time_step_s)
    verdicts = {v.name: v.ok for v in again.verdicts}
    assert verdicts["max_overlap"]
    assert verdicts["contact_steps"]
    assert again.advice.best_contact_steps == 4


def test_advice_names_the_softest_contact_allowed():
    assert advise(shortest=None, longest=11.2e-3, time_step=1e-3, contact_steps=None).best_contact_steps == 11
    wide = advise(shortest=None, longest=1.0, time_step=1e-3, contact_steps=None)
    assert (wide.contact_steps_range, wide.best_contact_steps) == ((4, 1000), 15)
    hertz = advise(shortest=30e-3, longest=1.0, time_step=1e-3, contact_steps=None)
    assert hertz.best_contact_steps == 30
    assert "Hertz" in advise(shortest=2.0, longest=1.0, time_step=1e-3, contact_steps=None).text


def test_best_contact_steps_sit_on_the_overlap_limit():
    for ending in ("zero-force", "zero-overlap"):
        dt = largest_time_step(0.5, 9.0, 0.005 * 0.015, 0.04, ending)
        d = soft_sphere(diameter=0.015, density=1120.0, restitution=0.5, contact_steps=9, time_step=dt,
                        impact_speed=0.04, gravity=0.0, ending=ending)  # fmt: skip
        assert d.max_overlap_fraction == pytest.approx(0.005, rel=1e-12)
        assert d.advice.best_contact_steps == 9
        assert d.ok


def test_advice_names_what_decides():
    fast = soft_sphere(**BEAD, restitution=0.9, contact_steps=8, time_step=1e-4, impact_speed=1.0)
    slow = soft_sphere(**BEAD, restitution=0.9, contact_steps=8, time_step=1e-4, impact_speed=1e-4)
    assert "the overlap at the impact speed decides" in fast.advice.text
    assert "the overlap at rest decides" in slow.advice.text


def test_softest_spring_for_a_load():
    d = soft_sphere(**BEAD, static_overlap=0.005, restitution=0.9)
    assert d.static_overlap_fraction == pytest.approx(0.005, rel=1e-14)
    assert d.stiffness_N_m == softest_stiffness(submerged_weight(1e-3, 2500.0, 998.0), 0.005e-3)


def test_unequal_spheres_and_walls():
    pair = soft_sphere(
        diameter=2e-3, density=1000.0, diameter2=1e-3, density2=3000.0, restitution=0.5, contact_time=1e-3
    )
    a, b = 1000.0 * math.pi / 6 * 8e-9, 3000.0 * math.pi / 6 * 1e-9
    assert pair.reduced_mass_kg == pytest.approx(a * b / (a + b), rel=1e-14)
    assert pair.diameter_m == 1e-3
    wall = soft_sphere(diameter=2e-3, density=1000.0, wall=True, restitution=0.5, contact_time=1e-3)
    equal = soft_sphere(diameter=2e-3, density=1000.0, restitution=0.5, contact_time=1e-3)
    assert wall.stiffness_N_m == pytest.approx(2.0 * equal.stiffness_N_m, rel=1e-14)


def test_stokes_numbers_and_wet_rebound():
    # Gondret et al. 2002: St = rho_p v d/(9 mu); Legendre et al. 2005 at St* = 100: e/e_dry = 0.7047
    assert stokes_number(math.pi / 6, 0.5, 9.0, 1.0) == pytest.approx(1.0, rel=1e-14)
    assert wet_restitution(1.0, 100.0, 1e12) == pytest.approx(0.704688, rel=1e-6)
    assert wet_restitution(0.9, 0.0, 2.0) == 0.0


def test_terminal_velocity_in_its_limits():
    # Stokes: v = (rho_p - rho_f) g d^2/(18 mu), drag factor 1 + 0.15 Re^0.681 is 1 + 1e-4 at Re = 2e-5
    v, re = terminal_velocity(1e-6, 2500.0, 1000.0, 1e-2)
    assert v == pytest.approx(1500.0 * 9.81 * 1e-12 / 0.18, rel=1e-4)
    assert re < 1e-4
    assert terminal_velocity(1e-2, 1000.0, 1000.0, 1e-3) == (0.0, 0.0)
    up, _ = terminal_velocity(1e-3, 500.0, 1000.0, 1e-3)
    down, _ = terminal_velocity(1e-3, 1500.0, 1000.0, 1e-3)
    assert up == down


def test_tangential_spring():
    k_t, eta_t = tangential_parameters(100.0, 0.3, 2 / 7)
    # the tangential reduced mass of solid spheres is 2/7 of the normal one: same zeta
    assert eta_t / math.sqrt(k_t * 2 / 7) == pytest.approx(0.3 / math.sqrt(100.0), rel=1e-14)
    for zeta in (0.0, 0.2, 1.0, 2.0):  # at ratio 2/7 both springs move alike, so both restitutions agree
        d = soft_sphere(mass=1.0, stiffness=1.0, damping=2.0 * zeta)
        assert tangential_restitution(zeta, 2 / 7) == pytest.approx(d.restitution, rel=1e-12)
    assert sliding_ratio(0.1, 0.9, 0.0) == pytest.approx(3.5 * 0.1 * 1.9)
    assert (ratio_from_poisson(0.0), ratio_from_poisson(0.5)) == (1.0, pytest.approx(2 / 3))
