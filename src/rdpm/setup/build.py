"""Case -> Simulation."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any, Self

import numpy as np

from rdpm.config.case import Case
from rdpm.config.declared import Quantity
from rdpm.config.load import load_case
from rdpm.config.rule import RuleError
from rdpm.contacts import Contacts, Lubrication, TangentialLubrication
from rdpm.coupling.mean_flow import MeanFlow
from rdpm.coupling.system import System
from rdpm.errors import CaseError
from rdpm.fluid import Fluid
from rdpm.grid import Box, Grid
from rdpm.parallel.ranks import Ranks, world
from rdpm.parallel.threads import available_threads
from rdpm.particles.calibration import CALIBRATION, Calibration
from rdpm.particles.immersed import ImmersedBodies
from rdpm.particles.prescribed import Motion, Prescription
from rdpm.particles.shared import SharedBodies
from rdpm.particles.state import Bodies
from rdpm.setup.inflow import inflow_of
from rdpm.setup.on_ranks import bodies_of, slab_of
from rdpm.setup.plan import Plan, plan
from rdpm.simulation.record import Record
from rdpm.simulation.time_loop import TimeLoop

__all__ = ["Simulation", "interval_of", "lubrication_correction"]


class Simulation(TimeLoop):
    """A case made ready to run.

    Parameters
    ----------
    case : Case, str, Path or dict
        From `rdpm.load_case`, or what that takes.
    threads : int, optional
        All processors, or OMP_NUM_THREADS, when left out.
    calibration : Calibration, optional
        Other fitted numbers than those rdpm was validated with.
    contact_step : float, optional, [s]
        Step that the contacts' parameters are tied to, where adaptive steps continue those of another run.
    ranks : Ranks, optional
        That share the box; those that a launcher started when left out.

    Attributes
    ----------
    plan : Plan
        What the case implied.

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

    def __init__(
        self,
        case: Case | str | Path | dict[str, Any],
        threads: int | None = None,
        calibration: Calibration = CALIBRATION,
        contact_step: float | None = None,
        ranks: Ranks | None = None,
    ) -> None:
        self.case = case if isinstance(case, Case) else load_case(case)
        self.plan = plan(self.case, contact_step)
        ranks = world() if ranks is None else ranks
        system = _system(self.plan, threads or available_threads(ranks.sharers), calibration, ranks)
        super().__init__(system, self.plan.step.dt, self.plan.step_control)

    def record(self, name: str, function: Callable[[Self], Any], every: float | str | None = None) -> Record:
        """Keep what a function gives, now and at every multiple of an interval: a column or a table of your own.

        Parameters
        ----------
        name : str
            Of the record, and of its column where the function gives one number.
        function : callable
            Takes this simulation; see `rdpm.simulation.record.Record` for what it may give.
        every : float or str, optional
            Seconds, or text with a unit; ``output.table_every`` of the case when left out. Due is the first step at or
            after a multiple; adaptive steps end at it.

        Returns
        -------
        Record
            Its ``values`` are the columns so far. Also in ``sim.records``.

        Raises
        ------
        CaseError
            The name is taken or is no name; `every` is no time; the function fails, or gives something else.

        Notes
        -----
        `rdpm.run` takes the same as ``record={name: function}`` and writes them into its folder.
        """
        return super().record(name, function, interval_of(name, every, self.case))


def interval_of(name: str, every: float | str | None, case: Case) -> float:
    """How often a record is kept [s]; as often as the tables where it is not said.

    Raises
    ------
    CaseError
        It is no time, or not above zero.

    Examples
    --------
    >>> interval_of("gap", "1 ms", None)
    0.001
    """
    if every is None:
        return case.output.table_every or case.time.end
    try:
        return float(Quantity("s", gt=0.0).check(every))
    except RuleError as error:
        place = f"record {name!r}, every"
        raise CaseError(place, every, error.rule, error.reason, error.cure or 'Write 1e-3, or "1 ms".') from None


def _system(made: Plan, threads: int, calibration: Calibration, ranks: Ranks) -> System:
    case, fluid = made.case, made.case.fluid
    bodies, prescription = _bodies(case)
    domain = case.domain
    walls = tuple(wall.surface for wall in case.walls)
    box = Box(domain.size, domain.kinds, np.array(domain.wall_velocities), walls, inflow_of(case))
    gravity = np.array(domain.gravity)
    if fluid is None or made.cells is None:
        contacts = _contacts(made, bodies, box, None, calibration, threads)
        return System(bodies, contacts, prescription, gravity, ranks=ranks)
    grid = Grid(box, made.cells, threads, slab_of(made, bodies, ranks))
    flow = Fluid(grid, fluid.density, fluid.nu, made.step.is_explicit, ranks)
    flow.set_velocity(*fluid.initial_velocity)
    lubrication, contact = None, case.contact
    if contact.lubrication and len(bodies):
        h = float(np.cbrt(np.prod(grid.spacing)))
        separation = 1.0 if contact.lubrication_in_separation else 0.0
        lubrication = lubrication_correction(
            fluid.mu, h, contact.lubrication_roughness, calibration, separation, contact.lubrication_tangential,
            made.step.longest or made.step.dt,
        )  # fmt: skip
    contacts = _contacts(made, bodies, box, lubrication, calibration, threads)
    immersed: ImmersedBodies | SharedBodies | None = None
    if len(bodies) or box.walls:
        kind = ImmersedBodies if ranks.size == 1 else SharedBodies
        immersed = kind(bodies, flow, gravity, calibration, made.step.longest is not None)
    initial = np.array(fluid.initial_velocity)
    mean_flow = MeanFlow(np.array(fluid.acceleration), case.zero_mean_flow, fluid.density * grid.volume, initial)
    return System(bodies, contacts, prescription, gravity, flow, immersed, mean_flow, ranks=ranks,
                  has_fluid_force_in_impact=contact.fluid_force_in_impact)  # fmt: skip


def _bodies(case: Case) -> tuple[Bodies, Prescription]:
    bodies, prescription = bodies_of(case), Prescription(_motions(case.expanded_bodies().motion))
    prescription.hold(bodies, 0.0, 0.0)
    return bodies, prescription


def lubrication_correction(
    viscosity: float,
    h: float,
    roughness: float = 1e-3,
    calibration: Calibration = CALIBRATION,
    separation: float = 1.0,
    is_tangential: bool = True,
    dt: float = 0.0,
) -> Lubrication:
    """What the grid does not resolve of lubrication.

    Parameters
    ----------
    viscosity : float, [Pa s]
        Dynamic.
    h : float, [m]
        Mean spacing of the grid.
    roughness : float, [-]
        Smallest gap over the smaller radius.
    calibration : Calibration
        Activation and resolved gaps in cells.
    separation : float, [-]
        Fraction of it where surfaces part.
    is_tangential : bool
        Whether slip and roll are lubricated too.
    dt : float, [s]
        Longest time step of a run, which bounds the rate at which they are slowed; 0: no bound.
    """
    c = calibration
    wall = c.wall_activation_gap * h, roughness, c.wall_resolved_gap * h
    pair = c.pair_activation_gap * h, c.pair_resolved_gap * h, c.pair_reference_radius * h
    tangential = None
    if is_tangential:
        wall_slip, pair_slip, roll = (
            (h * cut, h * touching) for cut, touching in (c.wall_slip_gaps, c.pair_slip_gaps, c.roll_gaps)
        )
        rate = c.tangential_rate / dt if dt else math.inf
        tangential = TangentialLubrication(wall_slip, pair_slip, roll, pair[2], rate)
    return Lubrication(viscosity, *wall, *pair, separation, tangential)


def _contacts(
    made: Plan,
    bodies: Bodies,
    box: Box,
    lubrication: Lubrication | None,
    calibration: Calibration,
    threads: int,
) -> Contacts:
    contact, fluid = made.case.contact, made.case.fluid
    substeps = calibration.substeps_per_contact
    times = [pair.design.contact_time_s for pair in made.pairs if pair.design.contact_time_s is not None]
    if contact.substeps is not None and times:
        substeps = max(10, math.ceil(contact.substeps * min(times) / made.step.dt))
    viscosity = fluid.mu if fluid else None
    return Contacts(bodies, box, made.law, lubrication, substeps, contact.overlap_limit, viscosity, threads)


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
