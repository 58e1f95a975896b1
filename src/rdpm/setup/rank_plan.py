"""What a case implies on several ranks: planes, memory and messages of each, and how well they work together."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from rdpm.errors import CaseError
from rdpm.particles.calibration import CALIBRATION
from rdpm.particles.seeding import marker_arms, marker_count
from rdpm.particles.sharing import Cuts, held_markers
from rdpm.particles.walls import wall_points
from rdpm.setup.disk import size_text
from rdpm.setup.needs import memory_needs
from rdpm.setup.on_ranks import MARKER_COST, bodies_of, planes_of_ranks
from rdpm.setup.plan import Plan
from rdpm.setup.rank_traffic import Traffic, shared_with, step_traffic
from rdpm.setup.rows import EXPECTED_NS, PlanRow
from rdpm.setup.scales import memory_needed

__all__ = ["RankShare", "RanksPlan", "plan_ranks"]

#: Planes of 8 bytes a cell that a slab has beside its fields: factors of its pressure solve, what it says to others.
SLAB_PLANES = 100

#: What MPI takes in each process [bytes].
MPI = 25_000_000

#: Of the model: time of a message [s], and what a rank sends in a second [bytes].
LATENCY, BANDWIDTH = 3e-6, 1e10

#: Of a cell: a picture of the flow, or vorticity and Q, as a rank sends it; on the root one quantity put together, and
#: rounded; averages likewise [bytes].
PICTURE, GATHERED, AVERAGED = 16, 24, 48

#: Time of a body's contacts in a step [s], which every rank computes, as if all touched.
CONTACT = 4.3e-6

#: Part of a marker's work that every rank with its body does; the other part is of the planes that it touches.
HELD = 0.4


@dataclass(frozen=True)
class RankShare:
    """What one rank has.

    Attributes
    ----------
    planes : int
        Of cells across z.
    bodies, markers : int
        That it works on when the run starts.
    memory : int, [bytes]
        Peak of its process.
    sent : Traffic
        In a step in which no body comes to another slab, and none hits another.
    work, waiting : float, [s]
        In a step: on one thread, and of messages by the model.
    """

    planes: int
    bodies: int
    markers: int
    memory: int
    sent: Traffic
    work: float
    waiting: float


@dataclass(frozen=True)
class RanksPlan:
    """What a case implies on several ranks.

    Attributes
    ----------
    threads : int
        Of each rank.
    shares : list of RankShare
        From bottom to top.
    efficiency : float, [-]
        By a model: speed over that of as many threads in one process that scales perfectly.
    seconds : float, [s]
        Wall time of the run, without output.
    """

    threads: int
    shares: list[RankShare]
    efficiency: float
    seconds: float

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers for machines."""
        shares = [
            {
                "planes": share.planes,
                "bodies": share.bodies,
                "markers": share.markers,
                "memory_bytes": share.memory,
                "messages_a_step": share.sent.messages,
                "sent_bytes_a_step": share.sent.sent_bytes,
            }
            for share in self.shares
        ]
        return {
            "ranks": len(shares),
            "threads": self.threads,
            "shares": shares,
            "efficiency": self.efficiency,
            "seconds": self.seconds,
        }

    def rows(self) -> list[PlanRow]:
        """The same for a reader."""
        shares = self.shares

        def span(values: list[int], text: Any = str) -> str:
            low, high = text(min(values)), text(max(values))
            return low if low == high else f"{low} to {high}"

        return [
            PlanRow("planes a rank", ", ".join(str(share.planes) for share in shares), "", "from bottom to top"),
            PlanRow("markers a rank", span([share.markers for share in shares])),
            PlanRow("memory a rank", span([share.memory for share in shares], size_text)),
            PlanRow("messages a rank, step", span([share.sent.messages for share in shares])),
            PlanRow("sent a rank, step", span([share.sent.sent_bytes for share in shares], size_text)),
            PlanRow(
                "efficiency", f"{100.0 * self.efficiency:.0f} %", "ok" if self.efficiency >= 0.7 else "warning",
                f"a model: {1e6 * LATENCY:g} us a message, {1e-9 * BANDWIDTH:g} GB/s a rank",
            ),
            PlanRow("time", f"about {self.seconds:.0f} s", "", f"{_threads(self.threads)} a rank; without output"),
        ]  # fmt: skip


def _memory(made: Plan, rank: int, slab: tuple[int, int, int], solver: int) -> int:
    """Peak of a rank's process [bytes]."""
    assert made.cells is not None
    needs, output = memory_needs(made.case, slab, solver), made.case.output
    here, whole = math.prod(slab), math.prod(made.cells)
    written = 0
    if output.fields_every:
        written = PICTURE * here * (2 if output.vorticity or output.q_criterion else 1)
    if rank == 0:
        written = max(needs.figures, written + (GATHERED * whole if output.fields_every else 0))
        written = max(written, AVERAGED * whole if output.average_from is not None else 0)
    return needs.solver + needs.libraries + MPI + written


def _of_walls(made: Plan, cuts: Cuts, h: float, rank: int) -> dict[int, int] | None:
    """By other rank, how many markers of walls within the box both have."""
    if not made.case.walls:
        return None
    size, depth = np.array(made.case.domain.size), CALIBRATION.marker_retraction * h
    z = np.concatenate([wall_points(wall.surface, size, h, depth)[0][:, 2] for wall in made.case.walls])
    holders = cuts.touched(z)
    return {other: n for other, (_, n) in shared_with(holders[:, :0], holders, rank).items()}


def _threads(count: int) -> str:
    return "one thread" if count == 1 else f"{count} threads"


def plan_ranks(made: Plan, ranks: int, threads: int = 1, cell_ns: float = EXPECTED_NS) -> RanksPlan:
    """Work out what a case implies on several ranks.

    Parameters
    ----------
    made : Plan
    ranks : int
        >= 1.
    threads : int
        Of each rank, for the estimate of time.
    cell_ns : float, [ns]
        Time of a cell and step on one thread.

    Returns
    -------
    RanksPlan

    Raises
    ------
    CaseError
        A dry case, which all ranks run alike; or too many ranks.

    Examples
    --------
    >>> from rdpm.config.load import load_case
    >>> from rdpm.setup.plan import plan
    >>> [share.planes for share in plan_ranks(plan(load_case("dkt")), 2).shares]
    [137, 133]
    """
    case, cells = made.case, made.cells
    if cells is None or ranks < 1:
        reason = "a dry case is run alike by all ranks" if cells is None else "a run has one at least"
        raise CaseError("--ranks", ranks, "must share a flow" if cells is None else "must be at least 1", reason)
    bodies = bodies_of(case)
    planes, costs = planes_of_ranks(made, bodies, ranks)
    x, y, dz = (length / n for length, n in zip(case.domain.size, cells, strict=True))
    period = case.domain.size[2] if case.domain.is_periodic[2] else 0.0
    cuts, h = Cuts(planes, (x, y, dz), period), float(np.cbrt(x * y * dz))
    z, travel = bodies.position[:, 2], 0.5 * made.step.dt * np.abs(bodies.velocity[:, 2])
    holders = cuts.beyond(z, 0.5 * bodies.diameter + travel) <= 0.0
    several = np.flatnonzero(holders.sum(axis=0) > 1)
    arms = marker_arms(bodies.diameter[several], h, CALIBRATION.marker_retraction)
    in_common = held_markers(cuts, holders[:, several], z[several], bodies.orientation[several], arms)
    alone = np.array([marker_count(0.5 * d, h) for d in bodies.diameter], np.int64)
    alone[several] = 0
    owned = np.bincount(cuts.owner(z), minlength=ranks)
    stages = 0 if made.step.is_explicit else made.step.stages
    ends, shares = np.concatenate([[0], np.cumsum(planes)]), []
    for rank in range(ranks):
        shared = shared_with(holders, in_common, rank)
        own = int(owned[rank]) if len(bodies) or case.walls else None
        walls, is_stream = _of_walls(made, cuts, h, rank), case.domain.inflow_axis in (0, 1)
        sent = step_traffic(cells, ranks, rank, period > 0.0, stages, shared, own, walls, is_stream)
        held = int(alone[holders[rank]].sum() + in_common[rank].sum())
        slab = cells[0], cells[1], planes[rank]
        solver = memory_needed(slab, made.step.is_explicit, held) + 8 * cells[0] * cells[1] * SLAB_PLANES
        memory = _memory(made, rank, slab, solver)
        flow, in_planes = cells[0] * cells[1] * planes[rank], float(costs[ends[rank] : ends[rank + 1]].sum())
        cost = flow + (1.0 - HELD) * (in_planes - flow) + HELD * MARKER_COST * held
        work = 1e-9 * cell_ns * cost
        waiting = LATENCY * sent.messages + sent.sent_bytes / BANDWIDTH
        shares.append(RankShare(planes[rank], int(holders[rank].sum()), held, memory, sent, work, waiting))
    contacts = CONTACT * len(bodies)
    ideal = (1e-9 * cell_ns * float(costs.sum()) + contacts) / (ranks * threads)
    slowest = max((share.work + contacts) / threads + share.waiting for share in shares)
    efficiency = ideal / slowest if math.isfinite(slowest) else 0.0
    return RanksPlan(threads, shares, efficiency, made.steps * slowest)
