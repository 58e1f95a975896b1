"""One call from a wanted closest gap to a judged repulsive force."""

from __future__ import annotations

from dataclasses import dataclass

from rdpm.design._checks import positive
from rdpm.design.bodies import read_impact, read_pair
from rdpm.design.report import Row, render_rows
from rdpm.design.repulsive import closest_gap, repulsion_stiffness, repulsion_time, resting_gap, weight_stiffness
from rdpm.design.result import Severity, Verdict, _Record
from rdpm.design.verdicts import LEAST_CONTACT_STEPS
from rdpm.errors import CaseError

__all__ = ["RepulsiveDesign", "repulsive_design"]

_SOURCE = "Glowinski et al., J. Comput. Phys. 169 (2001) 363"


@dataclass(frozen=True)
class RepulsiveDesign(_Record):
    """A designed repulsive force. Attributes carry their unit; None where unknown.

    Examples
    --------
    >>> d = repulsive_design(diameter=0.01, density=2500.0, range=1e-3, gap=5e-4, impact_speed=0.1)
    >>> round(d.stiffness_N, 4), round(d.closest_gap_m, 9)
    (0.0785, 0.0005)
    """

    stiffness_N: float  # noqa: N815
    """F_0 of the force F_0 (1 - gap/range)^2: the force at touch."""
    range_m: float
    reduced_mass_kg: float
    diameter_m: float
    is_wall: bool
    impact_speed_m_s: float | None
    impact_speed_source: str | None
    weight_N: float | None  # noqa: N815
    """Submerged, of the heavier sphere."""
    closest_gap_m: float | None
    """Of a head-on approach at the impact speed; negative where surfaces overlap."""
    resting_gap_m: float | None
    """Under the weight."""
    contact_time_s: float
    """Half a period at the slope of the force at touch: what steps must resolve."""
    contact_steps: float | None
    time_step_s: float | None
    largest_time_step_s: float
    max_overlap_fraction: float | None
    """Of the smaller diameter, where the closest gap is negative."""
    verdicts: tuple[Verdict, ...]

    @property
    def ok(self) -> bool:
        """Whether no limit is broken."""
        return all(v.ok for v in self.verdicts)

    @property
    def restitution(self) -> float:
        """1: the force is conservative."""
        return 1.0

    @property
    def stiffness_N_m(self) -> None:  # noqa: N802
        """None: the spring is not linear."""

    @property
    def damping_N_s_m(self) -> None:  # noqa: N802
        """None: there is no dashpot."""

    def rows(self) -> list[Row]:
        """Quantity, value, unit and note of each line for a reader."""
        return [
            ("reduced mass", self.reduced_mass_kg, "kg", "m_ij = (1/m_i + 1/m_j)^-1"),
            ("repulsion stiffness", self.stiffness_N, "N", "F_0 of F = F_0 (1 - gap/range)^2, the force at touch"),
            ("repulsion range", self.range_m, "m", "rho"),
            ("approach speed", self.impact_speed_m_s, "m/s", self.impact_speed_source or ""),
            ("closest gap", self.closest_gap_m, "m", "head-on at this speed"),
            ("submerged weight", self.weight_N, "N", "of the heavier sphere"),
            ("resting gap", self.resting_gap_m, "m", "under the weight"),
            ("repulsion time", self.contact_time_s, "s", "pi sqrt(m_ij rho/(2 F_0))"),
            ("steps in it", self.contact_steps, "", ""),
            ("time step", self.time_step_s, "s", "dt"),
            ("largest time step", self.largest_time_step_s, "s", f"{LEAST_CONTACT_STEPS} steps in that time"),
        ]

    def __str__(self) -> str:
        return render_rows("Short-range repulsive force", self.rows(), self.verdicts)


def repulsive_design(
    *,
    diameter: float,
    density: float,
    range: float,
    stiffness: float | None = None,
    gap: float | None = None,
    diameter2: float | None = None,
    density2: float | None = None,
    wall: bool = False,
    impact_speed: float | None = None,
    time_step: float | None = None,
    fluid_density: float | None = None,
    viscosity: float | None = None,
    gravity: float = 9.81,
) -> RepulsiveDesign:
    """Design a repulsive force from a stiffness, or from a closest gap wanted, and judge it.

    Parameters
    ----------
    diameter, diameter2 : float, [m]
        > 0; equal spheres unless ``diameter2`` or ``wall`` is given.
    density, density2 : float, [kg/m^3]
        > 0; ``density2`` defaults to ``density``.
    range : float, [m]
        Gap below which the force acts, > 0.
    stiffness : float, [N], optional
        Force at touch, > 0. Either this or ``gap``.
    gap : float, [m], optional
        Closest wanted, 0 <= gap < range, at the impact speed and under the submerged weight.
    wall : bool
        The partner is a wall.
    impact_speed : float, [m/s], optional
        Normal approach speed, > 0; default the terminal velocity, where the fluid is known.
    time_step : float, [s], optional
        > 0.
    fluid_density, viscosity : float, [kg/m^3], [Pa s], optional
        > 0.
    gravity : float, [m/s^2]
        >= 0.

    Returns
    -------
    RepulsiveDesign

    Raises
    ------
    CaseError
        A quantity outside its range; both or neither of stiffness and gap; neither speed nor weight for a gap.

    References
    ----------
    .. [1] Glowinski, Pan, Hesla, Joseph, Periaux, J. Comput. Phys. 169 (2001) 363-426, doi:10.1006/jcph.2000.6542.

    Examples
    --------
    >>> d = repulsive_design(diameter=0.01, density=1140.0, range=1e-3, gap=2e-4, fluid_density=1000.0,
    ...                      viscosity=1e-3)
    >>> d.ok, d.impact_speed_source
    (True, 'terminal velocity (Brown, Lawler 2003)')
    """
    if (stiffness is None) == (gap is None):
        raise CaseError("stiffness", stiffness, "give either stiffness or gap", "each follows from the other",
                        "Leave one out.")  # fmt: skip
    pair = read_pair(None, diameter, density, diameter2, density2, wall)
    impact = read_impact(pair, impact_speed, fluid_density, viscosity, gravity)
    m, d, rho = float(pair.mass or 0.0), float(pair.diameter or 0.0), float(positive("range", range))
    if stiffness is None:
        needed = [float(repulsion_stiffness(m, rho, impact.speed, gap))] if impact.speed else []
        needed += [float(weight_stiffness(impact.weight, rho, gap))] if impact.weight else []
        if not needed:
            raise CaseError("impact_speed", None, "must be given", "neither a speed nor a weight closes the gap",
                            "Add impact_speed, or gravity.")  # fmt: skip
        stiffness = max(needed)
    closest = None if impact.speed is None else float(closest_gap(m, stiffness, rho, impact.speed))
    resting = None if not impact.weight else float(resting_gap(impact.weight, stiffness, rho))
    time = float(repulsion_time(m, stiffness, rho))
    steps = None if time_step is None else time / float(positive("time_step", time_step))
    return RepulsiveDesign(
        stiffness_N=float(stiffness), range_m=rho, reduced_mass_kg=m, diameter_m=d, is_wall=wall,
        impact_speed_m_s=impact.speed, impact_speed_source=impact.source, weight_N=impact.weight,
        closest_gap_m=closest, resting_gap_m=resting, contact_time_s=time, contact_steps=steps,
        time_step_s=time_step, largest_time_step_s=time / LEAST_CONTACT_STEPS,
        max_overlap_fraction=None if closest is None else max(0.0, -closest / d),
        verdicts=_verdicts(closest, resting, steps, rho),
    )  # fmt: skip


def _verdicts(
    closest: float | None, resting: float | None, steps: float | None, rho: float
) -> tuple[Verdict, ...]:
    """Judge what is known: surfaces stay apart, steps resolve the force."""
    out = []
    for name, word, gap in (("closest_gap", "closest gap", closest), ("resting_gap", "resting gap", resting)):
        if gap is not None:
            is_apart = gap >= -1e-9 * rho  # round-off of a design for touch
            severity: Severity = "ok" if is_apart else "fail"
            text = f"{word} {1e2 * gap / rho:.3g} % of the range {'>=' if is_apart else '<'} 0"
            out.append(Verdict(name, gap, 0.0, is_apart, "below 0 the surfaces overlap", _SOURCE, severity, text))
    if steps is not None:
        is_resolved = steps * (1.0 + 1e-9) >= LEAST_CONTACT_STEPS
        text = f"force resolved by {steps:.3g} steps {'>=' if is_resolved else '<'} {LEAST_CONTACT_STEPS}"
        out.append(Verdict("contact_steps", steps, float(LEAST_CONTACT_STEPS), is_resolved,
                           "with fewer the fluid sees the repulsion as a jump", "rdpm's bound",
                           "ok" if is_resolved else "fail", text))  # fmt: skip
    return tuple(out)
