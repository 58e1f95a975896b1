r"""A sphere released from rest in Stokes flow, at density ratios from 0.01 to 1000.

With added mass and history force the speed obeys, in units of the Stokes speed and of :math:`\tau=\nu t/a^2`,

.. math:: m\,U' = 1 - U - \frac{1}{\sqrt\pi}\int_0^\tau \frac{U'(s)}{\sqrt{\tau-s}}\,ds,\qquad
          m = \tfrac29\left(\frac{\rho_p}{\rho_f}+\tfrac12\right)

(Basset 1888; Maxey and Riley, Phys. Fluids 26 (1983) 883-889), solved exactly below. The box is periodic with zero
mean flow. The sphere's images respond by what unsteady Stokeslets at a lattice add, to first order in a/L; that is part
of the reference, and reaches some 5 % when sqrt(nu t) is a quarter of the box.
"""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from rdpm.config.load import load_case
from rdpm.errors import GuardError
from rdpm.setup import Simulation
from rdpm.studies.validation.result import Chart, Curve, Found, Row, Tell

__all__ = ["basset", "basset_speed"]

SOURCE = "Basset 1888, exact"

Floats = NDArray[np.float64]

RATIOS = (0.5, 1.155, 2.56, 10.0)
WIDER = (0.01, 0.1, 100.0, 1000.0)

#: Cells a diameter, coarse and where the band of settling holds; diameters a box; viscous number nu dt / h^2 of a step.
COARSE, FINE = 8, 12
BOX, STEP = 8, 0.25

SETTLING_BAND, START_BAND = 0.03, 0.10


def basset_speed(density_ratio: float, tau: Floats) -> Floats:
    r"""Speed over the Stokes speed of a sphere released from rest in unbounded fluid.

    Parameters
    ----------
    density_ratio : float, [-]
        Body over fluid; > 0, not 0.625, where the two roots meet.
    tau : ndarray, [-]
        nu t / a^2, > 0.

    Returns
    -------
    ndarray, [-]
        By partial fractions of the Laplace transform :math:`1/(s(ms+\sqrt s+1))`.

    Examples
    --------
    >>> basset_speed(2.56, np.array([1.0])).round(6)   # 0.456324 by numerical inversion
    array([0.456324])
    """
    from scipy.special import wofz

    m = 2.0 / 9.0 * (density_ratio + 0.5)
    root = np.sqrt(complex(1.0 - 4.0 * m))
    p, q = (-1.0 + root) / (2.0 * m), (-1.0 - root) / (2.0 * m)
    # exp(p^2 t) erfc(-p sqrt t), without overflow
    first, second = (wofz(-1j * x * np.sqrt(tau)) for x in (p, q))
    speed: Floats = (1.0 + first / (m * p * (p - q)) + second / (m * q * (q - p))).real
    return speed


def _image_speed(density_ratio: float, tau: Floats, box: float) -> Floats:
    """What the images add to the speed, over the Stokes speed; box in radii."""
    t = np.linspace(0.0, tau[-1], 4001)[1:]
    dt = t[0]
    force = 1.0 - 2.0 / 9.0 * density_ratio * np.gradient(basset_speed(density_ratio, t), t)  # on the fluid
    middle = t - 0.5 * dt
    n = np.arange(1, 40)
    wave = np.exp(-np.outer(middle, (2.0 * np.pi * n / box) ** 2)).sum(axis=1)
    # Green's function of the lattice less that of one point, without the uniform flow that is held at zero
    near = middle < (box / 12.0) ** 2
    lattice = np.where(near, 0.0, (1.0 + 2.0 * wave) ** 3 - box**3 / (4.0 * np.pi * middle) ** 1.5) - 1.0
    green = 6.0 * np.pi * 2.0 / 3.0 / box**3 * lattice
    added = np.convolve(force, green)[: t.size] * dt
    at: Floats = np.interp(tau, t, added)
    return at


def _release(density_ratio: float, across: int, steps: int) -> tuple[Floats, Floats]:
    """Viscous time and speed over the Stokes speed."""
    box, weight = float(BOX), 1e-4  # weight: so small that Re stays below 1e-3
    stokes = weight / (3.0 * np.pi)
    volume = np.pi / 6.0
    case = {
        "domain": {
            "size": [box] * 3,
            "boundary": dict.fromkeys("xyz", "periodic"),
            "gravity": [0.0, 0.0, -weight / volume / (density_ratio - 1.0)],
        },
        "fluid": {"density": 1.0, "kinematic_viscosity": 1.0, "zero_mean_flow": True},
        "bodies": [{"diameter": 1.0, "density": density_ratio, "centers": [[0.52 * box, 0.51 * box, 0.505 * box]]}],
        "resolution": {"cells": [across * BOX] * 3},
        "time": {"end": 100.0, "step": STEP / across**2, "diffusion": "stabilised"},
        "contact": {"stiffness": 1.0, "restitution": 0.9},
    }
    simulation = Simulation(load_case(case))
    speed = []
    for _ in range(steps):
        simulation.advance()
        speed.append(-simulation.bodies.velocity[0, 2] / stokes)
    tau: Floats = 4.0 * simulation.dt * np.arange(1.0, steps + 1.0)
    return tau, np.array(speed)


def basset(quick: bool, tell: Tell) -> Found:
    """Speeds while sqrt(nu t) lies between two cells and a quarter of the box; the start; stability."""
    curves = []
    for across, ratio in itertools.product((COARSE,) if quick else (COARSE, FINE), (0.5, 2.56) if quick else RATIOS):
        what = f"density ratio {ratio}, {across} cells/d"
        tell(what)
        longest = 0.25 * BOX * across  # [cells]
        tau, speed = _release(ratio, across, int(longest**2 / STEP) // (4 if quick else 1))
        exact = basset_speed(ratio, tau)
        here = exact + _image_speed(ratio, tau, 2.0 * BOX)
        window = tau >= 4.0 * (2.0 / across) ** 2
        worst = float(abs(speed[window] / here[window] - 1.0).max())
        band = SETTLING_BAND if across == FINE else None
        yield Row(f"settling, {what}: largest difference", worst, None, band, "", SOURCE)
        one = np.searchsorted(tau, 4.0 * (1.0 / across) ** 2)  # mean acceleration until sqrt(nu t) is one cell
        yield Row(f"initial acceleration, {what}", float(speed[one]), float(here[one]), START_BAND, "", SOURCE)
        if across == (COARSE if quick else FINE):
            curves += [
                Curve(f"rdpm, {ratio:g}", tau, speed),
                Curve(f"exact, {ratio:g}", tau[7::24], here[7::24], True),
            ]
    for ratio in (0.1, 100.0) if quick else WIDER:
        tell(f"density ratio {ratio}")
        try:
            tau, speed = _release(ratio, COARSE, 200)
            worst = float(abs(speed / basset_speed(ratio, tau) - 1.0)[100:].max())
        except GuardError:
            worst = float("inf")
        yield Row(f"settling, density ratio {ratio}: largest difference", worst, None, None, "", SOURCE)
    yield Chart(
        "basset",
        "Released from rest in Stokes flow",
        "nu t / a²",
        "speed / Stokes speed",
        f"{across} cells a diameter, periodic box of {BOX} diameters, zero mean flow; by density ratio",
        curves,
    )
