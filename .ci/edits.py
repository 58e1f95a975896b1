"""Whether the tests see the coupling: single edits of the source must each make a test fail.

Each edit is made in a copy of the package, and the tests named beside it are run against that copy with the compiled
kernels of the installed package. Once a release, or after a change of the coupled step::

    python .ci/edits.py           # all; some minutes
    python .ci/edits.py 0 3       # some of them
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


@dataclass(frozen=True)
class Edit:
    """What is changed, where, and which tests must notice."""

    what: str
    file: str
    old: str
    new: str
    tests: str


EDITS = (
    Edit(
        "no second outer iteration in an impact", "coupling/impacts.py", "return 2 if", "return 1 if",
        "tests/property/test_step_terms.py",
    ),
    Edit(
        "two outer iterations in every step", "coupling/impacts.py", " else 1", " else 2",
        "tests/property/test_impacts.py",
    ),
    Edit(
        "lagged forces not placed at half a step", "particles/immersed.py",
        "bodies.position - 0.5 * dt * bodies.velocity", "bodies.position", "tests/property/test_step_terms.py",
    ),
    Edit(
        "unretained part not removed after diffusion", "particles/immersed.py", "        if unretained:\n",
        "        if unretained > 1e9:\n", "tests/unit/test_step_control.py tests/validation/test_ten_cate.py",
    ),
    Edit(
        "load not held over the sub-steps", "particles/immersed.py",
        "self.load = (np.repeat", "self.load = 0.0 * (np.repeat",
        "tests/property/test_coupling_motion.py tests/property/test_coupling_contact.py",
    ),
    Edit(
        "Adams-Bashforth weights of equal steps in steps that vary", "fluid/state.py",
        "ratio = 0.5 * dt / self._last_dt", "ratio = 0.5", "tests/analytic/test_fluid_taylor_green.py",
    ),
    Edit(
        "no rotational part of the pressure", "fluid/state.py", "0.5 * self.kinematic_viscosity", "0.0",
        "tests/property/test_step_terms.py",
    ),
    Edit(
        "no margin of the neighbour search for a spring under load", "contacts/contacts.py",
        "2.0 * self._history.largest_overlap", "0.0 * self._history.largest_overlap", "tests/unit/test_contact_step.py",
    ),
    Edit(
        "activation distance of a pair does not grow with its radius", "contacts/lubrication.py",
        "(radius_i + other) / self.pair_radius) ** (2.0 / 3.0)", "(radius_i + other) / self.pair_radius) ** 0.0",
        "tests/unit/test_contact_step.py",
    ),
    Edit(
        "roll as resistant as slip", "contacts/tangential_lubrication.py", "SLIP, ROLL = 2.0, 6.0 / 5.0",
        "SLIP, ROLL = 2.0, 2.0", "tests/analytic/test_tangential_lubrication.py",
    ),
)  # fmt: skip


def is_seen(edit: Edit) -> bool:
    """Whether a test fails with the edit."""
    from rdpm import _core  # of the installed package

    with tempfile.TemporaryDirectory() as folder:
        package = Path(folder) / "rdpm"
        shutil.copytree(ROOT / "src/rdpm", package)
        shutil.copy(str(_core.__file__), package)
        target = package / edit.file
        text = target.read_text(encoding="utf-8")
        if text.count(edit.old) != 1:
            sys.exit(f"{edit.file}: {edit.old!r} stands there {text.count(edit.old)} times, not once; mend the list")
        target.write_text(text.replace(edit.old, edit.new), encoding="utf-8")
        command = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", *edit.tests.split()]
        environment = {**os.environ, "PYTHONPATH": folder}
        done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
        if done.returncode not in (0, 1):
            sys.exit(done.stdout + done.stderr)
        return done.returncode == 1


def main() -> None:
    """Try the edits; exit with 1 where one is not seen."""
    chosen = [int(word) for word in sys.argv[1:]] or range(len(EDITS))
    missed = 0
    for n in chosen:
        seen = is_seen(EDITS[n])
        missed += not seen
        print(f"{n:2}  {'seen' if seen else 'NOT SEEN':9} {EDITS[n].what}", flush=True)
    sys.exit(bool(missed))


if __name__ == "__main__":
    main()
