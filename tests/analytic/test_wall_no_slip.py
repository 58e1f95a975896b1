"""The fluid does not slip on walls within the box: tubes against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

import rdpm
from rdpm.particles.walls import wall_points
from rdpm.surfaces import Cylinder, Plane

RADIUS, NU = 5e-3, 1e-4


def _tube(cells, wall=None, fluid=None, until=1.2, time=None, width=1.3, **tables):
    """A tube along the periodic z, some cells wide, run for this many diffusion times R^2/nu."""
    h = 2 * RADIUS / cells
    edge = round(width * cells) * h
    case = {
        "domain": {"size": [edge, edge, 4 * h], "gravity": [0, 0, 0], "boundary": {"z": "periodic"}},
        "fluid": {"density": 1000.0, "kinematic_viscosity": NU, **(fluid or {})},
        "walls": [{"shape": "cylinder", "point": [0.5 * edge, 0.5 * edge, 0], "axis": [0, 0, 1],
                   "diameter": 2 * RADIUS, **(wall or {})}],
        "resolution": {"cells": [round(edge / h)] * 2 + [4]},
        "time": time or {"end": 1.0, "step": 0.07 * h**2 / NU},
        **tables,
    }  # fmt: skip
    sim = rdpm.Simulation(rdpm.load_case(case), threads=1)
    sim.run(until=until * RADIUS**2 / NU)
    x = (np.arange(sim.fluid.grid.cells[0]) + 0.5) * sim.fluid.grid.spacing[0] - 0.5 * edge
    return sim, h, x


def test_flow_through_a_tube_is_a_parabola() -> None:
    """Body force f: w = f (R^2 - r^2) / (4 nu); the radius is met within an eighth of a cell."""
    force = 0.05
    sim, h, x = _tube(12, fluid={"body_force": [0, 0, force]})
    w = sim.fluid.w[2, 1:-1, 1:-1]
    square = x[None, :] ** 2 + x[:, None] ** 2
    inner = square < (0.7 * RADIUS) ** 2
    effective = np.sqrt(np.mean(4 * NU / force * w[inner] + square[inner]))
    assert abs(effective - RADIUS) < h / 8
    exact = force / (4 * NU) * (effective**2 - square[inner])
    assert np.allclose(w[inner], exact, rtol=0.02)


def test_a_moving_tube_moves_its_fluid() -> None:
    """As a solid, turning about its axis and sliding along it; four cells behind the wall move with it."""
    turning, speed = 3.0, 0.02
    sim, _, x = _tube(12, wall={"angular_velocity": turning, "velocity": [0, 0, speed]}, width=1.8)
    middle = len(x) // 2
    across, along = (q[2, 1:-1, 1:-1][middle] for q in (sim.fluid.v, sim.fluid.w))
    inner = np.abs(x) < 0.7 * RADIUS
    assert np.sum(across[inner] * x[inner]) / np.sum(x[inner] ** 2) == pytest.approx(turning, rel=0.02)
    assert np.allclose(along[inner], speed, rtol=5e-3)


def test_a_sphere_settles_slower_in_a_tube() -> None:
    """Wall factor of Haberman and Sayre (1958), half the tube's diameter: at 8 cells a diameter 10 to 15 % high.

    Two surfaces held by markers, four cells apart: as high as of two spheres (docs/validation.md).
    """
    d, mu, density, ratio = 5e-3, 0.1, 1000.0, 1.5
    h, share = d / 8, 0.5
    exact = (1 - 0.75857 * share**5) / (1 - 2.1050 * share + 2.0865 * share**3 - 1.7068 * share**5 + 0.72603 * share**6)
    stokes = 0.05 * mu / density / d
    gravity = stokes * 18 * mu / ((ratio - 1) * density * d**2)
    edge, height = 20 * h, 5 * d
    case = {
        "domain": {"size": [edge, edge, height], "gravity": [0, 0, -gravity]},
        "fluid": {"density": density, "viscosity": mu},
        "walls": [
            {"shape": "cylinder", "point": [0.5 * edge, 0.5 * edge, 0], "axis": [0, 0, 1], "diameter": d / share}
        ],
        "bodies": [{"diameter": d, "density": ratio * density, "centers": [[0.5 * edge, 0.5 * edge, 0.5 * height]]}],
        "resolution": {"cells_per_diameter": 8},
        "time": {"end": 100.0, "step": 0.07 * h**2 / (mu / density)},
    }
    sim = rdpm.Simulation(rdpm.load_case(case), threads=1)
    sim.run(until=0.12 * (d / share) ** 2 / (mu / density))
    assert 1.0 < stokes / -sim.bodies.velocity[0, 2] / exact < 1.16
    assert np.abs(sim.bodies.velocity[0, :2]).max() < 1e-6 * stokes


def test_points_of_a_wall_stand_for_its_area() -> None:
    """All points together: the area of the wall within the box, at the depth asked for behind it."""
    size, h, depth = np.array([0.1, 0.12, 0.08]), 0.002, 0.0006
    slope = Plane((0.05, 0.06, 0.04), (1.0, 0.0, 1.0))
    points, area = wall_points(slope, size, h, depth)
    assert len(points) * area == pytest.approx(0.12 * 0.08 * np.sqrt(2.0), rel=0.02)
    assert np.allclose(slope.distance(points)[0], -depth)
    tube = Cylinder((0.05, 0.06, 0.0), (0.0, 0.0, 1.0), 0.03)
    points, area = wall_points(tube, size, h, depth)
    assert len(points) * area == pytest.approx(2 * np.pi * 0.03 * 0.08, rel=0.02)
    assert np.allclose(tube.distance(points)[0], -depth)
