"""Guards: a run whose numbers can no longer be trusted stops, and says which, where, when and what to change."""

from __future__ import annotations

import hashlib

import numpy as np

from rdpm.contacts.neighbours import gaps_and_rates
from rdpm.conventions import partner_name
from rdpm.coupling.system import System
from rdpm.errors import BodyLeftError, CflError, DivergenceError, NanError, OverlapError, RanksError
from rdpm.grid.inflow import CLEAR_CELLS

__all__ = ["check_alike", "check_divergence", "check_step"]

#: Cells the flow may cross in a step. An automatic step aims at half a cell; the flow in the gap of a rebound reaches
#: 1.1 for a few steps unharmed, and a run that turns unstable passes 2 at once.
CFL_LIMIT = 2.0

#: Overlap of bodies whose motion is prescribed, over the diameter, beyond a touch.
PRESCRIBED_OVERLAP = 0.01

#: Divergence times the smallest spacing, over the largest speed: round-off of a direct solve stays far below.
DIVERGENCE_LIMIT = 1e-8


def check_step(system: System, dt: float) -> None:
    """Check bodies and flow after a step.

    Raises
    ------
    NanError, CflError, BodyLeftError, OverlapError
    """
    bodies, fluid = system.bodies, system.fluid
    when = f"step {system.steps}, t = {system.time:.6g} s"
    if len(bodies):
        good = (
            np.isfinite(bodies.position).all(axis=1)
            & np.isfinite(bodies.velocity).all(axis=1)
            & np.isfinite(bodies.angular_velocity).all(axis=1)
        )
        if not good.all():
            body = int(np.flatnonzero(~good)[0])
            raise NanError(
                f"nan guard, {when}: body {body}",
                bodies.velocity[body].tolist(),
                "position and velocity must be finite",
                "the step was too long for its forces",
                "Lower time.step, or soften the contact.",
            )
        size = np.array(system.contacts.box.size)
        out = ((bodies.position < 0.0) | (bodies.position > size)) & ~np.array(system.contacts.box.is_periodic)
        if out.any():
            body, axis = (int(n) for n in np.argwhere(out)[0])
            raise BodyLeftError(
                f"body guard, {when}: body {body}, {'xyz'[axis]}",
                float(bodies.position[body, axis]),
                f"its centre must stay between 0 and {size[axis]:g} m",
                "a prescribed motion leads out, or a contact was too soft to hold it",
                "Change the motion, stiffen the contact, or lower time.step.",
            )
        _check_ends(system, when)
        if not bodies.is_free.all():
            _check_prescribed(system, when)
    if fluid is None:
        return
    if not np.isfinite(fluid.square_sum):
        places = [str(system.ranks.share(_first_bad(system), rank)) for rank in range(system.ranks.size)]
        place = next(filter(None, places), "velocity")
        raise NanError(
            f"nan guard, {when}: {place}",
            None,
            "the velocity must be finite",
            "the run turned unstable",
            "Lower time.step or time.cfl.",
        )
    cfl = fluid.cfl_rate * dt
    if cfl > CFL_LIMIT:
        raise CflError(
            f"cfl guard, {when}",
            f"{cfl:.3g}",
            f"the flow must cross at most {CFL_LIMIT:g} cells a step",
            f"the fastest face moves {fluid.cfl_rate:.3g} cells a second",
            f"Set time.step to {0.5 / fluid.cfl_rate:.2g} s or less, or lower time.cfl.",
        )


def _check_ends(system: System, when: str) -> None:
    """Bodies do not pass through open ends, nor come so near that their markers would reach beyond."""
    bodies, inflow = system.bodies, system.contacts.box.inflow
    if inflow is None or system.fluid is None:
        return
    length, h = system.contacts.box.size[inflow.axis], system.fluid.grid.spacing[inflow.axis]
    at = bodies.position[:, inflow.axis]
    gap = np.minimum(at, length - at) - 0.5 * bodies.diameter
    body = int(np.argmin(gap))
    if gap[body] < CLEAR_CELLS * h:
        raise BodyLeftError(
            f"body guard, {when}: body {body}, {'xyz'[inflow.axis]}",
            float(at[body]),
            f"its surface must stay {CLEAR_CELLS:g} cells, {CLEAR_CELLS * h:.3g} m, from both ends of the stream",
            "a body cannot leave with the outflow",
            "End the run earlier, lengthen the box, or hold the body.",
        )


def _check_prescribed(system: System, when: str) -> None:
    """No contact keeps bodies of prescribed motion apart from walls and from each other."""
    bodies, box = system.bodies, system.contacts.box
    pairs = system.contacts.close_pairs(0.0)
    i, j = pairs.T
    pairs = pairs[~bodies.is_free[i] & ((j < 0) | ~bodies.is_free[np.where(j < 0, i, j)])]
    if not len(pairs):
        return
    gap, _ = gaps_and_rates(bodies, box, pairs)
    depth = -gap / bodies.diameter[pairs[:, 0]]
    worst = int(np.argmax(depth))
    if depth[worst] <= PRESCRIBED_OVERLAP:
        return
    i, j = (int(n) for n in pairs[worst])
    raise OverlapError(
        f"overlap guard, {when}: body {i} and {partner_name(j)}",
        f"{100.0 * depth[worst]:.3g} % of the diameter",
        f"must stay below {100.0 * PRESCRIBED_OVERLAP:g} %",
        "no contact acts where neither can give way: the motion of both is prescribed",
        "Change the motion, or end it with until = { gap = ... }.",
    )


def check_alike(system: System) -> None:
    """Bodies must be the same on all ranks, to the bit: each moves all of them.

    Raises
    ------
    RanksError
    """
    if system.ranks.size == 1:
        return
    bodies = system.bodies
    digest = hashlib.blake2b(digest_size=6)  # as a number it is exact
    for values in (bodies.position, bodies.orientation, bodies.velocity, bodies.angular_velocity):
        digest.update(values.tobytes())
    found = system.ranks.table([float(int.from_bytes(digest.digest(), "big"))])[:, 0]
    apart = np.flatnonzero(found != found[0])
    if len(apart):
        raise RanksError(
            f"ranks guard, step {system.steps}, t = {system.time:.6g} s: ranks {', '.join(map(str, apart))}",
            None,
            "must have the same bodies as rank 0",
            "their machines compute differently: another processor, library or build of rdpm",
            "Run on machines of one kind, with one installation.",
        )


def check_divergence(system: System) -> float:
    """Largest divergence [1/s], after checking that it is round-off.

    Raises
    ------
    DivergenceError
    """
    fluid = system.fluid
    if fluid is None:
        return 0.0
    divergence = fluid.largest_divergence()
    scale = max(fluid.cfl_rate, 1e-30)
    if divergence > DIVERGENCE_LIMIT * scale:
        raise DivergenceError(
            f"divergence guard, step {system.steps}, t = {system.time:.6g} s",
            f"{divergence:.3g} 1/s",
            f"must stay below {DIVERGENCE_LIMIT:g} of the flow's rate {scale:.3g} 1/s",
            "the pressure solve no longer does its work",
            "Report this case: it should not happen.",
        )
    return divergence


def _first_bad(system: System) -> str:
    """A place of this rank, or nothing."""
    assert system.fluid is not None
    grid = system.fluid.grid
    below = grid.slab.first if grid.slab is not None else 0
    for name, field in zip("uvw", system.fluid.velocity, strict=True):
        bad = np.argwhere(~np.isfinite(field[1:-1, 1:-1, 1:-1]))
        if len(bad):
            k, j, i = (int(n) for n in bad[0])
            x, y, z = ((n + 0.5) * h for n, h in zip((i, j, k + below), grid.spacing, strict=True))
            return f"{name} near ({x:.4g}, {y:.4g}, {z:.4g}) m"
    return ""
