"""The tutorial on collision parameters is run: its commands give the lines shown, its Python the values."""

import doctest
import shlex
from pathlib import Path

import pytest
from cyclopts import App

from rdpm.cli.design import design

TUTORIAL = Path(__file__).parents[2] / "docs" / "tutorial" / "design.md"


def commands() -> list[tuple[str, list[str]]]:
    """Every command of the console blocks with the lines shown below it."""
    found: list[tuple[str, list[str]]] = []
    for block in TUTORIAL.read_text(encoding="utf-8").split("```console\n")[1:]:
        for line in block.split("```")[0].splitlines():
            if line.startswith("$ "):
                found.append((line[2:], []))
            else:
                found[-1][1].append(line)
    return found


@pytest.mark.parametrize(("command", "shown"), commands())
def test_commands_print_what_is_shown(command, shown, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    app = App(name="design")
    app.default(design)
    words = shlex.split(command)
    assert words[:2] == ["rdpm", "design"]
    call, bound, *_ = app.parse_args(words[2:], exit_on_error=False, print_error=False)
    assert call(*bound.args, **bound.kwargs) == 0
    printed = capsys.readouterr().out.splitlines()
    assert [line for line in shown if line not in printed] == []
    assert printed


def test_python_of_the_tutorial():
    failed, tried = doctest.testfile(str(TUTORIAL), module_relative=False)
    assert tried >= 8
    assert failed == 0
