"""A step after the first takes no memory of the size of a plane of the grid, in Python or below."""

import subprocess
import sys

import pytest

CHILD = """
import ctypes, resource
libc = ctypes.CDLL("libc.so.6")
TRIM_THRESHOLD, MMAP_THRESHOLD, ARENA_MAX = -1, -3, -8
assert libc.mallopt(ARENA_MAX, 1)  # one heap for all threads
import rdpm

simulation = rdpm.Simulation(rdpm.load_case({case!r}), 2)
plane = simulation.fluid.u[0].nbytes
assert 8 * len(simulation.system.immersed.markers) > plane
# From now on what is half a plane long is a mapping of its own, whose pages are met as faults: nothing is trimmed from
# the heap, and its free pieces of that length are taken out.
assert libc.mallopt(MMAP_THRESHOLD, plane // 2) and libc.mallopt(TRIM_THRESHOLD, 1 << 30)
for _ in range(4):
    simulation.advance()
libc.mallinfo2.restype = type("Info", (ctypes.Structure,), dict(_fields_=[(c, ctypes.c_size_t) for c in "abcdefghij"]))
libc.malloc.restype = ctypes.c_void_p
mappings = libc.mallinfo2().d
while libc.mallinfo2().d == mappings:
    libc.malloc(ctypes.c_size_t(plane // 2))

def faults():
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt

before = faults()
for _ in range({steps}):
    {spoil}
    simulation.advance()
print((faults() - before) * resource.getpagesize() / plane)
"""

STEPS = 10


def case(diffusion: str, side: str) -> dict:
    """Spheres close enough to stand back from each other, many enough to outweigh a plane."""
    d = 0.01
    return {
        "title": "memory of a step",
        "domain": {"size": [0.04] * 3, "boundary": {"x": side, "y": "periodic", "z": side}},
        "fluid": {"density": 1000.0, "viscosity": 0.05},
        "bodies": [{"diameter": d, "density": 1200.0, "packing": {"count": 24, "seed": 1, "min_gap": 1e-4}}],
        "contact": {"restitution": 0.5, "contact_steps": 8},
        "resolution": {"cells": [48] * 3},
        "time": {"end": 1.0, "diffusion": diffusion},
    }


def planes_taken(diffusion: str, side: str, spoil: str = "pass") -> float:
    """Planes of memory that `STEPS` steps met for the first time, with a statement before each."""
    code = CHILD.format(case=case(diffusion, side), steps=STEPS, spoil=spoil)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    return float(done.stdout)


linux = pytest.mark.skipif(sys.platform != "linux", reason="glibc's allocator is asked")


@linux
@pytest.mark.parametrize(("diffusion", "side"), [("explicit", "periodic"), ("stabilised", "wall")])
def test_a_step_after_the_first_takes_no_plane_of_memory(diffusion: str, side: str) -> None:
    # The interpreter's own small objects stay far below; a plane in every step would be STEPS.
    assert planes_taken(diffusion, side) < 0.4 * STEPS


@linux
def test_an_array_of_the_markers_in_every_step_would_be_seen() -> None:
    assert planes_taken("explicit", "periodic", "simulation.system.immersed.markers.force * 1.0") > STEPS
