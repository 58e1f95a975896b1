"""Pictures of the page for its documentation: ``python docs/app_pictures.py``, with chromium and the extra `test`."""

from __future__ import annotations

import io
import sys
import tempfile
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "tests" / "app"))

from browser import browsing, serving  # noqa: E402

PAIR = """title = "A pair in a small tank"
[domain]
size = ["4 cm", "4 cm", "12 cm"]
[fluid]
density = "962 kg/m^3"
viscosity = "0.113 Pa s"
[[bodies]]
diameter = "10 mm"
density = "1300 kg/m^3"
centers = [["20 mm", "20 mm", "105 mm"], ["21 mm", "20 mm", "92 mm"]]
[contact]
restitution = {}
contact_steps = 8
friction = 0.2
overlap_warning = 0.025  # what a dry impact at the terminal speed may reach
[resolution]
cells_per_diameter = 6
[time]
end = "1.2 s"
[output]
table_every = "5 ms"
fields_every = "20 ms"
video = false
"""


def keep(page, name, whole=False):
    """Take a picture; few colours keep it small."""
    page.wait_for_timeout(1500)
    picture = Image.open(io.BytesIO(page.screenshot(full_page=whole))).convert("RGB")
    picture.quantize(160, dither=Image.Dither.NONE).save(ROOT / "docs" / "images" / f"app_{name}.png", optimize=True)


def run(page, base, case):
    """Start a run from the page of a case."""
    page.goto(f"{base}/cases?file={case}.toml")
    page.get_by_role("button", name="Run", exact=True).click()
    page.wait_for_url(f"**/run/{case}")


def main():
    """Make all pictures, from runs made for them."""
    with tempfile.TemporaryDirectory() as place:
        for name, restitution in (("pair-hard", 0.9), ("pair-soft", 0.3)):
            (Path(place) / f"{name}.toml").write_text(PAIR.format(restitution), encoding="utf-8")
        with serving(place) as address, browsing(address, 1100, 800) as (page, complaints):
            base = address.partition("/?")[0]
            page.goto(f"{base}/design?material=soda-lime+glass&diameter=2+mm&fluid=water&way=steps&contact_steps=8"
                      "&time_step=50+us&restitution=0.97")  # fmt: skip
            keep(page, "design")
            page.goto(f"{base}/cases?file=pair-hard.toml")
            keep(page, "case")
            run(page, base, "pair-hard")
            run(page, base, "pair-soft")
            page.goto(f"{base}/run/pair-hard")
            # until the pair is well on its way
            page.wait_for_function("+document.querySelector('progress')?.value > 45", timeout=180_000)
            keep(page, "run")
            page.goto(f"{base}/run/pair-soft")
            page.get_by_role("heading", name="Curves").wait_for(timeout=240_000)
            page.get_by_role("heading", name="Curves").scroll_into_view_if_needed()
            page.mouse.wheel(0, 300)
            keep(page, "results")
            page.goto(f"{base}/runs")
            keep(page, "runs")
            page.goto(f"{base}/overlay?run=pair-hard&run=pair-soft")
            keep(page, "overlay")
        if complaints:
            raise SystemExit("\n".join(complaints))
        with serving(place) as address, browsing(address, 390, 780, dark=True) as (page, _):
            keep(page, "phone")


if __name__ == "__main__":
    main()
