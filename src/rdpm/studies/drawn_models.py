"""Drawing of runs that differ in their contact model: what came out, one row a run."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from rdpm.figures.study_dots import Column, dot_chart
from rdpm.studies.pictures import Picture, spread_rows, sweep_of
from rdpm.studies.results import StudyResults

__all__ = ["draw_models"]

#: Measures of a pair, and of a rebound from a wall: factor and label.
_PAIR = (
    ("kiss_time_s", 1.0, "first kiss\n[s]"), ("tumble_start_s", 1.0, "tumble\n[s]"),
    ("gap_kiss_total_s", 1.0, "gap below 2 % d\n[s]"), ("min_gap_fraction", 100.0, "smallest gap\n[% d]"),
    ("final_angle_deg", 1.0, "angle at the end\n[deg]"),
)  # fmt: skip
_WALL = (
    ("wet_restitution", 1.0, "restitution\n[-]"), ("rebound_height_m", 1e3, "rebound height\n[mm]"),
    ("max_overlap_fraction", 100.0, "largest overlap\n[% d]"),
    ("first_contact_duration_s", 1e3, "first contact\n[ms]"),
)  # fmt: skip
_LUBRICATED = "-lubricated"  # how the run with lubrication is named beside the one without


def draw_models(results: StudyResults, folder: Path) -> list[Picture]:
    """Measures of each run beside each other, without lubrication and with it."""
    sweep = sweep_of(results)
    is_wall = np.isfinite(sweep.column("wet_restitution")).any()
    names = list(dict.fromkeys(str(row["run"]).removesuffix(_LUBRICATED) for row in sweep.rows))
    columns = []
    for quantity, factor, label in _WALL if is_wall else _PAIR:
        values = dict(zip((str(row["run"]) for row in sweep.rows), factor * sweep.column(quantity), strict=True))
        if not np.isfinite(list(values.values())).any():
            continue
        spread = spread_rows(results, quantity)
        width = factor * spread.half_width if spread is not None and spread.scale == "linear" else np.nan
        columns.append(Column(
            label, np.array([values.get(name, np.nan) for name in names]),
            np.array([values.get(name + _LUBRICATED, np.nan) for name in names]),
            float(width) if np.isfinite(width) else 0.0,
        ))  # fmt: skip
    if not columns:
        raise ValueError("no run has any of the measures")
    labels = [name.replace("contact_steps-", "soft sphere, N_c = ").replace("-", " ") for name in names]
    caption = f"{sweep.about(sweep.runs()[0])} Bands: spread that numerics alone give, about the first run."
    path = dot_chart(
        folder / "models.png", labels, columns, ("no lubrication", "with lubrication"), "Contact models", caption
    )
    return [Picture(path, "What the contact model changes; a run without a point has no such event.")]
