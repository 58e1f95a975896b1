"""The command ``rdpm``: verbs, exit codes, and what happens to an error."""

from __future__ import annotations

import errno
import importlib
import os
import sys
import tempfile
import traceback
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from rdpm.errors import RdpmError
from rdpm.parallel.launcher import launched_rank

__all__ = ["app", "main"]

# rdpm.cli.VERB has a function VERB
VERBS = ("new", "check", "run", "design", "study", "tune", "report", "validate", "bench", "app", "info")

USAGE, STOPPED, INTERNAL, INTERRUPTED = 2, 3, 1, 130

_FULL = (errno.ENOSPC, errno.EDQUOT)


def app() -> Any:
    """Return the cyclopts application with all verbs.

    Examples
    --------
    >>> app().name
    ('rdpm',)
    """
    import cyclopts

    import rdpm

    application = cyclopts.App(
        name="rdpm",
        help="Particle-resolved simulation of particulate flow with designed soft-sphere contacts.",
        version=rdpm.__version__,
    )
    for verb in VERBS:
        application.command(getattr(importlib.import_module(f"rdpm.cli.{verb}"), verb), name=verb)
    return application


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command.

    Parameters
    ----------
    arguments : sequence of str, optional
        The words after ``rdpm``; those of the process when left out.

    Returns
    -------
    int
        0 done, 1 an internal error, 2 bad input or usage, 3 a guard or a full disk stopped it,
        130 interrupted.

    Examples
    --------
    >>> main(["--version"])  # doctest: +ELLIPSIS
    0...
    0
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    try:
        return _call(words)
    except RdpmError as error:
        _tell(f"rdpm: {error}")
        return error.exit_code
    except KeyboardInterrupt:
        _tell("rdpm: interrupted")
        return INTERRUPTED
    except BrokenPipeError:  # the reader of our output has left; so do we, without a word
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except Exception as error:
        if isinstance(error, OSError) and error.errno in _FULL:
            _tell(f"rdpm: the disk is full ({error.filename or error.strerror})")
            return STOPPED
        _tell(
            f"rdpm: internal error, {type(error).__name__}: {_first_line(error)}. Please report it with "
            f"{_log_traceback(getattr(error, 'run_folder', None))}"
        )
        return INTERNAL


def _call(words: list[str]) -> int:
    import cyclopts

    application = app()
    try:
        command, bound, *_ = application.parse_args(words, exit_on_error=False, print_error=False)
    except cyclopts.CycloptsError as error:
        hint = f"rdpm {words[0]} --help" if words and words[0] in VERBS else "rdpm --help"
        _tell(f"rdpm: {' '.join(str(error).split())} See `{hint}`.")
        return USAGE
    result = command(*bound.args, **bound.kwargs)
    return result if isinstance(result, int) else 0


def _tell(text: str) -> None:
    """Say it on the terminal, which may be gone; of several ranks that find the same, the first does."""
    if launched_rank() == 0:
        with suppress(OSError):
            print(text, file=sys.stderr)


def _first_line(error: Exception) -> str:
    return str(error).partition("\n")[0].rstrip(".")


def _log_traceback(folder: Path | None) -> str:
    """Add the traceback to the run's log, or write a file of its own, and return the name."""
    text = traceback.format_exc()
    try:
        if folder is None:
            handle, name = tempfile.mkstemp(prefix="rdpm-", suffix=".log")
            os.close(handle)
        else:
            from rdpm.results.run_folder import RunFolder

            name = str(RunFolder(folder).log)
        with open(name, "a", encoding="utf-8") as log:
            log.write(text)
        return name
    except OSError:
        return "what you did (no log could be written)"


if __name__ == "__main__":
    sys.exit(main())
