"""What rdpm says when something is wrong: place, value, rule, reason, cure."""

from __future__ import annotations

__all__ = [
    "BodyLeftError",
    "CaseError",
    "CflError",
    "CheckpointError",
    "DivergenceError",
    "GuardError",
    "NanError",
    "OutputError",
    "OverlapError",
    "RdpmError",
]


class RdpmError(Exception):
    """An error a user can mend, told in five parts.

    Parameters
    ----------
    place : str
        Where: ``case.toml:3: fluid.viscosity``, a file, a step.
    value : object, optional
        What was found there; left out of the message when None.
    rule : str
        What must hold, without a full stop.
    reason : str, optional
        Why it must, in a few words.
    cure : str, optional
        What to do, as a sentence.

    Examples
    --------
    >>> print(CaseError("contact.contact_steps", 3, "must be at least 4", "rebound is not resolved",
    ...                 "Raise it, or lower time.step."))
    contact.contact_steps = 3: must be at least 4 (rebound is not resolved). Raise it, or lower time.step.
    """

    exit_code = 1

    def __init__(self, place: str, value: object, rule: str, reason: str = "", cure: str = "") -> None:
        self.place, self.value, self.rule, self.reason, self.cure = place, value, rule, reason, cure
        found = f" = {value}" if value is not None else ""
        why = f" ({reason})" if reason else ""
        super().__init__(f"{place}{found}: {rule}{why}.{' ' + cure if cure else ''}")

    def __reduce__(self) -> tuple[type[RdpmError], tuple[str, object, str, str, str]]:
        """For a copy in another process."""
        return type(self), (self.place, self.value, self.rule, self.reason, self.cure)


class CaseError(RdpmError, ValueError):
    """The input is wrong; nothing was written. Exit code 2."""

    exit_code = 2


class OutputError(RdpmError, OSError):
    """The results could not be written. Exit code 2 before the run, 3 during it."""

    exit_code = 3


class CheckpointError(RdpmError):
    """A checkpoint is missing, spoiled, or of another case. Exit code 2."""

    exit_code = 2


class GuardError(RdpmError):
    """A guard stopped the run: the numbers can no longer be trusted. Exit code 3."""

    exit_code = 3
    guard = "guard"


class NanError(GuardError):
    """A field or a body holds a number that is not finite."""

    guard = "nan"


class CflError(GuardError):
    """The flow crosses too much of a cell in one step."""

    guard = "cfl"


class DivergenceError(GuardError):
    """The velocity is not divergence-free to round-off."""

    guard = "divergence"


class RanksError(GuardError):
    """Bodies are no longer the same on all ranks."""

    guard = "ranks"


class OverlapError(GuardError):
    """Two bodies, or a body and a wall, overlap more than ``contact.overlap_limit``."""

    guard = "overlap"


class BodyLeftError(GuardError):
    """A body's centre left the box."""

    guard = "body left"
