"""Who may use the page: a token, an origin, a size; as ASGI middleware in front of everything, web sockets too."""

from __future__ import annotations

import hmac
import logging
from collections.abc import Awaitable, Callable, Iterable, MutableMapping
from http.cookies import CookieError, SimpleCookie
from typing import Any
from urllib.parse import parse_qsl, quote, urlencode, urlsplit

__all__ = ["LARGEST_BODY", "Guard"]

#: Bytes that a request may bring: a case file of a few thousand bodies.
LARGEST_BODY = 2 * 2**20

_log = logging.getLogger(__name__)

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]

_HEADERS = (
    (b"x-content-type-options", b"nosniff"),
    (b"x-frame-options", b"DENY"),
    (b"referrer-policy", b"no-referrer"),  # the token of the first address goes nowhere
)
# Nothing comes from elsewhere, whatever a page may ask for; the toolkit writes scripts and styles into the page.
_POLICY = (
    b"default-src 'self'; script-src 'self' 'unsafe-inline' 'unsafe-eval'; style-src 'self' 'unsafe-inline'; "
    b"img-src 'self' data: blob:; media-src 'self' data:; font-src 'self' data:; connect-src 'self' ws: wss:; "
    b"object-src 'none'; base-uri 'self'; form-action 'self'; frame-ancestors 'none'"
)
_CLOSED = (
    b'<!doctype html><html lang="en"><meta charset="utf-8"><title>rdpm: closed</title>'
    b'<body style="font: 16px/1.5 system-ui, sans-serif; margin: 3rem auto; max-width: 36rem; padding: 0 1rem">'
    b"<h1>This page needs its token</h1><p>Open the whole address that <code>rdpm app</code> printed, with "
    b"<code>?token=...</code> at its end. The browser then remembers it until <code>rdpm app</code> ends.</p>"
    b"</body></html>"
)


class _TooLarge(Exception):  # noqa: N818 (no error: the answer is sent by whoever catches it)
    """The body of a request is larger than allowed."""


class Guard:
    """Let through only requests that know the token, from the page itself, of limited size.

    The token comes once in the address; the answer sets a cookie and sends the browser to the address without it.

    Parameters
    ----------
    app : callable
        The ASGI application behind it.
    token : str
    cookie : str
        Name of the cookie; one for each port, as browsers do not tell ports apart.
    largest : int, [bytes]
        Of the body of a request.
    """

    def __init__(self, app: Any, token: str, cookie: str, largest: int = LARGEST_BODY) -> None:
        self.app, self.cookie, self.largest = app, cookie, largest
        self._token = token.encode()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, or hand it on."""
        if scope["type"] == "lifespan":
            await self.app(scope, receive, send)
            return
        headers = _headers(scope.get("headers", ()))
        if not self._knows(_cookie(headers.get("cookie", ""), self.cookie)):
            await self._first_visit(scope, receive, send)
        elif scope["type"] == "http" and _is_odd(scope["path"]):
            await _refuse(scope, receive, send, 404, b"There is no such page.")
        elif not _is_own(headers, scope):
            await _refuse(scope, receive, send, 403, b"This request comes from another page.")
        else:
            await self._hand_on(scope, headers, receive, send)

    def _knows(self, given: str) -> bool:
        return hmac.compare_digest(given.encode("utf-8", "replace"), self._token)

    async def _first_visit(self, scope: Scope, receive: Receive, send: Send) -> None:
        pairs = parse_qsl(scope.get("query_string", b"").decode("latin-1"), keep_blank_values=True, max_num_fields=None)
        given = [value for key, value in pairs if key == "token"]
        if (
            scope["type"] != "http"
            or scope["method"] not in ("GET", "HEAD")
            or len(given) != 1
            or not self._knows(given[0])
        ):
            await _refuse(scope, receive, send, 401, _CLOSED, b"text/html; charset=utf-8")
            return
        rest = urlencode([pair for pair in pairs if pair[0] != "token"])
        place = "/" + quote(scope["path"].lstrip("/"), safe="/", errors="replace")  # one slash: never another host
        cookie = f"{self.cookie}={self._token.decode()}; Path=/; HttpOnly; SameSite=Strict"
        headers = [(b"location", (place + ("?" + rest if rest else "")).encode()), (b"set-cookie", cookie.encode())]
        await _answer(send, 303, b"", [*headers, (b"cache-control", b"no-store"), *_HEADERS])

    async def _hand_on(self, scope: Scope, headers: dict[str, str], receive: Receive, send: Send) -> None:
        length = headers.get("content-length", "0")
        if not length.isdecimal() or len(length) > 12 or int(length) > self.largest:
            await _refuse(scope, receive, send, 413 if length.isdecimal() else 400, b"Too large.")
            return
        taken, begun, is_gone = 0, False, False

        async def counted() -> MutableMapping[str, Any]:
            nonlocal taken, is_gone
            message = await receive()
            is_gone = is_gone or message["type"] == "http.disconnect"
            taken += len(message.get("body") or b"")
            if scope["type"] == "http" and taken > self.largest:
                raise _TooLarge
            return message

        async def noted(message: MutableMapping[str, Any]) -> None:
            nonlocal begun
            if message["type"] == "http.response.start":
                begun = True
                given = {name.lower() for name, _ in message.get("headers", ())}
                own = [*_HEADERS, (b"content-security-policy", _POLICY)]
                message["headers"] = [*message.get("headers", ()), *(pair for pair in own if pair[0] not in given)]
            await send(message)

        try:
            await self.app(scope, counted, noted)
        except _TooLarge:
            if not begun:
                await _refuse(scope, receive, send, 413, b"Too large.")
        except Exception:
            if is_gone:  # whoever asked has left meanwhile
                return
            _log.exception("%s %s", scope["type"], scope.get("path", "")[:200].encode("ascii", "replace").decode())
            if not begun:
                await _refuse(
                    scope, receive, send, 500, b"Something went wrong here; the terminal of rdpm app says what."
                )


def _headers(pairs: Iterable[tuple[bytes, bytes]]) -> dict[str, str]:
    return {name.decode("latin-1").lower(): value.decode("latin-1") for name, value in pairs}


def _cookie(text: str, name: str) -> str:
    for part in text.split(";"):
        key, _, value = part.strip().partition("=")
        if key == name:
            try:
                return next(iter(SimpleCookie(f"{name}={value}").values())).value
            except (CookieError, StopIteration):
                return ""
    return ""


def _is_odd(path: str) -> bool:
    """Whether a path is one that no page of ours has: it climbs, or holds what no name may."""
    return ".." in path.split("/") or "\\" in path or not path.isprintable() or len(path) > 2000


def _is_own(headers: dict[str, str], scope: Scope) -> bool:
    """Whether a request that can change something comes from the page itself."""
    if scope["type"] == "http" and scope["method"] in ("GET", "HEAD", "OPTIONS"):
        return True
    if "origin" not in headers:  # no browser
        return True
    try:
        return urlsplit(headers["origin"]).netloc == headers.get("host", "")
    except ValueError:
        return False


async def _refuse(
    scope: Scope, receive: Receive, send: Send, status: int, body: bytes, kind: bytes = b"text/plain; charset=utf-8"
) -> None:
    if scope["type"] == "websocket":
        await receive()
        await send({"type": "websocket.close", "code": 4401, "reason": ""})
        return
    await _answer(send, status, body, [(b"content-type", kind), (b"cache-control", b"no-store"), *_HEADERS])


async def _answer(send: Send, status: int, body: bytes, headers: list[tuple[bytes, bytes]]) -> None:
    sized = [*headers, (b"content-length", str(len(body)).encode())]
    await send({"type": "http.response.start", "status": status, "headers": sized})
    await send({"type": "http.response.body", "body": body})
