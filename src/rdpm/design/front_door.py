"""One call from what a user knows to a judged design."""

from __future__ import annotations

import math

from rdpm.design._checks import Ending, check_ending, positive
from rdpm.design.advice import advise_on_spring, advise_on_steps
from rdpm.design.bodies import Impact, Pair, read_impact, read_pair
from rdpm.design.dimensionless import added_mass, legendre, reduced_mass, sphere_mass, stokes_number
from rdpm.design.hertz import effective_modulus, hertz_contact_time, rayleigh_time
from rdpm.design.integrators import INTEGRATORS, produced_restitution
from rdpm.design.oscillator import dimensionless_contact_time, peak_overlap_factor
from rdpm.design.oscillator import restitution as restitution_of
from rdpm.design.overlap import softest_stiffness
from rdpm.design.result import Advice, Body, Design, Prediction, Tangential
from rdpm.design.soft_sphere import peak_overlap
from rdpm.design.solve import Known, solve_contact
from rdpm.design.tangential import (
    ratio_from_poisson,
    sliding_ratio,
    tangential_parameters,
    tangential_restitution,
)
from rdpm.design.verdicts import USUAL_OVERLAP, regime_of, verdict_list
from rdpm.errors import CaseError

__all__ = ["soft_sphere"]

_LARGEST = 1e30
_LARGEST_OVERLAP = 0.05  # of the diameter; more is a percentage that lost its sign, or no sphere any more
_PREDICTED_UP_TO = 500.0  # contact steps; beyond, all but explicit Euler are within 0.2 %


def _contact_time(
    contact_time: float | None, contact_steps: float | None, time_step: float | None
) -> float | None:
    """Give the contact time that is fixed by the caller, if any."""
    for name, value in (
        ("contact_time", contact_time),
        ("contact_steps", contact_steps),
        ("time_step", time_step),
    ):
        if value is not None:
            positive(name, value)
    if contact_steps is None or time_step is None:
        return contact_time
    if contact_time is not None:
        rule = "cannot go with both contact_steps and time_step"
        raise CaseError("contact_time", f"{contact_time:g}", rule, "it is their product", "Take one away.")
    return contact_steps * time_step


def _need(value: float | None, name: str, why: str) -> float:
    """Refuse a quantity that something else given depends on."""
    if value is None:
        raise CaseError(name, None, "must be given", why, f"Add {name}.")
    return float(value)


def soft_sphere(
    *,
    mass: float | None = None,
    diameter: float | None = None,
    density: float | None = None,
    diameter2: float | None = None,
    density2: float | None = None,
    wall: bool = False,
    stiffness: float | None = None,
    damping: float | None = None,
    restitution: float | None = None,
    contact_time: float | None = None,
    contact_steps: float | None = None,
    time_step: float | None = None,
    max_overlap: float | None = None,
    static_overlap: float | None = None,
    impact_speed: float | None = None,
    youngs_modulus: float | None = None,
    poisson_ratio: float | None = None,
    fluid_density: float | None = None,
    viscosity: float | None = None,
    gravity: float = 9.81,
    tangential_ratio: float | None = None,
    friction: float | None = None,
    overlap_limit: float = USUAL_OVERLAP,
    ending: Ending = "zero-force",
) -> Design:
    r"""Design a linear soft-sphere contact from any sufficient set of what is known, and judge it.

    Parameters
    ----------
    mass : float, [kg], optional
        Reduced mass > 0; or ``diameter`` with ``density``. Left out, it follows where three of stiffness,
        damping, restitution and contact time are given.
    diameter, diameter2 : float, [m], optional
        > 0; equal spheres unless ``diameter2`` or ``wall`` is given.
    density, density2 : float, [kg/m^3], optional
        > 0; ``density2`` defaults to ``density``.
    wall : bool
        The partner is a wall, or a body held fixed.
    stiffness : float, [N/m], optional
        > 0.
    damping : float, [N s/m], optional
        >= 0.
    restitution : float, [-], optional
        0 < e_n <= 1; 0 at zero overlap with a stiffness.
    contact_time : float, [s], optional
        > 0; ``contact_steps`` with ``time_step`` say the same.
    contact_steps : float, [-], optional
        > 0.
    time_step : float, [s], optional
        > 0.
    max_overlap : float, [-], optional
        Peak overlap as a fraction of the smaller diameter, reached at ``impact_speed``; 0 < to 0.05.
    static_overlap : float, [-], optional
        Overlap under the submerged weight as a fraction of the smaller diameter: gives the stiffness.
        0 < to 0.05.
    impact_speed : float, [m/s], optional
        > 0; default the terminal velocity, where the fluid is known.
    youngs_modulus : float, [Pa], optional
        > 0, of both bodies, with ``poisson_ratio``: the lower limits of Hertz and Rayleigh. Where nothing else
        fixes how stiff the contact is, the contact time is Hertz's.
    poisson_ratio : float, [-], optional
        -1 < sigma <= 0.5; gives ``tangential_ratio`` too.
    fluid_density : float, [kg/m^3], optional
        > 0.
    viscosity : float, [Pa s], optional
        Dynamic, > 0.
    gravity : float, [m/s^2]
        >= 0.
    tangential_ratio : float, [-], optional
        :math:`k_t/k_n` >= 0; default 2/7.
    friction : float, [-], optional
        Coulomb's coefficient >= 0.
    overlap_limit : float, [-]
        Bound of the overlap verdicts, a fraction of the smaller diameter, 0 < to 0.05; a smaller ``max_overlap``
        tightens it, a larger one is judged by it. Above the usual 0.5 %, overlaps between the two are notes.
    ending : {"zero-force", "zero-overlap"}
        When the contact is over.

    Returns
    -------
    Design

    Raises
    ------
    CaseError
        A quantity outside its range; too little, too much or contradictory input, the message naming it.

    Notes
    -----
    One impact along the line of centres, dry; the fluid enters Stokes number and wet restitution only.

    References
    ----------
    .. [1] Hoomans et al., Chem. Eng. Sci. 51 (1996) 99-118.
    .. [2] Schwager, Poeschel, Granular Matter 9 (2007) 465-469, doi:10.1007/s10035-007-0065-z.

    Examples
    --------
    >>> d = soft_sphere(diameter=0.015, density=1120.0, restitution=0.5, contact_steps=8, time_step=1e-3,
    ...                 impact_speed=0.05, ending="zero-overlap")
    >>> round(d.stiffness_N_m, 2), round(d.damping_N_s_m, 4), d.advice.best_contact_steps
    (160.04, 0.1715, 6)
    """
    given = {name: q for name, q in locals().items() if isinstance(q, int | float) and name != "wall"}
    check_ending(ending)
    _refuse_extremes(given)
    pair = read_pair(mass, diameter, density, diameter2, density2, wall)
    impact = read_impact(pair, impact_speed, fluid_density, viscosity, gravity)
    t_c = _contact_time(contact_time, contact_steps, time_step)
    limit = _overlap_limit(max_overlap, static_overlap, overlap_limit)
    overlap_time = None if max_overlap is None else _overlap_time(max_overlap, pair, impact)
    if static_overlap is not None:
        stiffness = _static_stiffness(stiffness, static_overlap, pair, impact)
    hertz, rayleigh = _material_times(pair, impact, youngs_modulus, poisson_ratio)
    known = Known(pair.mass, stiffness, damping, restitution, t_c, overlap_time)
    if hertz is not None and t_c is None and sum(q is not None for q in known[1:]) == 1:
        t_c, known = hertz, known._replace(contact_time=hertz)
    is_spring_given = contact_steps is None or time_step is None
    m, k_n, eta_n = solve_contact(known, ending)
    zeta = 0.5 * eta_n / math.sqrt(m * k_n)
    e = _restitution(restitution, zeta, ending)
    duration = t_c if t_c is not None else _finite(dimensionless_contact_time(zeta, ending), math.sqrt(m / k_n))
    steps, step = _steps(duration, contact_steps, time_step)
    overlap, fraction, sink = _overlaps((m, k_n, eta_n), pair, impact)
    stokes, wet = _wet(m, pair, impact, e, fluid_density, viscosity)
    verdicts = verdict_list(
        damping_ratio=zeta, ending=ending, contact_time=duration, contact_steps=steps, max_overlap=fraction,
        static_overlap=sink, overlap_limit=limit, hertz_time=hertz, rayleigh_time=rayleigh, stokes_number=stokes,
        impact_speed=impact.speed,
    )  # fmt: skip
    return Design(
        stiffness_N_m=k_n, damping_N_s_m=eta_n, restitution=e, contact_time_s=duration, contact_steps=steps,
        damping_ratio=zeta, regime=regime_of(zeta), ending=ending, reduced_mass_kg=m, diameter_m=pair.diameter,
        spheres=tuple(Body(*sphere) for sphere in pair.spheres), is_wall=wall, time_step_s=step,
        impact_speed_m_s=impact.speed, impact_speed_source=impact.source, max_overlap_m=overlap,
        max_overlap_fraction=fraction, static_overlap_fraction=sink, overlap_limit_fraction=limit,
        hertz_contact_time_s=hertz, rayleigh_time_s=rayleigh, terminal_velocity_m_s=impact.terminal_velocity,
        terminal_reynolds_number=impact.terminal_reynolds, stokes_number=stokes, wet_restitution=wet,
        tangential=_tangential(k_n, eta_n, zeta, e, ending, tangential_ratio, poisson_ratio, friction),
        predictions=_predictions(e, steps, ending), verdicts=verdicts,
        advice=_advice(m, k_n, zeta, ending, limit, pair, impact, (hertz, rayleigh), steps, step, is_spring_given),
    )  # fmt: skip


def _overlap_time(max_overlap: float, pair: Pair, impact: Impact) -> float:
    """Give the overlap over the impact speed, in which the peak is sought."""
    speed = _need(impact.speed, "impact_speed", "an overlap is reached at a speed")
    return max_overlap * _need(pair.diameter, "diameter", "an overlap is a part of it") / speed


def _steps(duration: float | None, steps: float | None, step: float | None) -> tuple[float | None, float | None]:
    """Contact steps and time step, of which one may follow from the other; a contact that never ends has no steps."""
    if duration is None:
        return None, step
    if steps is None:
        return (None if step is None else duration / step), step
    return steps, duration / steps if step is None else step


def _overlaps(
    contact: tuple[float, float, float], pair: Pair, impact: Impact
) -> tuple[float | None, float | None, float | None]:
    """Peak overlap at the impact speed [m], the same over the diameter, and that under the weight over the diameter."""
    d, overlap = pair.diameter, None if impact.speed is None else float(peak_overlap(*contact, impact.speed))
    fraction = None if overlap is None or d is None else overlap / d
    return overlap, fraction, None if impact.weight is None or d is None else impact.weight / contact[1] / d


def _refuse_extremes(given: dict[str, float]) -> None:
    """Refuse what is not finite, or beyond where squares and cubes leave the range of a double."""
    for name, value in given.items():
        if not math.isfinite(value) or abs(value) > _LARGEST or 0.0 < abs(value) < 1.0 / _LARGEST:
            rule = f"must be a finite number above {1 / _LARGEST:g} and below {_LARGEST:g} in size, or 0"
            raise CaseError(name, f"{value:g}", rule, "nothing physical lies beyond", "Correct this value.")


def _overlap_limit(max_overlap: float | None, static_overlap: float | None, overlap_limit: float) -> float:
    """Give the bound of the overlap verdicts; refuse fractions that can only be percentages."""
    given = {"max_overlap": max_overlap, "static_overlap": static_overlap, "overlap_limit": overlap_limit}
    for name, value in given.items():
        if value is not None and positive(name, value) > _LARGEST_OVERLAP:
            rule = f"must be at most {_LARGEST_OVERLAP:g}, a fraction of the diameter"
            cure = f'For {value:g} % write {0.01 * value:g}, or "{value:g} %".' if value <= 5.0 else "Lower it."
            raise CaseError(name, f"{value:g}", rule, "a contact that deep is no sphere's", cure)
    return float(overlap_limit if max_overlap is None else min(max_overlap, overlap_limit))


def _finite(number: float, unit: float) -> float | None:
    """Give a product, None where it is infinite."""
    return float(number) * unit if math.isfinite(number) else None


def _restitution(given: float | None, zeta: float, ending: Ending) -> float | None:
    """Give the restitution; None where spheres never part, at zero overlap past critical damping."""
    if given is not None:
        return float(given)
    undefined = ending == "zero-overlap" and regime_of(zeta) == "overdamped"
    return None if undefined else float(restitution_of(zeta, ending))


def _static_stiffness(stiffness: float | None, fraction: float, pair: Pair, impact: Impact) -> float:
    """Give the spring that a resting sphere sinks into by a fraction of the smaller diameter."""
    if stiffness is not None:
        rule, why = "cannot go with stiffness", "each gives the other"
        raise CaseError("static_overlap", f"{fraction:g}", rule, why, "Take one away.")
    weight = _need(impact.weight, "density", "a static overlap needs a weight")
    if not weight > 0.0:
        rule, why = "needs a submerged weight above 0", "nothing presses the spheres together"
        raise CaseError("static_overlap", f"{fraction:g}", rule, why, "Give the stiffness.")
    d = _need(pair.diameter, "diameter", "an overlap is a part of it")
    return float(softest_stiffness(weight, positive("static_overlap", fraction) * d))


def _material_times(
    pair: Pair, impact: Impact, youngs_modulus: float | None, poisson_ratio: float | None
) -> tuple[float | None, float | None]:
    """Give the Hertz contact time and the Rayleigh time of the quicker sphere, None where not known."""
    if youngs_modulus is None:
        return None, None
    sigma = _need(poisson_ratio, "poisson_ratio", "youngs_modulus alone does not say how stiff a contact is")
    modulus = effective_modulus(youngs_modulus, sigma)
    waves = [float(rayleigh_time(0.5 * d, rho, youngs_modulus, sigma)) for d, rho in pair.spheres]
    hertz = None
    if pair.mass is not None and pair.radius is not None and impact.speed is not None:
        hertz = float(hertz_contact_time(pair.mass, pair.radius, modulus, impact.speed))
    return hertz, min(waves, default=None)


def _wet(
    m: float,
    pair: Pair,
    impact: Impact,
    e: float | None,
    fluid_density: float | None,
    viscosity: float | None,
) -> tuple[float | None, float | None]:
    """Give the Stokes number and Legendre's wet restitution, whose Stokes number has the added mass of both spheres."""
    if viscosity is None or impact.speed is None or pair.radius is None:
        return None, None
    stokes = float(stokes_number(m, pair.radius, impact.speed, viscosity))
    if e is None or fluid_density is None or not pair.spheres:
        return stokes, None
    masses = [sphere_mass(d, rho) + added_mass(d, fluid_density) for d, rho in pair.spheres]
    inertia = reduced_mass(*masses)
    return stokes, float(legendre(e, stokes_number(inertia, pair.radius, impact.speed, viscosity)))


def _tangential(
    k_n: float,
    eta_n: float,
    zeta: float,
    e: float | None,
    ending: Ending,
    ratio: float | None,
    poisson_ratio: float | None,
    friction: float | None,
) -> Tangential:
    """Give the tangential spring; its stiffness ratio is given, Mindlin's, or 2/7 (equal periods)."""
    if ratio is None:
        ratio = 2.0 / 7.0 if poisson_ratio is None else float(ratio_from_poisson(poisson_ratio))
    k_t, eta_t = tangential_parameters(k_n, eta_n, ratio)
    e_t = float(tangential_restitution(zeta, ratio, ending))
    slides = None
    if friction is not None and e is not None and e_t > -1.0:
        slides = float(sliding_ratio(friction, e, e_t))
    return Tangential(ratio, k_t, eta_t, e_t if math.isfinite(e_t) else None, friction, slides)


def _predictions(e: float | None, steps: float | None, ending: Ending) -> tuple[Prediction, ...]:
    """Say what each integrator makes of the design; empty where there are no steps to speak of."""
    if not e or steps is None or not 1.0 < steps <= _PREDICTED_UP_TO:
        return ()
    return tuple(Prediction(name, *produced_restitution(e, steps, name, ending)) for name in INTEGRATORS)


def _advice(
    m: float,
    k_n: float,
    zeta: float,
    ending: Ending,
    limit: float,
    pair: Pair,
    impact: Impact,
    material: tuple[float | None, float | None],
    steps: float | None,
    step: float | None,
    is_spring_given: bool,
) -> Advice:
    """Bound the contact time at this damping ratio from both sides."""
    tau = float(dimensionless_contact_time(zeta, ending))
    bounds = []
    if pair.diameter is not None and math.isfinite(tau):
        overlap = limit * pair.diameter
        if impact.speed is not None:
            at_impact = tau * overlap / impact.speed / float(peak_overlap_factor(zeta))
            bounds.append((at_impact, "the overlap at the impact speed"))
        if impact.weight:
            at_rest = tau * math.sqrt(m / float(softest_stiffness(impact.weight, overlap)))
            bounds.append((at_rest, "the overlap at rest"))
    waves = [(t, name) for t, name in zip(material, ("Hertz", "Rayleigh"), strict=True) if t is not None]
    shortest, asks = max(waves, default=(None, ""))
    longest, decides = min(bounds, default=(None, ""))
    if is_spring_given or step is None or steps is None:
        return advise_on_spring(
            stiffness=k_n, contact_time=_finite(tau, math.sqrt(m / k_n)), shortest=shortest, longest=longest,
            time_step=step, contact_steps=steps, asks=asks, decides=decides,
        )  # fmt: skip
    return advise_on_steps(
        shortest=shortest, longest=longest, time_step=step, contact_steps=steps, asks=asks, decides=decides
    )
