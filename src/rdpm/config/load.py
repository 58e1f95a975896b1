"""From a case file, a shipped name or a dict to a checked :class:`~rdpm.config.case.Case`.

The first problem is told, and only that: unknown keys before all else, as they explain what seems missing,
then in the order of the file.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from rdpm.config.body_file import read_body_files
from rdpm.config.case import Case
from rdpm.config.lines import line_numbers
from rdpm.config.overrides import apply_overrides, set_values
from rdpm.config.problems import Known, first_problem
from rdpm.config.rule import Path as KeyPath
from rdpm.config.source import case_name, parse_toml, read_source
from rdpm.config.write import case_to_toml
from rdpm.errors import CaseError

__all__ = ["case_name", "case_to_toml", "load_case"]

_CURES = {
    "domain": 'Add [domain] with size = ["10 cm", "10 cm", "50 cm"].',
    "time": 'Add [time] with end = "4 s".',
    "end": 'Write for example end = "4 s".',
    "size": 'Write for example size = ["10 cm", "10 cm", "50 cm"].',
    "diameter": 'Write for example diameter = "15 mm".',
    "density": 'Write for example density = "1120 kg/m^3".',
}


_KNOWN = Known("case", Case, _CURES)


def load_case(source: str | Path | dict[str, Any], overrides: Sequence[str] | Mapping[str, Any] = ()) -> Case:
    """Load a case and check all that the case alone can tell.

    Parameters
    ----------
    source : str, Path or dict
        A shipped name (``"dkt"``; it goes before a file of that name), a path, or what such a file holds.
    overrides : sequence of str, or mapping of str to object, optional
        ``key=value`` each, as ``--set``: the value is TOML, or a string where it does not parse. Or keys such as
        ``"contact.restitution"`` and their values, as a dict.

    Returns
    -------
    Case
        Frozen; every quantity in SI, the defaults filled in, files read.

    Raises
    ------
    CaseError
        One message for the first problem: place, value, rule, reason and cure.

    Notes
    -----
    Whether the time step is stable and the grid fits the memory is for the plan of a run to tell.

    Examples
    --------
    >>> case = load_case("dkt", ["time.end=10 ms"])
    >>> case.time.end, case.fluid.viscosity
    (0.01, 0.113)
    >>> load_case("dkt", {"contact.restitution": 0.8, "time.end": "10 ms"}).contact.restitution
    0.8
    """
    places: dict[KeyPath, str] = {}
    label, folder = "", Path()
    try:
        if isinstance(source, dict):
            raw = _copied(source)
        else:
            text, label, folder = read_source(source)
            raw = parse_toml(text, label)
            places = {path: f"{label}:{line}" for path, line in line_numbers(text).items()}
        if isinstance(overrides, Mapping):
            set_by = set_values(raw, overrides)
        else:
            set_by = apply_overrides(raw, [overrides] if isinstance(overrides, str) else overrides)
        # a value set from outside hides the lines of what it replaces
        places = {
            path: place
            for path, place in places.items()
            if not any(path[: len(key)] == key for key in set_by)
        } | set_by
        read_body_files(raw, folder, places)
        return Case.model_validate(raw)
    except ValidationError as error:
        raise first_problem(error, raw, places, label, _KNOWN) from None
    except RecursionError:
        raise CaseError(
            label or "case", None, "must be of a few levels", "lists or tables are nested too deeply"
        ) from None


def _copied(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _copied(item) for key, item in value.items()}
    return [_copied(item) for item in value] if isinstance(value, list | tuple) else value
