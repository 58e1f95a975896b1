"""The project speaks the words of the field: no private ones in the pages, nor in the sources."""

import re
from pathlib import Path

import pytest

CLONE = Path(__file__).parents[2]

#: What is read: pages, and sources with their strings, comments and names.
ROOTS = ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "docs", "src/rdpm", "cpp"]

SUFFIXES = {".md", ".py", ".hpp", ".cpp"}

#: Old word -> the field's word. A letter may not come before or after; an underscore may: names are read in parts.
WORDS = {
    r"films?": "lubrication (correction); video",
    r"kept[ _](?:forces?|shares?|impulses?)|keep_forces|f_\{kept\}|spread_kept|what is (?:not )?kept": "lagged forcing",
    r"fad(?:e|es|ed|ing) (?:forces?|forcing|share)|forces? (?:that )?fad(?:e|es|ed|ing)": "relaxation of the lagged",
    r"(?:stand|stands|stood|standing)[ _]back": "marker exclusion near contact",
    r"(?:inner|spread|contact)[ _]shares?(?:[ _]spin)?": "interior-fluid fraction",
    r"(?:pressure|fluid|liquid|flow|images?) (?:answer(?:s|ed|ing)?|has answered)": "responds; is found inside",
    r"paces?": "adaptive time step, step control",
    r"(?:the|an|this|each|chosen|two) endings?": "contact end (the key `ending` itself is promised)",
    r"held[ _](?:forces?|torques?|loads?)|_?held\(|System\.held": "non-contact load",
    r"(?:not|had|was) foreseen|missed|(?<!_)spare": "predicted, interior residual, unretained part",
    r"rounds? of forcing(?: passes)?|(?:two|second|another|one) rounds?": "outer iteration",
    r"push and turn|(?:the|a|its) turn of|turn[ _]vector": "rotation, rotation vector",
    r"(?:the|a|its|their|in) reach|reach of": "interaction range",
    r"(?:mean|velocity and|or|and|the|no) spins?(?! short)|spin in shear|spins have|\* ?spin,": "angular velocity",
    r"obtained": "achieved",
    r"(?:as|what is|the one|restitution|overlap|speed) asked(?! (?:to|for)\b)|asked and": "target",
    r"(?<!both )(?<!two )(?<!all )(?<!-hand )sides": "boundaries, faces",
    r"sides? of (?:the|a) (?:box|domain|tank|periodic direction)": "face of the box",
    r"(?:no-slip|free-slip|periodic|opposite|moving|upper|lower)(?: \S+)? side": "boundary, face",
}
#: Names that are gone, as they were written.
NAMES = (
    r"\b(?:INNER_SHARE\w*|SPREAD_SHARE|CONTACT_SHARE|FORCING_PASSES|RETRACTION|IMPACT|Pace|pace\.py|inner_share\.py)\b"
)

OLD = [*((re.compile(rf"(?<![A-Za-z])(?:{old})(?![A-Za-z])", re.IGNORECASE), new) for old, new in WORDS.items())]
OLD.append((re.compile(NAMES), "a field of Calibration, StepControl, interior_fraction_bound.py"))


def found(text: str) -> list[tuple[int, str, str]]:
    """Line, old word and new one; what a program printed, shown in a console block, is the program's."""
    blank = lambda block: "\n" * block[0].count("\n")  # noqa: E731
    prose = re.sub(r"^```console\n.*?^```", blank, text, flags=re.MULTILINE | re.DOTALL)
    # A word may be at the end of a line and its second half at the beginning of the next.
    hits = ((match, new) for pattern, new in OLD for match in pattern.finditer(prose.replace("\n", " ")))
    return sorted((prose.count("\n", 0, match.start()) + 1, match[0], new) for match, new in hits)


def is_read(path: Path) -> bool:
    place = path.relative_to(CLONE)
    return path.suffix in SUFFIXES and "_build" not in place.parts


@pytest.mark.parametrize("root", ROOTS)
def test_words_are_those_of_the_field(root):
    place = CLONE / root
    files = [path for path in ([place] if place.is_file() else sorted(place.rglob("*"))) if is_read(path)]
    assert files
    old = []
    for path in files:
        name, text = path.relative_to(CLONE).as_posix(), path.read_text(encoding="utf-8")
        old += [f"{name}:{n}: {word!r}: say {new}" for n, word, new in found(text)]
    assert not old, "\n" + "\n".join(old)


@pytest.mark.parametrize(
    "text",
    [
        "the film model", "film_gap", "a stiff\nfilm", "kept forces", "the kept\nshare", "markers stand back",
        "INNER_SHARE_SPIN", "inner share", "the pressure answers", "Pace in simulation", "the ending",
        "what was foreseen", "two rounds", "push and turn", "contacts in reach", "the spin", "obtained",
        "as asked", "free-slip sides", "a side of the box",
    ],
)  # fmt: skip
def test_an_old_word_is_found(text):
    assert found(text)


@pytest.mark.parametrize(
    "text",
    [
        "space", "spaces", "depending on", "GOMP_SPINCOUNT", "side by side", "beside", "the left-hand side",
        "on both sides", "np.round(x)", "the run was asked to stop", "reaches the end", "turns out", "held constant",
        "profile", "ending='zero-force'",
    ],
)  # fmt: skip
def test_a_word_with_another_meaning_is_not(text):
    assert not found(text)
