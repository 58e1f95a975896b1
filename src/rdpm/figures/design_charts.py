"""Charts of collision parameters: how stiffness, damping, contact time and steps hang together."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rdpm.design._checks import Ending
from rdpm.design.approaches import by_contact_steps, graphical
from rdpm.figures.design_limits import limits_map, line, produced_chart, trial_chart
from rdpm.figures.style import ACCENT, drawing, save

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = [
    "contact_steps_chart",
    "contact_time_chart",
    "damping_chart",
    "restitution_chart",
    "save_charts",
    "time_step_chart",
]

_K, _ETA = "normal stiffness $k_n$ [N/m]", "normal damping $\\eta_n$ [N s/m]"


def damping_chart(
    reduced_mass: float,
    stiffness: Any,
    restitutions: Sequence[float] = (0.1, 0.3, 0.5, 0.7, 0.9),
    ending: Ending = "zero-force",
) -> Figure:
    """Damping against stiffness for several restitutions; critical damping as the seed's e_n = 0.

    Parameters
    ----------
    reduced_mass : float, [kg]
        > 0.
    stiffness : (n,) array, [N/m]
        > 0.
    restitutions : sequence of float, [-]
        Each in (0, 1).
    ending : {"zero-force", "zero-overlap"}

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> len(damping_chart(1e-3, [1.0, 10.0]).axes)
    1
    """
    with drawing() as figure:
        axes = figure.add_subplot(xlabel=_K, ylabel=_ETA, xscale="log", yscale="log")
        for i, e in enumerate(restitutions):
            table = graphical(reduced_mass, e, stiffness, [1.0], ending)
            line(axes, i, table.stiffness, table.damping, f"$e_n$ = {e:g}")
        axes.plot(table.stiffness, table.critical_damping, color=ACCENT, lw=2.5, label="critical", zorder=1)
        axes.legend(loc="upper left")
    return figure


def contact_time_chart(
    reduced_mass: float,
    stiffness: Any,
    restitutions: Sequence[float] = (0.1, 0.5, 0.9),
    ending: Ending = "zero-force",
    hertz_time: float | None = None,
) -> Figure:
    """Contact time against stiffness, with the Hertz time [s] as the lower limit where it is known.

    Parameters
    ----------
    reduced_mass : float, [kg]
        > 0.
    stiffness : (n,) array, [N/m]
        > 0.
    restitutions : sequence of float, [-]
        Each in (0, 1].
    ending : {"zero-force", "zero-overlap"}
    hertz_time : float or None, [s]

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> len(contact_time_chart(1e-3, [1.0, 10.0]).axes)
    1
    """
    with drawing() as figure:
        axes = figure.add_subplot(xlabel=_K, ylabel="contact time $t_c$ [s]", xscale="log", yscale="log")
        for i, e in enumerate(restitutions):
            table = graphical(reduced_mass, e, stiffness, [1.0], ending)
            line(axes, i, table.stiffness, table.contact_time, f"$e_n$ = {e:g}")
        if hertz_time is not None:
            axes.axhline(hertz_time, color=ACCENT, lw=2.5, label="Hertz: no contact is shorter", zorder=1)
        axes.legend(loc="upper right")
    return figure


def time_step_chart(
    reduced_mass: float,
    restitution: float,
    stiffness: Any,
    contact_steps: Sequence[float] = (4, 8, 15, 50),
    ending: Ending = "zero-force",
) -> Figure:
    """Time step against stiffness for several contact steps.

    Parameters
    ----------
    reduced_mass : float, [kg]
        > 0.
    restitution : float, [-]
        In (0, 1].
    stiffness : (n,) array, [N/m]
        > 0.
    contact_steps : sequence of float, [-]
        > 0.
    ending : {"zero-force", "zero-overlap"}

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> len(time_step_chart(1e-3, 0.5, [1.0, 10.0]).axes)
    1
    """
    table = graphical(reduced_mass, restitution, stiffness, [1.0], ending)
    with drawing() as figure:
        axes = figure.add_subplot(xlabel=_K, ylabel="time step $\\delta t$ [s]", xscale="log", yscale="log")
        for i, n in enumerate(contact_steps):
            line(axes, i, table.stiffness, table.contact_time / n, f"$N_c$ = {n:g}")
        axes.legend(loc="lower left")
    return figure


def contact_steps_chart(
    reduced_mass: float,
    restitution: float,
    time_steps: Sequence[float],
    contact_steps: Any = range(4, 31),
    ending: Ending = "zero-force",
) -> Figure:
    """Stiffness and damping against contact steps for several time steps.

    Parameters
    ----------
    reduced_mass : float, [kg]
        > 0.
    restitution : float, [-]
        In (0, 1).
    time_steps : sequence of float, [s]
        > 0.
    contact_steps : (n,) array, [-]
        > 0.
    ending : {"zero-force", "zero-overlap"}

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> len(contact_steps_chart(1e-3, 0.5, [1e-3]).axes)
    2
    """
    n = np.asarray(contact_steps, dtype=np.float64)
    with drawing(8.4, 3.9) as figure:
        left, right = figure.subplots(1, 2)
        for i, dt in enumerate(time_steps):
            table = by_contact_steps(reduced_mass, restitution, n, dt, 1.0, 1.0, 0.0, ending)
            line(left, i, n, table.stiffness, f"$\\delta t$ = {1e3 * dt:.3g} ms")
            line(right, i, n, table.damping, f"$\\delta t$ = {1e3 * dt:.3g} ms")
        for axes, name in ((left, _K), (right, _ETA)):
            axes.set(xlabel="contact steps $N_c$", ylabel=name, yscale="log")
        left.legend()
    return figure


def restitution_chart(
    reduced_mass: float,
    time_step: float,
    contact_steps: Sequence[float] = (4, 8, 10, 12, 15),
    restitutions: Any = None,
    ending: Ending = "zero-force",
) -> Figure:
    """Stiffness and damping against restitution for several contact steps.

    Parameters
    ----------
    reduced_mass : float, [kg]
        > 0.
    time_step : float, [s]
        > 0.
    contact_steps : sequence of float, [-]
        > 0.
    restitutions : (n,) array, [-], optional
        Each in (0, 1]; default 0.02 to 1.
    ending : {"zero-force", "zero-overlap"}

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> len(restitution_chart(1e-3, 1e-3).axes)
    2
    """
    e = np.linspace(0.02, 1.0, 120) if restitutions is None else np.asarray(restitutions, dtype=np.float64)
    with drawing(8.4, 3.9) as figure:
        left, right = figure.subplots(1, 2)
        for i, n in enumerate(contact_steps):
            tables = [by_contact_steps(reduced_mass, q, n, time_step, 1.0, 1.0, 0.0, ending) for q in e]
            line(left, i, e, [t.stiffness[0] for t in tables], f"$N_c$ = {n:g}")
            line(right, i, e, [t.damping[0] for t in tables], f"$N_c$ = {n:g}")
        for axes, name in ((left, _K), (right, _ETA)):
            axes.set(xlabel="restitution $e_n$", ylabel=name)
        left.set_yscale("log")
        right.legend()
    return figure


def save_charts(
    folder: str | Path,
    *,
    reduced_mass: float,
    restitution: float,
    stiffness: float,
    damping: float,
    time_step: float,
    ending: Ending = "zero-force",
    diameter: float | None = None,
    impact_speed: float | None = None,
    overlap_limit: float = 0.005,
    hertz_time: float | None = None,
    contact_steps: float | None = None,
) -> list[Path]:
    """Write every chart for one contact as PNG.

    Parameters
    ----------
    folder : path
        Made if it is not there.
    reduced_mass : float, [kg]
        > 0.
    restitution : float, [-]
        In (0, 1].
    stiffness : float, [N/m]
        > 0; the charts span two decades either side.
    damping : float, [N s/m]
        >= 0.
    time_step : float, [s]
        > 0; its half and quarter are drawn too.
    ending : {"zero-force", "zero-overlap"}
    diameter, impact_speed : float or None, [m], [m/s]
        Without both there is no trial chart and no map of limits.
    overlap_limit : float, [-]
        Fraction of the diameter, > 0.
    hertz_time : float or None, [s]
        At the impact speed.
    contact_steps : float or None, [-]
        Of the design, marked in the map.

    Returns
    -------
    list of pathlib.Path

    Raises
    ------
    OutputError
        A file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     len(save_charts(folder, reduced_mass=1e-3, restitution=0.5, stiffness=100.0, damping=0.1,
    ...                     time_step=1e-3))
    6
    """
    k = stiffness * np.logspace(-2.0, 2.0, 121)
    m, e, steps = reduced_mass, restitution, (time_step, 0.5 * time_step, 0.25 * time_step)
    charts = {
        "damping_stiffness": damping_chart(m, k, ending=ending),
        "contact_time_stiffness": contact_time_chart(m, k, ending=ending, hertz_time=hertz_time),
        "time_step_stiffness": time_step_chart(m, e, k, ending=ending),
        "contact_steps": contact_steps_chart(m, e, steps, ending=ending),
        "restitution": restitution_chart(m, time_step, ending=ending),
        "restitution_produced": produced_chart(e, ending=ending),
    }
    if diameter is not None and impact_speed is not None:
        charts["trial_and_error"] = trial_chart(
            m, damping, k, time_step, diameter, impact_speed, overlap_limit, ending
        )
        charts["limits"] = limits_map(
            e, time_step, diameter, impact_speed * np.logspace(-1.5, 1.5, 121), overlap_limit,
            None if hertz_time is None else (hertz_time, impact_speed),
            None if contact_steps is None else (impact_speed, contact_steps), ending,
        )  # fmt: skip
    what = (
        f"Linear contact ending at {ending}: m_ij = {1e3 * m:.4g} g, e_n = {e:.3g}, "
        f"k_n = {stiffness:.4g} N/m, eta_n = {damping:.4g} N s/m, dt = {1e3 * time_step:.3g} ms"
    )
    if diameter is not None and impact_speed is not None:
        what += f", d = {1e3 * diameter:.4g} mm, v = {100 * impact_speed:.4g} cm/s"
    return [save(figure, Path(folder) / f"{name}.png", f"{what}.") for name, figure in charts.items()]
