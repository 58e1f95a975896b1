"""One call from a material to a judged Hertz contact."""

from __future__ import annotations

import math
from dataclasses import dataclass

from rdpm.design._checks import Ending, check_ending, positive
from rdpm.design.bodies import read_impact, read_pair
from rdpm.design.hertz import effective_modulus, rayleigh_time
from rdpm.design.hertz_contact import hertz_damping, hertz_duration, hertz_peak_overlap, hertz_stiffness
from rdpm.design.report import Row, render_rows
from rdpm.design.result import Verdict, _Record
from rdpm.design.verdicts import LEAST_CONTACT_STEPS, USUAL_OVERLAP, verdict_list
from rdpm.errors import CaseError

__all__ = ["HertzDesign", "hertz_design"]


@dataclass(frozen=True)
class HertzDesign(_Record):
    """A designed Hertz contact. Attributes carry their unit; None where unknown.

    Examples
    --------
    >>> d = hertz_design(diameter=0.01, density=2500.0, youngs_modulus=1e7, poisson_ratio=0.3, restitution=0.8,
    ...                  impact_speed=0.1)
    >>> round(d.contact_time_s * 1e3, 3), round(100 * d.max_overlap_fraction, 2)   # [ms], [% d]
    (1.533, 0.5)
    """

    stiffness_N_m32: float  # noqa: N815
    """k of the force k overlap^1.5 [N/m^1.5]."""
    damping_N_s_m54: float  # noqa: N815
    """eta of the force eta overlap^0.25 d(overlap)/dt [N s/m^1.25]."""
    restitution: float
    damping_ratio: float
    ending: Ending
    contact_time_s: float
    contact_steps: float | None
    time_step_s: float | None
    largest_time_step_s: float
    """At the fewest contact steps allowed."""
    impact_speed_m_s: float
    impact_speed_source: str
    reduced_mass_kg: float
    reduced_radius_m: float
    effective_modulus_Pa: float  # noqa: N815
    diameter_m: float
    """Of the smaller sphere."""
    is_wall: bool
    max_overlap_m: float
    max_overlap_fraction: float
    static_overlap_fraction: float | None
    overlap_limit_fraction: float
    rayleigh_time_s: float
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
        """None: the dashpot is not linear."""

    def rows(self) -> list[Row]:
        """Quantity, value, unit and note of each line for a reader."""
        return [
            ("reduced mass", self.reduced_mass_kg, "kg", "m_ij = (1/m_i + 1/m_j)^-1"),
            ("effective modulus", self.effective_modulus_Pa, "Pa", "E* = E/(2 (1 - sigma^2)): walls too"),
            ("stiffness k", self.stiffness_N_m32, "N/m^1.5", "4/3 E* sqrt(R*)"),
            ("damping eta", self.damping_N_s_m54, "N s/m^1.25", "sqrt(5 m_ij k) zeta(e_n)"),
            ("restitution, dry", self.restitution, "", "e_n, at every speed"),
            ("impact speed", self.impact_speed_m_s, "m/s", self.impact_speed_source),
            ("contact time", self.contact_time_s, "s", "t_c at this speed, goes with v^(-1/5)"),
            ("contact steps", self.contact_steps, "", "N_c = t_c/dt"),
            ("time step", self.time_step_s, "s", "dt"),
            ("largest time step", self.largest_time_step_s, "s", f"{LEAST_CONTACT_STEPS} steps a contact"),
            ("peak overlap", 100.0 * self.max_overlap_fraction, "% d", "at this speed, goes with v^(4/5)"),
            ("static overlap", _percent(self.static_overlap_fraction), "% d", "under the submerged weight"),
            ("Rayleigh time", self.rayleigh_time_s, "s", "of the surface waves"),
        ]

    def __str__(self) -> str:
        return render_rows(f"Hertz contact, ending at {self.ending}", self.rows(), self.verdicts)


def _percent(fraction: float | None) -> float | None:
    return None if fraction is None else 100.0 * fraction


def hertz_design(
    *,
    diameter: float,
    density: float,
    youngs_modulus: float,
    poisson_ratio: float,
    restitution: float,
    diameter2: float | None = None,
    density2: float | None = None,
    wall: bool = False,
    impact_speed: float | None = None,
    impact_speed_source: str = "given",
    time_step: float | None = None,
    fluid_density: float | None = None,
    viscosity: float | None = None,
    gravity: float = 9.81,
    overlap_limit: float = USUAL_OVERLAP,
    ending: Ending = "zero-force",
) -> HertzDesign:
    """Design a Hertz contact from a material and an impact speed, and judge it.

    Parameters
    ----------
    diameter, diameter2 : float, [m]
        > 0; equal spheres unless ``diameter2`` or ``wall`` is given.
    density, density2 : float, [kg/m^3]
        > 0; ``density2`` defaults to ``density``.
    youngs_modulus : float, [Pa]
        Of both bodies and of walls, > 0; softened at will.
    poisson_ratio : float, [-]
        -1 < sigma <= 0.5.
    restitution : float, [-]
        0 < e_n <= 1.
    wall : bool
        The partner is a wall of the same material.
    impact_speed : float, [m/s], optional
        > 0; default the terminal velocity, where the fluid is known.
    impact_speed_source : str
        Where a given speed comes from, for the reader.
    time_step : float, [s], optional
        > 0.
    fluid_density, viscosity : float, [kg/m^3], [Pa s], optional
        > 0.
    gravity : float, [m/s^2]
        >= 0.
    overlap_limit : float, [-]
        Bound of the overlap verdicts, of the smaller diameter.
    ending : {"zero-force", "zero-overlap"}

    Returns
    -------
    HertzDesign

    Raises
    ------
    CaseError
        A quantity outside its range, or no impact speed.

    References
    ----------
    .. [1] Antypov, Elliott, EPL 94 (2011) 50004, doi:10.1209/0295-5075/94/50004.

    Examples
    --------
    >>> d = hertz_design(diameter=0.02, density=2800.0, youngs_modulus=4.8e10, poisson_ratio=0.2, restitution=1.0,
    ...                  impact_speed=20.0)
    >>> round(d.contact_time_s * 1e6, 2), round(d.max_overlap_m * 1e6, 2)   # [us], [um]
    (40.34, 274.11)
    """
    check_ending(ending)
    pair = read_pair(None, diameter, density, diameter2, density2, wall)
    impact = read_impact(pair, impact_speed, fluid_density, viscosity, gravity)
    if impact.speed is None:
        raise CaseError("impact_speed", None, "must be given", "a Hertz contact's duration and overlap depend on it",
                        "Add impact_speed, or the fluid.")  # fmt: skip
    m, radius, d, v = float(pair.mass or 0.0), float(pair.radius or 0.0), float(pair.diameter or 0.0), impact.speed
    modulus = float(effective_modulus(youngs_modulus, poisson_ratio))
    k = float(hertz_stiffness(radius, modulus))
    duration = float(hertz_duration(m, k, v, restitution, ending))
    eta = float(hertz_damping(m, k, restitution, ending))
    zeta = eta / math.sqrt(5.0 * m * k)
    steps = None if time_step is None else duration / float(positive("time_step", time_step))
    overlap = float(hertz_peak_overlap(m, k, v, eta))
    sink = None if not impact.weight else (impact.weight / k) ** (2.0 / 3.0) / d
    rayleigh = min(float(rayleigh_time(0.5 * size, rho, youngs_modulus, poisson_ratio)) for size, rho in pair.spheres)
    source = str(impact.source) if impact_speed is None else impact_speed_source
    verdicts = verdict_list(
        damping_ratio=zeta, ending=ending, contact_time=duration, contact_steps=steps, max_overlap=overlap / d,
        static_overlap=sink, overlap_limit=overlap_limit, hertz_time=None, rayleigh_time=rayleigh,
        stokes_number=None, impact_speed=v,
    )  # fmt: skip
    return HertzDesign(
        stiffness_N_m32=k, damping_N_s_m54=eta, restitution=float(restitution), damping_ratio=zeta, ending=ending,
        contact_time_s=duration, contact_steps=steps, time_step_s=time_step,
        largest_time_step_s=duration / LEAST_CONTACT_STEPS, impact_speed_m_s=v,
        impact_speed_source=source, reduced_mass_kg=m, reduced_radius_m=radius,
        effective_modulus_Pa=modulus, diameter_m=d, is_wall=wall, max_overlap_m=overlap,
        max_overlap_fraction=overlap / d, static_overlap_fraction=sink, overlap_limit_fraction=overlap_limit,
        rayleigh_time_s=rayleigh, verdicts=verdicts,
    )  # fmt: skip
