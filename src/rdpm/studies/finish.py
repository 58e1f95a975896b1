"""What is made of a study's results: its drawings and the verdicts on its claims."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict
from typing import Any

from rdpm.io.files import reporting
from rdpm.io.provenance import write_json
from rdpm.studies.registry import CLAIMS, DRAWINGS
from rdpm.studies.results import StudyResults

__all__ = ["finish"]


def finish(results: StudyResults, tell: Callable[[str], None] = lambda _: None) -> list[dict[str, Any]]:
    """Draw what the study draws into ``figures/``, and judge its claims into ``claims.json``.

    Parameters
    ----------
    results : StudyResults
    tell : callable, optional
        Gets a sentence about what could not be drawn or judged.

    Returns
    -------
    list of dict
        ``study, claim, text, options`` and the fields of a `Judgement`, one a claim; verdict None where it could not be
        judged.

    Notes
    -----
    A drawing or a claim that fails is told, and the others are made.
    """
    index = results.index
    whole = {"name": results.name, **index["own"]}
    parts = [(part, results.part(part["name"])) for part in index["parts"] if part["name"] != results.name]
    judged = []
    alone = [(part, results) for part in index["parts"] if part["name"] == results.name]
    for part, found in (*parts, *alone, *([(whole, results)] if parts else [])):
        _draw(found, part["draw"], tell)
        judged += [_judge(found, claim, tell) for claim in part["claims"]]
    if judged:
        write_json(results.folder.path / "claims.json", {"claims": judged})
    return judged


def _draw(results: StudyResults, names: list[str], tell: Callable[[str], None]) -> None:
    if not names:
        return
    target = results.folder.figures / results.name
    with reporting(target):
        target.mkdir(parents=True, exist_ok=True)
    for name in names:
        try:
            DRAWINGS[name].draw(results, target)
        except Exception as error:
            tell(f"{results.name}: {name} was not drawn: {error}")


def _judge(results: StudyResults, claim: dict[str, Any], tell: Callable[[str], None]) -> dict[str, Any]:
    said = {"study": results.name, **claim}
    try:
        return said | asdict(CLAIMS[claim["claim"]](results, **claim["options"]))
    except Exception as error:
        tell(f"{results.name}: the claim {claim['claim']} was not judged: {error}")
        return said | {"verdict": None, "reason": f"not judged: {error}", "runs": (), "numbers": {}}
