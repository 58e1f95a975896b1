"""Charts of collision parameters: how stiffness, damping, contact time and steps hang together."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from rdpm.design._checks import Ending
from rdpm.design.approaches import by_contact_steps, graphical
from rdpm.design.soft_sphere import contact_time
from rdpm.design.wording import speed_text, time_text
from rdpm.figures.design_limits import limits_map, line, own, produced_chart, trial_chart
from rdpm.figures.style import ACCENT, column_chart, save

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

_K, _ETA = "stiffness $k_n$ [N/m]", "damping $\\eta_n$ [N s/m]"


def damping_chart(
    reduced_mass: float,
    stiffness: Any,
    restitutions: Sequence[float] = (0.1, 0.3, 0.5, 0.7, 0.9),
    ending: Ending = "zero-force",
    own_design: tuple[float, float] | None = None,
) -> Figure:
    """Damping against stiffness for several restitutions; critical damping is e_n = 0 at zero overlap.

    Parameters
    ----------
    reduced_mass : float, [kg]
        > 0.
    stiffness : (n,) array, [N/m]
        > 0.
    restitutions : sequence of float, [-]
        Each in (0, 1).
    ending : {"zero-force", "zero-overlap"}
    own_design : (float, float) or None
        Stiffness [N/m] and damping [N s/m] of the user's design, marked.

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> len(damping_chart(1e-3, [1.0, 10.0]).axes)
    1
    """
    with column_chart("Damping that gives a restitution") as figure:
        axes = figure.add_subplot(xlabel=_K, ylabel=_ETA, xscale="log", yscale="log")
        for i, e in enumerate(restitutions):
            table = graphical(reduced_mass, e, stiffness, [1.0], ending)
            line(axes, i, table.stiffness, table.damping, f"$e_n$ = {e:g}")
        axes.plot(table.stiffness, table.critical_damping, color=ACCENT, lw=2.5, label="critical", zorder=1)
        own(axes, own_design)
    return figure


def contact_time_chart(
    reduced_mass: float,
    stiffness: Any,
    restitutions: Sequence[float] = (0.1, 0.5, 0.9),
    ending: Ending = "zero-force",
    hertz_time: float | None = None,
    own_design: tuple[float, float] | None = None,
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
    own_design : (float, float) or None
        Stiffness [N/m] and contact time [s] of the user's design, marked.

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> len(contact_time_chart(1e-3, [1.0, 10.0]).axes)
    1
    """
    with column_chart("Contact time of a spring") as figure:
        axes = figure.add_subplot(xlabel=_K, ylabel="contact time $t_c$ [s]", xscale="log", yscale="log")
        for i, e in enumerate(restitutions):
            table = graphical(reduced_mass, e, stiffness, [1.0], ending)
            line(axes, i, table.stiffness, table.contact_time, f"$e_n$ = {e:g}")
        if hertz_time is not None:
            axes.axhline(hertz_time, color=ACCENT, lw=2.5, label="Hertz: no shorter", zorder=1)
        own(axes, own_design)
    return figure


def time_step_chart(
    reduced_mass: float,
    restitution: float,
    stiffness: Any,
    contact_steps: Sequence[float] = (4, 8, 15, 50),
    ending: Ending = "zero-force",
    own_design: tuple[float, float] | None = None,
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
    own_design : (float, float) or None
        Stiffness [N/m] and time step [s] of the user's design, marked.

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> len(time_step_chart(1e-3, 0.5, [1.0, 10.0]).axes)
    1
    """
    table = graphical(reduced_mass, restitution, stiffness, [1.0], ending)
    with column_chart("Time step that resolves a spring") as figure:
        axes = figure.add_subplot(xlabel=_K, ylabel="time step $\\delta t$ [s]", xscale="log", yscale="log")
        for i, n in enumerate(contact_steps):
            line(axes, i, table.stiffness, table.contact_time / n, f"$N_c$ = {n:g}")
        own(axes, own_design)
    return figure


def contact_steps_chart(
    reduced_mass: float,
    restitution: float,
    time_steps: Sequence[float],
    contact_steps: Any = range(4, 31),
    ending: Ending = "zero-force",
    own_design: tuple[float, float, float] | None = None,
) -> Figure:
    """Stiffness and damping against contact steps for several time steps.

    Parameters
    ----------
    reduced_mass : float, [kg]
        > 0.
    restitution : float, [-]
        In (0, 1].
    time_steps : sequence of float, [s]
        > 0.
    contact_steps : (n,) array, [-]
        > 0.
    ending : {"zero-force", "zero-overlap"}
    own_design : (float, float, float) or None
        Contact steps [-], stiffness [N/m] and damping [N s/m] of the user's design, marked.

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> len(contact_steps_chart(1e-3, 0.5, [1e-3]).axes)
    2
    """
    n = np.asarray(contact_steps, dtype=np.float64)
    with column_chart("Spring and dashpot from contact steps", 4.6) as figure:
        left, right = figure.subplots(2, 1, sharex=True)
        for i, dt in enumerate(time_steps):
            table = by_contact_steps(reduced_mass, restitution, n, dt, 1.0, 1.0, 0.0, ending)
            line(left, i, n, table.stiffness, f"$\\delta t$ = {time_text(dt)}")
            line(right, i, n, table.damping, f"$\\delta t$ = {time_text(dt)}")
        for axes, name, at in ((left, _K, 1), (right, _ETA, 2)):
            is_damped = axes is left or restitution < 1.0
            axes.set(ylabel=name, yscale="log" if is_damped else "linear")
            own(axes, None if own_design is None else (own_design[0], own_design[at]))
        right.set_xlabel("contact steps $N_c$")
        figure.align_ylabels()
    return figure


def restitution_chart(
    reduced_mass: float,
    time_step: float,
    contact_steps: Sequence[float] = (4, 8, 10, 12, 15),
    restitutions: Any = None,
    ending: Ending = "zero-force",
    own_design: tuple[float, float, float] | None = None,
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
    own_design : (float, float, float) or None
        Restitution [-], stiffness [N/m] and damping [N s/m] of the user's design, marked.

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> len(restitution_chart(1e-3, 1e-3).axes)
    2
    """
    e = np.linspace(0.02, 1.0, 120) if restitutions is None else np.asarray(restitutions, dtype=np.float64)
    with column_chart("Spring and dashpot from the restitution", 4.6) as figure:
        left, right = figure.subplots(2, 1, sharex=True)
        for i, n in enumerate(contact_steps):
            tables = [by_contact_steps(reduced_mass, q, n, time_step, 1.0, 1.0, 0.0, ending) for q in e]
            line(left, i, e, [t.stiffness[0] for t in tables], f"$N_c$ = {n:g}")
            line(right, i, e, [t.damping[0] for t in tables], f"$N_c$ = {n:g}")
        for axes, name, at in ((left, _K, 1), (right, _ETA, 2)):
            axes.set(ylabel=name)
            own(axes, None if own_design is None else (own_design[0], own_design[at]))
        left.set_yscale("log")
        right.set_xlabel("restitution $e_n$")
        figure.align_ylabels()
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
    kind: Literal["png", "pdf", "svg"] = "png",
) -> list[Path]:
    """Write every chart for one contact, which is marked in each.

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
    kind : {"png", "pdf", "svg"}
        Of the files.

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
    t_c = float(contact_time(m, stiffness, damping, ending))
    n = t_c / time_step
    counts = np.linspace(min(4.0, n), max(30.0, 1.2 * n), 60)
    own_count = float(f"{n:.3g}")
    others = [q for q in (4.0, 8.0, 12.0) if abs(q / n - 1.0) > 0.1]
    targets = sorted({float(f"{e:.3g}"), *(q for q in (0.1, 0.5, 0.9) if abs(q - e) > 0.05)} - {1.0})
    charts = {
        "damping_stiffness": damping_chart(m, k, targets, ending, (stiffness, damping)),
        "contact_time_stiffness": contact_time_chart(m, k, targets, ending, hertz_time, (stiffness, t_c)),
        "time_step_stiffness": time_step_chart(m, e, k, ending=ending, own_design=(stiffness, time_step)),
        "contact_steps": contact_steps_chart(m, e, steps, counts, ending, (n, stiffness, damping)),
        "restitution": restitution_chart(
            m, time_step, sorted({own_count, *others}), None, ending, (e, stiffness, damping)
        ),
        "restitution_achieved": produced_chart(
            e, np.geomspace(4.0, max(50.0, min(1.5 * n, 500.0)), 24), ending, own_steps=n
        ),
    }
    if diameter is not None and impact_speed is not None:
        charts["trial_and_error"] = trial_chart(
            m, damping, k, time_step, diameter, impact_speed, overlap_limit, ending, stiffness
        )
        charts["limits"] = limits_map(
            e, time_step, diameter, impact_speed * np.logspace(-1.5, 1.5, 121), overlap_limit,
            None if hertz_time is None else (hertz_time, impact_speed), (impact_speed, n), ending,
        )  # fmt: skip
    what = (
        f"Linear contact ending at {ending}: m_ij = {1e3 * m:.4g} g, e_n = {e:.3g}, "
        f"k_n = {stiffness:.4g} N/m, eta_n = {damping:.4g} N s/m, dt = {time_text(time_step)}"
    )
    if diameter is not None and impact_speed is not None:
        what += f", d = {1e3 * diameter:.4g} mm, v = {speed_text(impact_speed)}"
    return [save(figure, Path(folder) / f"{name}.{kind}", f"{what}.") for name, figure in charts.items()]
