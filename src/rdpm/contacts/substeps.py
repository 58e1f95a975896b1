"""Sub-steps of one time step: the driver compiled over a contact law (``contacts/substeps.hpp``)."""

from __future__ import annotations

from collections.abc import Callable
from math import ceil

import numpy as np
from numpy.typing import NDArray

from rdpm import _core
from rdpm.conventions import partner_name
from rdpm.errors import OverlapError

from .driver import ContactStep, ContactTask
from .episodes import FINISHED
from .rows import Rows, as_bytes, check_layout

__all__ = ["SubstepDriver"]

#: Fewer pairs than that are done before a second thread is awake.
PARALLEL_PAIRS = 2000


class SubstepDriver:
    """Resolves contacts that last, of any law that has an impulse a sub-step.

    Each sub-step drifts the bodies by half, adds what the non-contact load gives, visits the pairs in the order of
    their selection, even bands and then odd ones (odd sub-steps backwards), applies each impulse at once, and drifts
    the other half. Touch and end of a contact are located inside the sub-step.

    Parameters
    ----------
    kernel : ContactKernel
        ``run_substeps`` compiled over the law's struct.
    parameters, history : dtype
        Rows of the law, as its struct has them.

    Raises
    ------
    ImportError
        The rows differ from the struct's.
    """

    def __init__(
        self, kernel: _core.ContactKernel, parameters: np.dtype[np.void], history: np.dtype[np.void]
    ) -> None:
        check_layout(parameters, kernel.parameters, "contact parameters")
        check_layout(history, kernel.history, "contact history")
        self._kernel, self._parameters, self._history = kernel, parameters, history

    @property
    def parameters(self) -> np.dtype[np.void]:
        """Row of a pair's parameters."""
        return self._parameters

    @property
    def history(self) -> np.dtype[np.void]:
        """What a pair in contact remembers for its law."""
        return self._history

    def run(self, task: ContactTask, step: ContactStep, record: Callable[[NDArray[np.int32], Rows], None]) -> None:
        """Change bodies, states and histories of the task, and `step`; see :class:`rdpm.contacts.driver.Driver`."""
        b, table, chosen = task.bodies, task.table, task.selection
        if not len(chosen):
            return
        # An even number: what the order of the pairs does cancels between two sub-steps.
        step.substeps = 2 * ceil(0.5 * task.substeps_per_contact * task.dt / chosen.shortest)
        h = task.dt / max(step.substeps, 1)
        finished = np.empty(max(64, 4 * len(chosen)), FINISHED)
        room = task.room.holding(len(chosen.active), len(chosen))
        threads = task.threads if len(chosen) >= PARALLEL_PAIRS else 1
        at = 0
        while at < step.substeps:
            at, count, failed, min_gap, max_overlap = _core.run_substeps(
                self._kernel, task.box.table, b.position, b.velocity, b.angular_velocity, task.rotation,
                task.force, task.torque, task.inverse_mass, task.inverse_moment, task.radius,
                step.impulse, step.angular_impulse, step.contact_impulse, step.lubrication_angular_impulse,
                chosen.active, chosen.local, chosen.rows, chosen.bands, chosen.even_bands,
                table.kind, as_bytes(table.kinds), as_bytes(table.lubrication), as_bytes(table.state),
                as_bytes(table.history), as_bytes(finished), *room, chosen.reach / task.dt, task.time, h,
                task.overlap_limit, at, step.substeps, threads,
            )  # fmt: skip
            step.min_gap = min(step.min_gap, min_gap)
            step.max_overlap_fraction = max(step.max_overlap_fraction, max_overlap)
            if count:
                record(table.ids[finished["pair"][:count]], finished[:count])
            if failed >= 0:
                raise _overlap_error(task, failed, task.time + at * h)


def pair_names(ids: NDArray[np.int32]) -> tuple[int, str]:
    """The first of a pair, and the second in words."""
    i, j = ids.tolist()
    return i, partner_name(j)


def _overlap_error(task: ContactTask, pair: int, time: float) -> OverlapError:
    state = task.table.state[pair]
    i, other = pair_names(task.table.ids[pair])
    fraction = state["overlap"] / task.table.pairs["smaller_diameter"][pair]
    return OverlapError(
        f"overlap of body {i} and {other} at t = {time:.6g} s",
        f"{100.0 * fraction:.3g} % of the diameter",
        f"must stay below contact.overlap_limit = {100.0 * task.overlap_limit:g} %",
        f"they met at {state['impact_speed']:.3g} m/s and the contact is too soft for that",
        "Stiffen it: raise the stiffness of its model, or lower contact.contact_steps or time.step where it has none.",
    )
