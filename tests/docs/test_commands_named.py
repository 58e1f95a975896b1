"""Commands that the pages and the calibration name exist."""

import re
import shlex
from itertools import takewhile
from pathlib import Path

import pytest

from rdpm.cases import shipped_names
from rdpm.particles.calibration import CALIBRATION
from rdpm.studies.validation import CASES

ROOT = Path(__file__).parents[2]
PAGES = [page.read_text(encoding="utf-8") for page in (ROOT / "docs").rglob("*.md") if "_build" not in page.parts]
NAMED = sorted({command for page in PAGES for command in re.findall(r"`((?:rdpm validate|python) [^`]+)`", page)})


@pytest.mark.parametrize("command", sorted({*NAMED, *(row[5] for row in CALIBRATION.rows())}))
def test_a_named_command_exists(command):
    program, *words = shlex.split(command)
    files = [word for word in words if word.endswith(".py")]
    if program == "python":
        assert files
        assert [name for name in files if not (ROOT / name).exists()] == []
    else:
        verb, *names = takewhile(lambda word: not word.startswith("--"), words)
        known = {"validate": set(CASES), "run": set(shipped_names())}[verb]
        assert set(names) - {"NAME"} <= known
