"""Every example in a docstring of the package is run."""

import doctest
import importlib
import pkgutil

import pytest

import rdpm

MODULES = ["rdpm", *sorted(module.name for module in pkgutil.walk_packages(rdpm.__path__, "rdpm."))]


@pytest.mark.parametrize("name", MODULES)
def test_examples_hold(name: str, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)  # an example may write
    module = importlib.import_module(name)
    result = doctest.testmod(module, optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE)
    assert result.failed == 0


def test_there_are_examples_to_run() -> None:
    finder = doctest.DocTestFinder(exclude_empty=True)
    found = sum(bool(t.examples) for name in MODULES for t in finder.find(importlib.import_module(name)))
    assert found > 60
