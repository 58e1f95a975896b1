"""The list of edits that tests must notice fits the source: each text stands where the list says, once."""

import importlib.util
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
spec = importlib.util.spec_from_file_location("edits", ROOT / ".ci" / "edits.py")
edits = importlib.util.module_from_spec(spec)
sys.modules["edits"] = edits
spec.loader.exec_module(edits)


@pytest.mark.parametrize("edit", edits.EDITS, ids=lambda edit: edit.what)
def test_the_text_that_is_changed_stands_once(edit):
    assert (ROOT / "src" / "rdpm" / edit.file).read_text(encoding="utf-8").count(edit.old) == 1
    assert all((ROOT / test).is_file() for test in edit.tests.split())
