"""Whether a change keeps the results: a fixed set of runs, compared between two builds or with stored tables.

A change that should alter nothing is shown by bytes, between two builds on one machine::

    old/bin/python .ci/golden.py run before
    new/bin/python .ci/golden.py run after
    python .ci/golden.py same before after

Another machine contracts sums otherwise, so continuous integration runs a shorter set and compares it with the tables
in ``tests/data/golden`` within `TOLERANCE`. Who changes results on purpose renews these with ``keep``::

    python .ci/golden.py check
    python .ci/golden.py keep
"""

from __future__ import annotations

import argparse
import csv
import math
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path

STORED = Path(__file__).resolve().parents[1] / "tests/data/golden"
TABLES = ("particles.csv", "contacts.csv", "history.csv")

#: Largest difference, of the largest value of the column. Other instruction sets give 1e-13; what a pair does after a
#: contact amplifies that by some thousand times in these runs.
TOLERANCE = 1e-6

#: Share of its vector below which a component is round-off of what symmetry makes zero, and is held against the vector.
ZERO = 1e-9

#: Largest values by unit below which a vector is round-off of what symmetry makes zero.
LEAST = {"rad_s": 1e-6, "N_m": 1e-12}

#: Round-off alone: they have no digits to compare.
NOISE = {"divergence"}

#: Rows of a table that are stored, evenly taken.
ROWS = 12

DRY_BOX = """
title = "64 spheres of two sizes fall into a box"
[domain]
size = ["60 mm", "60 mm", "120 mm"]
[[bodies]]
diameter = "10 mm"
density = 2500
velocity = [0.1, 0.05, 0]
lattice.counts = [4, 4, 2]
lattice.spacing = ["14 mm", "14 mm", "14 mm"]
lattice.origin = ["9 mm", "9 mm", "20 mm"]
lattice.jitter = "1 mm"
lattice.seed = 3
[[bodies]]
diameter = "7 mm"
density = 1200
lattice.counts = [4, 4, 2]
lattice.spacing = ["14 mm", "14 mm", "14 mm"]
lattice.origin = ["9 mm", "9 mm", "60 mm"]
lattice.jitter = "1 mm"
lattice.seed = 4
[contact]
restitution = 0.7
contact_steps = 8
friction = 0.3
[time]
end = "0.3 s"
step = "0.05 ms"
[output]
table_every = "5 ms"
"""

DRY_SHEAR = """
title = "Spheres between moving walls, periodic along x, contacts that end at zero overlap"
[domain]
size = ["50 mm", "40 mm", "40 mm"]
boundary = { x = "periodic", y = "free-slip", z = "wall" }
gravity = [0, 0, 0]
[domain.wall_velocity]
z_lower = [-0.5, 0, 0]
z_upper = [0.5, 0, 0]
[[bodies]]
diameter = "9 mm"
density = 2500
velocity = [0.3, 0, 0.2]
angular_velocity = [0, 5, 0]
lattice.counts = [5, 4, 4]
lattice.spacing = ["10 mm", "10 mm", "10 mm"]
lattice.origin = ["5 mm", "5 mm", "5 mm"]
lattice.jitter = "0.4 mm"
lattice.seed = 5
[[bodies]]
diameter = "4 mm"
density = 7800
centers = [["10 mm", "10 mm", "10 mm"]]
motion = { velocity = [0.05, 0.0, 0.05], until = 0.02 }
[contact]
stiffness = "2e4 N/m"
damping = "0.5 N s/m"
ending = "zero-overlap"
friction = 0.4
[time]
end = "0.1 s"
[output]
table_every = "2 ms"
"""

#: Case, and what is set in it: as shipped, the rebound to 0.1 s after its first impact; then the short set.
FULL: dict[str, tuple[str, list[str]]] = {
    "settling": ("settling", []),
    "dkt": ("dkt", []),
    "dkt-adaptive": ("dkt", ["time.step=adaptive"]),
    "dkt-small": ("dkt-small", []),
    "rebound": ("rebound", ["time.end='0.25 s'"]),
    "cloud": ("cloud", []),
    "dry-box": (DRY_BOX, []),
    "dry-shear": (DRY_SHEAR, []),
}
SHORT: dict[str, tuple[str, list[str]]] = {
    "settling": ("settling", ["resolution.cells_per_diameter=6", "time.end=0.4"]),
    "dkt": ("dkt", ["resolution.cells_per_diameter=6", "time.end=2.0"]),
    "dkt-adaptive": ("dkt", ["resolution.cells_per_diameter=6", "time.step=adaptive", "time.end=2.0"]),
    "dkt-small": ("dkt-small", ["resolution.cells_per_diameter=6", "time.end=0.3"]),
    "rebound": (
        "rebound",
        [
            "domain.size=['12 mm', '12 mm', '40 mm']",
            "bodies[0].centers=[['6 mm', '6 mm', '30 mm']]",
            "resolution.cells_per_diameter=8",
            "time.step='0.08 ms'",
            "time.end='0.12 s'",
        ],
    ),
    "cloud": ("cloud", ["resolution.cells_per_diameter=6", "time.end=0.6"]),
    "dry-box": (DRY_BOX, ["time.end=0.12"]),
    "dry-shear": (DRY_SHEAR, ["time.end=0.04"]),
}


def run(chosen: dict[str, tuple[str, list[str]]], folder: Path, names: Iterable[str] = ()) -> None:
    """Run cases into a folder, one sub-folder each."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, (case, overrides) in chosen.items():
        if names and name not in names:
            continue
        if "\n" in case:
            path = folder / f"{name}.toml"
            path.write_text(case, encoding="utf-8")
            case = str(path)
        words = [case, "--out", str(folder / name), "--quiet"]
        for override in [*overrides, "output.report=false", "output.fields_every=0"]:
            words += ["--set", override]
        code = "import sys; from rdpm.cli.main import main; sys.exit(main())"
        print(f"{name} ...", flush=True)
        subprocess.run([sys.executable, "-c", code, "run", *words], check=True)


def same(one: Path, other: Path) -> list[str]:
    """Tables that differ by a byte."""
    found = []
    folders = sorted(path.parent for path in one.glob("*/particles.csv"))
    for folder in folders:
        for table in TABLES:
            first, second = folder / table, other / folder.name / table
            if not second.is_file():
                found.append(f"{folder.name}/{table}: missing in {other}")
            elif first.read_bytes() != second.read_bytes():
                found.append(f"{folder.name}/{table}: differs{_where(first, second)}")
    return found if folders else [f"{one} holds no runs"]


def _where(first: Path, second: Path) -> str:
    pairs = zip(first.read_text().splitlines(), second.read_text().splitlines(), strict=False)
    line = next((n for n, (a, b) in enumerate(pairs, 1) if a != b), None)
    return f" from line {line}" if line else " in length"


def thinned(path: Path) -> tuple[list[str], dict[int, list[str]]]:
    """Columns, and some rows by their number; -1 holds how many there are."""
    with path.open(newline="") as file:
        columns, *rows = csv.reader(file)
    chosen = sorted({round(n * (len(rows) - 1) / (ROWS - 1)) for n in range(ROWS)}) if rows else []
    return columns, {n: rows[n] for n in chosen} | {-1: [str(len(rows))]}


def compare(folder: Path) -> list[str]:
    """What is further from the stored tables than the tolerance."""
    found: list[str] = []
    for stored in sorted(STORED.glob("*.csv")):
        name, table = stored.stem.split(".")
        columns, rows = thinned(folder / name / f"{table}.csv")
        with stored.open(newline="") as file:
            head, *kept = csv.reader(file)
        if gone := [column for column in head[1:] if column not in columns]:
            found.append(f"{name}/{table}: columns {gone} are missing")
            continue
        expected = {int(row[0]): row[1:] for row in kept}
        if expected.pop(-1)[0] != rows.pop(-1)[0]:
            found.append(f"{name}/{table}: another number of rows")
            continue
        least = {_vector(column): value for column in head for unit, value in LEAST.items() if column.endswith(unit)}
        vectors = dict(least)
        largest = {
            column: max((abs(x) for v in expected.values() if math.isfinite(x := _number(v[n]))), default=0.0)
            for n, column in enumerate(head[1:])
        }
        for column, own in largest.items():
            vectors[_vector(column)] = max(vectors.get(_vector(column), 0.0), own)
        for n, column in enumerate(head[1:]):  # a column that was added is not yet stored
            if column not in NOISE:
                computed = {row: values[columns.index(column)] for row, values in rows.items()}
                stored = {row: values[n] for row, values in expected.items()}
                vector, own = vectors[_vector(column)], largest[column]
                is_zero = vector == least.get(_vector(column)) or own <= ZERO * vector
                scale = vector if is_zero else own
                found += _column(f"{name}/{table}: {column}", stored, computed, scale)
    return found


def _vector(column: str) -> str:
    """The column's name without its direction: a component that symmetry makes zero is round-off of the others."""
    return re.sub(r"(^|_)[xyzuvw](_|$)", r"\1\2", column)


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan


def _column(place: str, expected: dict[int, str], computed: dict[int, str], scale: float) -> list[str]:
    pairs = [(row, expected[row], computed[row]) for row in expected]
    try:
        numbers = [(row, float(a or "nan"), float(b or "nan")) for row, a, b in pairs]
    except ValueError:
        return [f"{place}: {b}, not {a}" for _, a, b in pairs if a != b]
    return [
        f"{place}, row {row}: {b!r}, not {a!r}"
        for row, a, b in numbers
        if not (a == b or (math.isnan(a) and math.isnan(b)) or abs(a - b) <= TOLERANCE * scale)
    ]


def keep(folder: Path) -> None:
    """Store the thinned tables of the short set."""
    STORED.mkdir(parents=True, exist_ok=True)
    for name in SHORT:
        for table in TABLES:
            columns, rows = thinned(folder / name / table)
            with (STORED / f"{name}.{table}").open("w", newline="") as file:
                writer = csv.writer(file, lineterminator="\n")
                writer.writerow(["row", *columns])
                writer.writerows([n, *row, *[""] * (len(columns) - len(row))] for n, row in sorted(rows.items()))


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = parser.add_subparsers(dest="verb", required=True)
    verb = verbs.add_parser("run", help="run the set with this interpreter's rdpm")
    verb.add_argument("folder", type=Path)
    verb.add_argument("names", nargs="*", help="some of the set")
    verb.add_argument("--short", action="store_true", help="the set of `check`")
    verb = verbs.add_parser("same", help="compare two folders byte by byte")
    verb.add_argument("one", type=Path)
    verb.add_argument("other", type=Path)
    verbs.add_parser("check", help="run the short set and compare it with the stored tables")
    verbs.add_parser("keep", help="run the short set and store its tables")
    asked = parser.parse_args()
    problems: list[str] = []
    if asked.verb == "run":
        run(SHORT if asked.short else FULL, asked.folder, asked.names)
    elif asked.verb == "same":
        problems = same(asked.one, asked.other)
    else:
        with tempfile.TemporaryDirectory() as folder:
            run(SHORT, Path(folder))
            if asked.verb == "keep":
                keep(Path(folder))
            else:
                problems = compare(Path(folder))
    print("\n".join(problems[:40]) or "good")
    sys.exit(bool(problems))


if __name__ == "__main__":
    main()
