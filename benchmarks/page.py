"""Speed of the page: how fast pages open, how fast the scene moves, what watching costs a run.

``python benchmarks/page.py`` needs chromium, the extra `test`, and an idle machine for its wall times; the cost of
watching is in processor time, which other work disturbs less. ``pages``, ``scene`` or ``watching`` alone may be named.
"""

from __future__ import annotations

import os
import sys
import tempfile
import threading
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "app"))

from browser import browsing, serving

from rdpm.io.lock import locked
from rdpm.io.tables import PARTICLE_COLUMNS, TableWriter

COUNT, RATE, SECONDS = 1000, 10.0, 12.0
TANK = """title = "A sphere that is watched"
[domain]
size = ["10 cm", "10 cm", "16 cm"]
[fluid]
density = "962 kg/m^3"
viscosity = "0.113 Pa s"
[[bodies]]
diameter = "15 mm"
density = "1120 kg/m^3"
centers = [["5 cm", "5 cm", "13 cm"]]
[resolution]
cells_per_diameter = 8
[time]
end = "20 s"
[output]
table_every = "5 ms"
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
            rows[:, 2:5] = ([*position, 0.0, 0.0, -0.001 * n]) % 0.1
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
            page.wait_for_function("+document.querySelector('.rdpm-scene')?.dataset.frames > 5", timeout=60_000)
            first = int(page.locator(".rdpm-scene").get_attribute("data-frames"))
            begun = time.perf_counter()
            page.wait_for_timeout(1000.0 * SECONDS)
            last = int(page.locator(".rdpm-scene").get_attribute("data-frames"))
            print(f"{COUNT} spheres: {(last - first) / (time.perf_counter() - begun):.1f} pictures a second")
    finally:
        stop.set()
        writer.join()


def watching(folder):
    """Processor time of the page's server over that of the run it watches."""
    (Path(folder) / "tank.toml").write_text(TANK)
    with serving(folder) as address, browsing(address) as (page, _):
        base = address.partition("/?")[0]
        page.goto(f"{base}/cases?file=tank.toml")
        page.get_by_role("button", name="Run", exact=True).click()
        page.wait_for_url("**/run/tank")
        page.wait_for_function("+document.querySelector('.rdpm-scene')?.dataset.frames > 5", timeout=60_000)
        run = int((Path(folder) / "tank" / "run.lock").read_text())
        parent = int(Path(f"/proc/{run}/stat").read_text().rpartition(")")[2].split()[1])
        before = processor_seconds(parent), processor_seconds(run), time.perf_counter()
        page.wait_for_timeout(2000.0 * SECONDS)
        after = processor_seconds(parent), processor_seconds(run), time.perf_counter()
        server, solver, wall = (b - a for a, b in zip(before, after, strict=True))
        of_machine = 100 * server / wall / (os.cpu_count() or 1)
        print(f"watched for {wall:.0f} s: the run took {solver:.2f} s of processor time, the server {server:.2f} s:")
        print(f"{100 * server / solver:.1f} %, {of_machine:.1f} % of the machine")
        page.get_by_role("button", name="Stop").click()
        page.get_by_role("button", name="Stop now").click()
        page.wait_for_timeout(3000)


if __name__ == "__main__":
    parts = {"pages": pages, "scene": scene, "watching": watching}
    for name in sys.argv[1:] or parts:
        with tempfile.TemporaryDirectory() as place:
            parts[name](place)
