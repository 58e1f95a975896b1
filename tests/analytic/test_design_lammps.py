"""The LAMMPS fragment, run: two spheres meet head-on and leave as designed."""

import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from rdpm.design import soft_sphere
from rdpm.design.export import export

LAMMPS = shutil.which("lmp", path=str(Path(sys.executable).parent)) or shutil.which("lmp")
STEPS = 1000  # a contact; semi-implicit Euler errs by O(1/STEPS) in e_n and a step at either end in t_c

SETUP = """
units si
atom_style sphere
atom_modify map array
boundary f f f
newton off
comm_modify vel yes
region box block -0.05 0.05 -0.05 0.05 -0.05 0.05
create_box 1 box
create_atoms 1 single -0.00750005 0 0
create_atoms 1 single 0.00750005 0 0
set type 1 diameter 0.015 density 1120
{fragment}
neighbor 0.002 bin
timestep {dt}
fix 1 all nve/sphere
group a id 1
group b id 2
velocity a set 0.02 0 0
velocity b set -0.02 0 0
variable f equal fx[2]
variable v equal vx[2]-vx[1]
variable g equal x[2]-x[1]-0.015
fix p all print 1 "$(v_f) $(v_v) $(v_g)" file record.txt screen no
run {run}
"""


@pytest.mark.skipif(LAMMPS is None, reason="lammps and mpich of the test extra are not installed")
@pytest.mark.parametrize("ending", ["zero-force", "zero-overlap"])
@pytest.mark.parametrize("restitution", [0.3, 0.8])
def test_lammps_finds_the_contact_designed(ending, restitution, tmp_path):
    contact_time = 8e-3
    d = soft_sphere(diameter=0.015, density=1120.0, restitution=restitution, contact_time=contact_time,
                    ending=ending, friction=0.1)  # fmt: skip
    dt = contact_time / STEPS
    text = SETUP.format(fragment=export(d, "lammps"), dt=dt, run=2 * STEPS)
    (tmp_path / "in.pair").write_text(text)
    done = subprocess.run(
        [LAMMPS, "-in", "in.pair", "-log", "none"], cwd=tmp_path, capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 0, done.stdout[-2000:]
    force, speed, _ = np.loadtxt(tmp_path / "record.txt", comments="#").T
    touching = np.flatnonzero(force)
    assert speed[-1] / 0.04 == pytest.approx(restitution, abs=2.0 / STEPS)
    assert (touching[-1] - touching[0] + 1) * dt == pytest.approx(contact_time, abs=3 * dt)
