"""Speed of the page: how fast pages open, how fast the scene moves, what watching costs a run.

``python benchmarks/page.py`` needs chromium, the extra `test`, and an idle machine for its wall times. ``pages``,
``scene`` or ``watching`` alone may be named.

What watching costs is measured on one run, of one thread, in spans of simulated time that are watched by turns: the
drift of the run and of the machine is in both. Who watches asks for the page and takes all that it sends, as a browser
does, but draws nothing: that is the work of the visitor's machine.
"""

from __future__ import annotations

import asyncio
import os
import re
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import contextmanager
from pathlib import Path
from urllib.request import HTTPCookieProcessor, build_opener

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "app"))

from browser import browsing, serving

from rdpm.io.lock import locked
from rdpm.io.tables import PARTICLE_COLUMNS, TableWriter

COUNT, RATE, SECONDS = 1000, 10.0, 12.0
PAIRS, SPAN = 12, 0.3  # of spans watched and not; s of simulated time
TANK = """title = "A sphere that is watched"
[domain]
size = ["6 cm", "6 cm", "12 cm"]
[fluid]
density = "962 kg/m^3"
viscosity = "0.113 Pa s"
[[bodies]]
diameter = "15 mm"
density = "966 kg/m^3"
centers = [["3 cm", "3 cm", "10 cm"]]
[resolution]
cells_per_diameter = 12
[time]
end = "20 s"
step = "2 ms"
[output]
table_every = "4 ms"
fields_every = "50 ms"
"""
CLOUD = """[domain]
size = [0.1, 0.1, 0.1]
[[bodies]]
diameter = 0.004
density = 2500
lattice = {{ counts = [10, 10, 10], spacing = [0.01, 0.01, 0.01] }}
[time]
end = {}
step = "1 ms"
"""


def processor_seconds(process):
    """User and system time of a process."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def pages(folder):
    """Wall time until a page has drawn its heading and can be used."""
    with serving(folder) as address, browsing(address) as (page, _):
        base = address.partition("/?")[0]
        for path in ("/design", "/cases", "/cases?shipped=dkt", "/runs"):
            page.goto(base + path)  # the first time fills the browser's cache
        for path in ("/design", "/cases", "/cases?shipped=dkt", "/runs"):
            begun = time.perf_counter()
            page.goto(base + path)
            page.get_by_role("heading", level=1).wait_for()
            print(f"{path:22} opens in {time.perf_counter() - begun:.2f} s")


def writing(folder, stop):
    """Write the table of 1,000 spheres as a run would, ten times a second."""
    rng = np.random.default_rng(1)
    position = rng.uniform(0.0, 0.1, (COUNT, 3))
    with locked(folder / "run.lock"), TableWriter(folder / "particles.csv", PARTICLE_COLUMNS) as table:
        begun, n = time.monotonic(), 0
        while not stop.is_set():
            rows = np.zeros((COUNT, len(PARTICLE_COLUMNS)))
            rows[:, 0], rows[:, 1] = n / RATE, np.arange(COUNT)
            rows[:, 2:5] = (position - np.array([0.0, 0.0, 0.001 * n])) % 0.1
            rows[:, 8:11] = 3.0
            table.write(rows)
            table.flush()
            n += 1
            time.sleep(max(0.0, begun + n / RATE - time.monotonic()))


def scene(folder):
    """Pictures a second of the live scene with 1,000 spheres."""
    run = Path(folder) / "cloud"
    run.mkdir()
    (run / "case.toml").write_text(CLOUD.format(1000))
    stop = threading.Event()
    writer = threading.Thread(target=writing, args=(run, stop))
    writer.start()
    try:
        with serving(folder) as address, browsing(address) as (page, _):
            page.goto(f"{address.partition('/?')[0]}/run/cloud")
            page.wait_for_function("+document.querySelector('.rdpm-scene')?.dataset.frames > 5")
            first = int(page.locator(".rdpm-scene").get_attribute("data-frames"))
            begun = time.perf_counter()
            page.wait_for_timeout(1000.0 * SECONDS)
            last = int(page.locator(".rdpm-scene").get_attribute("data-frames"))
            print(f"{COUNT} spheres: {(last - first) / (time.perf_counter() - begun):.1f} pictures a second")
    finally:
        stop.set()
        writer.join()


@contextmanager
def watcher(address, path):
    """Have a page open, and take what it sends; gives the list of what has come."""
    import socketio

    base, came, over = address.partition("/?")[0], [], threading.Event()
    opener = build_opener(HTTPCookieProcessor())
    opener.open(address).read()
    cookies = next(h.cookiejar for h in opener.handlers if isinstance(h, HTTPCookieProcessor))
    text = opener.open(base + path).read().decode()
    client = re.search(r"client_id['\"]: *['\"]([^'\"]+)", text).group(1)

    async def watch():
        socket = socketio.AsyncClient()
        socket.on("*", lambda event, *_: came.append(event))
        own = {"client_id": client, "tab_id": client, "document_id": client, "next_message_id": 0}
        ask = "&".join(f"{key}={value}" for key, value in own.items())
        cookie = "; ".join(f"{one.name}={one.value}" for one in cookies)
        await socket.connect(f"{base}?{ask}&implicit_handshake=true", headers={"Cookie": cookie},
                             socketio_path="/_nicegui_ws/socket.io", transports=["websocket"])  # fmt: skip
        while not over.is_set():
            await asyncio.sleep(0.2)
        await socket.disconnect()

    thread = threading.Thread(target=asyncio.run, args=(watch(),))
    thread.start()
    try:
        yield came
    finally:
        over.set()
        thread.join()


def stepped(run, after):
    """Wait until a run has passed a simulated time: step, simulated time, wall time."""
    while True:
        with (run / "timing.csv").open("rb") as file:
            file.seek(max(0, file.seek(0, 2) - 4096))
            lines = file.read().split(b"\n")[1:-1]
        if lines:
            step, now, wall = map(float, lines[-1].split(b",")[:3])
            if now >= after:
                return step, now, wall
        time.sleep(0.005)


def watching(folder):
    """Processor and wall time a step of a run that is watched by turns, and processor time of the page's server."""
    place = Path(folder) / "tank"
    (Path(folder) / "tank.toml").write_text(TANK)
    command = [sys.executable, "-m", "rdpm.cli.main", "run", "tank.toml", "--threads", "1", "--quiet"]
    with serving(folder) as address:
        server = int(Path(f"/proc/self/task/{os.getpid()}/children").read_text().split()[0])
        run = subprocess.Popen(command, cwd=folder)
        try:
            while not (place / "timing.csv").is_file():
                time.sleep(0.1)
            now, found = 0.05, []
            for n in range(2 * PAIRS):
                if n % 2:
                    time.sleep(4.0)  # the server lets go of the page
                    now, values = spent(run.pid, server, place, now)
                else:
                    with watcher(address, "/run/tank") as came:
                        while "run_javascript" not in came:  # the scene moves
                            time.sleep(0.05)
                        now, values = spent(run.pid, server, place, now)
                found.append(values)
                print(".", end="", flush=True)
        finally:
            run.kill()
            run.wait()
    watched, alone = np.array(found)[::2], np.array(found)[1::2]
    for n, name in enumerate(("processor time", "wall time")):
        more = 100.0 * (watched[:, n] / alone[:, n] - 1.0)
        error = more.std(ddof=1) / np.sqrt(PAIRS)
        print(f"\n{name} a step: watched {1e3 * watched[:, n].mean():.2f} ms, alone {1e3 * alone[:, n].mean():.2f} ms: "
              f"{more.mean():+.2f} % +- {error:.2f} % (standard error of {PAIRS} pairs)", end="")  # fmt: skip
    print(f"\npage's server: {100 * watched[:, 2].mean():.1f} % of a core, alone {100 * alone[:, 2].mean():.1f} %")


def spent(run, server, place, after):
    """Follow a run over a span: where it ends, and processor and wall time a step, and the server's share of a core."""
    step, begin, wall = stepped(place, after)
    own, others = processor_seconds(run), processor_seconds(server)
    last, end, until = stepped(place, begin + SPAN)
    own, others = processor_seconds(run) - own, processor_seconds(server) - others
    steps, wall = last - step, until - wall
    return end, (own / steps, wall / steps, others / wall)


if __name__ == "__main__":
    parts = {"pages": pages, "scene": scene, "watching": watching}
    for name in sys.argv[1:] or parts:
        with tempfile.TemporaryDirectory() as place:
            parts[name](place)
