"""The page in a real browser, with the network cut: from a design to two runs over each other."""

import re

import browser
import pytest

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
        page.wait_for_function("+document.querySelector('.rdpm-scene')?.dataset.frames > 3", timeout=60_000)
        page.goto("about:blank")  # the page is closed, the run goes on

        run_case(page, base, "two")
        page.get_by_role("heading", name="Replay").wait_for(timeout=120_000)
        page.goto(f"{base}/runs")
        for name in ("one", "two"):
            page.get_by_label(f"overlay {name}").check()
        page.get_by_role("button", name=re.compile("Overlay")).click()
        page.wait_for_url("**/overlay?run=one&run=two")
        assert page.locator(".rdpm-chart canvas").count() >= 4

        page.set_viewport_size({"width": 390, "height": 800})  # a phone
        for path in ("/design", "/cases?shipped=dkt", "/runs", "/run/one"):
            page.goto(base + path)
            page.get_by_role("heading", level=1).wait_for()
            assert page.evaluate("document.documentElement.scrollWidth") <= 391
        assert complaints == []
