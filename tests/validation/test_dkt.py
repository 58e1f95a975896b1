"""Two spheres draft, kiss and tumble; at 6 cells a diameter, where two close surfaces share their cells for long."""

import numpy as np
import pytest

import rdpm
from rdpm.results.dkt import phases


@pytest.mark.slow
def test_the_pair_drafts_kisses_and_tumbles_in_that_order() -> None:
    case = rdpm.load_case("dkt", ["resolution.cells_per_diameter=6", "time.end=3.2"])
    sim = rdpm.Simulation(case)
    rows = [(0.0, sim.bodies.position.copy())]
    sim.on_step(lambda s: rows.append((s.time, s.bodies.position.copy())), every=5)
    sim.run(until=3.2)
    time, position = np.array([t for t, _ in rows]), np.array([x for _, x in rows])
    found = phases(
        time, position[:, 0], position[:, 1], 0.015, 0.015, (0, 0, -9.81), sim.plan.pairs[0].design.contact_time_s
    )
    assert found.drafting_time_s is not None
    assert found.kiss_time_s is not None
    assert found.tumble_time_s is not None
    assert 0.0 <= found.drafting_time_s < found.kiss_time_s < found.tumble_time_s
    # Kiss at 1.58 s, past 45 degrees at 2.74 s were measured; at 8 cells 1.46 and 2.68 s.
    assert 1.4 < found.kiss_time_s < 1.8
    assert 2.3 < found.tumble_time_s < 3.1
    # Up to round-off that tumbling magnifies, the pair stays in the plane of its offset.
    assert np.abs(position[:, :, 1] - 0.05).max() < 1e-6
    gap = np.linalg.norm(position[:, 0] - position[:, 1], axis=1) / 0.015 - 1.0
    assert gap.min() > -0.02
