"""``rdpm app``: the page in the browser."""

from __future__ import annotations

import importlib.util
from pathlib import Path

from rdpm.errors import CaseError

__all__ = ["app"]


def app(
    *,
    folder: Path = Path(),
    host: str = "127.0.0.1",
    port: int | None = None,
    at_once: int = 1,
    threads: int | None = None,
) -> None:
    """Open a page in the browser: design a contact, edit and check cases, run and watch them, look at results.

    The address that is printed holds a token; without it nothing is answered. Runs are processes of their own: they go
    on when the page is closed, and the page finds them again, as it finds runs started on the command line.

    Parameters
    ----------
    folder : Path
        What the page works in: its cases, runs and studies; nothing outside is read or written. Here when left out.
    host : str
        Address to listen at. Anything but this machine's own makes the page visible to others.
    port : int, optional
        The first free one from 8300 on when left out.
    at_once : int
        Queued runs that may go on side by side.
    threads : int, optional
        OpenMP threads of each run; all cores, or OMP_NUM_THREADS, when left out.

    Raises
    ------
    CaseError
        The folder is missing, the port is taken, or the page's libraries are not installed.
    """
    if not folder.is_dir():
        raise CaseError(
            "--folder", str(folder), "must be a folder", "it is not there", "Make it first, or name another."
        )
    if not 1 <= at_once <= 64:
        raise CaseError("--at-once", at_once, "must lie between 1 and 64")
    if threads is not None:
        from rdpm.parallel.threads import checked_threads

        checked_threads(threads, "--threads")
    lacking = [name for name in ("nicegui", "tomlkit") if importlib.util.find_spec(name) is None]
    if lacking:
        reason, cure = f"{' and '.join(lacking)} not installed", "pip install 'rdpm[app]'"
        raise CaseError("rdpm app", None, "needs the libraries of the page", reason, cure)
    from rdpm.app.server import serve

    serve(folder, host, port, at_once, threads, lambda text: print(text, flush=True))
