"""What left the range that a design promises, and why: in the table, the summary and the report, for each model."""

import re

import numpy as np
import pytest

import rdpm
from rdpm.figures import report
from rdpm.io.tables import read_table
from rdpm.results.contacts import count_reasons, outside_range
from rdpm.results.summary import ContactDesign, PairDesign, read_summary
from rdpm.runs.runner import run_case
from rdpm.runs.warnings import planned
from rdpm.setup import plan

NAN = np.nan
WALL = PairDesign("sphere-wall", restitution=0.8, impact_speed_m_s=0.1, max_overlap_fraction=0.004)


def contact(**other):
    row = {"kind": "sphere-wall", "impact_speed_m_s": 0.1, "rebound_speed_m_s": 0.08, "max_overlap_fraction": 0.004,
           "steps": 8.0, "restitution": 0.8, "stokes_number": NAN}  # fmt: skip
    return row | other


def judged(design, *rows, pressed=None):
    columns = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    return outside_range(columns, np.zeros(len(rows), bool) if pressed is None else pressed, design).tolist()


def test_reasons_of_a_soft_sphere():
    design = ContactDesign("soft-sphere", pairs=(WALL,), overlap_warning=0.005)
    found = judged(
        design,
        contact(),
        contact(impact_speed_m_s=0.2, max_overlap_fraction=0.008),  # in proportion to the speed
        contact(max_overlap_fraction=0.008),
        contact(steps=3.0),
        contact(steps=3.0, rebound_speed_m_s=NAN, restitution=NAN),
        contact(restitution=0.7),
        contact(restitution=0.7, stokes_number=50.0),  # the fluid takes the rest
        contact(restitution=0.9, stokes_number=50.0),
        contact(max_overlap_fraction=0.006, steps=2.0, restitution=1.2),
    )
    assert found == [
        "no", "overlap (fast impact)", "overlap (pushed)", "steps (pushed)", "steps (cut)", "restitution (pushed)",
        "no", "restitution (pushed)", "overlap (pushed); steps (pushed); restitution (pushed)",
    ]  # fmt: skip
    pressed = judged(design, contact(max_overlap_fraction=0.02, restitution=NAN, steps=3.0), pressed=np.array([True]))
    assert pressed == ["overlap (pressed)"]  # neither steps nor restitution have a target
    assert count_reasons(found)["restitution (pushed)"] == 3


def test_overlap_goes_with_the_power_of_the_law():
    deep = contact(impact_speed_m_s=0.4, max_overlap_fraction=0.004 * 4**0.8, steps=3.0)
    soft, hertz = (ContactDesign(model, pairs=(WALL,), overlap_warning=0.005) for model in ("soft-sphere", "hertz"))
    assert judged(hertz, deep) == ["overlap (fast impact); steps (fast impact)"]
    assert judged(soft, deep) == ["overlap (fast impact); steps (pushed)"]  # its time does not depend on the speed
    assert judged(hertz, deep | {"max_overlap_fraction": 0.004 * 4.0}) == ["overlap (pushed); steps (fast impact)"]


def test_without_a_design_speed_the_spring_tells():
    spring = PairDesign("sphere-wall", reduced_mass_kg=1e-3, stiffness_N_m=1e3, diameter_m=0.01)
    design = ContactDesign("soft-sphere", pairs=(spring,), overlap_warning=0.005)
    assert judged(design, contact(max_overlap_fraction=0.0099), contact(max_overlap_fraction=0.012)) == [
        "overlap (fast impact)", "overlap (pushed)",
    ]  # fmt: skip


def test_reasons_of_the_other_models():
    hard = ContactDesign("hard-sphere", restitution=0.8, overlap_warning=0.005)
    still = contact(steps=0.0, max_overlap_fraction=0.0)
    assert judged(hard, still, still | {"restitution": 0.0}) == ["no", "restitution (at rest)"]
    repulsive = ContactDesign("repulsive", pairs=(PairDesign("sphere-wall", restitution=1.0),), overlap_warning=0.005)
    pressed = np.array([False, True])
    assert judged(repulsive, contact(), contact(), pressed=pressed) == ["touch (fast impact)", "touch (pressed)"]


BALL = {
    "domain": {"size": [0.05, 0.05, 0.05]},
    "bodies": [{"diameter": 0.01, "density": 2500.0, "centers": [[0.025, 0.025, 0.0052]], "velocity": [0, 0, -0.3]}],
    "time": {"end": 0.02, "step": 2e-5}, "output": {"video": False},
}  # fmt: skip
MODELS = {
    "soft-sphere": ({"stiffness": 50.0, "restitution": 0.9}, "stiffness k_n", "raise contact.stiffness"),
    "hertz": (
        {"model": "hertz", "youngs_modulus": 1e5, "poisson_ratio": 0.3, "restitution": 0.9}, "effective modulus",
        "raise contact.youngs_modulus",
    ),
    "repulsive": (
        {"model": "repulsive", "repulsion_stiffness": 0.1, "repulsion_range": 1e-3}, "repulsion range",
        "raise contact.repulsion_stiffness, or contact.repulsion_range",
    ),
    "hard-sphere": ({"model": "hard-sphere", "restitution": 0.9}, "rest speed", None),
}  # fmt: skip


@pytest.mark.parametrize("model", MODELS)
def test_table_summary_and_page_say_the_same_of_each_model(model, tmp_path, monkeypatch):
    monkeypatch.setattr(report, "start_rendering", lambda *_: None)
    given, parameter, cure = MODELS[model]
    case = rdpm.load_case(BALL | {"contact": given})
    summary = run_case(case, tmp_path, threads=1)
    said = read_table(tmp_path / "contacts.csv")["outside"]
    assert summary.contacts.count == len(said) >= 1
    assert summary.contacts.outside == (said != "no").sum()
    assert summary.contacts.outside_reasons == count_reasons(said)
    assert read_summary(tmp_path / "summary.json") == summary
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    shown = re.sub(r"<[^>]+>", " ", re.sub(r"base64,[^\"]+", "", page))
    assert f"Law: {model}, " in shown
    assert parameter in shown
    assert f"{summary.contacts.outside} of {len(said)} contacts." in shown or not summary.contacts.outside
    assert ("k_n" in shown) == (model == "soft-sphere")
    assert "contact_steps" not in shown.split("case.toml")[0]
    assert "None" not in shown.split("case.toml")[0]
    cures = {warning.cure for warning in (*planned(plan(case)), *summary.warning_details)}
    assert cures == ({cure} if cure else set())
