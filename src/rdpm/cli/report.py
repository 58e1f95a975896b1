"""``rdpm report``: figures, video and one page from a folder of results."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from rdpm.errors import CaseError

__all__ = ["report"]


def report(
    folder: Path,
    /,
    *,
    video: bool = True,
    figure_format: Literal["png", "pdf", "svg"] | None = None,
    quiet: Annotated[bool, Parameter(negative="", show_default=False)] = False,
) -> None:
    """Make the figures, the video and report.html of a run's folder again.

    Parameters
    ----------
    folder : Path
        Where a run wrote its results.
    video : bool
        Whether to make the video, which takes longest.
    figure_format
        Of charts for print, beside those of the page: pdf or svg; that of the case when left out.
    quiet : bool
        Say nothing but errors.

    Raises
    ------
    CaseError
        The folder is missing, or holds no results.
    """
    from rdpm.cli.progress import say
    from rdpm.figures.report import make_report
    from rdpm.results.run_folder import RunFolder

    if not folder.is_dir():
        rule = "must be a folder" if folder.exists() else "there is no such folder"
        raise CaseError(str(folder), None, rule, cure="Name the folder that `rdpm run` wrote.")
    files = RunFolder(folder)
    if not (files.summary.is_file() or files.case.is_file()):
        raise CaseError(
            str(folder),
            None,
            "must hold a run's results",
            f"neither {files.summary.name} nor {files.case.name} is there",
            "Name the folder that `rdpm run` wrote.",
        )
    made = make_report(folder, video=video, figure_format=figure_format, progress=None if quiet else say)
    if not quiet:
        for path in made:
            print(path)
