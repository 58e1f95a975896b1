"""Bodies that move so slowly in Stokes flow that they hardly change place, at one gap after another."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from rdpm.config.load import load_case
from rdpm.particles.immersed import ImmersedBodies
from rdpm.setup import Simulation

__all__ = ["SPEED", "slow_motion"]

#: Speed of the bodies; diameter, density and viscosity are 1.
SPEED = 1e-7


def slow_motion(
    pair: str,
    across: int,
    gaps: tuple[float, ...],
    offset: tuple[float, float, float],
    motions: Sequence[dict[str, Any]],
    *,
    box: tuple[float, float, float],
    step: float,
    settling: tuple[float, float],
) -> Iterator[ImmersedBodies]:
    """Bodies at a given motion, once the flow is steady at each gap.

    Parameters
    ----------
    pair : str
        "wall" or "spheres".
    across : int
        Cells a diameter.
    gaps : tuple of float, [radii]
        From wide to narrow.
    offset : tuple of float, [cells]
        Of the sphere, or of the middle of two, from a corner of a cell; the third only of two.
    motions : sequence of dict
        Motion of each body, as in a case file; the first of two is above.
    box : tuple of float, [diameters]
        Edges; two spheres have one more in height.
    step : float, [-]
        Viscous number nu dt / h^2.
    settling : tuple of float, [radius squared over viscosity]
        Until the flow is steady from rest, and from one gap to the next.
    """
    x, y = (0.5 * edge + o / across for edge, o in zip(box[:2], offset[:2], strict=True))
    is_wall = pair == "wall"
    size = [*box[:2], box[2] if is_wall else box[2] + 1.0]

    def heights(gap: float) -> list[float]:
        # two spheres: half of the gap is between cells, so that neither sits like the other on the grid
        if is_wall:
            return [0.5 + 0.5 * gap]
        return [0.5 * size[2] + sign * (0.5 + 0.25 * gap) + offset[2] / across for sign in (1, -1)]

    simulation = Simulation(load_case({
        "domain": {"size": size, "boundary": {"x": "periodic", "y": "periodic"}, "gravity": [0, 0, 0]},
        "fluid": {"density": 1.0, "kinematic_viscosity": 1.0},
        "bodies": [
            {"diameter": 1.0, "density": 1.0, "centers": [[x, y, z]], "motion": motion}
            for z, motion in zip(heights(gaps[0]), motions, strict=True)
        ],
        "resolution": {"cells": [round(edge * across) for edge in size]},
        "time": {"end": 100.0, "step": step / across**2, "diffusion": "stabilised"},
        "contact": {"stiffness": 1.0, "restitution": 0.9, "lubrication": False},
    }))  # fmt: skip
    immersed = simulation.system.immersed
    assert isinstance(immersed, ImmersedBodies)
    for n, gap in enumerate(gaps):
        simulation.bodies.position[:, 2] = heights(gap)
        for _ in range(int(settling[1 if n else 0] / step * (0.5 * across) ** 2)):
            simulation.advance()
        yield immersed
