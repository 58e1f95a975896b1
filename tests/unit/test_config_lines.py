"""Line numbers of keys in TOML."""

import tomllib

import pytest

from rdpm.cases import shipped_names, shipped_text
from rdpm.config.lines import line_numbers

TEXT = '''# a comment with [brackets] and "quotes"
title = "a # in text, and = too"
a.b = 1
"quoted key" = """
several
lines"""
[domain]
size = [ # comment
  1,
  [2, 3],
]
inline = { x = "}", y = { z = [1, 2] } }
[[bodies]]
d = 'it''s'
[[bodies]]
d = 2
[bodies.motion]
until = 3
last = 1979-05-27T07:32:00Z
'''.replace("''s'", "s'")


def paths(value, path=()):
    """All key paths of parsed TOML."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in items:
        yield (*path, key)
        yield from paths(item, (*path, key))


def test_lines():
    lines = line_numbers(TEXT)
    expected = {
        ("title",): 2,
        ("a", "b"): 3,
        ("quoted key",): 4,
        ("domain",): 7,
        ("domain", "size", 0): 9,
        ("domain", "size", 1, 1): 10,
        ("domain", "inline", "y", "z", 1): 12,
        ("bodies", 0): 13,
        ("bodies", 1, "d"): 16,
        ("bodies", 1, "motion", "until"): 18,
        ("bodies", 1, "motion", "last"): 19,
    }
    assert {path: lines.get(path) for path in expected} == expected


@pytest.mark.parametrize("text", [TEXT, *map(shipped_text, shipped_names())])
def test_every_key_has_a_line(text):
    assert set(line_numbers(text)) == set(paths(tomllib.loads(text)))


@pytest.mark.parametrize(
    "text", ["", "[", "a", "a =", "a = [", 'a = "', "a = {b", "= 1", "[a]]\n[b", "a = [1,,"]
)
def test_broken_text_is_no_error(text):
    line_numbers(text)


def test_linear_in_the_length():
    rows = "a = [\n" + "[1, 2, 3],\n" * 20_000 + "]\n"
    assert line_numbers(rows)[("a", 19_999, 2)] == 20_001
