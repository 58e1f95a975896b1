"""The page as a server: what answers which address, behind the guard; and the clock that starts queued runs."""

from __future__ import annotations

import asyncio
import secrets
import socket
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress
from pathlib import Path
from typing import Any

from rdpm.app.guard import Guard
from rdpm.app.launch import Launcher
from rdpm.app.settings import Settings, current, use
from rdpm.app.workspace import Workspace
from rdpm.errors import CaseError

__all__ = ["LOOPBACK", "make_app", "serve"]

LOOPBACK = "127.0.0.1"
_PORTS = range(8300, 8320)  # tried when none is named
_BETWEEN = 1.0  # s, looks at the queue


def make_app(settings: Settings, token: str, cookie: str = "rdpm_token") -> Any:
    """Make the application, as ASGI.

    Parameters
    ----------
    settings : Settings
    token : str
        Without it nothing is answered.
    cookie : str
        That remembers it.
    """
    from fastapi import FastAPI
    from nicegui import ui

    from rdpm.app import pages

    use(settings)
    app = FastAPI(openapi_url=None, docs_url=None, redoc_url=None, lifespan=_lifespan)
    pages.register(app)
    ui.run_with(app, title="rdpm", dark=None, language="en-US", tailwind=False, show_welcome_message=False,
                favicon=Path(__file__).parent / "static" / "icon.svg", binding_refresh_interval=None)  # fmt: skip
    return Guard(app, token, cookie)


@asynccontextmanager
async def _lifespan(_: Any) -> AsyncIterator[None]:
    task = asyncio.create_task(_start_queued())
    yield
    task.cancel()
    with suppress(asyncio.CancelledError):
        await task


async def _start_queued() -> None:
    while True:
        with suppress(OSError, CaseError):  # the disk may be full now, and not later
            await asyncio.to_thread(current().launcher.dispatch)
        await asyncio.sleep(_BETWEEN)


def serve(
    folder: Path, host: str, port: int | None, at_once: int, threads: int | None, tell: Callable[[str], None]
) -> None:
    """Serve the page until a signal ends it; runs that it started go on.

    Parameters
    ----------
    folder : pathlib.Path
        What the page works in; exists.
    host : str
    port : int, optional
        The first free one from 8300 on when left out.
    at_once : int
        Queued runs that may go on side by side.
    threads : int, optional
        Of each run.
    tell : callable
        Gets the address, and what to know about it.

    Raises
    ------
    CaseError
        The port is taken, or the host is not one of this machine.
    """
    import uvicorn

    token = secrets.token_urlsafe(24)
    work = Workspace(folder.resolve())
    listening = _listening(host, port)
    bound = listening.getsockname()[1]
    app = make_app(Settings(work, Launcher(work, at_once, threads)), token, f"rdpm_token_{bound}")
    config = uvicorn.Config(
        app, log_level="warning", access_log=False, server_header=False, ws_max_size=2**20, lifespan="on",
        timeout_graceful_shutdown=2,
    )  # fmt: skip
    name = f"[{host}]" if ":" in host else socket.gethostname() if host == "0.0.0.0" else host
    tell(f"http://{name}:{bound}/?token={token}")
    if host not in (LOOPBACK, "localhost", "::1"):
        tell("Whoever has this address can start runs on this machine; it goes over the network unencrypted.")
    uvicorn.Server(config).run(sockets=[listening])


def _listening(host: str, port: int | None) -> socket.socket:
    tried: OSError | None = None
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    for number in _PORTS if port is None else (port,):
        made = socket.socket(family, socket.SOCK_STREAM)
        made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            made.bind((host, number))
            return made
        except (OSError, OverflowError) as error:
            made.close()
            tried = error if isinstance(error, OSError) else OSError(str(error))
    value = host if port is None else f"{host}:{port}"
    reason = (tried.strerror or str(tried)) if tried else ""
    raise CaseError("--port", value, "must be a free port of this machine", reason, "Name another.")
