"""Range checks of the design functions: arguments are named, values kept, nothing repaired."""

from __future__ import annotations

from typing import Any, Literal, TypeAlias

import numpy as np

from rdpm.errors import CaseError

Values: TypeAlias = Any
"""A float or an array; a function gives floats for floats and broadcasts arrays."""

Ending: TypeAlias = Literal["zero-force", "zero-overlap"]
"""When a contact is over: the force turns attractive, or the overlap is gone."""

ENDINGS = ("zero-force", "zero-overlap")


def as_given(result: Any) -> Values:
    """Give a float for a single value, else the array."""
    return float(result) if np.ndim(result) == 0 else result


def check_ending(ending: str) -> None:
    """Refuse a contact end that is not one of the two."""
    if ending not in ENDINGS:
        raise CaseError(
            "ending", repr(ending), 'must be "zero-force" or "zero-overlap"', cure="Name one of the two."
        )


def _refuse(name: str, value: Any, ok: Any, rule: str, reason: str, cure: str) -> None:
    """Raise CaseError with the first value that breaks the rule."""
    if not np.all(ok):
        wrong = np.extract(~np.broadcast_to(ok, np.shape(value)), value)[0]
        raise CaseError(name, f"{wrong:g}", rule, reason, cure or "Correct this value.")


def positive(name: str, value: Any, reason: str = "", cure: str = "") -> Any:
    """Give the value as float64, refused unless finite and above zero."""
    x = np.asarray(value, dtype=np.float64)
    _refuse(name, x, (x > 0) & np.isfinite(x), "must be a finite number above 0", reason, cure)
    return x


def not_negative(name: str, value: Any, reason: str = "", cure: str = "") -> Any:
    """Give the value as float64, refused unless finite and at least zero."""
    x = np.asarray(value, dtype=np.float64)
    _refuse(name, x, (x >= 0) & np.isfinite(x), "must be a finite number of at least 0", reason, cure)
    return x


def within(name: str, value: Any, ok: Any, rule: str, reason: str = "", cure: str = "") -> Any:
    """Give the value as float64, refused where ``ok`` is false."""
    x = np.asarray(value, dtype=np.float64)
    _refuse(name, x, ok, rule, reason, cure)
    return x


def restitution_in_range(value: Any, ending: str) -> Any:
    """Give the restitution as float64: 0 <= e_n <= 1, and above 0 where the contact ends at zero force."""
    e = np.asarray(value, dtype=np.float64)
    within("restitution", e, (e >= 0) & (e <= 1), "must be in 0 <= e_n <= 1", "a contact adds no energy")
    if ending == "zero-force":
        within(
            "restitution", e, e > 0, "must be above 0 when the contact ends at zero force",
            "no finite damping stops a sphere that is never pulled back",
            'Ask for a small value such as 0.01, or choose ending = "zero-overlap" (critical damping).',
        )  # fmt: skip
    return e
