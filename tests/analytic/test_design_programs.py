"""Inputs written for other programs, run where these are installed: pair and wall rebound as foretold."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from rdpm.design import soft_sphere
from rdpm.design.export import export
from rdpm.design.programs import trial

HERE = str(Path(sys.executable).parent)
COMMANDS = {
    "lammps": ("lmp", ["-in", "FILE", "-log", "none"]),
    "liggghts": ("liggghts", ["-in", "FILE", "-log", "none"]),
    "yade": ("yade", ["-n", "-x", "FILE"]),
}
DESIGNS = {
    "equal": {"diameter": 0.015, "density": 1120.0, "impact_speed": 0.04, "friction": 0.1},
    "unequal": {"diameter": 0.015, "density": 1120.0, "diameter2": 0.008, "density2": 7800.0, "impact_speed": 0.04},
    "wall": {"diameter": 1e-3, "density": 2500.0, "wall": True, "impact_speed": 0.1},
    "mass": {"mass": 1e-3},
}
#: Beyond the spread over 40 phases: a phase between two of them, and at the wall the speed of the first rebound.
MARGIN = 3e-3


@pytest.mark.parametrize("ending", ["zero-force", "zero-overlap"])
@pytest.mark.parametrize(("bodies", "restitution"), [("equal", 0.5), ("unequal", 0.3), ("wall", 0.97), ("mass", 0.8)])
@pytest.mark.parametrize("program", COMMANDS)
def test_the_input_runs_and_gives_the_restitution_foretold(program, bodies, restitution, ending, tmp_path):
    name, words = COMMANDS[program]
    command = shutil.which(name, path=HERE) or shutil.which(name)
    if command is None:
        pytest.skip(f"{name} is not installed")
    design = soft_sphere(**DESIGNS[bodies], restitution=restitution, contact_time=8e-3, ending=ending)
    file = tmp_path / "pair.py"
    file.write_text(export(design, program))
    done = subprocess.run(
        [command, *(str(file) if word == "FILE" else word for word in words)],
        cwd=tmp_path, capture_output=True, text=True, timeout=60,
    )  # fmt: skip
    found = dict(re.findall(r"^restitution (?:of|at) the (pair|wall) (\S+)$", done.stdout, re.MULTILINE))
    assert sorted(found) == ["pair", "wall"], done.stdout[-2000:] + done.stderr[-2000:]
    there = trial(design, program).there
    for value in map(float, found.values()):
        assert there.achieved.least - MARGIN <= value <= there.achieved.greatest + MARGIN
    # where the program ends a contact as the design does, that is the design's restitution
    if there.ending == ending:
        assert float(found["pair"]) == pytest.approx(restitution, abs=0.01 + MARGIN)
