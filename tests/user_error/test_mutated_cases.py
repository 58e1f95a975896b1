"""Whatever is done to a case file, it is accepted or refused with one message."""

import os
import random
import re
import time
import warnings

import pytest

from rdpm.cases import shipped_names, shipped_text
from rdpm.config.load import case_to_toml, load_case
from rdpm.errors import CaseError
from rdpm.setup import plan

# a case file and way of mutation: 20 of these make the 2,000 of the quick tier; `nox -s mutations` asks for 1e5
COUNT = int(os.environ.get("RDPM_MUTATIONS", "2000")) // 20
SLOWEST = 20.0  # s; no mutation may hang, whatever the machine does beside

VALUES = [
    "0",
    "-1",
    "nan",
    "inf",
    "1e400",
    "-1e-300",
    "true",
    '""',
    "[]",
    "{}",
    "[[]]",
    "[1, 2, 3]",
    "{ x = 1 }",
    '"1 kg"',
    '"1e9 m"',
    '"-1 mm"',
    "1979-05-27",
    "9" * 400,
    "0x" + "f" * 4000,
    '"' + "a" * 3000 + '"',
    "1e30",
    "1e-30",
    '"periodic"',
    '"auto"',
    '"free"',
    "[1e9, 1e9, 1e9]",
    "[1000000, 1000000, 1000000]",
    "999999999",
    "{ times = [0], values = [[0, 0, 0]] }",
    '"\\u0000"',
    "[" * 200 + "]" * 200,
]


def mutated(text, rng, way):
    """The text with one to three wounds."""
    for _ in range(rng.randint(1, 3)):
        lines = text.split("\n")
        if way == "value":
            where = [n for n, line in enumerate(lines) if re.match(r"\s*[\w.]+ *=", line)]
            n = rng.choice(where)
            lines[n] = f"{lines[n].partition('=')[0]}= {rng.choice(VALUES)}"
            text = "\n".join(lines)
        elif way == "token":
            found = list(re.finditer(r'"[^"\n]*"|[\w.]+', text))
            old, new = rng.choice(found), rng.choice([*VALUES, rng.choice(found)[0]])
            text = text[: old.start()] + new + text[old.end() :]
        elif way == "lines":
            n, m = rng.randrange(len(lines)), rng.randrange(len(lines))
            lines[n] = rng.choice(["", lines[m], lines[n] + lines[m]])
            text = "\n".join(lines)
        else:
            n = rng.randrange(len(text))
            text = (
                text[:n]
                + rng.choice(["", "\0", "é", '"', "[", "]", "{", "=", "\n", "#", "9", "-", "e"])
                + text[n + 1 :]
            )
    return text


def check_plan(case, where):
    """What the case implies is worked out, or refused with one message."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            made = plan(case)
    except CaseError as error:
        message = str(error)
        assert "\n" not in message, where
    except Exception as error:
        raise AssertionError(f"{where}: {type(error).__name__}: {error}") from error
    else:
        assert made.step.dt > 0.0, where
        assert made.sections, where


@pytest.mark.parametrize("way", ["value", "token", "lines", "bytes"])
@pytest.mark.parametrize("name", shipped_names())
def test_valid_or_one_message(name, way, tmp_path):
    seed = f"{name} {way}"
    rng = random.Random(seed)
    path = tmp_path / "case.toml"
    accepted = 0
    for number in range(COUNT):
        text = mutated(shipped_text(name), rng, way)
        path.write_text(text, encoding="utf-8")
        began = time.monotonic()
        try:
            case = load_case(path)
        except CaseError as error:
            message = str(error)
            assert "\n" not in message, (seed, number)
            assert len(message) < 1000, (seed, number, message)
            assert "case.toml" in message, (seed, number, message)
        except Exception as error:
            raise AssertionError(
                f"mutation {number} of {seed!r}: {type(error).__name__}: {error}\n{text}"
            ) from error
        else:
            accepted += 1
            assert load_case(path) == case
            case_to_toml(case)
            check_plan(case, (seed, number, text))
        assert time.monotonic() - began < SLOWEST, (seed, number)
    assert accepted < COUNT  # the wounds hurt


def test_random_bytes(tmp_path):
    rng = random.Random(3)
    path = tmp_path / "case.toml"
    for _ in range(COUNT):
        path.write_bytes(rng.randbytes(rng.randrange(200)))
        with pytest.raises(CaseError):
            load_case(path)
