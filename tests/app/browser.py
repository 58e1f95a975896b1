"""A real browser and a real `rdpm app`, for tests and for the pictures of the documentation."""

from __future__ import annotations

import shutil
import subprocess
import sys
from contextlib import contextmanager

#: Debian's chromium, and what others call theirs.
NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")
ARGUMENTS = [
    "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist",
    "--host-resolver-rules=MAP * ~NOTFOUND , EXCLUDE 127.0.0.1",   # the network is cut: only the page answers
]  # fmt: skip


def missing():
    """Why there is no browser to test in; empty where there is one."""
    try:
        import playwright.sync_api  # noqa: F401
    except ImportError:
        return "playwright is not installed: pip install playwright"
    if not any(map(shutil.which, NAMES)):
        return "no chromium: apt-get install chromium"
    return ""


@contextmanager
def serving(folder, *options):
    """Start `rdpm app` on a folder; give the address with the token."""
    command = [sys.executable, "-m", "rdpm.cli.main", "app", "--folder", str(folder), *options]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        yield process.stdout.readline().strip()
    finally:
        process.terminate()
        try:
            process.wait(20.0)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        process.stdout.close()


@contextmanager
def browsing(address, width=1280, height=900, dark=False):
    """Open an address; give the page, and a list that takes every complaint of the browser."""
    from playwright.sync_api import sync_playwright

    path = next(found for found in map(shutil.which, NAMES) if found)
    complaints = []
    with sync_playwright() as player:
        browser = player.chromium.launch(executable_path=path, args=ARGUMENTS)
        page = browser.new_page(viewport={"width": width, "height": height}, color_scheme="dark" if dark else "light")
        page.on("console", lambda said: complaints.append(f"console: {said.text}") if said.type == "error" else None)
        page.on("pageerror", lambda error: complaints.append(f"script: {error}"))
        page.on("requestfailed", lambda request: complaints.append(f"failed: {request.url} {request.failure}"))
        page.on(
            "response",
            lambda answer: complaints.append(f"{answer.status}: {answer.url}") if answer.status >= 400 else None,
        )
        page.goto(address)
        try:
            yield page, complaints
        finally:
            browser.close()
