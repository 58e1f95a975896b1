"""One call from restitution and duration to a judged contact of the adaptive collision time model."""

from __future__ import annotations

from dataclasses import dataclass

from rdpm.design._checks import Ending, positive
from rdpm.design.adaptive import adaptive_collision, adaptive_overlap, adaptive_stiffness
from rdpm.design.bodies import read_impact, read_pair
from rdpm.design.report import Row, render_rows
from rdpm.design.result import Verdict, _Record
from rdpm.design.verdicts import USUAL_OVERLAP, verdict_list
from rdpm.errors import CaseError

__all__ = ["AdaptiveDesign", "adaptive_design"]


@dataclass(frozen=True)
class AdaptiveDesign(_Record):
    """A designed contact of the adaptive collision time model. Attributes carry their unit; None where unknown.

    Examples
    --------
    >>> d = adaptive_design(diameter=0.01, density=2500.0, restitution=0.8, contact_time=1e-3, impact_speed=0.1)
    >>> round(100 * d.max_overlap_fraction, 3)   # [% d]
    0.33
    """

    stiffness_N_m32: float  # noqa: N815
    """k of the force k overlap^1.5 at the impact speed [N/m^1.5]."""
    linear_damping_N_s_m: float  # noqa: N815
    """d of the force d d(overlap)/dt [N s/m]."""
    restitution: float
    ending: Ending
    contact_time_s: float
    contact_steps: float | None
    time_step_s: float | None
    impact_speed_m_s: float
    least_speed_m_s: float | None
    reduced_mass_kg: float
    diameter_m: float
    """Of the smaller sphere."""
    is_wall: bool
    max_overlap_fraction: float
    overlap_limit_fraction: float
    verdicts: tuple[Verdict, ...]

    @property
    def ok(self) -> bool:
        """Whether no limit is broken."""
        return all(v.ok for v in self.verdicts)

    @property
    def stiffness_N_m(self) -> None:  # noqa: N802
        """None: the spring is not linear."""

    @property
    def damping_N_s_m(self) -> None:  # noqa: N802
        """None: it belongs to no linear spring."""

    def rows(self) -> list[Row]:
        """Quantity, value, unit and note of each line for a reader."""
        return [
            ("reduced mass", self.reduced_mass_kg, "kg", "m_ij = (1/m_i + 1/m_j)^-1"),
            ("restitution, dry", self.restitution, "", "e_n, at every speed"),
            ("contact time", self.contact_time_s, "s", "T_c, at every speed"),
            ("contact steps", self.contact_steps, "", "N_c = T_c/dt"),
            ("damping d", self.linear_damping_N_s_m, "N s/m", "of the force d d(overlap)/dt"),
            ("impact speed", self.impact_speed_m_s, "m/s", "of the two lines below"),
            ("stiffness k", self.stiffness_N_m32, "N/m^1.5", "goes with v^(-1/2)"),
            ("peak overlap", 100.0 * self.max_overlap_fraction, "% d", "goes with v"),
            ("least speed", self.least_speed_m_s, "m/s", "slower touches have its stiffness"),
        ]

    def __str__(self) -> str:
        return render_rows(f"Adaptive collision time, ending at {self.ending}", self.rows(), self.verdicts)


def adaptive_design(
    *,
    diameter: float,
    density: float,
    restitution: float,
    contact_time: float,
    diameter2: float | None = None,
    density2: float | None = None,
    wall: bool = False,
    impact_speed: float | None = None,
    least_speed: float | None = None,
    time_step: float | None = None,
    fluid_density: float | None = None,
    viscosity: float | None = None,
    gravity: float = 9.81,
    overlap_limit: float = USUAL_OVERLAP,
    ending: Ending = "zero-force",
) -> AdaptiveDesign:
    """Stiffness, damping and overlap of an impact, judged.

    Parameters
    ----------
    diameter, diameter2 : float, [m]
        > 0; equal spheres unless ``diameter2`` or ``wall`` is given.
    density, density2 : float, [kg/m^3]
        > 0; ``density2`` defaults to ``density``.
    restitution : float, [-]
        0.05 <= e_n <= 1.
    contact_time : float, [s]
        > 0.
    wall : bool
        The partner is a wall.
    impact_speed : float, [m/s], optional
        > 0; default the terminal velocity, where the fluid is known.
    least_speed : float, [m/s], optional
        Whose stiffness slower touches have.
    time_step : float, [s], optional
        > 0.
    fluid_density, viscosity : float, [kg/m^3], [Pa s], optional
        > 0.
    gravity : float, [m/s^2]
        >= 0.
    overlap_limit : float, [-]
        Bound of the overlap verdict, of the smaller diameter.
    ending : {"zero-force", "zero-overlap"}

    Returns
    -------
    AdaptiveDesign

    Raises
    ------
    CaseError
        A quantity outside its range, or no impact speed.

    Examples
    --------
    >>> d = adaptive_design(diameter=0.01, density=2500.0, restitution=0.8, contact_time=1e-3, impact_speed=0.1,
    ...                     time_step=1e-4)
    >>> round(d.contact_steps, 6), d.ok
    (10.0, True)
    """
    pair = read_pair(None, diameter, density, diameter2, density2, wall)
    impact = read_impact(pair, impact_speed, fluid_density, viscosity, gravity)
    if impact.speed is None:
        raise CaseError("impact_speed", None, "must be given", "the stiffness depends on it",
                        "Add impact_speed, or the fluid.")  # fmt: skip
    m, size, speed = float(pair.mass or 0.0), float(pair.diameter or 0.0), impact.speed
    k, d = adaptive_stiffness(m, restitution, contact_time, speed, ending)
    t_star = contact_time / adaptive_collision(restitution, ending)[1]
    overlap = adaptive_overlap(restitution, ending) * speed * t_star / size
    steps = None if time_step is None else contact_time / float(positive("time_step", time_step))
    verdicts = verdict_list(
        damping_ratio=0.0, ending=ending, contact_time=contact_time, contact_steps=steps, max_overlap=overlap,
        static_overlap=None, overlap_limit=overlap_limit, hertz_time=None, rayleigh_time=None, stokes_number=None,
        impact_speed=speed,
    )  # fmt: skip
    return AdaptiveDesign(
        stiffness_N_m32=k, linear_damping_N_s_m=d, restitution=restitution, ending=ending,
        contact_time_s=contact_time, contact_steps=steps, time_step_s=time_step, impact_speed_m_s=speed,
        least_speed_m_s=least_speed, reduced_mass_kg=m, diameter_m=size, is_wall=wall, max_overlap_fraction=overlap,
        overlap_limit_fraction=overlap_limit, verdicts=tuple(v for v in verdicts if v.name != "regime"),
    )  # fmt: skip
