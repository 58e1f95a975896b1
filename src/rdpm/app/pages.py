"""Which address shows what."""

from __future__ import annotations

from typing import Any

from fastapi import FastAPI, Request
from fastapi.responses import FileResponse, PlainTextResponse, RedirectResponse, Response
from nicegui import ui

from rdpm.app.case_page import CasePage, case_list
from rdpm.app.design_page import DesignPage
from rdpm.app.overlay_page import overlay
from rdpm.app.run_page import RunPage
from rdpm.app.runs_page import RunsPage
from rdpm.app.settings import current
from rdpm.app.study_page import study
from rdpm.errors import CaseError

__all__ = ["register"]

# A page made from results is shown, its scripts (it has none) are not run.
_SHOWN = {"content-security-policy": "sandbox; default-src 'none'; img-src 'self' data:; media-src 'self' data:; "
                                     "style-src 'unsafe-inline'"}  # fmt: skip


def register(app: FastAPI) -> None:
    """Name all pages, and the files of the folder."""
    app.add_api_route("/", _home, include_in_schema=False)
    app.add_api_route("/files/{name:path}", _file, methods=["GET", "HEAD"], include_in_schema=False)
    ui.page("/design")(_design)
    ui.page("/cases")(_cases)
    ui.page("/runs")(_runs)
    ui.page("/run/{name:path}")(_run)
    ui.page("/overlay")(_overlay)
    ui.page("/study/{name:path}")(_study)


def _home() -> Response:
    return RedirectResponse("/design", status_code=303)


def _file(name: str, request: Request) -> Response:
    try:
        path = current().work.file(name)
    except CaseError as error:
        return PlainTextResponse(str(error), status_code=404)
    download = path.name if "download" in request.query_params else None
    headers = _SHOWN if path.suffix in (".html", ".svg") else {}
    kind = "text/plain; charset=utf-8" if path.suffix in (".toml", ".log", ".md", ".csv") and not download else None
    return FileResponse(path, filename=download, headers=headers | {"cache-control": "no-cache"}, media_type=kind)


def _design(request: Request) -> Any:
    DesignPage(dict(request.query_params))


def _cases(request: Request) -> Any:
    query = dict(request.query_params)
    if {"shipped", "file", "run"} & set(query):
        CasePage(query)
    else:
        case_list()


def _runs(request: Request) -> Any:
    RunsPage(dict(request.query_params))


def _run(name: str) -> Any:
    RunPage(name)


def _overlay(request: Request) -> Any:
    overlay(request.query_params.getlist("run"))


def _study(name: str, request: Request) -> Any:
    study(name, request.query_params.get("sort", ""))
