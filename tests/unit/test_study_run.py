"""Running a study: what is made, kept, made again; the same bits whatever the number of workers and threads."""

import csv
import json

import pandas
import pytest

import rdpm
from rdpm.results.dkt import pair_gap
from rdpm.runs.runner import run_case
from rdpm.studies import load
from rdpm.studies.claims import Claim, Computed, Judgement
from rdpm.studies.folder import StudyFolder
from rdpm.studies.kept_flow import keep_plane
from rdpm.studies.one_job import do_job
from rdpm.studies.pictures import Drawing, Picture
from rdpm.studies.prepare import prepare, write_folder
from rdpm.studies.registry import CLAIMS, DRAWINGS
from rdpm.studies.study import run_study
from rdpm.studies.study_file import load_study
from studies import MEETING, command, run_bytes, sweep, without_time


class Watch:
    """Remembers what jobs were begun and how they ended."""

    def __init__(self):
        self.begun, self.ended, self.threads = [], {}, []

    def begin(self, jobs, workers):
        self.workers = workers

    def update(self, job, said):
        if said["phase"] == "starting":
            self.begun.append(job.name)
            self.threads.append(said["threads"])
        elif said["phase"] in ("done", "stopped", "failed"):
            self.ended[job.name] = said["phase"]


def run(folder, content, **how):
    watch = Watch()
    return run_study(load_study(content), folder, watcher=watch, **how), watch


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study") / "sweep"
    results, watch = run(folder, sweep(), workers=2)
    return folder, results, watch


def test_one_row_a_run_with_parameters_measures_status_version(done):
    folder, results, watch = done
    assert watch.begun[0] == "start-1"
    assert set(watch.ended.values()) == {"done"}
    table = results.table
    assert table["run"].tolist() == ["contact_steps-12", "contact_steps-20"]
    assert table["contact.contact_steps"].tolist() == [12.0, 20.0]
    assert table["contacts"].tolist() == [1, 1]
    short, long = table["first_contact_duration_s"]
    assert long / short == pytest.approx(20 / 12, rel=0.05)   # both longer than in a void: the fluid is moved too
    assert table["status"].tolist() == ["done", "done"]
    assert set(table["rdpm_version"]) == {rdpm.__version__}
    assert (table["wall_s"] > 0).all()
    pandas.testing.assert_frame_equal(load(folder), table)
    with (folder / "table.csv").open() as file:
        as_text = [row["first_restitution"] for row in csv.DictReader(file)]
    assert [float(text) for text in as_text] == table["first_restitution"].tolist()


def test_runs_leave_ordinary_folders_without_fields_and_checkpoints(done):
    folder, _, _ = done
    home = StudyFolder(folder)
    assert json.loads(home.run("contact_steps-12").summary.read_text())["status"] == "done"
    assert not list((folder / "runs").rglob("*.checkpoint"))
    assert not list(folder.rglob("*.vtkhdf"))
    assert not list(folder.rglob("report.html"))
    assert sum(path.stat().st_size for path in (folder / "runs").rglob("*") if path.is_file()) < 200_000


def test_a_run_is_read_from_time_zero(done):
    _, results, _ = done
    tracks = results.run("contact_steps-12").tracks
    assert tracks.times[0] == 0.0
    assert tracks.times[-1] == pytest.approx(0.04)
    assert (tracks.times[1:] > tracks.times[:-1]).all()
    gap = pair_gap(tracks.position[:, 0], tracks.position[:, 1], 0.01, 0.01)
    assert gap[0] == pytest.approx(0.001, rel=0.05)


def test_workers_and_threads_change_no_bit(done, tmp_path):
    folder, results, _ = done
    one, watch = run(tmp_path / "one", sweep(), workers=1)
    assert len(watch.begun) == 3
    pandas.testing.assert_frame_equal(without_time(one.table), without_time(results.table), check_exact=True)
    assert run_bytes(tmp_path / "one") == run_bytes(folder)


def test_the_common_start_changes_no_bit_of_an_equal_contact(done, tmp_path):
    """The run with the base's contact is the one that never stopped."""
    _, results, _ = done
    content = sweep()
    del content["start"]
    whole, _ = run(tmp_path / "whole", content, workers=2)
    with_start = results.run("contact_steps-20").tracks
    without = whole.run("contact_steps-20").tracks
    assert with_start.times[-1] == without.times[-1]
    assert (with_start.position[-1] == without.position[-1]).all()


def test_finished_runs_are_kept_and_an_edited_study_runs_what_changed(done):
    folder, results, _ = done
    again, watch = run(folder, sweep())
    assert watch.begun == []
    pandas.testing.assert_frame_equal(again.table, results.table)
    edited, watch = run(folder, sweep(vary={"contact.contact_steps": [12, 15, 20]}))
    assert watch.begun == ["contact_steps-15"]
    assert edited.table["run"].tolist() == ["contact_steps-12", "contact_steps-15", "contact_steps-20"]
    _, watch = run(folder, sweep())
    assert watch.begun == []   # back again


def test_the_study_in_the_folder_is_whole(done, monkeypatch, tmp_path):
    folder, _, _ = done
    monkeypatch.chdir(tmp_path)
    kept = load_study(folder / "study.toml")
    _, watch = run(folder, {**kept.raw, "name": kept.name})
    assert watch.begun == []


def test_a_run_that_a_guard_stops_is_told_and_the_others_are_made(tmp_path):
    rows = [{"name": "soft", "set": {"contact.contact_steps": 60, "contact.overlap_limit": 0.01}}, {"name": "hard"}]
    content = sweep(vary={}, runs=rows)
    results, watch = run(tmp_path / "s", content, workers=1)
    assert watch.ended == {"start-1": "done", "soft": "stopped", "hard": "done"}
    soft = results.table.set_index("run").loc["soft"]
    assert soft["status"] == "stopped"
    assert "overlap" in soft["reason"]
    assert pandas.isna(soft["contacts"])
    _, watch = run(tmp_path / "s", content)
    assert watch.begun == []   # it would be stopped again


def test_included_studies_have_their_parts(tmp_path):
    content = {"name": "both", "include": [
        sweep(name="one"), sweep(name="two", vary={"contact.contact_steps": [20]}, measure=["end"]),
    ]}
    results, watch = run(tmp_path / "both", content)
    assert len(watch.begun) == 3
    assert results.table["study"].tolist() == ["one", "one", "two"]
    assert results.parts == ["one", "two"]
    assert results.part("two").table["end_speed_m_s"].notna().all()
    assert results.part("one").table["end_speed_m_s"].isna().all()
    assert results.run("contact_steps-20", "two").folder.path == results.run("contact_steps-20", "one").folder.path


def test_drawings_and_claims_are_made_by_name(tmp_path, monkeypatch):
    def draw(results, folder):
        (folder / "a.txt").write_text(",".join(results.runs()["run"]))
        return [Picture(folder / "a.txt", "Names.")]

    def broken():
        raise ValueError("no such column")

    monkeypatch.setitem(DRAWINGS, "names", Drawing(draw))
    known = Computed(lambda: Judgement("confirmed", "Two."))
    monkeypatch.setitem(CLAIMS, "known", Claim("known", "", "", known, "So."))
    monkeypatch.setitem(CLAIMS, "broken", Claim("broken", "", "", Computed(broken), ""))
    claims = ["broken", "known"]
    told = []
    run(tmp_path / "s", sweep(draw=["names"], claims=claims), tell=told.append)
    assert (tmp_path / "s/figures/sweep/a.txt").read_text() == "contact_steps-12,contact_steps-20"
    judged = json.loads((tmp_path / "s/claims.json").read_text())["claims"]
    assert [(item["verdict"], item["sentence"], item["reason"]) for item in judged] == [
        ("not judged", "no such column", ""), ("confirmed", "Two.", "So."),
    ]
    assert told == ["sweep: the claim broken was not judged: no such column"]


def test_from_python(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    case = rdpm.load_case(MEETING, ["time.end=0.004"])
    study = rdpm.Study(case, vary={"contact.restitution": "0.5:0.7:2"}, measure=["end"], name="mine")
    table = study.run(workers=2).table
    assert table["contact.restitution"].tolist() == [0.5, 0.7]
    assert table["end_speed_m_s"].notna().all()
    assert "2 of 2 runs ended" in capsys.readouterr().err
    run_case(case, StudyFolder(tmp_path / "mine").path.parent, threads=1)   # the same case by itself
    alone = (tmp_path / "particles.csv").read_bytes()
    assert (tmp_path / "mine/runs/restitution-0.7/particles.csv").read_bytes() == alone


def test_the_command_runs_collects_and_continues(tmp_path):
    from rdpm.studies.write import study_to_toml

    (tmp_path / "mine.toml").write_text(study_to_toml(sweep()))
    with command("mine.toml", "--workers", "2", cwd=tmp_path) as process:
        out, err = process.communicate()
    assert (process.returncode, "2 of 2 runs are done. Table: sweep" in out) == (0, True), err
    assert "3 of 3 runs ended" in err
    (tmp_path / "sweep/table.parquet").unlink()
    for words in (("collect", "sweep"), ("sweep",)):
        with command(*words, cwd=tmp_path) as process:
            out, err = process.communicate()
        assert process.returncode == 0, err
        assert len(load(tmp_path / "sweep")) == 2
    assert "3 of 3 runs need not be made again" in err


@pytest.mark.parametrize("tolerance", [0.0, 1e-3])
def test_disk_is_what_was_told(tmp_path, monkeypatch, tolerance):
    monkeypatch.setitem(DRAWINGS, "flow", Drawing(lambda results, folder: [], needs_fields=True))
    output = {"output.fields_every": 0.002, "output.fields_tolerance": tolerance}
    base = {"case": MEETING, "set": output}
    prepared = prepare(load_study(sweep(base=base, draw=["flow"], vary={"contact.contact_steps": [12]})))
    folder, at_work = write_folder(prepared, tmp_path / "s", ""), {}

    def watched(files):
        at_work[files.path.name] = size_of(files.path)
        keep_plane(files)

    monkeypatch.setattr("rdpm.studies.one_job.keep_plane", watched)
    for job in prepared.jobs:
        assert do_job(folder, job, 1).status == "done"
        taken, left = at_work[job.name], size_of(folder.work(job).path)
        if tolerance == 0.0:
            assert taken == pytest.approx(job.disk, rel=0.2)
        else:
            assert taken < 1.2 * job.disk
        assert left < 1.2 * job.disk_left   # planes are compressed, and small in a box so small
    assert prepared.disk(1) > max(at_work.values())
    assert prepared.disk_left == sum(job.disk_left for job in prepared.jobs)


def size_of(folder):
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())


def test_every_model_goes_on_from_one_start(tmp_path):
    keys = {
        "soft": {"contact_steps": 12},
        "hard": {"model": "hard-sphere"},
        "hertz": {"model": "hertz", "youngs_modulus": 1e6, "poisson_ratio": 0.3, "impact_speed": 0.4},
        "repulsive": {"model": "repulsive", "repulsion_stiffness": 0.4, "repulsion_range": 1e-3},
    }
    models = [{"name": name, "set": {"contact": values}} for name, values in keys.items()]
    dry = {key: value for key, value in MEETING.items() if key not in ("fluid", "resolution")}
    study = sweep(base={"case": dry}, vary={}, runs=models, start={"at": 0.0005})   # hardly in the range yet
    prepared = prepare(load_study(study))
    assert [job.name for job in prepared.jobs if job.is_start] == ["start-1"]
    assert "contact.friction gives way to model = repulsive" in prepared.runs[3].notes
    results, watch = run(tmp_path / "s", study, workers=1)
    assert set(watch.ended.values()) == {"done"}
    table = results.table.set_index("run")
    # each thrown back with what its model leaves; the repulsive force keeps all
    assert table["first_restitution"][["soft", "hard", "hertz"]].tolist() == pytest.approx([0.7] * 3, abs=0.02)
    assert table["max_overlap_fraction"]["hard"] == pytest.approx(0.0, abs=1e-9)
    velocity = results.run("repulsive").tracks.velocity[:, :, 0]
    assert (velocity[:, 1] - velocity[:, 0]).max() == pytest.approx(0.4, rel=0.05)   # thrown back, before the walls
