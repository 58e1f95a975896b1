"""Charts of what limits a contact: overlap, material, resolution, integrator."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rdpm.design._checks import Ending
from rdpm.design.approaches import trial_and_error
from rdpm.design.integrators import INTEGRATORS, produced_restitution
from rdpm.design.overlap import largest_contact_time
from rdpm.design.verdicts import LEAST_CONTACT_STEPS, MOST_CONTACT_STEPS
from rdpm.figures.style import ACCENT, OWN, PALETTE, column_chart

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["limits_map", "line", "own", "produced_chart", "trial_chart"]

_MARKS = ("-", "--", "-.", ":")
_SCHEMES = {
    "explicit-euler": "explicit Euler", "semi-implicit-euler": "semi-implicit Euler",
    "velocity-verlet": "velocity Verlet", "exact": "exact (rdpm)",
}  # fmt: skip


def line(axes: Any, i: int, x: Any, y: Any, label: str, **more: Any) -> None:
    """Draw a line told from the others by colour and dash."""
    style = {"color": PALETTE[i % len(PALETTE)], "ls": _MARKS[i % len(_MARKS)], "label": label}
    axes.plot(x, y, **{**style, **more})


def own(axes: Any, mark: tuple[float, float] | None) -> None:
    """Mark the user's own design; an undamped one has no place on a logarithmic axis of damping."""
    if mark is not None and not (axes.get_yscale() == "log" and mark[1] <= 0.0):
        star: Any = {"marker": "*", "ms": 10, "mfc": "#F0E442", "mec": "#262626", "mew": 0.8, "ls": "none"}
        axes.plot(*mark, **star, label=OWN, zorder=5, clip_on=False)


def trial_chart(
    reduced_mass: float,
    damping: float,
    stiffness: Any,
    time_step: float,
    diameter: float,
    impact_speed: float,
    overlap_limit: float = 0.005,
    ending: Ending = "zero-force",
    own_stiffness: float | None = None,
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
    own_stiffness : float or None, [N/m]
        Of the user's design, marked.

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> len(trial_chart(1e-3, 0.15, [5.0, 50.0], 1e-3, 0.015, 0.02).axes)
    3
    """
    limit = overlap_limit * diameter

    def found(k: Any) -> tuple[Any, tuple[Any, ...]]:
        t = trial_and_error(reduced_mass, damping, k, time_step, limit, impact_speed, ending)
        steps = np.where(np.isfinite(t.contact_steps), t.contact_steps, np.nan)
        return t, (t.restitution, steps, 100.0 * t.overlap / diameter)

    t, values = found(stiffness)
    names = ("restitution $e_n$", "contact steps $N_c$", "peak overlap [% d]")
    limits = (None, (LEAST_CONTACT_STEPS, "least steps"), (100.0 * overlap_limit, "largest overlap"))
    marks = None if own_stiffness is None else found([own_stiffness])[1]
    with column_chart("Springs beside a fixed dashpot", 5.6) as figure:
        stack = figure.subplots(3, 1, sharex=True)
        for i, axes in enumerate(stack):
            line(axes, 0, t.stiffness, values[i], "given by the spring")
            axes.fill_between(
                t.stiffness, 0, 1, where=t.accepted, transform=axes.get_xaxis_transform(),
                color="#56B4E9", alpha=0.2, lw=0, label="keeps to all limits",
            )  # fmt: skip
            bound = limits[i]
            if bound is not None:
                name = f"{bound[1]}: {bound[0]:g}" + (" % d" if i == 2 else "")
                axes.axhline(bound[0], color=PALETTE[2 + i], lw=1.0, ls="--", label=name)
            axes.set(ylabel=names[i], xscale="log")
            if i == 0:
                axes.set_ylim(0.0, 1.05)
            else:
                axes.set_yscale("log")
            if marks is not None:
                own(axes, (float(own_stiffness or 0.0), float(marks[i][0])))
        stack[-1].set_xlabel("normal stiffness $k_n$ [N/m]")
        figure.align_ylabels()
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
    with column_chart("Contact steps that keep to the limits", 3.6) as figure:
        axes = figure.add_subplot(xlabel="impact speed $v$ [m/s]", ylabel="contact steps $N_c$")
        axes.set(xscale="log", yscale="log")
        line(axes, 0, v, upper, f"no more: overlap {100 * overlap_limit:g} % d")
        axes.axhline(LEAST_CONTACT_STEPS, color=PALETTE[2], ls="--", label="no fewer: resolution")
        if hertz is not None:
            steps = hertz[0] * (v / hertz[1]) ** -0.2 / time_step
            axes.plot(v, steps, color=PALETTE[6], ls="-.", label="no fewer: Hertz")
            lower = np.maximum(lower, steps)
        axes.fill_between(
            v, lower, upper, where=upper >= lower, color="#56B4E9", alpha=0.3, lw=0, label="allowed"
        )
        axes.axhline(MOST_CONTACT_STEPS, color=ACCENT, ls=":", label="more gains nothing")
        own(axes, chosen)
        axes.set_xlim(v.min(), v.max())
        n = 10.0 if chosen is None else chosen[1]
        axes.set_ylim(min(1.0, 0.5 * n), max(200.0, 2.0 * n))
    return figure


def produced_chart(
    restitution: float,
    contact_steps: Any = (4, 5, 6, 8, 10, 12, 15, 20, 30, 50),
    ending: Ending = "zero-overlap",
    own_steps: float | None = None,
) -> Figure:
    """Restitution that integrators achieve without sub-steps, mean and spread over the phase of touch.

    Parameters
    ----------
    restitution : float, [-]
        Designed, in (0, 1].
    contact_steps : (n,) array, [-]
        > 1.
    ending : {"zero-force", "zero-overlap"}
    own_steps : float or None, [-]
        Contact steps of the user's design, marked where rdpm puts it: at the design restitution.

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> len(produced_chart(0.5, (8, 10)).axes)
    1
    """
    n = np.asarray(contact_steps, dtype=np.float64)
    with column_chart("Restitution achieved without sub-steps", 3.4) as figure:
        axes = figure.add_subplot(xlabel="contact steps $N_c$", ylabel="restitution achieved", xscale="log")
        for i, name in enumerate(INTEGRATORS):
            found = np.array([produced_restitution(restitution, q, name, ending) for q in n])
            found[~np.isfinite(found)] = np.nan
            line(axes, i, n, found[:, 0], _SCHEMES.get(name, name))
            color = PALETTE[i % len(PALETTE)]
            axes.fill_between(n, found[:, 1], found[:, 2], color=color, alpha=0.2, lw=0)
        own(axes, None if own_steps is None else (own_steps, restitution))
        axes.set_ylim(0.0, min(1.5, axes.get_ylim()[1]))
    return figure
