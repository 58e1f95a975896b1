"""What ``CASE`` on the command line means."""

from __future__ import annotations

from pathlib import Path

__all__ = ["case_source"]


def case_source(case: str, prefers_folder: bool = False) -> tuple[str, Path | None, str]:
    """Find what to load as the case.

    Parameters
    ----------
    case : str
        A file, the name of a shipped case, or the folder of a run. A bare shipped name means the file ``NAME.toml``
        here, if there is one: it is a copy that was edited. A folder of that name is meant where a path says so, as
        ``./dkt``.
    prefers_folder : bool
        A folder of that name goes before the shipped case.

    Returns
    -------
    source : str
        For `rdpm.load_case`.
    folder : pathlib.Path or None
        The folder, if it is that of a run.
    note : str
        A line to tell where the choice is not plain; else empty.

    Examples
    --------
    >>> case_source("settling")
    ('settling', None, '')
    """
    from rdpm.cases import shipped_names
    from rdpm.config.source import local_file
    from rdpm.results.run_folder import RunFolder

    is_shipped = case in shipped_names()
    folder = RunFolder(Path(case))
    if (prefers_folder or not is_shipped) and folder.case.is_file():
        return str(folder.case), folder.path, ""
    if is_shipped and (local := local_file(case)):
        return str(local[0]), None, local[1]
    return case, None, ""
