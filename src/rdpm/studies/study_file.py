"""The study file: a family of cases, what is measured, drawn and claimed; from TOML to a checked model."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, StrictStr, ValidationError, model_validator

from rdpm.cases import shipped_studies, shipped_study_text
from rdpm.config.declared import Components, EachOf, Quantity, Whole, items, placed
from rdpm.config.fields import Model, Vectors
from rdpm.config.lines import line_numbers
from rdpm.config.problems import Known, first_problem
from rdpm.config.rule import Path as KeyPath
from rdpm.config.rule import RuleError, listed, shown, suggestion
from rdpm.config.source import parse_toml, read_text
from rdpm.errors import CaseError
from rdpm.studies.registry import CLAIMS, DRAWINGS, MEASURES
from rdpm.studies.values import is_range, to_values

__all__ = ["Base", "LoadedStudy", "Quick", "Row", "Spread", "Start", "StudyFile", "load_study", "study_name"]

Values = dict[str, Any]

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.+-]{0,79}")


def _flat(value: Any, above: str = "") -> Values:
    """Dotted keys of nested tables: ``contact.stiffness = 1`` and ``"contact.stiffness" = 1`` are the same."""
    if not isinstance(value, dict):
        raise RuleError("must be a table of keys and values", value=value)
    found: Values = {}
    for key, item in value.items():
        name = f"{above}.{key}" if above else str(key)
        if isinstance(item, dict) and item and not is_range(item):
            found |= _flat(item, name)
        else:
            found[name] = item
    return found


def _varied(value: Any) -> dict[str, tuple[Any, ...]]:
    return {key: placed(key, to_values, item) for key, item in _flat(value).items()}


def _columns(value: Any) -> dict[str, tuple[Any, ...]]:
    columns = _varied(value)
    if not columns:
        raise RuleError("must have at least one key", cure='Write "contact.stiffness" = [...] below it.')
    lengths = {key: len(column) for key, column in columns.items()}
    if len(set(lengths.values())) > 1:
        said = ", ".join(f"{key} has {count}" for key, count in lengths.items())
        raise RuleError("must have columns of one length", said)
    for n, name in enumerate(columns.get("name", ())):
        placed("name", _name, name) if isinstance(name, str) else placed("name", _no_name, n, name)
    return columns


def _no_name(row: int, value: Any) -> None:
    raise RuleError("must be text", value=value).below(row)


def _name(value: Any) -> str:
    if not isinstance(value, str) or not _NAME.fullmatch(value):
        raise RuleError("must be a name of letters, digits and _ . + -", "a folder carries it", value=value)
    return value


def _tables(value: Any) -> tuple[Any, ...]:
    if isinstance(value, dict):
        raise RuleError("must be a list of tables", cure="Write the header with two brackets, [[...]].", value=value)
    return tuple(items(value))


def _names_of(known: Mapping[str, object]) -> BeforeValidator:
    def check(value: Any) -> tuple[str, ...]:
        return tuple(placed(n, _one_of, item, known) for n, item in enumerate(items(value)))

    return BeforeValidator(check)


def _one_of(value: Any, known: Mapping[str, object]) -> str:
    if isinstance(value, str) and value in known:
        return value
    if not known:
        raise RuleError("must be one of those there are, and there is none", value=value)
    cure = suggestion(value, known) if isinstance(value, str) and len(value) < 80 else ""
    raise RuleError(f"must be one of {listed(sorted(known))}", cure=cure, value=value)


def _texts(value: Any) -> tuple[str, ...]:
    for n, item in enumerate(items(value)):
        if not isinstance(item, str):
            raise RuleError("must be text", value=item, at=(n,))
    return tuple(value)


Set = Annotated[Values, BeforeValidator(_flat)]
Texts = Annotated[tuple[str, ...], BeforeValidator(_texts)]


class Base(Model):
    """What all runs share.

    Attributes
    ----------
    case : str or dict
        A shipped case, a path (from the study file's folder), or what a case file holds.
    set : dict
        Dotted keys of the case and their values, instead of the base's.
    unset : tuple of str
        Keys of the base that are left out.
    """

    case: StrictStr | dict[str, Any]
    set: Set = Field(default_factory=dict)
    unset: Texts = ()


class Start(Model):
    """One run to a checkpoint from which all runs go on that differ from it in contact parameters, end or output only.

    Attributes
    ----------
    at : float, [s]
        > 0, before the end of each run; before the first contact, if the runs are to be told apart by contacts alone.
    """

    at: Annotated[float, Quantity("s", gt=0.0)]


class Row(Model):
    """One run by name.

    Attributes
    ----------
    name : str
    set : dict
    unset : tuple of str
    """

    name: Annotated[str, BeforeValidator(_name)]
    set: Set = Field(default_factory=dict)
    unset: Texts = ()


class Spread(Model):
    """Runs repeated with changes that physics does not know.

    Attributes
    ----------
    of : tuple of str
        Names of the runs that are repeated; all when left out.
    shifts : tuple of 3-tuples, [cells]
        All bodies are moved by so many cells along x, y, z.
    orientation_seeds : tuple of int
        Markers turned at random.
    time_steps : tuple of float, [s]
        Other steps; contacts of a given number of steps keep their length in time.
    """

    of: Texts = ()
    shifts: Annotated[Vectors, EachOf(Components(Quantity("")))] = ()
    orientation_seeds: Annotated[tuple[int, ...], EachOf(Whole(0, 2**63 - 1))] = ()
    time_steps: Annotated[tuple[float, ...], EachOf(Quantity("s", gt=0.0))] = ()

    @model_validator(mode="after")
    def _has_some(self) -> Spread:
        if not (self.shifts or self.orientation_seeds or self.time_steps):
            raise RuleError('must have "shifts", "orientation_seeds" or "time_steps"', "nothing would be changed")
        return self


class Quick(Model):
    """A miniature of the study, for a first look and for tests (``--quick``).

    Attributes
    ----------
    set : dict
        Dotted keys and values, after all others.
    start_at : float, [s], optional
        Instead of ``start.at``; 0 leaves the common start out.
    most_runs : int
        Of the study's runs, evenly taken; 1 to 1000.
    """

    set: Set = Field(default_factory=dict)
    start_at: Annotated[float | None, Quantity("s", ge=0.0)] = None
    most_runs: Annotated[int, Whole(1, 1000)] = 3


class StudyFile(Model):
    """What a study file says.

    Attributes
    ----------
    title, question : str
    include : tuple of str
        Names or paths of other studies, which are run as parts of this one; it then has no runs of its own.
    base : Base
    start : Start, optional
    vary : dict of tuple
        Keys and their values; the runs are all combinations.
    linked : tuple of dict of tuple
        Each: columns of one length, varied together; combined with `vary` and with each other. A column ``name`` names
        its rows.
    runs : tuple of Row
        Runs beside those of `vary` and `linked`.
    measure, draw, claims : tuple of str
        Names of `rdpm.studies.registry`.
    spread : Spread, optional
    quick : Quick, optional
    """

    title: StrictStr = ""
    question: StrictStr = ""
    include: tuple[StrictStr | dict[str, Any], ...] = ()
    base: Base | None = None
    start: Start | None = None
    vary: Annotated[dict[str, tuple[Any, ...]], BeforeValidator(_varied)] = Field(default_factory=dict)
    linked: Annotated[
        tuple[dict[str, tuple[Any, ...]], ...],
        BeforeValidator(lambda value: tuple(placed(n, _columns, item) for n, item in enumerate(_tables(value)))),
    ] = ()
    runs: Annotated[tuple[Row, ...], BeforeValidator(_tables)] = ()
    measure: Annotated[tuple[str, ...], _names_of(MEASURES)] = ("contacts", "extremes")
    draw: Annotated[tuple[str, ...], _names_of(DRAWINGS)] = ()
    claims: Annotated[tuple[str, ...], _names_of(CLAIMS)] = ()
    spread: Spread | None = None
    quick: Quick | None = None

    @model_validator(mode="after")
    def _is_one_kind(self) -> StudyFile:
        own = [name for name in ("base", "start", "vary", "linked", "runs", "spread") if getattr(self, name)]
        if self.include and own:
            raise RuleError(
                "must not stand beside include", "the included studies have their own runs",
                "Leave it out, or write a study of its own and include it.", at=(own[0],),
            )
        if not self.include and self.base is None:
            raise RuleError("is missing", cure='Add [base] with case = "dkt".', at=("base",))
        return self


_KNOWN = Known(
    "study",
    StudyFile,
    {
        "case": 'Write for example case = "dkt".', "at": 'Write for example at = "1.3 s".',
        "name": 'Write for example name = "soft".',
    },
)


class LoadedStudy:
    """A study file with what is needed to tell where something stands.

    Attributes
    ----------
    name : str
        Of the shipped study, or of the file without its ending.
    file : StudyFile
    raw : dict
        What the file holds.
    places : dict
        Key path -> ``file:line``.
    folder : pathlib.Path or None
        From which paths in the file go; None for a shipped study, and for one that is no file.
    parts : tuple of LoadedStudy
        The included ones.
    """

    def __init__(
        self, name: str, file: StudyFile, raw: Values, places: dict[KeyPath, str], folder: Path | None
    ) -> None:
        self.name, self.file, self.raw, self.places, self.folder = name, file, raw, places, folder
        self.parts: tuple[LoadedStudy, ...] = ()

    def place(self, *path: str | int) -> str:
        """Where the longest known part of a key path stands; the study's name where that is unknown."""
        for length in range(len(path), 0, -1):
            if path[:length] in self.places:
                return self.places[path[:length]]
        return self.name


def study_name(source: str | Path | Values) -> str:
    """Name of a study: the shipped name, or the file's without its ending.

    Examples
    --------
    >>> study_name("dkt-stiffness"), study_name("mine/sweep.toml"), study_name({})
    ('dkt-stiffness', 'sweep', 'study')
    """
    return str(source.get("name", "study")) if isinstance(source, dict) else Path(source).stem or "study"


def load_study(source: str | Path | Values, _above: tuple[str, ...] = ()) -> LoadedStudy:
    """Load a study file and check all that the file alone can tell.

    Parameters
    ----------
    source : str, Path or dict
        A shipped study (its name goes before a file of that name), a path, or what such a file holds.

    Returns
    -------
    LoadedStudy

    Raises
    ------
    CaseError
        One message for the first problem: place, value, rule, reason and cure.

    Notes
    -----
    Whether each run's case is right is told by `rdpm.studies.expand.expand`.

    Examples
    --------
    >>> load_study({"base": {"case": "dkt"}, "vary": {"contact.restitution": "0.3:0.9:3"}}).file.vary
    {'contact.restitution': (0.3, 0.6, 0.9)}
    """
    raw, label, folder, places = _read(source)
    name = raw.pop("name", None) or study_name(source)
    if name in _above:
        raise CaseError(label, None, "must not include itself", " > ".join((*_above, name)))
    try:
        study = LoadedStudy(name, StudyFile.model_validate(raw), raw, places, folder)
    except ValidationError as error:
        raise first_problem(error, raw, places, label, _KNOWN) from None
    except RecursionError:
        raise CaseError(label, None, "must be of a few levels", "lists or tables are nested too deeply") from None
    parts = []
    for n, part in enumerate(study.file.include):
        try:
            found = (folder or Path()) / part if isinstance(part, str) and part not in shipped_studies() else part
            parts.append(load_study(found, (*_above, name)))
        except CaseError as error:
            place = f"{study.place('include', n)}: include[{n}]: {error.place}"
            raise CaseError(place, error.value, error.rule, error.reason, error.cure) from None
    names = [part.name for part in parts]
    if len(set(names)) < len(names):
        raise CaseError(f"{study.place('include')}: include", None, "must name each study once", ", ".join(names))
    study.parts = tuple(parts)
    return study


def _read(source: str | Path | Values) -> tuple[Values, str, Path | None, dict[KeyPath, str]]:
    """What a study file holds, its label in messages, the folder of its paths, and the lines of its keys."""
    if isinstance(source, dict):
        return dict(source), study_name(source), None, {}
    folder: Path | None = None
    if isinstance(source, str) and source in shipped_studies():
        text, label = shipped_study_text(source), f"{source}.toml"
    else:
        path = Path(source)
        if not path.exists() and path.suffix in ("", ".toml") and path.parent == Path():
            cure = suggestion(path.stem[:80], shipped_studies()).replace("There are:", "Shipped studies are:")
            raise CaseError(shown(str(source))[1:-1], None, "there is no such study", cure=cure)
        text, label, folder = read_text(path), shown(str(source), longest=200)[1:-1], path.parent
    places = {path_: f"{label}:{line}" for path_, line in line_numbers(text).items()}
    return parse_toml(text, label), label, folder, places


