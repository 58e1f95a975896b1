"""Drafting, kissing and tumbling of two spheres: phases of a run's summary, and the numbers that studies compare."""

from __future__ import annotations

from rdpm.results.dkt.geometry import line_of_centres, pair_gap
from rdpm.results.dkt.numbers import DktNumbers, Kiss, contact_kisses, gap_kisses, pair_numbers
from rdpm.results.dkt.pair_phases import KISS_GAP, TUMBLE_ANGLE, DktPhases, from_particles_table, phases

__all__ = [
    "KISS_GAP",
    "TUMBLE_ANGLE",
    "DktNumbers",
    "DktPhases",
    "Kiss",
    "contact_kisses",
    "from_particles_table",
    "gap_kisses",
    "line_of_centres",
    "pair_gap",
    "pair_numbers",
    "phases",
]
