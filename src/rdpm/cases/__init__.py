"""The shipped cases: editable TOML files, by name."""

from __future__ import annotations

from importlib.resources import files

__all__ = ["shipped_names", "shipped_text"]


def shipped_names() -> list[str]:
    """Return the names of the shipped cases, sorted.

    Examples
    --------
    >>> "dkt" in shipped_names()
    True
    """
    return sorted(
        item.name.removesuffix(".toml") for item in files(__name__).iterdir() if item.name.endswith(".toml")
    )


def shipped_text(name: str) -> str:
    """Return the TOML text of a shipped case.

    Parameters
    ----------
    name : str
        One of :func:`shipped_names`.

    Raises
    ------
    KeyError
        There is no such case.

    Examples
    --------
    >>> shipped_text("dkt").startswith("#")
    True
    """
    if name not in shipped_names():
        raise KeyError(name)
    return files(__name__).joinpath(f"{name}.toml").read_text(encoding="utf-8")
