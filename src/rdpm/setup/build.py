"""Case -> Simulation."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from rdpm.config.case import Case
from rdpm.contacts import Contacts, Lubrication
from rdpm.conventions import FACES
from rdpm.coupling.mean_flow import MeanFlow
from rdpm.coupling.step import System
from rdpm.fluid import Fluid
from rdpm.grid import Box, Grid
from rdpm.parallel.threads import available_threads
from rdpm.particles.markers import MarkerSet
from rdpm.particles.prescribed import Motion, Prescription
from rdpm.particles.rigid_motion import RigidMotion
from rdpm.particles.state import Bodies
from rdpm.setup.plan import Plan, plan
from rdpm.simulation import simulation

__all__ = ["FORCING_PASSES", "PAIR_FILM", "WALL_FILM", "Simulation", "film_model"]

#: Forcing passes a step. The third changes the settling speed by 0.14 %, a fourth by 0.05 % (case settling, 8 cells a
#: diameter); the slip falls to 0.48 and 0.66 of what it was.
FORCING_PASSES = 3

#: Gaps [cells] below which the film model enters, and at which the grid sees touching surfaces: read off the resolved
#: resistance in Stokes flow, of a sphere against a wall and of two, from 8 to 16 cells a diameter (docs/validation.md).
#: Of two spheres they grow as the reduced radius in cells to the 2/3, and are given for 8 cells a diameter.
WALL_FILM, PAIR_FILM, PAIR_FILM_RADIUS = (1.5, 0.28), (0.31, 0.19), 2.0



class Simulation(simulation.Simulation):
    """A case made ready to run.

    Parameters
    ----------
    case : Case
        From `rdpm.load_case`.
    threads : int, optional
        All processors, or OMP_NUM_THREADS, when left out.

    Raises
    ------
    CaseError
        The case cannot run on this machine or with this time step.

    Examples
    --------
    >>> import rdpm
    >>> case = rdpm.load_case("settling", ["resolution.cells_per_diameter=4", "domain.size=['6 cm', '6 cm', '16 cm']",
    ...                                    "bodies[0].centers=[['3 cm', '3 cm', '12 cm']]"])
    >>> sim = rdpm.Simulation(case)
    >>> sim.run(until=0.02)
    >>> bool(sim.bodies.velocity[0, 2] < 0)
    True
    """

    def __init__(self, case: Case, threads: int | None = None) -> None:
        self.plan: Plan = plan(case)
        self.case = case
        super().__init__(_system(self.plan, threads or available_threads()), self.plan.step.dt)


def _system(made: Plan, threads: int) -> System:
    case = made.case
    table = case.expanded_bodies()
    bodies = Bodies(table.diameter, table.density, table.position, table.velocity, table.angular_velocity)
    for number, group in enumerate(case.bodies):
        if group.orientation_seed is not None:
            members = np.flatnonzero(table.group == number)
            bodies.turn_at_random(members, group.orientation_seed)
    prescription = Prescription(_motions(table.motion))
    prescription.hold(bodies, 0.0, 0.0)
    domain = case.domain
    wall_velocity = np.array([getattr(domain.wall_velocity, face) or (0.0, 0.0, 0.0) for face in FACES])
    x, y, z = domain.size
    box = Box((x, y, z), domain.kinds, wall_velocity)
    gravity = np.array(domain.gravity)
    fluid = case.fluid
    if fluid is None or made.cells is None:
        contacts = _contacts(made, bodies, box, None)
        held = np.concatenate([bodies.mass[:, None] * gravity, np.zeros((len(bodies), 3))], axis=1)
        return System(bodies, contacts, prescription, held)
    grid = Grid(box, made.cells, threads)
    flow = Fluid(grid, fluid.density, fluid.nu, made.step.is_explicit)
    flow.set_velocity(*fluid.initial_velocity)
    film = None
    if case.contact.lubrication and len(bodies):
        film = film_model(fluid.mu, float(np.cbrt(np.prod(grid.spacing))), case.contact.lubrication_roughness)
    contacts = _contacts(made, bodies, box, film)
    markers = motion = None
    held = np.zeros((len(bodies), 6))
    if len(bodies):
        markers = MarkerSet(bodies, grid)
        motion = RigidMotion(bodies, flow, markers, gravity, FORCING_PASSES)
        markers.place(bodies)
        motion.begin()
        # Until the flow answers, weight less buoyancy moves body and added mass.
        answer = motion.contact_inertia[0] / (bodies.mass + 0.5 * motion.fluid_mass)
        held[:, :3] = answer[:, None] * motion.weight
    drive = (
        np.array(fluid.body_force or (0.0, 0.0, 0.0))
        - np.array(fluid.pressure_gradient or (0.0, 0.0, 0.0)) / fluid.density
    )
    mean_flow = MeanFlow(drive, case.zero_mean_flow, fluid.density * grid.volume, np.array(fluid.initial_velocity))
    return System(bodies, contacts, prescription, held, flow, markers, motion, mean_flow)


def film_model(viscosity: float, h: float, roughness: float = 1e-3) -> Lubrication:
    """What the grid misses of squeeze films.

    Parameters
    ----------
    viscosity : float, [Pa s]
    h : float, [m]
        Mean spacing of the grid.
    roughness : float, [-]
        Smallest gap over the smaller radius.
    """
    return Lubrication(
        viscosity,
        WALL_FILM[0] * h,
        roughness,
        WALL_FILM[1] * h,
        PAIR_FILM[0] * h,
        PAIR_FILM[1] * h,
        PAIR_FILM_RADIUS * h,
    )


def _contacts(made: Plan, bodies: Bodies, box: Box, film: Lubrication | None) -> Contacts:
    contact, fluid = made.case.contact, made.case.fluid
    more: dict[str, Any] = {"viscosity": fluid.mu} if fluid else {}
    times = [pair.design.contact_time_s for pair in made.pairs if pair.design.contact_time_s is not None]
    if contact.substeps is not None and times:
        more["substeps_per_contact"] = max(10, math.ceil(contact.substeps * min(times) / made.step.dt))
    return Contacts(bodies, box, made.law, film, overlap_limit=contact.overlap_limit, **more)


def _motions(given: tuple[Any, ...]) -> dict[int, Motion]:
    motions = {}
    for body, motion in enumerate(given):
        if motion == "free":
            continue
        if motion == "fixed":
            motions[body] = Motion(np.zeros(1), np.zeros((1, 3)), np.zeros((1, 3)))
            continue
        tables = [np.array(getattr(course, "times", (0.0,))) for course in (motion.velocity, motion.rotation)]
        times = np.unique(np.concatenate(tables))
        until = motion.until
        motions[body] = Motion(
            times,
            np.array([motion.velocity_at(t) for t in times]),
            np.array([motion.rotation_at(t) for t in times]),
            until=until if isinstance(until, float) else math.inf,
            until_gap=until.gap if until is not None and not isinstance(until, float) else -math.inf,
        )
    return motions
