"""Who is let in, and what thousands of bad requests do: nothing."""

import asyncio
import random
import re

import httpx
import pytest

TOKEN, COOKIE = "a-token-of-the-tests", "rdpm_token"  # of conftest.py
SECRET = "what lies outside the folder"
KNOWN = {COOKIE: TOKEN}


def asked(page, *requests, cookies=None):
    """Answers to requests, each a method, an address and what httpx takes besides."""

    async def ask():
        transport = httpx.ASGITransport(page.app, raise_app_exceptions=False)
        async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:8300", cookies=cookies) as client:
            return [await client.request(method, address, **more) for method, address, more in requests]

    return asyncio.run(ask())


def test_the_token_is_needed_and_then_remembered(page):
    refused, wrong, let_in = asked(page, ("GET", "/runs", {}), ("GET", "/runs?token=no", {}),
                                   ("GET", f"/runs?sort=time&token={TOKEN}", {}))  # fmt: skip
    assert (refused.status_code, wrong.status_code, let_in.status_code) == (401, 401, 303)
    assert let_in.headers["location"] == "/runs?sort=time"
    assert f"{COOKIE}={TOKEN}" in let_in.headers["set-cookie"]
    assert "HttpOnly" in let_in.headers["set-cookie"]
    assert "SameSite=Strict" in let_in.headers["set-cookie"]
    (home,) = asked(page, ("GET", "/", {}), cookies=KNOWN)
    assert (home.status_code, home.headers["location"]) == (303, "/design")


@pytest.mark.parametrize("path", ["//elsewhere.org", "/\\elsewhere.org", "///elsewhere.org/x"])
def test_the_first_visit_leads_nowhere_else(page, path):
    (answer,) = asked(page, ("GET", f"http://127.0.0.1:8300{path}?token={TOKEN}", {}))
    assert re.match(r"/[^/\\]", answer.headers["location"])


def test_another_page_cannot_act(page):
    theirs = {"origin": "http://elsewhere.org"}
    ours = {"origin": "http://127.0.0.1:8300"}
    for path in ("/runs", "/_nicegui/client/a/upload/1"):
        bad, good = asked(page, ("POST", path, {"headers": theirs}), ("POST", path, {"headers": ours}), cookies=KNOWN)
        assert bad.status_code == 403
        assert good.status_code in (404, 405)


def websocket(page, headers):
    """What is sent to one who opens a web socket."""
    sent = []

    async def receive():
        return {"type": "websocket.connect"}

    async def send(message):
        sent.append(message)

    scope = {"type": "websocket", "path": "/_nicegui_ws/socket.io/", "query_string": b"", "headers": headers,
             "subprotocols": [], "root_path": "", "scheme": "ws"}  # fmt: skip
    asyncio.run(page.app(scope, receive, send))
    return sent


def test_a_web_socket_needs_the_token_and_the_same_origin(page):
    cookie = (b"cookie", f"{COOKIE}={TOKEN}".encode())
    host, foreign = (b"host", b"127.0.0.1:8300"), (b"origin", b"http://127.0.0.1:9999")
    for headers in ([host], [host, (b"cookie", b"rdpm_token=guess")]):
        assert [message["type"] for message in websocket(page, headers)] == ["websocket.close"]
    assert websocket(page, [host, cookie, foreign])[0]["type"] == "websocket.close"


def test_headers_keep_the_page_to_itself(page):
    (answer,) = asked(page, ("GET", "/cases", {}), cookies=KNOWN)
    assert answer.status_code == 200
    assert "default-src 'self'" in answer.headers["content-security-policy"]
    assert answer.headers["x-frame-options"] == "DENY"
    assert answer.headers["referrer-policy"] == "no-referrer"


def test_files_of_the_folder_are_served_and_no_others(page):
    (page.root / "table.csv").write_text("a\n1\n")
    (page.root / "page.html").write_text("<script>alert(1)</script>")
    (page.root / "key.pem").write_text(SECRET)
    (page.root / ".hidden.csv").write_text(SECRET)
    table, shown, key, hidden, part = asked(
        page, ("GET", "/files/table.csv", {}), ("GET", "/files/page.html", {}), ("GET", "/files/key.pem", {}),
        ("GET", "/files/.hidden.csv", {}), ("GET", "/files/table.csv", {"headers": {"range": "bytes=2-2"}}),
        cookies=KNOWN,
    )  # fmt: skip
    assert table.text == "a\n1\n"
    assert shown.headers["content-security-policy"].startswith("sandbox;")
    assert (key.status_code, hidden.status_code) == (404, 404)
    assert (part.status_code, part.text) == (206, "1")


async def body(size):
    for _ in range(size // 65536):
        yield b"x" * 65536


#: Paths that are no file of the folder.
OUTSIDE = [
    "../secret.toml",
    "../../etc/passwd",
    "/etc/passwd",
    "link.toml",
    "linked/secret.toml",
    "a/../../secret.toml",
    "..\\secret.toml",
    "%2e%2e/secret.toml",
    "..%2fsecret.toml",
    "%252e%252e%252fsecret.toml",
    "secret.toml\0.csv",
    "~root/x",
    ".hidden.toml",
    "....//secret.toml",
    "./../secret.toml",
    "x" * 3000,
    "\u202e\ud7ff",
    "%ff%fe",
    "%00",
    "con",
    "file:///etc/passwd",
    "http://127.0.0.1/x.csv",
]


def bad_requests(number, seed):
    """Requests of every bad kind that came to mind, in a random order: whether they know the token, and the request."""
    rng = random.Random(seed)
    places = ["/files/{}", "/run/{}", "/study/{}", "/cases?file={}", "/cases?run={}", "/cases?shipped={}",
              "/overlay?run={0}&run={0}x"]  # fmt: skip
    junk = ["nan", "1e999", "-1", "'; rm -rf /", "<script>", "{}", "[]", "null", "1 lightyear", "\0", "9" * 400, "%s%n"]
    for n in range(number):
        kind = rng.randrange(8)
        if kind < 3:
            guess = rng.choice(["", "x", TOKEN[:-1], TOKEN + "x", TOKEN.upper(), "%00", "\u00e9", "a" * 5000])
            address = rng.choice(places).format(rng.choice(OUTSIDE))
            yield (
                False,
                (
                    "GET",
                    address + ("&" if "?" in address else "?") + f"token={guess}",
                    {"headers": {"cookie": f"{COOKIE}={n}"}},
                ),
            )
        elif kind < 6:
            is_page = n % 20 == 0  # a page that opens costs more than one that is refused
            place = rng.choice(places) if is_page else "/files/{}"
            yield True, ("GET", place.format(rng.choice(OUTSIDE)), {})
        elif kind == 6:
            method = rng.choice(["POST", "PUT", "DELETE", "PATCH", "OPTIONS", "TRACE", "BREW"])
            address = rng.choice(["/", "/files/a.csv", "/runs", "/_nicegui/client/1/upload/2", "/run/x"])
            what = rng.choice(
                [
                    {"content": b"\xff" * 100},
                    {"json": {"a": [1]}},
                    {"data": {"x": "y"}},
                    {"files": {"f": ("../../x.toml", b"\0" * 5000)}},
                    {"headers": {"content-length": "-5"}},
                    {"headers": {"content-length": "9" * 30}},
                    {"headers": {"content-type": "multipart/form-data"}},
                ]
            )
            yield True, (method, address, what)
        else:
            address = rng.choice(
                ["/design?diameter={}&way=steps", "/design?way={}", "/runs?sort={}&down", "/files/{}?download"]
            )
            is_page = n % 20 == 1
            yield True, ("GET", address.format(rng.choice(junk)) if is_page else f"/files/{rng.choice(junk)}", {})


def prepared(page):
    (page.root.parent / "secret.toml").write_text(f'title = "{SECRET}"')
    (page.root / ".hidden.toml").write_text(f'title = "{SECRET}"')
    (page.root / "link.toml").symlink_to(page.root.parent / "secret.toml")
    (page.root / "linked").symlink_to(page.root.parent)


def test_five_thousand_bad_requests_do_nothing(page):
    prepared(page)
    before = sorted(path.name for path in page.root.iterdir())
    seed = random.randrange(10**6)
    print("seed", seed)

    async def send():
        transport = httpx.ASGITransport(page.app, raise_app_exceptions=False)
        found, not_sent = {}, 0
        async with (
            httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:8300", cookies=KNOWN) as known,
            httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:8300") as unknown,
        ):
            for knows, (method, address, more) in bad_requests(5000, seed):
                try:
                    request = (known if knows else unknown).build_request(method, address, **more)
                except (httpx.InvalidURL, UnicodeEncodeError, ValueError):
                    not_sent += 1
                    continue
                answer = await (known if knows else unknown).send(request)
                assert answer.status_code < 500, (method, address, more)
                assert SECRET not in answer.text, (method, address, more)
                assert knows or answer.status_code == 401, (method, address)
                found[answer.status_code] = found.get(answer.status_code, 0) + 1
        return found, not_sent

    found, not_sent = asyncio.run(send())
    assert sum(found.values()) + not_sent == 5000
    assert not_sent < 1500
    assert found[401] > 1000
    assert found[404] > 1000
    assert sorted(path.name for path in page.root.iterdir()) == before


def test_a_body_beyond_the_limit_is_not_read(page):
    announced, streamed = asked(
        page, ("POST", "/_nicegui/client/1/upload/1", {"headers": {"content-length": str(10**9)}, "content": b"x"}),
        ("POST", "/_nicegui/client/1/upload/1", {"content": body(4 * 2**20)}), cookies=KNOWN,
    )  # fmt: skip
    assert announced.status_code == 413
    assert streamed.status_code in (404, 413)  # no such upload, or too large: it is not kept either way
