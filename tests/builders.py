"""What several test files build: spheres in ten Cate's oil, the folder of a made-up run."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np

import rdpm
from rdpm.io.provenance import environment, write_json
from rdpm.io.tables import CONTACT_COLUMNS, HISTORY_COLUMNS, PARTICLE_COLUMNS, TableWriter
from rdpm.io.vtkhdf import FieldWriter
from rdpm.results.run_folder import RunFolder

D = 0.015
BOX, CELLS, SPACING = (0.06, 0.05, 0.24), (24, 20, 96), (0.0025, 0.0025, 0.0025)


#: A nylon sphere in oil between walls (ten Cate et al. 2002, case E3), 6 cells a diameter.
OIL_CASE = {
    "domain": {"size": [0.06, 0.06, 0.09]},
    "fluid": {"density": 962.0, "viscosity": 0.113},
    "bodies": [{"diameter": D, "density": 1120.0, "centers": [[0.03, 0.03, 0.06]]}],
    "contact": {"restitution": 0.9, "contact_steps": 8},
    "resolution": {"cells_per_diameter": 6},
    "time": {"end": 0.5},
}


def oil_case(**changes: Any) -> dict[str, Any]:
    """`OIL_CASE` with ``time__step=1e-3`` for time.step, ``contact={...}`` for a whole table; None removes a key."""
    made = copy.deepcopy(OIL_CASE)
    for key, value in changes.items():
        node, (*path, last) = made, key.split("__")
        for name in path:
            node = node.setdefault(name, {})
        if value is None:
            node.pop(last, None)
        else:
            node[last] = value
    return made


def in_oil(threads: int = 1, ranks: Any = None, **changes: Any) -> rdpm.Simulation:
    """A simulation of `oil_case`."""
    return rdpm.Simulation(rdpm.load_case(oil_case(**changes)), threads=threads, ranks=ranks)


def pair_motion(times):
    """Two spheres: the upper one catches up (1.2 s), they turn (2 s) and part: (T, 2, 3)."""
    gap = np.interp(times, [0.0, 0.4, 1.2, 2.2, 3.0], [D, 0.97 * D, -0.003 * D, -0.003 * D, 0.8 * D])
    theta = np.radians(np.interp(times, [0.0, 1.2, 2.0, 3.0], [1.0, 3.0, 45.0, 85.0]))
    height = 0.20 - 0.055 * times + 0.01 * np.exp(-4 * times)
    middle = np.stack([0.03 + 0 * times, 0.025 + 0 * times, height], axis=1)
    line = 0.5 * (D + gap)[:, None] * np.stack([np.sin(theta), 0 * theta, np.cos(theta)], axis=1)
    return np.stack([middle + line, middle - line], axis=1)


def cloud_motion(times):
    """27 spheres that sink and drift through periodic boundaries: (T, 27, 3)."""
    rng = np.random.default_rng(1)
    grid = np.stack(np.meshgrid(*[np.arange(3)] * 3), -1).reshape(-1, 3) * np.array(BOX) / 3 + 0.01
    drift = rng.normal(0.0, 0.01, (27, 3)) + np.array([0.0, 0.0, -0.06])
    return grid + times[:, None, None] * drift


def write_particles(path, times, position, periodic):
    velocity = np.gradient(position, times, axis=0)
    position = position % np.array(BOX) if periodic else position
    loads = np.zeros(len(PARTICLE_COLUMNS) - 19)
    with TableWriter(path, PARTICLE_COLUMNS) as table:
        for n, time in enumerate(times):
            table.write(
                (time, b, *position[n, b], *velocity[n, b], 0.0, 6.0 - 12 * b, 0.0, *np.zeros(6), 0.01, -5, *loads)
                for b in range(position.shape[1])
            )


def write_flow(path, times, position):
    """Each body drags its surroundings along: a smooth made-up field."""
    fields = FieldWriter(path, CELLS, SPACING)
    axes = [(np.arange(n) + 0.5) * b / n for b, n in zip(BOX, CELLS, strict=True)]
    z, y, x = np.meshgrid(*axes[::-1], indexing="ij")
    for time in times:
        u = np.zeros((*z.shape, 3))
        for body in position(np.array([time, time + 1e-3])).transpose(1, 0, 2):
            body = body - np.array(BOX) * np.floor(body[0] / np.array(BOX))
            wake = np.where(z > body[0, 2], 3.0, 1.0)
            r2 = (x - body[0, 0]) ** 2 + (y - body[0, 1]) ** 2 + ((z - body[0, 2]) / wake) ** 2
            u += np.exp(-r2 / D**2)[..., None] * (body[1] - body[0]) / 1e-3
        fields.write(time, u, u[..., 2])


CONTACTS = [
    (0, 1, "sphere-sphere", 1.2, 0.9, 430.0, 0.003, 0.012, 0.001, 0.08, 0.24, -1e-7, "no"),
    (1, -5, "sphere-wall", 2.8, 0.016, 8.0, 0.006, 0.05, 0.004, 0.08, 1.2, -1e-6, "overlap (pushed)"),
]
CASE = """title = "Two spheres: drafting & kissing"
[domain]
size = [0.06, 0.05, 0.24]
boundary = {{ x = "{0}", y = "{0}", z = "{0}" }}
gravity = [0.0, 0.0, -9.81]
{1}
[[bodies]]
diameter = 0.015
density = 1120.0
"""
FLUID = "[fluid]\ndensity = 962.0\nviscosity = 0.113"
PAIR = {"kind": "sphere-sphere", "reduced_mass_kg": 9.9e-4, "stiffness_N_m": 40.1, "damping_N_s_m": 0.086}
SUMMARY = {
    "rdpm_version": "0.1.0", "status": "done", "cells": CELLS, "spacing_m": SPACING,
    "cells_per_diameter": 6.0, "steps": 1500, "time_s": 3.0, "dt_s": 2e-3, "dt_limit": "contact",
    "wall_s": 21.4, "ns_per_cell_step": 24.0, "threads": 2, "ranks": 1, "peak_memory_bytes": 210_000_000,
    "max_divergence": 1e-12, **environment(),
    "contact": {"model": "soft-sphere", "ending": "zero-force", "contact_time_s": 0.016,
                "contact_steps": 8, "restitution": 0.5, "pairs": [PAIR]},
    "contacts": {"count": 2, "max_overlap_fraction": 0.006, "total_time_s": 0.9},
}


def made_up_run(folder, motion, bodies, fluid=True, boundary="wall"):
    """The folder of a run of 3 s."""
    files = RunFolder(folder)
    folder.mkdir()
    files.case.write_text(CASE.format(boundary, FLUID if fluid else ""))
    times = np.linspace(0.0, 3.0, 61)
    if bodies:
        write_particles(files.table("particles"), times, motion(times), boundary == "periodic")
    with TableWriter(files.table("contacts"), CONTACT_COLUMNS) as table:
        table.write(CONTACTS[:bodies])
    with TableWriter(files.table("history"), HISTORY_COLUMNS) as table:
        table.write((n, t, 2e-3, 0.3, 1e-12, 1e-5 * t, 1e-6, 0.0, 0.01) for n, t in enumerate(times))
    if fluid:
        write_flow(files.fields, np.linspace(0.0, 3.0, 7), motion if bodies else lambda t: np.zeros((2, 0, 3)))
    each = [{"id": n, "diameter_m": D, "max_speed_m_s": 0.06} for n in range(bodies)]
    write_json(files.summary, SUMMARY | {"bodies": each})
    return folder
