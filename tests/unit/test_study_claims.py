"""Claims judged on small made-up tables, and those that formulas decide against numbers worked out independently."""

from __future__ import annotations

import math

import pytest

from rdpm.studies.claims import (
    CLAIMS,
    DESIGN_CLAIMS,
    RUN_CLAIMS,
    Alike,
    Approaches,
    Claim,
    Computed,
    Happens,
    Insensitive,
    Judgement,
    Limit,
    Trend,
    judge,
    judge_each,
    judge_study,
)
from rdpm.studies.claims.of_study import quantities_of, widest_spreads
from rdpm.studies.measures import QUANTITIES
from rdpm.studies.spread import Spread, spread_of, spreads_of

K = "contact.stiffness"


def table(values, along=K, at=(1.0, 50.0, 500.0), quantity="tumble_start_s", **fixed):
    return [
        {"run": f"run-{n}", along: x, quantity: value, **fixed}
        for n, (x, value) in enumerate(zip(at, values, strict=True))
    ]


def claim(expected, **others):
    return Claim("id", "statement", "slide", expected, "reason", **others)


def spread(half_width, quantity="tumble_start_s", scale="linear"):
    return {quantity: Spread(quantity, 2.0, half_width, 5, scale)}


@pytest.mark.parametrize(
    ("values", "verdict"),
    [
        ((2.0, 2.5, 3.0), "confirmed"),
        ((2.0, 2.5, 2.4), "confirmed"),            # 0.1 back is within sqrt(2) 0.1
        ((3.0, 2.5, 2.0), "contradicted"),
        ((2.0, 2.05, 2.1), "within the spread"),
        ((2.0, 2.14, 2.28), "confirmed"),          # no step alone, both together
        ((2.0, 3.0, 2.2), "conditional"),
    ],
)  # fmt: skip
def test_a_trend(values, verdict):
    found = judge(claim(Trend("tumble_start_s", K, True)), table(values), spread(0.1))
    assert found.verdict == verdict
    assert found.runs == ("run-0", "run-1", "run-2")
    assert (found.reason, found.numbers[f"tumble_start_s@{K}=50"]) == ("reason", values[1])
    falling = judge(claim(Trend("tumble_start_s", K, False)), table(values[::-1]), spread(0.1))
    assert falling.verdict == verdict


def test_a_conditional_trend_says_where_it_holds():
    found = judge(claim(Trend("tumble_start_s", K, True)), table((2.0, 3.0, 2.2)), spread(0.1))
    assert "2 s, 3 s, 2.2 s at contact.stiffness = 1, 50, 500" in found.sentence
    assert "from 1 to 50 only" in found.sentence


def test_rows_are_sorted_selected_and_averaged():
    rows = table((3.0, 2.0), at=(500.0, 1.0), lubrication=False)
    rows += table((1.0,), at=(500.0,), lubrication=True)
    wanted = claim(Trend("tumble_start_s", K, True), where={"lubrication": False})
    assert judge(wanted, rows, spread(0.1)).verdict == "confirmed"
    # Without the choice, 3 and 1 at one stiffness are 2.
    assert judge(claim(Trend("tumble_start_s", K, True)), rows, spread(0.1)).verdict == "within the spread"
    assert judge(claim(Trend("tumble_start_s", K, True), where={"viscosity": 0.1}), rows, {}).verdict == "not judged"


def test_what_spans_decades_is_compared_by_its_ratio():
    rows = table((0.045, 0.0025, 0.00075), quantity="max_overlap_fraction")
    softer = claim(Trend("max_overlap_fraction", K, False))
    of_half = spread(math.log(1.5), "max_overlap_fraction", "log")
    assert judge(softer, rows, of_half).verdict == "confirmed"
    near = table((0.00090, 0.00080, 0.00075), quantity="max_overlap_fraction")
    assert judge(softer, near, of_half).verdict == "within the spread"


def test_without_runs_or_spread_nothing_is_judged():
    trend = claim(Trend("tumble_start_s", K, True))
    assert judge(trend, table((2.0, 3.0, 4.0)), {}).verdict == "not judged"
    assert judge(trend, table((2.0, None, float("nan"))), spread(0.1)).verdict == "not judged"
    assert judge(trend, [], spread(0.1)).verdict == "not judged"


@pytest.mark.parametrize(
    ("values", "verdict"),
    [
        ((0.001, 0.002, 0.003), "confirmed"),
        ((0.001, 0.002, 0.02), "conditional"),
        ((0.01, 0.02, 0.03), "contradicted"),
        ((0.001, 0.0049, 0.0051), "within the spread"),
    ],
)
def test_a_limit(values, verdict):
    rows = table(values, "contact.contact_steps", (9.0, 12.0, 14.0), "max_overlap_fraction")
    rows += table((0.4,), "contact.contact_steps", (15.0,), "max_overlap_fraction")   # outside of the range
    limit = Limit("max_overlap_fraction", 0.005, True, "contact.contact_steps", 8.0, 15.0)
    of_tenth = spread(0.1, "max_overlap_fraction", "log")
    assert judge(claim(limit), rows, of_tenth).verdict == verdict
    found = judge(claim(limit, condition="at these speeds"), rows, of_tenth)
    assert found.verdict == ("conditional" if verdict == "confirmed" else verdict)
    assert ("It holds at these speeds." in found.sentence) == (verdict == "confirmed")


def test_a_lower_limit():
    stokes = claim(Limit("max_stokes_number", 10.0, at_most=False))
    rows = table((0.006, 0.004, 0.005), quantity="max_stokes_number")
    assert judge(stokes, rows, spread(0.5, "max_stokes_number", "log")).verdict == "contradicted"


def test_insensitive():
    rows = [a | b for a, b in zip(table((2.7, 2.75, 2.72)), table((1.0, 1.0, 2.0), quantity="kisses"), strict=True)]
    steady, changing = Insensitive(("tumble_start_s",), K, 1.0, 500.0), Insensitive(("kisses",), K, 1.0, 500.0)
    spreads = spread(0.1) | spread(0.0, "kisses")
    assert judge(claim(steady), rows, spreads).verdict == "confirmed"
    assert judge(claim(changing), rows, spreads).verdict == "contradicted"
    both = judge(claim(Insensitive(("tumble_start_s", "kisses"), K)), rows, spreads)
    assert both.verdict == "conditional"
    assert "it changes: kisses is 1, 1, 2" in both.sentence
    # Below the stiffest run nothing changes.
    assert judge(claim(Insensitive(("kisses",), K, 1.0, 100.0)), rows, spreads).verdict == "confirmed"


def test_what_happens_in_some_runs_only_is_a_change():
    rows = table((2.7, None, 2.7))
    assert judge(claim(Insensitive(("tumble_start_s",), K)), rows, spread(0.1)).verdict == "contradicted"
    # Unless numerics alone decide whether it happens.
    assert judge(claim(Insensitive(("tumble_start_s",), K)), rows, spread(math.inf)).verdict == "within the spread"


def test_an_event():
    tumbles = claim(Happens("tumble_start_s"))
    assert judge(tumbles, table((2.7, 2.7, 2.8)), {}).verdict == "confirmed"
    assert judge(tumbles, table((None, None, None)), {}).verdict == "contradicted"
    assert judge(tumbles, table((2.7, None, None)), {}).verdict == "conditional"
    assert judge(tumbles, table((2.7, None, None)), spread(math.inf)).verdict == "within the spread"


def test_each_resolution_by_itself():
    rows = table((2.0, 2.5, 3.0), cells=8) + table((2.0, 2.0, 2.0), cells=12)
    found = judge_each(claim(Trend("tumble_start_s", K, True)), rows, spread(0.1), "cells")
    assert {cells: one.verdict for cells, one in found.items()} == {8: "confirmed", 12: "within the spread"}


def test_spread_is_two_standard_deviations():
    rows = [{"tumble_start_s": t} for t in (2.6, 2.7, 2.7, 2.8)]
    found = spread_of(rows, "tumble_start_s")
    assert (found.center, found.half_width) == (pytest.approx(2.7), pytest.approx(2.0 * math.sqrt(0.02 / 3.0)))
    # Two runs differ from sqrt(2) of it on.
    assert found.excess(2.7, 2.7 + math.sqrt(2.0) * found.half_width) == pytest.approx(1.0)
    ratio = spread_of([{"max_overlap_fraction": x} for x in (0.001, 0.002)], "max_overlap_fraction")
    assert ratio.scale == "log"
    assert ratio.half_width == pytest.approx(2.0 * math.log(2.0) / math.sqrt(2.0))
    assert ratio.center == pytest.approx(math.sqrt(2.0) * 0.001)


def test_spread_of_what_happens_sometimes():
    rows = [{"tumble_start_s": t} for t in (2.6, None, 2.7, 2.8)]
    assert spread_of(rows, "tumble_start_s").half_width == math.inf
    assert spreads_of([{}, {}], ["kisses"])["kisses"].center is None
    with pytest.raises(ValueError, match="at least two runs"):
        spread_of(rows[:1], "tumble_start_s")


def test_claims_use_known_quantities_and_have_reasons():
    assert len(CLAIMS) == len(DESIGN_CLAIMS) + len(RUN_CLAIMS)
    for one in CLAIMS.values():
        assert one.reason
        assert one.slide
    for one in RUN_CLAIMS:
        assert set(quantities_of(one)) <= set(QUANTITIES), one.id


@pytest.mark.parametrize(
    ("values", "verdict"),
    [
        ((2.71, 2.8, 3.2), "confirmed"),       # sqrt(2) S = 0.14 from the reference, 2.7
        ((2.71, 2.72, 2.8), "within the spread"),
        ((2.9, 3.0, 3.2), "conditional"),
        ((3.2, 3.0, 2.9), "contradicted"),
    ],
)
def test_runs_that_come_to_a_reference(values, verdict):
    rows = [
        *table(values, along="contact.contact_steps", at=(4.0, 8.0, 20.0)),
        {"run": "hard", "contact.model": "hard-sphere", "tumble_start_s": 2.7},
    ]
    expected = Approaches(("tumble_start_s",), "contact.contact_steps", {"contact.model": "hard-sphere"})
    spread = {"tumble_start_s": Spread("tumble_start_s", 2.7, 0.1, 4)}
    found = judge(claim(expected), rows, spread)
    assert found.verdict == verdict
    assert found.runs == ("hard", "run-0", "run-1", "run-2")
    assert found.numbers["tumble_start_s"] == 2.7
    assert judge(claim(expected), rows[:-1], spread).verdict == "not judged"


def test_runs_are_alike_when_no_two_differ():
    expected = Alike(("tumble_start_s",))
    spread = {"tumble_start_s": Spread("tumble_start_s", 2.7, 0.1, 4)}
    assert judge(claim(expected), table((2.7, 2.75, 2.8)), spread).verdict == "confirmed"
    assert judge(claim(expected), table((2.7, 2.75, 2.9)), spread).verdict == "contradicted"
    without = judge(claim(expected), table((2.7, 2.75, None)), spread)
    assert without.verdict == "contradicted"
    assert "none in run-2" in without.sentence
    assert judge(claim(expected), table((2.7,), at=(1.0,)), spread).verdict == "not judged"


def found_by(name: str) -> Judgement:
    assert isinstance(CLAIMS[name].expected, Computed)
    return judge(CLAIMS[name], [], {})


# Numbers worked out from the formulas, independently of this package, to the digits given (m_ij = 0.9902467 g unless
# the key says otherwise). St: 0.98960e-3 kg * 0.09435 m/s / (6 pi * 0.113 Pa s * (3.75 mm)^2).
@pytest.mark.parametrize(
    ("name", "verdict", "numbers"),
    [
        ("parameters-fall-with-time-step", "confirmed", {"stiffness_power": "-2.00", "damping_power": "-1.00"}),
        ("steps-table", "conditional", {"nominal_mass_kg": "0.00098960"}),
        ("graphical-table", "confirmed", {}),
        ("ranges-agree", "conditional", {"least_contact_steps": "10.12"}),
        ("measured-stiffness", "contradicted", {}),
        ("printed-viscosity", "contradicted", {"reynolds_printed": "0.31", "reynolds": "12.0"}),
        ("runs-have-a-restitution", "conditional",
         {"zeta@k_n=1000,eta_n=100": "1.59", "zeta@k_n=5000,eta_n=150": "1.07"}),
        ("hertz-lower-limit", "contradicted", {"contact_time_soft_s": "0.0020", "contact_time_stiff_s": "0.00006"}),
        ("overlap-by-steps", "conditional",
         {"speed_cm_s@N_c=8": "4.07", "speed_cm_s@N_c=10": "3.25", "speed_cm_s@N_c=12": "2.71"}),
        ("overlap-at-rest", "conditional", {"static_overlap_percent": "3.7"}),
        ("hard-limit", "conditional", {}),
        ("more-than-one-step", "conditional", {"restitution_explicit-euler": "0.94"}),
        ("restitution-of-damping", "conditional", {"restitution_zero_force": "0.550"}),
        ("dry-for-wet-by-speed", "contradicted", {"stokes_number": "3.12"}),
    ],
)  # fmt: skip
def test_claims_that_formulas_decide(name, verdict, numbers):
    found = found_by(name)
    assert found.verdict == verdict
    assert found.sentence
    assert found.reason == CLAIMS[name].reason
    for key, digits in numbers.items():
        assert f"{found.numbers[key]:.{len(digits.split('.')[1])}f}" == digits, key


def test_every_design_claim_is_tested_above():
    parameters = test_claims_that_formulas_decide.pytestmark[0].args[1]
    assert {row[0] for row in parameters} == {one.id for one in DESIGN_CLAIMS}


def test_tables_of_the_talk_are_met():
    assert found_by("steps-table").numbers["largest_deviation"] < 1e-4
    assert found_by("graphical-table").numbers["last_digits"] < 0.5


def test_overlap_and_contact_time_go_with_the_steps():
    numbers = found_by("hard-limit").numbers
    assert numbers["overlap_percent@N_c=4"] == pytest.approx(0.5 * numbers["overlap_percent@N_c=8"])


STIFFNESS_SWEEP = {"contact.lubrication": False, "fluid.viscosity": 0.113, "contact.damping": 0.1}


def test_kissing_on_a_made_up_sweep():
    """Contacts, as tried at 8 cells a diameter: 1, 1 and 2; overlap 4.5, 0.25 and 0.075 % d."""
    rows = [
        {"run": f"k-{k:g}", K: k, "contact_kisses": kisses, "max_overlap_fraction": overlap, **STIFFNESS_SWEEP}
        for k, kisses, overlap in ((1.0, 1, 0.045), (50.0, 1, 0.0025), (500.0, 2, 0.00075))
    ]
    spreads = spread(0.0, "contact_kisses") | spread(0.2, "max_overlap_fraction", "log")
    assert judge(CLAIMS["kissing-grows-with-stiffness"], rows, spreads).verdict == "confirmed"
    assert judge(CLAIMS["softer-with-less-stiffness"], rows, spreads).verdict == "confirmed"
    # Where numerics alone change the number of contacts by one, nothing follows from it.
    kissing = judge(CLAIMS["kissing-grows-with-stiffness"], rows, spread(1.0, "contact_kisses"))
    assert kissing.verdict == "within the spread"
    lubricated = [row | {"contact.lubrication": True} for row in rows]
    assert judge(CLAIMS["kissing-grows-with-stiffness"], lubricated, spreads).verdict == "not judged"


class Study:
    """What is used of a study's results; records stand for the DataFrame."""

    def __init__(self, folder, rows):
        self.folder, self.rows = folder, rows

    @property
    def table(self):
        return self

    def to_dict(self, orient):
        assert orient == "records"
        return self.rows

    def run_folder(self, name, study=""):
        return self.folder / study / name


def study_of(tmp_path, lubrication="false"):
    """Two stiffnesses, one of them repeated with other numerics, and a run that failed."""
    rows = []
    for name, k, kisses, repeats, status in (
        ("soft", 1.0, 1, "", "done"), ("stiff", 500.0, 2, "", "done"), ("lost", 900.0, 0, "", "failed"),
        ("soft-1", 1.0, 1, "soft", "done"), ("soft-2", 1.0, 1, "soft", "done"),
    ):  # fmt: skip
        folder = tmp_path / "sweep" / name
        folder.mkdir(parents=True)
        contact = f"[contact]\nstiffness = {k}\ndamping = 0.1\nlubrication = {lubrication}\n"
        (folder / "case.toml").write_text(f"[fluid]\nviscosity = 0.113\n{contact}")
        rows.append({"study": "sweep", "run": name, "spread_of": repeats, "status": status, K: k,
                     "contact_kisses": kisses})  # fmt: skip
    return Study(tmp_path, rows)


def test_a_study_is_judged_by_its_table_cases_and_repetitions(tmp_path):
    found = judge_study(CLAIMS["kissing-grows-with-stiffness"], study_of(tmp_path))
    assert (found.verdict, found.runs) == ("confirmed", ("soft", "stiff"))
    assert "(n = 3)" in found.sentence
    assert judge_study(CLAIMS["hertz-lower-limit"], study_of(tmp_path / "other")).verdict == "contradicted"


def test_what_all_runs_share_is_read_from_their_cases(tmp_path):
    """The talk's runs have no lubrication; the table of a sweep does not say so."""
    found = judge_study(CLAIMS["kissing-grows-with-stiffness"], study_of(tmp_path, "true"))
    assert found.verdict == "not judged"


def test_what_another_part_varies_is_read_from_the_cases_of_this_one(tmp_path):
    """The table of a study of several parts has a column for each key that any of them varies: NaN in the others."""
    study = study_of(tmp_path)
    for row in study.rows:
        row |= {"contact.damping": math.nan, "contact.lubrication": math.nan, "fluid.viscosity": None}
    assert judge_study(CLAIMS["kissing-grows-with-stiffness"], study).verdict == "confirmed"


def test_resolutions_are_not_mixed(tmp_path):
    study = study_of(tmp_path)
    fine = [row | {"run": f"fine-{row['run']}", "contact_kisses": 1} for row in study.rows[:2]]
    for row in fine:
        (tmp_path / "sweep" / row["run"]).mkdir()
        (tmp_path / "sweep" / row["run"] / "case.toml").write_text(
            "[fluid]\nviscosity = 0.113\n[contact]\ndamping = 0.1\nlubrication = false\n"
        )
    for rows, cells in ((study.rows, 8.0), (fine, 12.0)):
        for row in rows:
            row["resolution.cells_per_diameter"] = cells
    found = judge_study(CLAIMS["kissing-grows-with-stiffness"], Study(tmp_path, study.rows + fine))
    assert (found.verdict, found.runs) == ("confirmed", ("soft", "stiff"))
    assert found.sentence.endswith("This is at 8 cells a diameter. At 12: within the spread.")


def test_of_several_repeated_runs_the_widest_spread_counts():
    rows = [
        {"run": run, "spread_of": "" if n == 0 else run[:1], "tumble_start_s": value}
        for values, runs in (((2.6, 2.8), ("a", "a1")), ((2.7, 2.72), ("b", "b1")))
        for n, (run, value) in enumerate(zip(runs, values, strict=True))
    ]
    assert widest_spreads(rows, ["tumble_start_s"])["tumble_start_s"].center == pytest.approx(2.7)
    assert widest_spreads(rows[:1], ["tumble_start_s"]) == {}
