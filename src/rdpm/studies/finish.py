"""What is made of a study's results: its drawings, the verdicts on its claims, and the page that shows both."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, replace
from typing import Any

from rdpm.figures.study_charts import shrink
from rdpm.io.files import reporting
from rdpm.io.provenance import write_json
from rdpm.studies.claims import judge_study
from rdpm.studies.page import write_page
from rdpm.studies.pictures import Picture
from rdpm.studies.registry import CLAIMS, DRAWINGS
from rdpm.studies.results import StudyResults

__all__ = ["finish", "finished"]


def finish(results: StudyResults, tell: Callable[[str], None] = lambda _: None) -> list[dict[str, Any]]:
    """Draw what the study draws into ``figures/``, judge its claims into ``claims.json``, write ``page.html``.

    Parameters
    ----------
    results : StudyResults
    tell : callable, optional
        Gets a sentence about what could not be drawn or judged.

    Returns
    -------
    list of dict
        ``study, claim, statement, slide`` and the fields of a `rdpm.studies.claims.Judgement`, one a claim.

    Notes
    -----
    The claims of an included study are judged by its own runs against their own spread; where none of them was
    repeated, against the widest that the other parts know.
    A drawing or a claim that fails is told, and the others are made.
    """
    judged, pictures = finished(results, tell)
    if judged:
        write_json(results.folder.path / "claims.json", {"claims": judged})
    write_page(results, judged, pictures)
    return judged


def finished(
    results: StudyResults, tell: Callable[[str], None]
) -> tuple[list[dict[str, Any]], dict[str, list[Picture]]]:
    """Draw and judge as `finish` does: the judged claims, and the pictures by the name of the part."""
    index = results.index
    parts = [(part, results.part(part["name"])) for part in index["parts"]]
    if [part["name"] for part, _ in parts] != [results.name]:
        parts.append(({"name": results.name, **index["own"]}, results))
    judged: list[dict[str, Any]] = []
    pictures: dict[str, list[Picture]] = {}
    for part, found in parts:
        pictures[found.name] = _drawn(found, part["draw"], tell)
        seen = _with_spread(found, results) if part["claims"] else found
        judged += [_judged(seen, name, tell) for name in part["claims"]]
    return judged, pictures


def _drawn(results: StudyResults, names: list[str], tell: Callable[[str], None]) -> list[Picture]:
    target, found = results.folder.figures / results.name, []
    if names:
        with reporting(target):
            target.mkdir(parents=True, exist_ok=True)
    for name in names:
        try:
            found += DRAWINGS[name].draw(results, target)
        except Exception as error:
            tell(f"{results.name}: {name} was not drawn: {error}")
    for picture in found:
        shrink(picture.path)
    return found


def _judged(results: StudyResults, name: str, tell: Callable[[str], None]) -> dict[str, Any]:
    claim = CLAIMS[name]
    said = {"study": results.name, "claim": name, "statement": claim.statement, "slide": claim.slide}
    try:
        judgement: Mapping[str, Any] = asdict(judge_study(claim, results))
    except Exception as error:
        tell(f"{results.name}: the claim {name} was not judged: {error}")
        judgement = {"verdict": "not judged", "sentence": str(error), "reason": "", "runs": (), "numbers": {}}
    return said | dict(judgement)


def _with_spread(part: StudyResults, whole: StudyResults) -> StudyResults:
    """The part; where it repeats no run, with those that other parts repeat, which count for the spread only."""
    import pandas

    if (part.table["spread_of"].fillna("") != "").any():
        return part
    others = whole.table[whole.table["study"] != part.name].copy()
    others["spread_of"] = others["spread_of"].fillna("")
    repeated = set(zip(others["study"], others["spread_of"], strict=True))
    is_repeated = [pair in repeated for pair in zip(others["study"], others["run"], strict=True)]
    others.loc[is_repeated, "spread_of"] = others.loc[is_repeated, "run"]
    others = others[others["spread_of"] != ""]
    if part.name == whole.name or others.empty:
        return part
    return replace(part, table=pandas.concat([part.table, others], ignore_index=True))
