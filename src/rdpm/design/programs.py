"""Other programs: how each steps a contact and ends it, the time step it needs, a run that shows the contact."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

from rdpm.design._checks import Ending
from rdpm.design.dimensionless import reduced_mass, sphere_mass
from rdpm.design.integrators import ProducedRestitution, fewest_steps, produced_restitution
from rdpm.design.oscillator import dimensionless_contact_time, peak_overlap_factor, restitution
from rdpm.design.result import Body, Design
from rdpm.design.wording import time_text
from rdpm.errors import CaseError

__all__ = ["PROGRAMS", "Program", "Spring", "StepThere", "Trial", "step_lines", "step_there", "steps_there", "trial"]

_ASSUMED_DENSITY = 2500.0  # of spheres that are not known [kg/m^3]


class Program(NamedTuple):
    """What matters of a program."""

    title: str
    ending: Ending | None
    """When a contact is over there; None where an option decides, and the design's end is kept."""
    tried: str
    """What of the fragment was run, and what only read."""
    integrator: str = "semi-implicit-euler"


PROGRAMS = {
    "lammps": Program("LAMMPS", None, "Run with LAMMPS 22Jul2025: pair and wall give the restitution below."),
    "liggghts": Program("LIGGGHTS", None, "Run with LIGGGHTS-PUBLIC 3.8.0: pair and wall give the restitution below."),
    "mfix": Program("MFIX-DEM", "zero-overlap", "Not run; read against the user guide and published sources of MFiX."),
    "yade": Program("YADE", "zero-force", "Run with YADE 2023.02a: pair and wall give the restitution below."),
    "mercurydpm": Program(
        "MercuryDPM", "zero-overlap", "Not run; read against the documentation and drivers of MercuryDPM."
    ),
}
"""Names that :func:`rdpm.design.export.export` knows. All step velocities first, with the forces at the positions
before, then positions: in half-step velocities that is semi-implicit Euler, velocity Verlet and leapfrog alike."""


@dataclass(frozen=True)
class StepThere:
    """A design in another program.

    Examples
    --------
    >>> from rdpm.design import soft_sphere
    >>> there = step_there(soft_sphere(mass=1e-3, restitution=0.5, contact_time=8e-3), "mfix")
    >>> there.ending, round(there.restitution, 3), there.contact_steps
    ('zero-overlap', 0.436, 50)
    """

    program: str
    ending: Ending
    restitution: float
    """In exact time, as a contact ends there [-]."""
    contact_time: float
    """[s]."""
    contact_steps: int
    time_step: float
    """[s]."""
    achieved: ProducedRestitution


def step_there(design: Design, program: str) -> StepThere | None:
    """Give the time step that another program needs for this spring, and what it makes of the contact.

    Parameters
    ----------
    design : Design
    program : str
        One of ``PROGRAMS``.

    Returns
    -------
    StepThere or None
        None where the contact never ends there.
    """
    known = PROGRAMS[program]
    ending = known.ending or design.ending
    tau = float(dimensionless_contact_time(design.damping_ratio, ending))
    e = float(restitution(design.damping_ratio, ending))
    if not (math.isfinite(tau) and e > 0.0):
        return None
    e = design.restitution if ending == design.ending and design.restitution else e
    steps = fewest_steps(e, known.integrator, ending)
    t_c = tau * math.sqrt(design.reduced_mass_kg / design.stiffness_N_m)
    achieved = produced_restitution(e, steps, known.integrator, ending)
    return StepThere(program, ending, e, t_c, steps, t_c / steps, achieved)


def steps_there(design: Design) -> dict[str, dict[str, Any] | None]:
    """Give the time step of this spring in every other program as plain types, null where the contact never ends there.

    Examples
    --------
    >>> from rdpm.design import soft_sphere
    >>> steps_there(soft_sphere(mass=1e-3, restitution=0.5, contact_time=8e-3))["yade"]["contact_steps"]
    50
    """
    found = {name: step_there(design, name) for name in PROGRAMS}
    return {
        name: None if there is None else {
            "ending": there.ending, "restitution": there.restitution, "contact_time_s": there.contact_time,
            "contact_steps": there.contact_steps, "time_step_s": there.time_step,
            "achieved_restitution": there.achieved._asdict(),
        }
        for name, there in found.items()
    }  # fmt: skip


def step_lines(design: Design) -> list[str]:
    """Say the time step of this spring in every other program, a line each.

    Examples
    --------
    >>> from rdpm.design import soft_sphere
    >>> print(step_lines(soft_sphere(mass=1e-3, restitution=0.5, contact_time=8e-3))[2])
    MFIX-DEM    dt = 191 us     (50 steps); e_n 0.433 (0.427 to 0.442): it ends a contact at zero-overlap
    """
    lines = []
    for name, program in PROGRAMS.items():
        there = step_there(design, name)
        if there is None:
            lines.append(f"{program.title:<12}the contact never ends there")
            continue
        e = there.achieved
        line = f"{program.title:<12}dt = {time_text(there.time_step):<11}({there.contact_steps} steps); "
        line += f"e_n {e.mean:.3f} ({e.least:.3f} to {e.greatest:.3f})"
        differs = there.ending != design.ending
        lines.append(line + (f": it ends a contact at {there.ending}" if differs else ""))
    return lines


class Spring(NamedTuple):
    """Stiffness and damping, normal and tangential, of one kind of contact [N/m], [N s/m]."""

    normal_stiffness: float
    normal_damping: float
    tangential_stiffness: float
    tangential_damping: float


@dataclass(frozen=True)
class Trial:
    """Two spheres that meet head-on, the second of which then meets a wall: the run that shows a contact elsewhere.

    Attributes
    ----------
    there : StepThere
    spheres : tuple of Body
    is_assumed : bool
        The spheres' size or density is not the design's.
    pair : Spring
        Of the two spheres.
    walls : tuple of Spring
        Of each sphere and a wall. Stiffness and damping go with the reduced mass, so that contact time, restitution and
        overlap are the pair's.
    speeds : tuple of float, [m/s]
        Along x at the start; their difference is the impact speed.
    places : tuple of float, [m]
        Centres along x at the start, half a step from touch.
    wall : float, [m]
        Where the wall stands, reached half a contact time after the spheres have parted.
    steps : tuple of int
        Until the spheres have parted, and from there until the second has left the wall.
    """

    there: StepThere
    spheres: tuple[Body, Body]
    is_assumed: bool
    pair: Spring
    walls: tuple[Spring, Spring]
    speeds: tuple[float, float]
    places: tuple[float, float]
    wall: float
    steps: tuple[int, int]

    @property
    def impact_speed(self) -> float:
        """[m/s]."""
        return self.speeds[0] - self.speeds[1]


def trial(design: Design, program: str) -> Trial:
    """Lay out the run of two spheres and a wall.

    Parameters
    ----------
    design : Design
    program : str
        One of ``PROGRAMS``.

    Returns
    -------
    Trial

    Raises
    ------
    CaseError
        The contact never ends there.

    Examples
    --------
    >>> from rdpm.design import soft_sphere
    >>> t = trial(soft_sphere(mass=1e-3, stiffness=100.0, restitution=0.8), "lammps")
    >>> round(t.walls[1].normal_stiffness), t.is_assumed
    (200, True)
    """
    there = step_there(design, program)
    if there is None:
        reason = f"{PROGRAMS[program].title} ends a contact at zero overlap, and there is no such end"
        cure = 'Lower the damping, or end the contact at "zero-force".'
        raise CaseError("export", program, "needs a damping ratio below 1", reason, cure)
    spheres, is_assumed = _spheres(design)
    m = [float(sphere_mass(s.diameter_m, s.density_kg_m3)) for s in spheres]
    pair_mass = float(reduced_mass(*m))
    v = design.impact_speed_m_s or _gentle_speed(design, min(s.diameter_m for s in spheres))
    speeds = (v * m[1] / sum(m), -v * m[0] / sum(m))
    touch = 0.5 * v * there.time_step
    places = (-0.5 * spheres[0].diameter_m, 0.5 * spheres[1].diameter_m + touch)
    rebound = there.restitution * -speeds[1]
    wall = places[1] + 0.5 * spheres[1].diameter_m + 0.5 * there.contact_time * rebound
    # at zero force the spheres part a little later than their contact ends: 2 zeta/omega_0
    zeta, lag = design.damping_ratio, 0.0
    if there.ending == "zero-force":
        lag = 2.0 * zeta / float(dimensionless_contact_time(zeta, there.ending))
    n = there.contact_steps
    steps = (math.ceil((1.25 + lag) * n), math.ceil(1.75 * n))
    walls = (_spring(design, m[0]), _spring(design, m[1]))
    return Trial(there, spheres, is_assumed, _spring(design, pair_mass), walls, speeds, places, wall, steps)


def _spring(design: Design, mass: float) -> Spring:
    """Give the spring of a contact with another reduced mass: it lasts as long."""
    f, t = mass / design.reduced_mass_kg, design.tangential
    return Spring(
        f * design.stiffness_N_m, f * design.damping_N_s_m, f * t.stiffness_N_m, f * t.damping_N_s_m
    )


def _spheres(design: Design) -> tuple[tuple[Body, Body], bool]:
    """Give two spheres: the design's, a pair of the one that meets a wall, or such as have its reduced mass."""
    if design.spheres:
        return (design.spheres[0], design.spheres[-1]), False
    mass = design.reduced_mass_kg * (1.0 if design.is_wall else 2.0)
    d = design.diameter_m or (6.0 * mass / (math.pi * _ASSUMED_DENSITY)) ** (1.0 / 3.0)
    one = Body(d, mass / float(sphere_mass(d, 1.0)))
    return (one, one), True


def _gentle_speed(design: Design, diameter: float) -> float:
    """Give the impact speed of an overlap of 0.1 % d."""
    omega = math.sqrt(design.stiffness_N_m / design.reduced_mass_kg)
    return 1e-3 * diameter * omega / float(peak_overlap_factor(design.damping_ratio))
