"""A study small enough for tests: two spheres meet in oil, 80 steps on 15 x 15 x 25 cells."""

from __future__ import annotations

import os
import signal
import subprocess
import sys

TABLES = ("particles.csv", "contacts.csv", "history.csv")

MEETING = {
    "domain": {"size": [0.03, 0.03, 0.05]},
    "fluid": {"density": 960.0, "viscosity": 0.05},
    "bodies": [
        {
            "diameter": 0.01,
            "density": 2500.0,
            "centers": [[0.0095, 0.015, 0.0252], [0.0205, 0.0155, 0.0256]],
            "velocity": [[0.2, 0.0, 0.0], [-0.2, 0.0, -0.02]],
        }
    ],
    "contact": {"restitution": 0.7, "contact_steps": 20, "friction": 0.3, "lubrication": False},
    "resolution": {"cells_per_diameter": 5},
    "time": {"end": 0.04, "step": 0.0005},
    "output": {"table_every": 0.002},
}


def sweep(**more):
    """Two contacts, from a common checkpoint shortly before."""
    return {
        "name": "sweep", "base": {"case": MEETING}, "start": {"at": 0.0015},
        "vary": {"contact.contact_steps": [12, 20]}, "measure": ["contacts", "extremes"], **more,
    }


def without_time(table):
    """A table without what two equal runs may differ in."""
    return table.drop(columns="wall_s")


def run_bytes(folder):
    """All that the runs of a study found, by file."""
    found = [path for path in sorted(folder.rglob("*.csv")) if path.name in TABLES]
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in found}


def command(*words, **options):
    """The command line in a process of its own."""
    return subprocess.Popen(
        [sys.executable, "-m", "rdpm.cli.main", "study", *map(str, words)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=dict(os.environ), **options,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),   # which jobs in the background ignore
    )
