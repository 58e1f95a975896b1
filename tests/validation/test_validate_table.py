"""What `rdpm validate` is made of: rows and bands, published points, exact solutions, and one cheap case by command."""

import json
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

from rdpm.cli.main import main
from rdpm.figures.validation import draw
from rdpm.particles.calibration import CALIBRATION
from rdpm.setup.build import lubrication_correction
from rdpm.studies.validation import CASES, Chart, Curve, Row, validate
from rdpm.studies.validation.basset import basset_speed
from rdpm.studies.validation.near_contact import lubrication_resistance, resolved_resistance
from rdpm.studies.validation.near_contact_shear import QUANTITIES, TABLE, resolved_shear, tangential_resistance
from rdpm.studies.validation.points import crossing, points
from rdpm.studies.validation.wall_impact import Sphere, Track, peaks, recorded_impacts, wall_impact

DATA = Path(__file__).parents[1] / "data"


def test_a_row_is_judged_by_its_difference_or_by_its_value():
    assert Row("a", 1.02, 1.0, 0.02 + 1e-12).ok is True
    assert Row("a", 0.97, 1.0, 0.02).ok is False
    assert Row("a", 0.97, 1.0).ok is None
    assert Row("error", -0.03, None, 0.02).ok is False
    assert Row("error", float("nan"), None, 0.02).ok is False
    assert Row("error", float("nan")).to_dict()["value"] is None


def test_published_points_say_where_they_come_from():
    folder = files("rdpm.studies.validation").joinpath("data")
    tables = [item for item in folder.iterdir() if item.name.endswith(".csv")]
    assert tables
    for table in tables:
        first = table.read_text("utf-8").splitlines()[0]
        assert first.startswith("# "), table.name
        years = ("2012", "2011", "2002", "2000", "1999", "1964", "1961")
        assert any(year in first + table.name for year in years), table.name


def test_a_level_that_is_not_crossed_gives_nan():
    assert np.isnan(crossing(np.arange(3.0), np.arange(3.0), 5.0))


def test_speed_after_release_is_the_published_one():
    rows = np.genfromtxt(DATA / "validate_basset.csv", delimiter=",", names=True, skip_header=2)
    for row in rows:
        found = basset_speed(row["density_ratio"], np.array([row["tau"]]))[0]
        assert found == pytest.approx(row["speed"], rel=1e-6)  # the table has seven digits


def test_peaks_are_the_tops_of_the_measured_bounces():
    found = peaks(*points("gondret_2002", "time_s", "gap_m"), 3e-5)
    # The published curve: 7.466, 2.234 and 0.520 mm.
    np.testing.assert_allclose(found, [7.466e-3, 2.234e-3, 0.520e-3], rtol=2e-3)


def test_a_recording_gives_speed_and_restitution_of_its_impacts():
    recording = points("gondret_2002", "time_s", "gap_m")
    found = recorded_impacts(*recording, *recording)
    # Worked by hand from the frames -5.6, -1.6, 0.4 and 4.4 ms; the later impacts are those at St 77 and 39.
    assert found[0] == pytest.approx(((3.285 - 0.914) / 4.0, (2.0 - 0.2059) / (3.285 - 0.914)), rel=1e-9)
    assert [7800.0 * speed * 3e-3 / 0.09 for speed, _ in found] == pytest.approx([154.1, 76.7, 39.5], abs=0.1)
    # A track that starts elsewhere in time: a bounce at 0.7 of the speed, and nothing after it.
    time = np.linspace(0.95, 1.05, 1001)
    gap = np.where(time < 1.0, 0.6 * (1.0 - time), 0.42 * (time - 1.0))
    ((speed, restitution),) = recorded_impacts(*recording, time, gap)
    assert (speed, restitution) == pytest.approx((0.6, 0.7), rel=1e-9)


def test_speed_after_the_wall_counts_from_the_end_of_the_contact():
    time = np.array([-2.0, -1.0, 0.0, 1.0, 2.0, 3.0])
    track = Track(time, np.array([1.0, 0.0, -1.0, 0.0, 1.0, 2.0]), np.array([-1.0, -1.0, 0.5, 4.0, 3.0, 2.0]), 0.1)
    assert track.speed_after(0.5) == 3.5
    assert Track(time - 10.0, track.gap, track.speed, 0.1).speed_after(0.5) == 0.0


@pytest.mark.parametrize(
    ("pair", "activation"),
    [("wall", CALIBRATION.wall_activation_gap), ("spheres", CALIBRATION.pair_activation_gap)],
)
def test_lubrication_is_what_the_grid_misses(pair, activation):
    """Resolved and modelled resistance together, at 8 cells a diameter, from a tenth of the radius down."""
    gap, exact = points("approach_stokes", "gap_over_a", "resistance", pair=pair)
    gaps = (1.0, 0.2, 0.1, 0.05, 0.02, 0.01)
    resolved = resolved_resistance(pair, 8, gaps)
    both = resolved + lubrication_resistance(pair, 8, gaps)
    reference = np.array([exact[gap == g][0] for g in gaps])
    np.testing.assert_allclose(both[2:], reference[2:], rtol=0.10)  # the band of the published case at 16 cells
    assert np.all(resolved[3:] < 0.95 * reference[3:])  # there is something to add
    other = np.inf if pair == "wall" else 4.0
    row = lubrication_correction(1.0, 1.0).rows(np.array([4.0]), np.array([other]))
    assert row["cutoff_gap"][0] == activation  # 8 cells a diameter


@pytest.mark.parametrize("pair", QUANTITIES)
def test_tangential_lubrication_is_what_the_grid_misses_of_slip_and_roll(pair):
    """At 8 cells a diameter, from a twentieth of the radius down: forces and torques of shear and rotation."""
    gap, _ = points(TABLE, "gap_over_a", "value", pair=pair, quantity=QUANTITIES[pair][0])
    gaps = tuple(gap[gap < 0.06])
    resolved, added = resolved_shear(pair, 8, gaps), tangential_resistance(pair, 8, gaps)
    for name in QUANTITIES[pair]:
        all_gaps, values = points(TABLE, "gap_over_a", "value", pair=pair, quantity=name)
        reference = values[np.isin(all_gaps, gaps)]
        np.testing.assert_allclose(resolved[name] + added[name], reference, rtol=0.15, err_msg=name)  # of the case
        if name in ("rotation torque", "shear force", "rotation torque, alike", "rotation torque, opposite"):
            assert resolved[name][-1] < 0.95 * reference[-1]  # there is something to add


def test_a_steel_sphere_rebounds_by_what_the_liquid_leaves():
    thin, thick = (
        wall_impact(Sphere(6e-3, 0.519, 965.0, mu), 6, 2e-4, {"contact_steps": 8}, start=2.5, after=4e-3)
        for mu in (0.0321, 0.27)
    )
    # St 84: Legendre's curve gives 0.66; at 6 cells a diameter within 0.1. St 10 leaves nothing.
    assert thin.speed_after(1e-3) / 0.519 == pytest.approx(0.66, abs=0.1)
    assert 0.01 < thin.deepest < 0.06
    assert thick.speed_after(1e-3) / 0.519 < 0.02


def test_a_chart_becomes_a_picture(tmp_path):
    line = Curve("rdpm", np.arange(1.0, 4.0), np.arange(1.0, 4.0))
    chart = Chart("x", "title", "t [s]", "y [m]", "what was run", [line, Curve("measured", line.x, line.y, True)], True)
    path = draw(chart, tmp_path / "new")
    assert path.name == "validation_x.png"
    assert path.stat().st_size > 5000


def test_the_command_prints_json_and_ends_with_0_where_nothing_is_outside(capsys):
    assert main(["validate", "time-order", "--quick", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["quick"] is True
    assert {row["case"] for row in found["rows"]} == {"time-order"}


def test_the_command_ends_with_1_where_a_case_is_outside(monkeypatch, capsys):
    monkeypatch.setitem(CASES, "time-order", (lambda quick, tell: iter([Row("drag", 2.0, 1.0, 0.1)]), True))
    assert main(["validate", "time-order"]) == 1
    assert "0 of 1 within" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("case", "charts"),
    [("bouncing-sphere", 0), ("stacked-spheres", 1), ("sliding-ball", 0), ("normal-impact", 1), ("oblique-impact", 3),
     ("glass-spheres", 1)],
)  # fmt: skip
def test_dry_cases_are_within_their_bands(case, charts):
    found = list(validate([case]))
    rows = [item for item in found if isinstance(item, dict)]
    assert len(found) - len(rows) == charts
    assert {row["ok"] for row in rows} <= {True, None}, [row for row in rows if row["ok"] is False]
    assert any(row["ok"] for row in rows)


def test_an_unknown_case_is_refused_by_name(capsys):
    assert main(["validate", "nothing"]) == 2
    assert "simple-cubic" in capsys.readouterr().err


def test_rows_carry_the_case_and_their_seconds(monkeypatch):
    monkeypatch.setitem(CASES, "time-order", (lambda quick, tell: iter([Row("drag", 1.0, 1.0, 0.1)]), True))
    (row,) = validate(["time-order"])
    assert row["case"] == "time-order"
    assert row["ok"] is True
    assert row["seconds"] >= 0.0


def test_the_command_prints_the_table_of_the_documentation(monkeypatch, capsys):
    rows = [Row("drag", 1.01, 1.0, 0.02, "N"), Row("error", 0.01, None, 0.02)]
    monkeypatch.setitem(CASES, "time-order", (lambda quick, tell: iter(rows), True))
    assert main(["validate", "time-order", "--markdown"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("| case | quantity |")
    assert lines[2] == "| time-order | drag [N] | 1.01 | 1 | +1.00 % | 2.00 % | yes |"
    assert lines[3] == "| time-order | error | 0.01 |  |  | at most 0.02 | yes |"
    page = Path(__file__).parents[2] / "docs" / "validation.md"
    assert lines[0] in page.read_text("utf-8").splitlines()
