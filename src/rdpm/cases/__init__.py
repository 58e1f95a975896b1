"""The shipped cases and studies: editable TOML files, by name."""

from __future__ import annotations

from importlib.resources import files
from importlib.resources.abc import Traversable

__all__ = ["shipped_names", "shipped_studies", "shipped_study_text", "shipped_text"]


def shipped_names() -> list[str]:
    """Return the names of the shipped cases, sorted.

    Examples
    --------
    >>> "dkt" in shipped_names()
    True
    """
    return _names(files(__name__))


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
    return _text(files(__name__), name)


def shipped_studies() -> list[str]:
    """Return the names of the shipped studies, sorted.

    Examples
    --------
    >>> "dkt-stiffness" in shipped_studies()
    True
    """
    return _names(files(__name__) / "studies")


def shipped_study_text(name: str) -> str:
    """Return the TOML text of a shipped study.

    Parameters
    ----------
    name : str
        One of :func:`shipped_studies`.

    Raises
    ------
    KeyError
        There is no such study.

    Examples
    --------
    >>> "[base]" in shipped_study_text("dkt-stiffness")
    True
    """
    return _text(files(__name__) / "studies", name)


def _names(folder: Traversable) -> list[str]:
    return sorted(item.name.removesuffix(".toml") for item in folder.iterdir() if item.name.endswith(".toml"))


def _text(folder: Traversable, name: str) -> str:
    if name not in _names(folder):
        raise KeyError(name)
    return folder.joinpath(f"{name}.toml").read_text(encoding="utf-8")
