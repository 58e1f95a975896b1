"""The page in a real browser, with the network cut: from a design to two runs over each other."""

import io
import re

import browser
import numpy as np
import pytest
from PIL import Image

from rdpm.io.tables import PARTICLE_COLUMNS, TableWriter

SETTLING = """title = "One sphere settling in a small tank"
[domain]
size = ["5 cm", "5 cm", "8 cm"]
[fluid]
density = "962 kg/m^3"
viscosity = "0.113 Pa s"
[[bodies]]
diameter = "15 mm"
density = "1120 kg/m^3"
centers = [["25 mm", "25 mm", "60 mm"]]
[resolution]
cells_per_diameter = 5
[time]
end = "0.6 s"
[output]
table_every = "5 ms"
fields_every = "20 ms"
report = false
"""

pytestmark = [pytest.mark.slow, pytest.mark.skipif(bool(browser.missing()), reason=browser.missing() or "there is one")]


def run_case(page, base, name):
    page.goto(f"{base}/cases?file=settling.toml")
    page.get_by_label("name of the run").fill(name)
    page.get_by_role("button", name="Run", exact=True).click()
    page.wait_for_url(f"**/run/{name}")


def test_design_check_run_watch_come_back_and_compare(tmp_path):
    (tmp_path / "settling.toml").write_text(SETTLING)
    with browser.serving(tmp_path, "--threads", "1") as address, browser.browsing(address) as (page, complaints):
        base = address.partition("/?")[0]
        assert "token" not in page.url

        page.get_by_label("contact steps N_c", exact=True).first.fill("12")
        page.wait_for_function("location.search.includes('contact_steps=12')")  # the link holds the state
        page.get_by_role("tab", name="LAMMPS").click()
        page.get_by_text("pair_style").first.wait_for()
        kept = page.url
        page.goto(kept)
        assert page.get_by_label("contact steps N_c", exact=True).first.input_value() == "12"

        page.goto(f"{base}/cases?file=settling.toml")
        page.get_by_label("end [s] *").fill("-1 s")
        page.get_by_text("must be positive").first.wait_for()
        assert 'end = "-1 s"' in page.get_by_label("Case file (TOML)").input_value()

        run_case(page, base, "one")
        page.wait_for_function("+document.querySelector('.rdpm-scene')?.dataset.frames > 3")
        page.goto("about:blank")  # the page is closed, the run goes on

        run_case(page, base, "two")
        page.get_by_role("heading", name="Replay").wait_for()
        page.goto(f"{base}/runs")
        for name in ("one", "two"):
            page.get_by_label(f"overlay {name}").check()
        page.get_by_role("button", name=re.compile("Overlay")).click()
        page.wait_for_url("**/overlay?run=one&run=two")
        page.locator(".rdpm-chart canvas").nth(2).wait_for()
        assert page.locator(".rdpm-chart").count() == 3  # without a contact, no chart of contacts

        page.set_viewport_size({"width": 390, "height": 800})  # a phone
        for path in ("/design", "/cases?shipped=dkt", "/runs", "/run/one"):
            page.goto(base + path)
            page.get_by_role("heading", level=1).wait_for()
            assert page.evaluate("document.documentElement.scrollWidth") <= 391
        assert complaints == []


CLOUD = """[domain]
size = [0.1, 0.1, 0.1]
[[bodies]]
diameter = 0.004
density = 2500
lattice = { counts = [10, 10, 10], spacing = [0.01, 0.01, 0.01] }
[time]
end = 1
step = "1 ms"
"""


def test_a_thousand_spheres_are_drawn(tmp_path):
    run = tmp_path / "cloud"
    run.mkdir()
    (run / "case.toml").write_text(CLOUD)
    rows = np.zeros((2, 1000, len(PARTICLE_COLUMNS)))
    rows[1, :, 0], rows[..., 1] = 0.1, np.arange(1000)
    rows[..., 2:5] = 0.005 + 0.01 * np.stack(np.unravel_index(np.arange(1000), (10, 10, 10)), axis=1)
    with TableWriter(run / "particles.csv", PARTICLE_COLUMNS) as table:
        table.write(rows.reshape(2000, -1))
    with browser.serving(tmp_path) as address, browser.browsing(address) as (page, complaints):
        page.goto(f"{address.partition('/?')[0]}/run/cloud")
        page.wait_for_function("+document.querySelector('.rdpm-scene')?.dataset.frames > 0")
        scene = page.locator(".rdpm-scene")

        def colourful():
            pixels = np.asarray(Image.open(io.BytesIO(scene.screenshot())).convert("RGB")).astype(int)
            return np.ptp(pixels, axis=2) > 40

        page.wait_for_timeout(1000)
        before = colourful()
        assert before.mean() > 0.05  # box and ground are grey
        scene.focus()
        for key in ("+", "+", "Shift+ArrowLeft"):
            page.keyboard.press(key)
        page.wait_for_timeout(1000)
        assert colourful().mean() > 1.2 * before.mean()  # it came closer
        assert complaints == []
