"""What a hard sphere spares: the error of a soft one at given contact steps, judged."""

from __future__ import annotations

from dataclasses import dataclass

from rdpm.design._checks import Ending, check_ending, positive
from rdpm.design.bodies import read_impact, read_pair
from rdpm.design.dimensionless import stokes_number
from rdpm.design.hard_sphere import finite_contact_error
from rdpm.design.report import Row, render_rows
from rdpm.design.result import _Record
from rdpm.errors import CaseError

__all__ = ["COMPARED_STEPS", "HardSphereDesign", "hard_sphere_design"]

#: Contact steps of the soft sphere that a hard one is compared with, where none are given.
COMPARED_STEPS = 8.0


@dataclass(frozen=True)
class HardSphereDesign(_Record):
    """A hard sphere against a soft one of N_c steps. Attributes carry their unit; None where unknown.

    Examples
    --------
    >>> d = hard_sphere_design(diameter=0.01, density=2500.0, restitution=0.9, impact_speed=0.1, time_step=1e-4)
    >>> round(100 * d.soft_overlap_fraction, 2), round(100 * d.soft_lag_fraction, 2)   # [% d]
    (0.25, 0.74)
    """

    restitution: float
    impact_speed_m_s: float
    reduced_mass_kg: float
    diameter_m: float
    """Of the smaller sphere."""
    is_wall: bool
    stokes_number: float | None
    contact_steps: float
    """Of the soft sphere it is compared with."""
    time_step_s: float
    ending: Ending
    soft_contact_time_s: float
    soft_time_fraction: float
    """Of the time d/v."""
    soft_overlap_fraction: float
    soft_lag_fraction: float

    def rows(self) -> list[Row]:
        """Quantity, value, unit and note of each line for a reader."""
        return [
            ("reduced mass", self.reduced_mass_kg, "kg", "m_ij = (1/m_i + 1/m_j)^-1"),
            ("restitution, dry", self.restitution, "", "e_n, exact at every speed"),
            ("impact speed", self.impact_speed_m_s, "m/s", ""),
            ("Stokes number", self.stokes_number, "", "of the impact"),
            ("contact steps", self.contact_steps, "", "N_c of the soft sphere of the lines below"),
            ("contact time", self.soft_contact_time_s, "s", "t_c = N_c dt; a hard sphere's is 0"),
            ("in contact", 100.0 * self.soft_time_fraction, "% d/v", "t_c over the time to cross a diameter"),
            ("peak overlap", 100.0 * self.soft_overlap_fraction, "% d", "a hard sphere has none"),
            ("lag", 100.0 * self.soft_lag_fraction, "% d", "it is behind the hard sphere after the rebound"),
        ]

    def __str__(self) -> str:
        title = f"A hard sphere, and the error of a soft one of {self.contact_steps:g} steps, ending at {self.ending}"
        return render_rows(title, self.rows(), ())


def hard_sphere_design(
    *,
    diameter: float,
    density: float,
    restitution: float,
    time_step: float,
    contact_steps: float = COMPARED_STEPS,
    diameter2: float | None = None,
    density2: float | None = None,
    wall: bool = False,
    impact_speed: float | None = None,
    fluid_density: float | None = None,
    viscosity: float | None = None,
    gravity: float = 9.81,
    ending: Ending = "zero-force",
) -> HardSphereDesign:
    """Compare a hard sphere with a soft one of a finite contact time.

    Parameters
    ----------
    diameter, diameter2 : float, [m]
        > 0; equal spheres unless ``diameter2`` or ``wall`` is given.
    density, density2 : float, [kg/m^3]
        > 0; ``density2`` defaults to ``density``.
    restitution : float, [-]
        Dry, 0 < e_n <= 1.
    time_step : float, [s]
        > 0.
    contact_steps : float, [-]
        Of the soft sphere, > 0.
    wall : bool
        The partner is a wall.
    impact_speed : float, [m/s], optional
        > 0; default the terminal velocity, where the fluid is known.
    fluid_density, viscosity : float, [kg/m^3], [Pa s], optional
        > 0.
    gravity : float, [m/s^2]
        >= 0.
    ending : {"zero-force", "zero-overlap"}
        Of the soft sphere.

    Returns
    -------
    HardSphereDesign

    Raises
    ------
    CaseError
        A quantity outside its range, or no impact speed.

    Examples
    --------
    >>> small, large = (hard_sphere_design(diameter=0.01, density=2500.0, restitution=0.9, impact_speed=0.1,
    ...                                    time_step=1e-4, contact_steps=n) for n in (8, 16))
    >>> round(large.soft_lag_fraction / small.soft_lag_fraction, 6)   # the error is proportional to N_c dt
    2.0
    """
    check_ending(ending)
    pair = read_pair(None, diameter, density, diameter2, density2, wall)
    impact = read_impact(pair, impact_speed, fluid_density, viscosity, gravity)
    if impact.speed is None:
        raise CaseError("impact_speed", None, "must be given", "overlap and lag go with it",
                        "Add impact_speed, or the fluid.")  # fmt: skip
    m, radius, size = (float(value or 0.0) for value in (pair.mass, pair.radius, pair.diameter))
    speed = impact.speed
    time = float(positive("contact_steps", contact_steps)) * float(positive("time_step", time_step))
    error = finite_contact_error(time, restitution, size, speed, ending)
    wet = None if viscosity is None else float(stokes_number(m, radius, speed, viscosity))
    return HardSphereDesign(
        restitution=restitution, impact_speed_m_s=speed, reduced_mass_kg=m, diameter_m=size, is_wall=wall,
        stokes_number=wet, contact_steps=contact_steps, time_step_s=time_step, ending=ending,
        soft_contact_time_s=time, soft_time_fraction=error.time_ratio, soft_overlap_fraction=error.overlap,
        soft_lag_fraction=error.lag,
    )  # fmt: skip
