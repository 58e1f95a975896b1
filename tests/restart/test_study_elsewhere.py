"""The same study through Dask, of whose two workers one is killed, and through the command lines of a SLURM array."""

import os
import re
import signal
import stat
import subprocess
import threading
import time
import warnings

import pandas
import pytest

from rdpm.cli.main import main
from rdpm.errors import CaseError
from rdpm.studies import load
from rdpm.studies.folder import StudyFolder
from rdpm.studies.study import run_study
from rdpm.studies.study_file import load_study
from rdpm.studies.write import study_to_toml
from studies import MEETING, run_bytes, sweep, without_time

LONG = sweep(
    base={"case": MEETING, "set": {"time.end": 0.15, "output.checkpoint_every": 0.01}},
    vary={"contact.contact_steps": [12, 14, 16, 20]},
)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")   # of distributed, about ports and times
def test_dask_makes_the_run_of_a_killed_worker_again(tmp_path):
    distributed = pytest.importorskip("distributed")
    whole = run_study(load_study(LONG), tmp_path / "whole", workers=2)
    folder = tmp_path / "dask"
    killed = []
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
    ) as cluster:
        def kill():
            end = time.monotonic() + 100.0
            while time.monotonic() < end and not killed:
                for lock in (folder / "runs").glob("*/run.lock"):
                    if any(lock.parent.glob("checkpoints/step-*")):
                        worker = worker_of(lock.read_text())
                        if worker:
                            os.kill(worker, signal.SIGKILL)
                            killed.append(worker)
                            return
                time.sleep(0.02)

        thread = threading.Thread(target=kill)
        thread.start()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            results = run_study(load_study(LONG), folder, scheduler=cluster.scheduler_address)
        thread.join()
    assert killed
    assert results.table["status"].tolist() == ["done"] * 4
    pandas.testing.assert_frame_equal(without_time(results.table), without_time(whole.table), check_exact=True)
    assert run_bytes(folder) == run_bytes(tmp_path / "whole")


def worker_of(text):
    """The process that started the one named in a lock: a worker of Dask."""
    if not text.strip():
        return None
    try:
        with open(f"/proc/{text.strip()}/stat") as file:
            return int(file.read().rpartition(")")[2].split()[1])
    except FileNotFoundError:
        return None


def test_no_scheduler_is_told(tmp_path):
    pytest.importorskip("distributed")
    with pytest.raises(CaseError, match="must be the address of a Dask scheduler that answers"):
        run_study(load_study(sweep()), tmp_path / "s", scheduler="nonsense://head")


def test_slurm_scripts_and_their_command_lines(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.toml").write_text(study_to_toml(sweep()))
    assert main(["study", "mine.toml", "--slurm"]) == 0
    assert "bash" in capsys.readouterr().out
    home = tmp_path / "sweep" / "slurm"
    scripts = ["collect.sbatch", "runs.sbatch", "starts.sbatch", "submit.sh"]
    assert sorted(path.name for path in home.iterdir()) == scripts
    starts, runs = ((home / f"{kind}.sbatch").read_text() for kind in ("starts", "runs"))
    assert "#SBATCH --array=0\n" in starts
    assert "#SBATCH --array=1-2\n" in runs
    assert "#SBATCH --cpus-per-task=4\n" in runs
    assert re.search(r"#SBATCH --time=00:30:00\n", runs)
    # sbatch as a script that runs the array at once, one task after the other
    fake = tmp_path / "bin" / "sbatch"
    fake.parent.mkdir()
    fake.write_text(
        '#!/bin/bash\nscript="${@: -1}"\necho "$@" >> calls\nexport SLURM_CPUS_PER_TASK=1\n'
        'array=$(sed -n "s/^#SBATCH --array=//p" "$script" | sed "s/-/ /")\n'
        'for n in $([ -n "$array" ] && (set -- $array; seq $1 ${2:-$1}) || echo 0); do\n'
        '  SLURM_ARRAY_TASK_ID=$n bash "$script" >> out 2>&1 || echo "$n failed" >> out\ndone\necho 7\n'
    )
    fake.chmod(fake.stat().st_mode | stat.S_IXUSR)
    environment = {**os.environ, "PATH": f"{fake.parent}:{os.environ['PATH']}"}
    subprocess.run(["bash", str(home / "submit.sh")], check=True, env=environment, capture_output=True)
    calls = (tmp_path / "calls").read_text().splitlines()
    assert [call.split("/")[-1] for call in calls] == ["starts.sbatch", "runs.sbatch", "collect.sbatch"]
    assert "--dependency=afterok:7" in calls[1]
    assert "--dependency=afterany:7" in calls[2]
    table = load(tmp_path / "sweep")
    assert table["status"].tolist() == ["done", "done"], (tmp_path / "out").read_text()
    local = run_study(load_study(sweep()), tmp_path / "local", workers=2)
    pandas.testing.assert_frame_equal(without_time(table), without_time(local.table), check_exact=True)
    assert StudyFolder(tmp_path / "sweep").jobs() == StudyFolder(tmp_path / "local").jobs()
