"""A contact law of tests only, as anybody would add one: a struct (constant_force.cpp) and this class."""

import ctypes
import functools
import os
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from rdpm import _core
from rdpm.contacts import SubstepDriver

SOURCE = Path(__file__).with_name("constant_force.cpp")
HEADERS = Path(__file__).parents[2] / "cpp" / "include"
PARAMETERS = np.dtype([("force", np.float64)])
HISTORY = np.dtype([])


@functools.cache
def compiled_kernel() -> int:
    """Compile the driver over the law's struct and give its address; skip the test where there is no C++ compiler."""
    compiler = next(filter(None, map(shutil.which, (os.environ.get("CXX", "c++"), "g++", "clang++"))), None)
    if compiler is None:
        pytest.skip("no C++ compiler here to compile the law with")
    library = Path(tempfile.mkdtemp()) / "constant_force.so"
    flags = ["-std=c++20", "-O2", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC", "-fopenmp"]
    subprocess.run([compiler, *flags, "-I", HEADERS, SOURCE, "-o", library], check=True)
    return ctypes.addressof(ctypes.c_char.in_dll(ctypes.CDLL(str(library)), "constant_force"))


@dataclass(frozen=True)
class ConstantForce:
    """The force of a pair is its reduced mass times `acceleration` [m/s^2]: all rebound alike from `speed` [m/s]."""

    acceleration: float
    speed: float
    interaction_range: float = 0.0

    @property
    def driver(self) -> SubstepDriver:
        return SubstepDriver(_core.ContactKernel.at(compiled_kernel()), PARAMETERS, HISTORY)

    def parameters(self, pairs):
        result = np.zeros(len(pairs), PARAMETERS)
        result["force"] = self.acceleration * pairs["reduced_mass"]
        return result

    def time_scale(self, pairs):
        return np.full(len(pairs), 2.0 * self.speed / self.acceleration)
