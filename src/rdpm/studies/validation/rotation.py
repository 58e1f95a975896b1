r"""Rotation in Stokes flow: the torque on a turning sphere, and a free sphere in shear.

*Torque.* A sphere turns at a given rate in a periodic box. A lattice of torques lets the fluid between turn backwards
by the solid fraction times the rate: the reference is :math:`8\pi\mu a^3\Omega\,(1+\phi)`, to first order.

*Shear.* A neutrally buoyant sphere, free, midway between two walls that slide against each other:
:math:`\omega/G = 1/2 - 0.0540\,Re_s^{3/2}`, :math:`Re_s=Ga^2/\nu` (Meibohm, Candelier, Rosen, Einarsson, Lundell,
Mehlig, Phys. Rev. Fluids 1 (2016) 084203).
"""

from __future__ import annotations

import numpy as np

from rdpm.config.load import load_case
from rdpm.setup import Simulation
from rdpm.studies.validation.result import Found, Row, Tell

__all__ = ["rotation"]

#: Diameters along the box; viscous number nu dt / h^2 of a step; viscous times a^2/nu until steady.
BOX, STEP, STEADY = 4, 0.8, 6.0

#: Cells a diameter -> band of the torque.
TORQUE_BANDS = {16: 0.04, 24: 0.02}
SHEAR_BAND = 0.02

#: Re_s of the sphere in shear: small enough for the expansion.
SHEAR_RE = 0.05

#: The sphere's centre from a corner of a cell [cells].
OFFSET = (0.125, 0.375, 0.25)


def _case(across: int) -> dict[str, object]:
    box = float(BOX)
    center = [0.5 * box + o / across for o in OFFSET]
    return {
        "domain": {"size": [box] * 3, "boundary": dict.fromkeys("xyz", "periodic"), "gravity": [0, 0, 0]},
        "fluid": {"density": 1.0, "kinematic_viscosity": 1.0},
        "bodies": [{"diameter": 1.0, "density": 1.0, "centers": [center]}],
        "resolution": {"cells": [BOX * across] * 3},
        "time": {"end": 10.0, "step": STEP / across**2, "diffusion": "stabilised"},
    }


def torque(across: int) -> float:
    """Torque over 8 pi mu a^3 Omega of a sphere in a periodic box of 4 diameters, at so many cells a diameter."""
    rate = 1e-3
    case = _case(across)
    case["bodies"][0]["motion"] = {"rotation": [0.0, 0.0, rate]}  # type: ignore[index]
    simulation = Simulation(load_case(case))
    simulation.run(until=STEADY / 4.0)
    immersed = simulation.system.immersed
    assert immersed is not None
    return float(-immersed.hydrodynamic_torque[0, 2] / (np.pi * rate))


def rate_in_shear(across: int) -> float:
    """Angular velocity over the shear rate of a free sphere, at so many cells a diameter."""
    shear = 4.0 * SHEAR_RE
    half = 0.5 * BOX * shear
    case = _case(across)
    domain = case["domain"]
    assert isinstance(domain, dict)
    domain["boundary"] = {"x": "periodic", "y": "periodic", "z": "wall"}
    domain["wall_velocity"] = {"z_lower": [-half, 0, 0], "z_upper": [half, 0, 0]}
    case["bodies"][0]["centers"] = [[0.5 * BOX] * 3]  # type: ignore[index]
    simulation = Simulation(load_case(case))
    fluid = simulation.fluid
    assert fluid is not None
    height = (np.arange(fluid.u.shape[0]) - 0.5) / across - 0.5 * BOX
    fluid.set_velocity(shear * height[:, None, None] * np.ones_like(fluid.u), 0.0, 0.0)
    simulation.run(until=STEADY / 4.0)
    return float(simulation.bodies.angular_velocity[0, 1] / shear)


def rotation(quick: bool, tell: Tell) -> Found:
    """Torque at 8, 16 and 24 cells a diameter; angular velocity in shear at 16 (quick: 8 and 12)."""
    exact = 1.0 + np.pi / 6.0 / BOX**3
    for across in (8, 16) if quick else (8, 16, 24):
        tell(f"torque, {across} cells a diameter")
        yield Row(
            f"torque / (8 pi mu a^3 Omega), {across} cells/d",
            torque(across),
            exact,
            TORQUE_BANDS.get(across),
            source="Lamb; images by the solid fraction",
        )
    for across in (8,) if quick else (8, 16):
        tell(f"free sphere in shear, {across} cells a diameter")
        yield Row(
            f"angular velocity / shear rate, Re_s {SHEAR_RE}, {across} cells/d",
            rate_in_shear(across),
            0.5 - 0.0540 * SHEAR_RE**1.5,
            SHEAR_BAND,
            source="Meibohm et al. 2016",
        )
