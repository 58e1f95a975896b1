"""What the project says of itself holds: commands, examples, file names, rooms."""

import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from rdpm.cases import shipped_names
from rdpm.cli.main import VERBS, main
from rdpm.config.load import load_case
from rdpm.io.tables import CONTACT_COLUMNS, HISTORY_COLUMNS, PARTICLE_COLUMNS, TIMING_COLUMNS
from rdpm.runs.runner import run_case

ROOT = Path(__file__).parents[2]
README = ROOT / "README.md"
PAGES = sorted([*ROOT.glob("*.md"), *(p for p in (ROOT / "docs").rglob("*.md") if "_build" not in p.parts)])
# Where a file named in the text may start: clone, package, kernels, or beside them one room down.
STARTS = ("", "src/rdpm/", "cpp/include/rdpm/", "cpp/bindings/", "docs/")
# The commands of these verbs end within a second; those of the others are shown as they ran.
QUICK = ("rdpm new", "rdpm check", "rdpm design")


def blocks(page: Path, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize(
    ("name", "must_hold"), [("run", (".venv/bin/pip install .", "rdpm run dkt")), ("test", ("'.[test]'", "pytest"))]
)
def test_each_setup_command_is_one_marked_line(name, must_hold):
    found = re.findall(rf"^<!-- command: {name} -->\n```sh\n(.*)\n```$", README.read_text("utf-8"), re.MULTILINE)
    assert len(found) == 1
    assert all(part in found[0] for part in must_hold)


def test_python_example_prints_what_is_shown(capsys):
    run_python(README)
    assert capsys.readouterr().out == blocks(README, "text")[0]


@pytest.mark.parametrize("page", [README, ROOT / "docs" / "tutorial" / "first_run.md"], ids=lambda page: page.name)
def test_quick_commands_print_what_is_shown(page, capsys, tmp_path, monkeypatch):
    """In the order of the page; a line of a toml block replaces that of the same key in dkt.toml, as a reader would."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")
    tried = 0
    fences = re.compile(r"^```(console|toml)\n(.*?)^```", re.MULTILINE | re.DOTALL)
    for language, block in fences.findall(page.read_text("utf-8")):
        if language == "toml":
            edit(tmp_path / "dkt.toml", block.splitlines())
            continue
        for part in block.split("$ ")[1:]:
            command, *shown = part.splitlines()
            if not command.startswith(QUICK):
                continue
            main(shlex.split(command)[1:])
            out = capsys.readouterr()
            printed = [line.rstrip() for line in (out.out + out.err).splitlines()]
            assert [line for line in shown if line and line not in printed] == [], command
            tried += 1
    assert tried >= 1


def edit(case: Path, lines: list[str]) -> None:
    text = case.read_text(encoding="utf-8").splitlines()
    for line in lines:
        (place,) = (n for n, old in enumerate(text) if old.split("=")[0] == line.split("=")[0])
        text[place] = line
    case.write_text("\n".join(text), encoding="utf-8")


def test_dry_case_as_told(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    page = ROOT / "docs" / "howto" / "dry_case.md"
    Path("bounce.toml").write_text(blocks(page, "toml")[0], encoding="utf-8")
    run_python(page)
    assert capsys.readouterr().out == blocks(page, "text")[0]


@pytest.fixture(scope="module")
def dkt(tmp_path_factory):
    """A folder that holds ./dkt, as the pages have it."""
    changes = ["resolution.cells_per_diameter=4", "time.end=0.01", "output.fields_every=0.005", "output.report=false"]
    folder = tmp_path_factory.mktemp("pages") / "dkt"
    folder.mkdir()
    run_case(load_case("dkt", changes), folder)
    return folder.parent


def test_results_are_read_as_told(dkt, monkeypatch, capsys):
    monkeypatch.chdir(dkt)
    run_python(ROOT / "docs" / "howto" / "read_results.md")
    printed = capsys.readouterr().out.splitlines()
    assert printed[0].startswith("done; fastest: 0.0")
    assert -0.01 < float(printed[1]) < 0.0
    assert printed[2].startswith("fastest: 0.0")
    assert printed[3].startswith("3 pictures of (27, 27, 135) cells; velocity (135, 27, 27, 3) at t = 0.01 s")
    assert printed[4].startswith("done ")


def test_the_flow_is_sampled_as_told(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    page = ROOT / "docs" / "howto" / "sample.md"
    run_python(page)
    assert capsys.readouterr().out == "".join(blocks(page, "text"))
    asked = tomllib.loads(blocks(page, "toml")[0])
    load_case("dkt", {f"output.{key}": value for key, value in asked["output"].items()})


def test_the_last_time_is_shown_as_told(dkt):
    """In a process of its own: what draws may crash where there is no graphics library."""
    script = "".join(blocks(ROOT / "docs" / "howto" / "paraview.md", "python"))
    done = subprocess.run([sys.executable, "-c", script], cwd=dkt, capture_output=True, text=True, timeout=100)
    assert done.returncode == 0, done.stderr
    picture = np.asarray(Image.open(dkt / "last.png").convert("RGB"))
    assert len(np.unique(picture.reshape(-1, 3), axis=0)) > 100  # the flow's colours


def run_python(page: Path) -> None:
    """All Python of a page, as one script."""
    exec(compile("".join(blocks(page, "python")), str(page), "exec"), {})


def test_every_verb_is_described():
    text = (ROOT / "docs" / "reference" / "command_line.md").read_text(encoding="utf-8")
    assert [verb for verb in VERBS if f"## `rdpm {verb}`\n" not in text] == []


def test_columns_of_the_output_are_described():
    text = (ROOT / "docs" / "reference" / "output.md").read_text(encoding="utf-8")
    columns = {*PARTICLE_COLUMNS, *CONTACT_COLUMNS, *HISTORY_COLUMNS, *TIMING_COLUMNS}
    assert sorted(name for name in columns if f"`{name}`" not in text) == []


def test_every_shipped_case_is_in_the_table():
    (rows,) = re.findall(r"^\| case \|.*\n\|-.*\n((?:\|.*\n)+)", README.read_text("utf-8"), re.MULTILINE)
    assert sorted(re.findall(r"^\| `([a-z-]+)` \|", rows, re.MULTILINE)) == shipped_names()


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_and_file_names_lead_somewhere(page):
    text = page.read_text(encoding="utf-8")
    links = [link.partition("#")[0] for link in re.findall(r"\]\(([^)\s]+)\)", text) if ":" not in link]
    assert [link for link in links if link and not (page.parent / link).exists()] == []
    named = re.findall(r"`([\w./-]+/[\w.-]+\.(?:py|hpp|cpp|toml|csv|md))`", text)
    assert [name for name in named if not any((ROOT / start / name).exists() for start in STARTS)] == []


def test_architecture_names_every_room():
    text = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
    rooms = [path.parent.name for path in (ROOT / "src" / "rdpm").glob("*/__init__.py")]
    assert rooms
    assert [room for room in rooms if f"`{room}/`" not in text] == []
