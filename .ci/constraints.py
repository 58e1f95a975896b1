"""The packages with which the tests ran: ``keep`` writes ``constraints.txt``, ``compare`` says what is newer here.

Both look at the environment that runs this file, which has rdpm with all its extras.
"""

from __future__ import annotations

import re
import sys
from importlib.metadata import distributions, requires
from pathlib import Path

FILE = Path(__file__).resolve().parents[1] / "constraints.txt"
HEADER = "# Versions with which the tests passed; made by .ci/constraints.py keep.\n"

#: Part of every environment, and of none of rdpm's needs.
NOT_NEEDED = {"pip", "rdpm", "setuptools", "wheel"}


def plain(name: str) -> str:
    """A package's name as the index compares it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def installed() -> dict[str, str]:
    """Version of each package of this environment."""
    found = {plain(d.metadata["Name"]): d.version for d in distributions()}
    return {name: found[name] for name in sorted(found) if name not in NOT_NEEDED}


def listed() -> dict[str, str]:
    """Version of each package in the file."""
    lines = FILE.read_text().splitlines()
    return dict(line.split("==") for line in lines if "==" in line)


def needed() -> set[str]:
    """What rdpm names itself, its extras included."""
    return {plain(re.split(r"[\s<>=!~;\[(]", line, maxsplit=1)[0]) for line in requires("rdpm") or ()}


def main(verb: str) -> str | None:
    """Return what is wrong, or None."""
    here = installed()
    if absent := sorted(needed() - set(here)):
        return f"not installed here: {', '.join(absent)}. Install rdpm with all its extras."
    if verb == "keep":
        FILE.write_text(HEADER + "".join(f"{name}=={version}\n" for name, version in here.items()))
        return None
    there = listed()
    for name in sorted(set(here) | set(there)):
        if here.get(name) != there.get(name):
            print(f"{name}: {here.get(name, 'not')} here, {there.get(name, 'not')} in constraints.txt")
    if absent := sorted(needed() - set(there)):
        return f"not in constraints.txt: {', '.join(absent)}. Make it again: python .ci/constraints.py keep"
    return None


if __name__ == "__main__":
    if sys.argv[1:] not in (["keep"], ["compare"]):
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1]))
