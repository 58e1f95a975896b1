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
from rdpm.design.advice import advise_on_steps
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
        ({**BEAD, "restitution": 0.5, "max_overlap": 0.5}, "max_overlap", 'write 0.005, or "0.5 %"'),
        ({**BEAD, "restitution": 0.5, "static_overlap": 0.2}, "static_overlap", "at most 0.05"),
        ({**BEAD, "restitution": 0.5, "stiffness": 1.0, "overlap_limit": 0.051}, "overlap_limit", "0.00051"),
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
    assert d.advice.time_step_s < 1e-4
    assert d.advice.best_contact_steps is None
    assert d.advice.text.startswith("No N_c")
    # the advice, taken, passes every limit of overlap and resolution
    again = soft_sphere(**BEAD, restitution=0.97, contact_steps=4, time_step=d.advice.largest_time_step_s)
    verdicts = {v.name: v.ok for v in again.verdicts}
    assert verdicts["max_overlap"]
    assert verdicts["contact_steps"]
    assert again.advice.best_contact_steps == 4


def test_advice_names_the_softest_contact_allowed():
    given = {"time_step": 1e-3, "contact_steps": 8.0}
    assert advise_on_steps(shortest=None, longest=11.2e-3, **given).best_contact_steps == 11
    wide = advise_on_steps(shortest=None, longest=1.0, **given)
    assert (wide.contact_steps_range, wide.best_contact_steps, wide.time_step_s) == ((4, 1000), 15, 1e-3)
    assert advise_on_steps(shortest=30e-3, longest=1.0, **given).best_contact_steps == 30
    none = advise_on_steps(shortest=2.0, longest=1.0, asks="Rayleigh", **given)
    assert "Rayleigh asks 2 s" in none.text
    assert none.time_step_s is None


@pytest.mark.parametrize(
    ("given", "taken"),
    [
        ({"youngs_modulus": 63e9, "poisson_ratio": 0.22, "restitution": 0.97}, 8),
        ({"stiffness": 1e5, "restitution": 0.97}, 8),
        ({"stiffness": 1e5, "damping": 0.01}, 8),
        ({"stiffness": 1e5, "restitution": 0.97, "time_step": 1e-3}, 8),  # 0.008 steps a contact
        ({"stiffness": 1e5, "restitution": 0.97, "contact_steps": 12}, 12),
        ({"stiffness": 1e5, "restitution": 0.97, "time_step": 1e-6}, 7.99),
        ({"contact_time": 1e-6, "restitution": 0.97, "contact_steps": 2}, 8),
        ({"max_overlap": 0.002, "restitution": 0.97}, 8),
    ],
)
def test_advice_is_for_the_spring_given(given, taken):
    """No time step in it is above a quarter of that spring's contact time, whatever softer springs would allow."""
    d = soft_sphere(**BEAD, **given)
    t_c, advice = d.contact_time_s, d.advice
    assert advice.largest_time_step_s == pytest.approx(t_c / 4, rel=1e-12)
    assert advice.time_step_s == pytest.approx(t_c / taken, rel=1e-2)
    assert advice.best_contact_steps == int(taken)
    assert f"{1e9 * advice.time_step_s:.3g} ns" in advice.text or f"{1e6 * advice.time_step_s:.3g} us" in advice.text


def test_advice_says_which_springs_would_do():
    soft = soft_sphere(**BEAD, stiffness=1.0, restitution=0.9)
    least = float(soft.advice.text.split("k_n of at least ")[1].split()[0])
    assert "too soft: the overlap at the impact speed" in soft.advice.text
    assert soft_sphere(**BEAD, stiffness=1.01 * least, restitution=0.9).ok
    glass = {"youngs_modulus": 7e10, "poisson_ratio": 0.22}
    stiff = soft_sphere(**BEAD, **glass, stiffness=1e9, restitution=0.9)
    most = float(stiff.advice.text.split("k_n of at most ")[1].split()[0])
    assert "too stiff: Hertz" in stiff.advice.text
    assert soft_sphere(**BEAD, **glass, stiffness=0.99 * most, restitution=0.9).ok
    endless = soft_sphere(**BEAD, stiffness=1.0, damping=1.0, ending="zero-overlap")
    assert endless.advice.time_step_s is None
    assert "lower the damping" in endless.advice.text


def test_the_bound_that_decides_is_named():
    """Surface waves round a soft, fast sphere outlast Hertz's contact: it is Rayleigh's time that asks."""
    d = soft_sphere(diameter=0.015, density=1120.0, restitution=0.5, contact_steps=8, time_step=1e-3,
                    impact_speed=2.0, youngs_modulus=3e5, poisson_ratio=0.3)  # fmt: skip
    first, second = ("Rayleigh", d.rayleigh_time_s), ("Hertz", d.hertz_contact_time_s)
    name, time = max(first, second, key=lambda pair: pair[1])
    assert f"{name} asks {1e3 * time:.3g} ms" in d.advice.text
    fast = soft_sphere(diameter=0.015, density=1120.0, restitution=0.5, contact_steps=8, time_step=1e-3,
                       impact_speed=200.0, youngs_modulus=3e5, poisson_ratio=0.3)  # fmt: skip
    assert fast.rayleigh_time_s > fast.hertz_contact_time_s
    assert f"Rayleigh asks {1e3 * fast.rayleigh_time_s:.3g} ms" in fast.advice.text


def test_an_input_does_not_move_its_own_limit():
    wide = soft_sphere(**BEAD, restitution=0.9, max_overlap=0.02)
    found = {v.name: v for v in wide.verdicts}["max_overlap"]
    assert (found.ok, found.severity, found.limit) == (False, "fail", 0.005)
    assert str(found) == "FAIL overlap 2 % d > 0.5 % (at 14.8 cm/s)"
    told = soft_sphere(**BEAD, restitution=0.9, max_overlap=0.02, overlap_limit=0.03)
    found = {v.name: v for v in told.verdicts}["max_overlap"]
    assert (found.ok, found.severity, found.limit) == (True, "note", 0.02)
    assert "> 0.5 %, the usual limit (at 14.8 cm/s); within the 2 % allowed here" in found.text
    tight = soft_sphere(**BEAD, restitution=0.9, max_overlap=0.002)
    assert tight.overlap_limit_fraction == 0.002
    assert tight.ok


def test_verdicts_are_said_as_a_reader_says_them():
    d = soft_sphere(diameter=0.015, density=1120.0, fluid_density=962.0, viscosity=0.113, restitution=0.5,
                    contact_steps=3, time_step=1e-3, impact_speed=0.041, youngs_modulus=1e6,
                    poisson_ratio=0.3)  # fmt: skip
    assert [str(v) for v in d.verdicts] == [
        "ok   damping ratio 0.255 < 1 (underdamped: the sphere rebounds)",
        "FAIL contact resolved by 3 steps < 4",
        "ok   overlap 0.214 % d <= 0.5 % (at 4.1 cm/s)",
        "ok   overlap at rest 0.0225 % d <= 0.5 % (under the submerged weight)",
        "FAIL contact time 3 ms < 5.28 ms (Hertz, at 4.1 cm/s)",
        "ok   contact time 3 ms >= 1.37 ms (Rayleigh)",
        "note: viscous damping governs (St 1.35 < 10); e_n and k_n hardly matter",
    ]
    assert all((v.severity == "fail") == (not v.ok) for v in d.verdicts)
    assert not d.ok


def test_little_rebound_in_the_liquid_is_a_note_and_breaks_nothing():
    d = soft_sphere(**BEAD, restitution=0.97, contact_steps=15, time_step=1e-4, impact_speed=0.01)
    found = d.verdicts[-1]
    assert (found.name, found.ok, found.severity) == ("wet_rebound", True, "note")
    assert d.ok


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


def test_wet_restitution_has_the_added_mass_of_both():
    light, heavy = {"diameter": 0.01, "density": 1100.0}, {"diameter2": 0.004, "density2": 7800.0}
    known = {"fluid_density": 1000.0, "viscosity": 1e-3, "impact_speed": 0.1, "restitution": 0.97}
    d = soft_sphere(**light, **heavy, **known, contact_time=1e-4)
    m = [math.pi / 6 * 1e-6 * (1100.0 + 500.0), math.pi / 6 * 0.064e-6 * (7800.0 + 500.0)]
    a = 0.005 * 0.002 / 0.007
    stokes = m[0] * m[1] / (m[0] + m[1]) * 0.1 / (6 * math.pi * 1e-3 * a * a)
    assert d.wet_restitution == pytest.approx(0.97 * math.exp(-35.0 / stokes), rel=1e-12)
    # of one density it is the published form, St (1 + rho_f/(2 rho_p))
    same = soft_sphere(**light, **known, contact_time=1e-4)
    assert same.wet_restitution == pytest.approx(wet_restitution(0.97, same.stokes_number, 1.1), rel=1e-12)


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
