"""Memory and disk that `rdpm check` tells, against what a run then takes."""

import json
import subprocess
import sys

import pytest

import rdpm
from rdpm.cli.main import main
from rdpm.setup import plan

#: Of memory and disk that were told, over what was taken.
TOLERANCE = 0.2

SHORT = ["output.report=false", "output.fields_tolerance=0"]
CASES = {
    "settling": ["time.end=0.04"],  # with its report
    "dkt-small": [*SHORT, "time.end=2 ms", "output.table_every=0.1 ms", "output.fields_every=0.5 ms"],
    "cloud": [
        *SHORT, "time.end=8 ms", "output.fields_every=2 ms", "output.average_from=0", "output.average_every=2 ms",
        "output.vorticity=true",
        "output.planes=[{normal = 'y', position = '1 cm'}]", "output.points=[['1 cm', '1 cm', '1 cm']]",
    ],
}  # fmt: skip
SCRIPT = """
import sys
from rdpm.cli.main import main
from rdpm.io.provenance import peak_memory_bytes
code = main()
print(peak_memory_bytes())
sys.exit(code)
"""


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_a_run_takes_what_was_told(name, tmp_path, capsys):
    sets = [word for change in CASES[name] for word in ("--set", change)]
    assert main(["check", name, "--json", *sets]) == 0
    told = json.loads(capsys.readouterr().out)
    words = [sys.executable, "-c", SCRIPT, "run", name, "--out", str(tmp_path / "run"), "--quiet", *sets]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    assert told["memory_bytes"] == pytest.approx(int(done.stdout.split()[-1]), rel=TOLERANCE)
    taken = sum(path.stat().st_size for path in (tmp_path / "run").rglob("*") if path.is_file())
    least = sum(file["least"] for file in told["disk"].values())
    assert (1.0 - TOLERANCE) * least < taken < (1.0 + TOLERANCE) * told["disk_bytes"]
    if name != "settling":
        assert least == told["disk_bytes"]
        for file, size in told["disk"].items():
            if file.startswith(("fields", "averages", "checkpoints")):
                parts = [p for p in (tmp_path / "run" / file, *(tmp_path / "run" / file).glob("*")) if p.is_file()]
                assert sum(p.stat().st_size for p in parts) == pytest.approx(size["most"], rel=0.1), file


def test_processes_are_told_apart():
    needs = plan(rdpm.load_case("dkt")).needs
    assert needs.process == needs.solver + needs.libraries + max(needs.output, needs.figures)
    assert needs.at_once == needs.process + needs.view + needs.video
    bare = plan(rdpm.load_case("dkt", ["output.report=false", "output.fields_every=0"])).needs
    assert (bare.at_once, bare.output, bare.view) == (bare.solver + bare.libraries, 0, 0)


def test_a_dry_case_is_told_too():
    bead = {"diameter": 0.01, "density": 2500, "lattice": {"counts": [5, 5, 5], "spacing": [0.011] * 3}}
    bead["lattice"]["origin"] = [0.01] * 3
    case = {"domain": {"size": [0.1, 0.1, 0.1]}, "bodies": [bead], "time": {"end": 0.05, "step": "1 ms"}}
    made = plan(rdpm.load_case(case | {"output": {"table_every": 0.001}}))
    assert made.disk["particles.csv"][1] == 51 * 125 * 320
    assert 60e6 < made.needs.process < 200e6
