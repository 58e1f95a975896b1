"""Charts of what limits a contact: overlap, material, resolution, integrator."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rdpm.design._checks import Ending
from rdpm.design.approaches import trial_and_error
from rdpm.design.integrators import INTEGRATORS, produced_restitution
from rdpm.design.overlap import largest_contact_time
from rdpm.design.verdicts import LEAST_CONTACT_STEPS, MOST_CONTACT_STEPS
from rdpm.figures.style import ACCENT, PALETTE, drawing

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["limits_map", "line", "produced_chart", "trial_chart"]

_MARKS = ("-", "--", "-.", ":")


def line(axes: Any, i: int, x: Any, y: Any, label: str, **more: Any) -> None:
    """Draw a line told from the others by colour and dash."""
    style = {"color": PALETTE[i % len(PALETTE)], "ls": _MARKS[i % len(_MARKS)], "label": label}
    axes.plot(x, y, **{**style, **more})


def trial_chart(
    reduced_mass: float,
    damping: float,
    stiffness: Any,
    time_step: float,
    diameter: float,
    impact_speed: float,
    overlap_limit: float = 0.005,
    ending: Ending = "zero-force",
) -> Figure:
    """What a fixed dashpot does beside springs of several stiffness, and which pass.

    Parameters
    ----------
    reduced_mass : float, [kg]
        > 0.
    damping : float, [N s/m]
        >= 0.
    stiffness : (n,) array, [N/m]
        > 0.
    time_step : float, [s]
        > 0.
    diameter : float, [m]
        Of the smaller sphere, > 0.
    impact_speed : float, [m/s]
        > 0.
    overlap_limit : float, [-]
        Fraction of the diameter, > 0.
    ending : {"zero-force", "zero-overlap"}

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> len(trial_chart(1e-3, 0.15, [5.0, 50.0], 1e-3, 0.015, 0.02).axes)
    3
    """
    t = trial_and_error(
        reduced_mass, damping, stiffness, time_step, overlap_limit * diameter, impact_speed, ending
    )
    panels = (
        ("restitution $e_n$", t.restitution, None),
        (
            "contact steps $N_c$",
            np.where(np.isfinite(t.contact_steps), t.contact_steps, np.nan),
            LEAST_CONTACT_STEPS,
        ),
        ("peak overlap [% d]", 100.0 * t.overlap / diameter, 100.0 * overlap_limit),
    )
    with drawing(7.0, 6.4) as figure:
        stack = figure.subplots(3, 1, sharex=True)
        for i, (axes, (name, values, limit)) in enumerate(zip(stack, panels, strict=True)):
            axes.plot(t.stiffness, values, color=PALETTE[i])
            axes.fill_between(
                t.stiffness, 0, 1, where=t.accepted, transform=axes.get_xaxis_transform(),
                color="#56B4E9", alpha=0.2, lw=0, label="keeps to all limits",
            )  # fmt: skip
            if limit is not None:
                axes.axhline(limit, color=ACCENT, lw=1.0, ls="--", label=f"limit {limit:g}")
            axes.set(ylabel=name, xscale="log")
            if i == 1:
                axes.set_yscale("log")
                axes.yaxis.set_major_formatter("{x:g}")
            else:
                axes.set_ylim(bottom=0.0)
            axes.legend(loc="best")
        stack[-1].set_xlabel("normal stiffness $k_n$ [N/m]")
    return figure


def limits_map(
    restitution: float,
    time_step: float,
    diameter: float,
    impact_speeds: Any,
    overlap_limit: float = 0.005,
    hertz: tuple[float, float] | None = None,
    chosen: tuple[float, float] | None = None,
    ending: Ending = "zero-force",
) -> Figure:
    """Contact steps against impact speed: where overlap, Hertz and resolution leave room.

    Parameters
    ----------
    restitution : float, [-]
        In (0, 1].
    time_step : float, [s]
        > 0.
    diameter : float, [m]
        Of the smaller sphere, > 0.
    impact_speeds : (n,) array, [m/s]
        > 0.
    overlap_limit : float, [-]
        Fraction of the diameter, > 0.
    hertz : (float, float) or None
        A Hertz contact time [s] and the speed [m/s] it belongs to; it falls as speed to the power -1/5.
    chosen : (float, float) or None
        Impact speed [m/s] and contact steps of a design, marked.
    ending : {"zero-force", "zero-overlap"}

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> len(limits_map(0.5, 1e-3, 0.015, [0.01, 0.1]).axes)
    1
    """
    v = np.asarray(impact_speeds, dtype=np.float64)
    upper = largest_contact_time(restitution, overlap_limit * diameter, v, ending) / time_step
    lower = np.full(v.shape, float(LEAST_CONTACT_STEPS))
    with drawing() as figure:
        axes = figure.add_subplot(xlabel="impact speed [m/s]", ylabel="contact steps $N_c$")
        axes.set(xscale="log", yscale="log")
        axes.plot(v, upper, color=PALETTE[0], label=f"overlap {100 * overlap_limit:g} % d: no more")
        axes.axhline(LEAST_CONTACT_STEPS, color=PALETTE[2], ls="--", label="resolution: no fewer")
        if hertz is not None:
            steps = hertz[0] * (v / hertz[1]) ** -0.2 / time_step
            axes.plot(v, steps, color=PALETTE[6], ls="-.", label="Hertz: no fewer")
            lower = np.maximum(lower, steps)
        axes.fill_between(
            v, lower, upper, where=upper >= lower, color="#56B4E9", alpha=0.3, lw=0, label="room"
        )
        axes.axhline(MOST_CONTACT_STEPS, color=ACCENT, ls=":", label="more gains nothing")
        if chosen is not None:
            axes.plot(*chosen, "o", color=PALETTE[1], label="this design")
        axes.set_xlim(v.min(), v.max())
        axes.set_ylim(1.0, 200.0)
        axes.yaxis.set_major_formatter("{x:g}")
        axes.legend(loc="upper right")
    return figure


def produced_chart(
    restitution: float,
    contact_steps: Any = (4, 5, 6, 8, 10, 12, 15, 20, 30, 50),
    ending: Ending = "zero-overlap",
) -> Figure:
    """Restitution that integrators produce without sub-steps, mean and spread over the phase of touch.

    Parameters
    ----------
    restitution : float, [-]
        Designed, in (0, 1].
    contact_steps : (n,) array, [-]
        > 1.
    ending : {"zero-force", "zero-overlap"}

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> len(produced_chart(0.5, (8, 10)).axes)
    1
    """
    with drawing() as figure:
        axes = figure.add_subplot(xlabel="contact steps $N_c$", ylabel="restitution produced", xscale="log")
        for i, name in enumerate(INTEGRATORS):
            found = np.array([produced_restitution(restitution, n, name, ending) for n in contact_steps])
            line(axes, i, contact_steps, found[:, 0], name)
            color = PALETTE[i % len(PALETTE)]
            axes.fill_between(contact_steps, found[:, 1], found[:, 2], color=color, alpha=0.2, lw=0)
        axes.set_xticks(contact_steps, [f"{n:g}" for n in contact_steps])
        axes.minorticks_off()
        axes.set_ylim(bottom=0.0)
        axes.legend()
    return figure
