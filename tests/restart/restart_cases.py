"""Small cases, runs that are stopped on the way, and what two runs must share."""

import signal
from pathlib import Path

import numpy as np

import rdpm
from rdpm.io.checkpoint import read_checkpoint
from rdpm.io.vtkhdf import field_times, read_fields
from rdpm.runs.runner import run_case

TABLES = ("particles.csv", "contacts.csv", "history.csv")  # timing.csv alone may differ
WALL_TIMES = {"wall_s", "parts_s"}

GLASS = {"diameter": 0.01, "density": 2500.0}
OIL = {"density": 960.0, "viscosity": 0.05}
SOFT = {"restitution": 0.7, "contact_steps": 20, "friction": 0.3}
BOX = {"size": [0.03, 0.03, 0.05]}
QUIET = {"report": False, "fields_every": 0.02}

TWO = {**GLASS, "centers": [[0.0105, 0.015, 0.0065], [0.0195, 0.0155, 0.0165]], "velocity": [0.3, 0.1, -0.1]}

CASES = {
    # Side by side and closing, one spinning: the contact is oblique, under way from step 12 to 37, then with the floor.
    "wet contact": {
        "domain": BOX,
        "fluid": OIL,
        "bodies": [
            {
                **GLASS,
                "centers": [[0.0095, 0.015, 0.0052], [0.0205, 0.0155, 0.0056]],
                "velocity": [[0.2, 0.0, 0.0], [-0.2, 0.0, -0.02]],
                "angular_velocity": [[0.0, 20.0, 5.0], [0.0, 0.0, 0.0]],
            }
        ],
        "contact": {**SOFT, "lubrication": True},
        "resolution": {"cells_per_diameter": 5},
        "time": {"end": 0.04, "step": 0.0005},
        "output": {**QUIET, "table_every": 0.004, "fields_every": 0.01},
    },
    # Steps of up to six times the shortest on the way, from step 70 on the shortest: one sphere meets another.
    "adaptive steps": {
        "domain": BOX,
        "fluid": OIL | {"viscosity": 0.2},
        "bodies": [{**GLASS, "centers": [[0.015, 0.014, 0.04], [0.0155, 0.015, 0.0052]]}],
        "contact": {**SOFT, "contact_steps": 8},
        "resolution": {"cells_per_diameter": 5},
        "time": {"end": 0.2, "step": "adaptive"},
        "output": {**QUIET, "table_every": 0.008},
    },
    "stabilised diffusion": {
        "domain": BOX,
        "fluid": OIL | {"viscosity": 0.5},
        "bodies": [{**GLASS, "centers": [[0.015, 0.014, 0.03]]}],
        "contact": SOFT,
        "resolution": {"cells_per_diameter": 5},
        "time": {"end": 0.1, "step": 0.004, "diffusion": "stabilised"},
        "output": {**QUIET, "table_every": 0.008},
    },
    # A tube and a slope in a fluid: lagged forces of their markers; a sphere touches the slope.
    "walls": {
        "domain": BOX,
        "fluid": OIL,
        "walls": [
            {"shape": "cylinder", "point": [0.015, 0.015, 0.0], "axis": [0, 0, 1], "diameter": 0.024},
            {"shape": "plane", "point": [0.015, 0.015, 0.008], "normal": [0.5, 0.0, 1.0], "velocity": [0.0, 0.1, 0.0]},
        ],
        "bodies": [{**GLASS, "centers": [[0.015, 0.014, 0.0148]], "velocity": [0.0, 0.0, -0.1]}],
        "contact": SOFT,
        "resolution": {"cells_per_diameter": 5},
        "time": {"end": 0.03, "step": 0.0005},
        "output": {**QUIET, "table_every": 0.004},
    },
    "hertz": {
        "domain": {"size": [0.03, 0.03, 0.05]},
        "bodies": [TWO],
        "contact": {"model": "hertz", "youngs_modulus": 1e5, "poisson_ratio": 0.3, "restitution": 0.7, "friction": 0.3,
                    "impact_speed": 0.3},
        "time": {"end": 0.06, "step": 0.0005},
        "output": {**QUIET, "table_every": 0.004},
    },
    "adaptive collision time": {
        "domain": {"size": [0.03, 0.03, 0.05]},
        "bodies": [TWO],
        "contact": SOFT | {"adaptive_collision_time": True},
        "time": {"end": 0.06, "step": 0.0005},
        "output": {**QUIET, "table_every": 0.004},
    },
    "repulsive": {
        "domain": {"size": [0.03, 0.03, 0.05]},
        "bodies": [TWO],
        "contact": {"model": "repulsive", "repulsion_stiffness": 0.2, "repulsion_range": 0.001},
        "time": {"end": 0.06, "step": 0.0005},
        "output": {**QUIET, "table_every": 0.004},
    },
    # Held for half of the time.
    "released body": {
        "domain": BOX,
        "fluid": OIL,
        "bodies": [
            {
                **GLASS,
                "centers": [[0.015, 0.014, 0.035]],
                "motion": {"velocity": [0.01, 0.0, -0.05], "rotation": [0.0, 3.0, 0.0], "until": 0.025},
            }
        ],
        "contact": SOFT,
        "resolution": {"cells_per_diameter": 5},
        "time": {"end": 0.05, "step": 0.001},
        "output": {**QUIET, "table_every": 0.01},
    },
    # The lowest spheres leave through the floor: crossings, and images of markers.
    "periodic cloud": {
        "domain": {"size": [0.03, 0.03, 0.03], "boundary": {"x": "periodic", "y": "periodic", "z": "periodic"}},
        "fluid": OIL,
        "bodies": [
            {**GLASS, "lattice": {"counts": [2, 2, 2], "spacing": [0.015] * 3, "origin": [0.007] * 3, "jitter": 0.002}}
        ],
        "contact": SOFT,
        "resolution": {"cells_per_diameter": 4},
        "time": {"end": 0.075, "step": 0.0015},
        "output": {**QUIET, "table_every": 0.02},
    },
    # The inflow rises until step 30; what leaves depends on what left before.
    "stream": {
        "domain": {
            "size": [0.04, 0.03, 0.03],
            "boundary": {"x": "inflow-outflow", "y": "wall", "z": "free-slip"},
            "inflow": {"velocity": 0.1, "profile": "parabolic", "start_up": 0.06},
        },
        "fluid": OIL,
        "bodies": [{**GLASS, "motion": "fixed", "centers": [[0.018, 0.0154, 0.015]]}],
        "contact": SOFT,
        "resolution": {"cells_per_diameter": 5},
        "time": {"end": 0.12, "step": 0.002, "diffusion": "stabilised"},
        "output": {**QUIET, "table_every": 0.01},
    },
    # A heap that comes to rest on the floor: contacts open at any time after the first.
    "dry heap": {
        "domain": {"size": [0.04, 0.04, 0.08]},
        "bodies": [{**GLASS, "packing": {"count": 20, "seed": 3}}],
        "contact": {"stiffness": 500.0, "restitution": 0.5, "friction": 0.4},
        "time": {"end": 0.3},
        "output": {**QUIET, "table_every": 0.01, "fields_every": 0.1},
    },
}


def case_of(name, *overrides):
    return rdpm.load_case(CASES[name], overrides)


class StopsAt:
    """A reporter that sends a signal after so many steps, and keeps what it is told."""

    def __init__(self, step=None, number=signal.SIGTERM):
        self.step, self.number, self.notes = step, number, []

    def start(self, plan):
        pass

    def update(self, step, time, end, message=""):
        if step == self.step:
            signal.raise_signal(self.number)

    def note(self, text):
        self.notes.append(text)

    def finish(self, summary):
        pass


def new_folder(folder):
    folder.mkdir()
    return folder


def run_whole(case, folder, threads=1):
    summary = run_case(case, new_folder(folder), threads=threads)
    assert summary.status == "done"
    return summary


def run_until(case, folder, step, threads=1):
    """Stop after `step` and one more steps; the newest checkpoint."""
    summary = run_case(case, new_folder(folder), threads=threads, reporter=StopsAt(step))
    assert (summary.status, summary.steps) == ("interrupted", step + 1)
    return newest(folder)


def newest(folder: Path) -> Path:
    return max((folder / "checkpoints").glob("step-*"))


def assert_equal_runs(one: Path, other: Path):
    """Tables to the byte; the last checkpoints and the fields to the bit."""
    for name in TABLES:
        assert (one / name).read_bytes() == (other / name).read_bytes(), name
    (a, facts_a), (b, facts_b) = (read_checkpoint(newest(folder)) for folder in (one, other))
    assert a.keys() == b.keys()
    for name, values in a.items():
        np.testing.assert_array_equal(values, b[name], err_msg=name)
        assert values.dtype == b[name].dtype
    assert {k: v for k, v in facts_a.items() if k not in WALL_TIMES | {"recorder"}} == {
        k: v for k, v in facts_b.items() if k not in WALL_TIMES | {"recorder"}
    }
    for name in ("fields.vtkhdf", "bodies.vtkhdf"):
        if (one / name).exists():
            np.testing.assert_array_equal(field_times(one / name), field_times(other / name))
    if (one / "fields.vtkhdf").exists():
        for step in range(len(field_times(one / "fields.vtkhdf"))):
            for x, y in zip(
                read_fields(one / "fields.vtkhdf", step), read_fields(other / "fields.vtkhdf", step), strict=True
            ):
                np.testing.assert_array_equal(x, y)
