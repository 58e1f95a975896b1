"""What a reader is told of the hard spheres of a case."""

from __future__ import annotations

from rdpm import design
from rdpm.config.case import Case
from rdpm.setup.contact import hard_sphere
from rdpm.setup.rows import PlanRow

__all__ = ["hard_sphere_rows"]

#: Contact steps of the soft sphere that a hard one is compared with.
COMPARED_STEPS = 8.0


def hard_sphere_rows(case: Case, dt: float, fall: float) -> list[PlanRow]:
    """What a case implies of its hard spheres, as lines for a reader.

    Parameters
    ----------
    case : Case
    dt : float, [s]
        Time step.
    fall : float, [m/s]
        Impact speed in the worst case; 0 where none is known.

    Returns
    -------
    list of PlanRow
    """
    law = hard_sphere(case)
    rows = [
        PlanRow("restitution e_n", f"{law.restitution:.4g}", "", "dry"),
        PlanRow("rest speed", f"{law.rest_speed:.4g} m/s", "", "slower contacts do not rebound"),
        PlanRow("most events", str(law.most_events), "", "of a pair in a step, after which it rests"),
        PlanRow("time step", "not limited by contacts", "", "collisions are found inside it"),
    ]
    if fall > 0.0 and law.restitution > 0.0:
        diameter = float(case.expanded_bodies().diameter.min())
        error = design.finite_contact_error(COMPARED_STEPS * dt, law.restitution, diameter, fall)
        rows.append(
            PlanRow(
                f"a soft sphere of {COMPARED_STEPS:g} steps",
                f"{100.0 * error.time_ratio:.3g} % of d / v in contact",
                "",
                f"would overlap by {100.0 * error.overlap:.3g} % of d and lag by {100.0 * error.lag:.3g} % of d",
            )
        )
    return rows
