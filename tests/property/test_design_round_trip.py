"""Any designed set, fed back through any other way in, gives the same set."""

from itertools import combinations

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from rdpm.design import contact_parameters, peak_overlap, restitution, soft_sphere
from rdpm.design.solve import Known, solve_contact

SAME = (
    1e-8  # k_n and t_c fix zeta through 1 - (pi/tau)^2: round-off is magnified by 1/zeta^2 < 4e5 for e < 0.99
)

masses = st.floats(1e-12, 1e3)
times = st.floats(1e-7, 1e1)
restitutions = st.floats(0.02, 0.99)
endings = st.sampled_from(["zero-force", "zero-overlap"])


@given(masses, restitutions, times, endings)
def test_every_pair_gives_the_same_contact(mass, e, t_c, ending):
    k, eta = contact_parameters(mass, e, t_c, ending)
    known = {
        "stiffness": k, "damping": eta, "restitution": e, "contact_time": t_c,
        "overlap_time": peak_overlap(mass, k, eta, 1.0),
    }  # fmt: skip
    for pair in combinations(known, 2):
        m, k2, eta2 = solve_contact(Known(mass=mass, **{n: known[n] for n in pair}), ending)
        assert (m, k2, eta2) == pytest.approx((mass, k, eta), rel=SAME), pair


@given(masses, restitutions, times, endings)
def test_mass_follows_from_three(mass, e, t_c, ending):
    k, eta = contact_parameters(mass, e, t_c, ending)
    known = {"stiffness": k, "damping": eta, "contact_time": t_c}
    for pair in combinations(known, 2):
        found = solve_contact(Known(restitution=e, **{n: known[n] for n in pair}), ending)
        assert found == pytest.approx((mass, k, eta), rel=SAME), pair


@given(
    st.floats(1e-5, 0.1), st.floats(100, 2e4), restitutions, st.floats(4, 50), st.floats(1e-6, 1e-2), endings
)
def test_front_door_agrees_with_itself(diameter, density, e, steps, dt, ending):
    bodies = {"diameter": diameter, "density": density, "ending": ending, "impact_speed": 0.01}
    first = soft_sphere(**bodies, restitution=e, contact_steps=steps, time_step=dt)
    assume(first.max_overlap_fraction <= 0.05)
    again = soft_sphere(**bodies, stiffness=first.stiffness_N_m, damping=first.damping_N_s_m, time_step=dt)
    overlap = soft_sphere(
        **bodies, restitution=e, max_overlap=first.max_overlap_fraction, contact_steps=steps
    )
    for other in (again, overlap):
        assert other.restitution == pytest.approx(e, rel=SAME)
        assert other.contact_steps == pytest.approx(steps, rel=SAME)
        assert other.time_step_s == pytest.approx(dt, rel=SAME)
        assert other.max_overlap_fraction == pytest.approx(first.max_overlap_fraction, rel=SAME)


@given(st.floats(0, 50), st.floats(0, 50))
def test_more_damping_never_rebounds_more(a, b):
    low, high = sorted((a, b))
    for ending in ("zero-force", "zero-overlap"):
        assert restitution(low, ending) >= restitution(high, ending)


@given(
    st.floats(1e-4, 0.1), st.floats(100, 2e4), st.floats(1e-4, 0.1), st.floats(100, 2e4), st.floats(1e-4, 10.0),
    restitutions, endings, st.booleans(),
)  # fmt: skip
def test_two_bodies_have_no_order(d1, rho1, d2, rho2, speed, e, ending, is_fast):
    """Swapped, the same pair has the same design: numbers, verdicts, advice."""
    known = {"fluid_density": 1000.0, "viscosity": 1e-3, "restitution": e, "contact_time": 1e-4, "ending": ending}
    if is_fast:
        known["impact_speed"] = speed
    one = soft_sphere(diameter=d1, density=rho1, diameter2=d2, density2=rho2, **known).to_dict()
    other = soft_sphere(diameter=d2, density=rho2, diameter2=d1, density2=rho1, **known).to_dict()
    assert one.pop("spheres") == other.pop("spheres")[::-1]
    assert one == other
