"""The first page leads from a question to every page of how-to, theory, tutorial and reference."""

import re
from pathlib import Path

DOCS = Path(__file__).parents[2] / "docs"


def test_every_page_answers_a_question():
    table = "\n".join(line for line in (DOCS / "index.md").read_text().splitlines() if line.startswith("| "))
    linked = {target.split("#")[0] for target in re.findall(r"\]\(([^)]+)\)", table)}
    pages = {p.relative_to(DOCS).as_posix() for folder in ("howto", "theory", "tutorial", "reference")
             for p in (DOCS / folder).glob("*.md")}  # fmt: skip
    assert pages - linked == set()
    assert {target for target in linked if not (DOCS / target).is_file()} == set()
