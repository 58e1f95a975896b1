"""The closed forms against an independent integration of the contact's equation of motion."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rdpm.design import damping_ratio, dimensionless_contact_time, restitution
from rdpm.design.oscillator import peak_overlap_factor, peak_time

IN_E = 1e-9  # absolute; the integration's own error is below 1e-11
IN_TIME = 1e-8  # relative
RATIOS = [0.0, 1e-3, 0.05, 0.3, 0.7, 0.95, 1.0 - 1e-4, 1.0, 1.0 + 1e-9, 1.3, 2.0, 3.0]


def integrate(zeta, event, start=1.0):
    event.terminal, event.direction = True, -1
    found = solve_ivp(
        lambda t, y: (y[1], -2 * zeta * y[1] - y[0]), (0, 60), (0.0, start), "DOP853", events=event,
        rtol=1e-13, atol=1e-18,
    )  # fmt: skip
    return found.t_events[0][0], found.y_events[0][0]


@pytest.mark.parametrize("zeta", RATIOS)
def test_zero_force_end_and_peak(zeta):
    t, (x, v) = integrate(
        zeta, lambda t, y: y[0] + 2 * zeta * y[1] + (1.0 if t < 1e-9 and zeta == 0 else 0.0)
    )
    assert dimensionless_contact_time(zeta) == pytest.approx(t, rel=IN_TIME)
    assert restitution(zeta) == pytest.approx(-v, abs=IN_E)
    t, (x, v) = integrate(zeta, lambda t, y: y[1])
    assert peak_time(zeta) == pytest.approx(t, rel=IN_TIME)
    assert peak_overlap_factor(zeta) == pytest.approx(x, rel=IN_TIME)


@pytest.mark.parametrize("zeta", [z for z in RATIOS if z < 0.96])
def test_zero_overlap_end(zeta):
    t, (_, v) = integrate(zeta, lambda t, y: y[0] if t > 1e-6 else 1.0)
    assert dimensionless_contact_time(zeta, "zero-overlap") == pytest.approx(t, rel=IN_TIME)
    assert restitution(zeta, "zero-overlap") == pytest.approx(-v, abs=IN_E)


@pytest.mark.parametrize("ending", ["zero-force", "zero-overlap"])
def test_inversion_holds_from_end_to_end(ending):
    e = np.concatenate([[1.0], 1.0 - np.logspace(-15, -1, 40), np.logspace(-12, -0.1, 60)])
    back = np.asarray(restitution(damping_ratio(e, ending), ending))
    # ln(e) is as large as 28 and critical damping squeezes it further: 1e-13 relative to e and ln(e) each
    tolerance = 1e-13 * (1 + np.abs(np.log(e)))
    if (
        ending == "zero-overlap"
    ):  # zeta tends to 1 as 1 - pi^2/(2 ln^2 e): its round-off is magnified by ln^3(e)/pi^2
        tolerance = tolerance + 2e-16 * np.abs(np.log(e)) ** 3
    assert np.all(np.abs(back / e - 1) < tolerance)


def test_nothing_jumps_at_critical_damping():
    z = 1.0 + np.array([-1e-6, -1e-9, -1e-12, 0.0, 1e-12, 1e-9, 1e-6])
    # d ln e/d zeta = -2 (h + h') = -4/3 and h' = -1/3 at zeta = 1
    assert np.allclose(np.asarray(restitution(z)) * np.exp(2.0) - 1.0, -4.0 / 3.0 * (z - 1.0), atol=1e-11)
    assert np.allclose(np.asarray(peak_time(z)) - 1.0, -(z - 1.0) / 3.0, atol=1e-11)


def test_limits_are_exact():
    assert damping_ratio(1.0) == 0.0
    assert damping_ratio(1.0, "zero-overlap") == 0.0
    assert damping_ratio(0.0, "zero-overlap") == 1.0
    assert restitution(0.0) == 1.0
    assert restitution(1.5, "zero-overlap") == 0.0
    assert dimensionless_contact_time(0.0) == np.pi
    assert dimensionless_contact_time(1.0, "zero-overlap") == np.inf
