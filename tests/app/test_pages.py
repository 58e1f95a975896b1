"""The pages, with a stand-in for the browser."""

import asyncio
import time

from nicegui import ui

from builders import made_up_run, pair_motion
from rdpm.cases import shipped_text
from rdpm.config.load import load_case

DRY = """title = "A bead above a floor"
[domain]
size = ["10 cm", "10 cm", "10 cm"]
[[bodies]]
diameter = "10 mm"
density = 2500
centers = [["5 cm", "5 cm", "5 cm"]]
[time]
end = "50 ms"
step = "1 ms"
[output]
report = false
"""


def save_run(folder):
    folder.parent.mkdir(exist_ok=True)
    made_up_run(folder, pair_motion, 2)


def shown(user):
    return "\n".join(one.content for one in user.find(kind=ui.html).elements)


def one(user, kind, content):
    (found,) = user.find(kind=kind, content=content).elements
    return found


def test_design_follows_what_is_typed_and_names_what_is_wrong(visit):
    async def act(user):
        await user.open("/design?diameter=15+mm&density=1120&way=stiffness&stiffness=100&restitution=0.5")
        field = one(user, ui.input, "stiffness k_n [N/m]")
        with user:
            field.set_value("200 N/m")
        assert "<dd>200 N/m</dd>" in shown(user)
        with user:
            field.set_value("-1")
        assert "must be" in field.error
        assert "stiffness = -1" in shown(user)

    visit(act)


def test_a_material_names_its_source_and_leaves_its_numbers_behind(visit):
    async def act(user):
        await user.open("/design?material=soda-lime+glass&diameter=2+mm")
        assert "Callister" in shown(user)
        with user:
            one(user, ui.select, "material").set_value("")
        assert "Callister" not in shown(user)
        assert one(user, ui.input, "density of the sphere").value == "2500 kg/m^3"

    visit(act)


def test_a_design_change_takes_less_than_a_tenth_of_a_second(visit):
    async def act(user):
        await user.open("/design")
        field, spent = one(user, ui.input, "restitution e_n"), []
        for number in range(12):
            begun = time.process_time()
            with user:
                field.set_value(f"{0.5 + 0.02 * number}")
            spent.append(time.process_time() - begun)
        assert sorted(spent)[6] < 0.1

    visit(act)


def test_a_form_and_its_text_follow_each_other(visit, page):
    (page.root / "bead.toml").write_text(DRY)

    async def act(user):
        await user.open("/cases?file=bead.toml")
        text, end = one(user, ui.textarea, "Case file (TOML)"), one(user, ui.input, "end [s] *")
        assert end.value == "50 ms"
        with user:
            text.set_value(DRY.replace("50 ms", "70 ms"))
        await asyncio.sleep(0.5)
        assert end.value == "70 ms"
        with user:
            end.set_value("-1 s")
        await asyncio.sleep(0.5)
        assert 'end = "-1 s"' in text.value
        assert "must be positive" in end.error
        assert "Line 9" in shown(user)
        with user:
            end.set_value("80 ms")
        await asyncio.sleep(0.5)
        assert end.error is None
        assert "can run" in shown(user)

    visit(act)


def test_a_case_is_run_and_found_again(visit, page):
    (page.root / "bead.toml").write_text(DRY)

    async def start(user):
        await user.open("/cases?file=bead.toml")
        await asyncio.sleep(0.3)
        user.find(kind=ui.button, content="Run").click()
        await asyncio.sleep(0.5)
        assert page.work.runs() == ["bead"]
        for _ in range(300):  # the clock of the page starts it
            if (page.root / "bead" / "summary.json").exists() and not (page.root / "bead" / "run.lock").exists():
                break
            await asyncio.sleep(0.1)

    async def come_back(user):
        await user.open("/runs")
        assert ">done<" in shown(user)
        await user.open("/run/bead")
        await asyncio.sleep(1.0)
        assert "Replay" in shown(user)
        assert "particles.csv" in shown(user)

    visit(start)
    visit(come_back)


def test_two_runs_are_laid_over_each_other(visit, page):
    for name in ("one", "two"):
        save_run(page.root / name)

    async def act(user):
        await user.open("/overlay?run=one&run=two")
        assert len(user.find(kind=ui.echart).elements) == 4
        await user.open("/overlay?run=one")
        assert "not 1" in shown(user)
        await user.open("/overlay?run=one&run=..%2Ftwo&run=two")
        assert "left out" in shown(user)

    visit(act)


def test_a_study_has_a_page(visit, page):
    study = page.root / "stiffness"
    (study / "figures").mkdir(parents=True)
    (study / "study.json").write_text('{"parts": [{"title": "Stiffness", "question": "Does it matter?"}], "jobs": []}')
    (study / "table.csv").write_text("run,contact.stiffness\nsoft,10.0\nhard,1000.0\nmiddle,100.0\n")
    save_run(study / "runs" / "soft")

    async def act(user):
        await user.open("/runs")
        assert "/study/stiffness" in shown(user)
        await user.open("/study/stiffness?sort=contact.stiffness")
        text = shown(user)
        assert "Does it matter?" in text
        assert "/run/stiffness/runs/soft" in text
        assert text.index("soft") < text.index("middle") < text.index("hard")

    visit(act)


def test_every_shipped_case_opens_in_its_form(visit):
    async def act(user):
        for name in ("cloud", "rebound"):
            await user.open(f"/cases?shipped={name}")
            text = one(user, ui.textarea, "Case file (TOML)").value
            assert text == shipped_text(name)
            assert "can run" in shown(user)
            assert one(user, ui.input, "end [s] *").value

    visit(act)


def test_what_the_form_writes_is_what_is_loaded(visit, page):
    async def act(user):
        await user.open("/cases?shipped=settling")
        with user:
            one(user, ui.input, "cells per diameter").set_value("10")
        await asyncio.sleep(0.6)
        path = page.root / "kept.toml"
        path.write_text(one(user, ui.textarea, "Case file (TOML)").value)
        assert load_case(path) == load_case("settling", {"resolution.cells_per_diameter": 10})

    visit(act)
