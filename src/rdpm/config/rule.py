"""What a rule of the case file says when it is broken, before the place is known."""

from __future__ import annotations

from typing import Any

__all__ = ["RuleError", "listed", "shown", "suggestion"]

Path = tuple[str | int, ...]


class RuleError(ValueError):
    """A broken rule: all of a :class:`~rdpm.errors.CaseError` but its place.

    Parameters
    ----------
    rule : str
        What must hold, without a full stop.
    reason, cure : str, optional
        Why it must, and what to do.
    value : object, optional
        What was found; left out of the message when None.
    at : tuple of str and int, optional
        The place below the model that raises: ``("centers", 1)``.
    """

    def __init__(
        self, rule: str, reason: str = "", cure: str = "", *, value: object = None, at: Path = ()
    ) -> None:
        super().__init__(rule)
        self.rule, self.reason, self.cure, self.value, self.at = rule, reason, cure, value, at

    def __str__(self) -> str:
        found = f"{shown(self.value)}: " if self.value is not None else ""
        why = f" ({self.reason})" if self.reason else ""
        return f"{found}{self.rule}{why}.{' ' + self.cure if self.cure else ''}"

    def below(self, *at: str | int) -> RuleError:
        """Return the same problem, placed one level deeper."""
        return RuleError(self.rule, self.reason, self.cure, value=self.value, at=(*at, *self.at))


def shown(value: Any, longest: int = 60) -> str:
    """Write a value on one short line, whatever it is."""
    if isinstance(value, dict):
        return "a table"
    if isinstance(value, list | tuple) and len(value) > 3:
        return f"a list of {len(value)}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(shown(item) for item in value) + "]"
    if isinstance(value, bool):
        return "true" if value else "false"
    try:
        text = f'"{value}"' if isinstance(value, str) else repr(value)
    except ValueError:  # Python writes no integer beyond 4300 digits
        return "a number of thousands of digits"
    text = "".join(c if c.isprintable() else "?" for c in text)
    return text if len(text) <= longest else text[: longest - 3] + "..."


def listed(names: Any) -> str:
    """Join names as ``"a", "b"``."""
    return ", ".join(f'"{name}"' for name in names)


def suggestion(name: str, known: Any) -> str:
    """Return ``Did you mean "x"?`` or, where nothing is near, the names there are."""
    import difflib

    near = difflib.get_close_matches(name, list(known), n=1, cutoff=0.6)
    return f'Did you mean "{near[0]}"?' if near else f"There are: {listed(known)}."
