"""Claims of Musong, Feng and Michaelides (2012) that formulas decide; numbers in the units of the talk (dyn, cm, s)."""

from __future__ import annotations

import numpy as np

from rdpm import design
from rdpm.studies.claims.claim import Claim, Computed, Judgement, Verdict

__all__ = ["DESIGN_CLAIMS"]

#: Reduced mass behind the talk's tables [kg]; that of its spheres (15 mm, 1120 kg/m3) is 0.065 % lower.
TALK_MASS = 0.9902467e-3
DIAMETER, PARTICLE_DENSITY, FLUID_DENSITY = 0.015, 1120.0, 962.0
#: Viscosity as printed, and that of the fluid that has this density (ten Cate et al. 2002, case E3) [Pa s].
PRINTED_VISCOSITY, VISCOSITY = 0.913, 0.113
RESTITUTION, TIME_STEP = 0.5, 1e-3
OVERLAP_LIMIT = 0.005
DYN_CM = 1e-3   # N/m, and N s/m a dyn s/cm

#: N_c, k_n [dyn/cm], eta_n [dyn s/cm].
STEPS_TABLE = ((8, 160142.35, 171.60), (10, 102491.10, 137.28), (12, 71174.37, 114.39))
#: k_n [dyn/cm], eta_n of e_n = 0 and of e_n = 0.8 [dyn s/cm], contact time [s].
GRAPHICAL_TABLE = (
    (1e2, 19.90, 1.41, 0.3134), (1e3, 62.94, 4.46, 0.0991), (5e3, 140.73, 9.97, 0.0443), (5e4, 445.03, 31.53, 0.0140),
    (1e5, 629.36, 44.59, 0.0099), (5e5, 1407.30, 99.71, 0.0044), (1e6, 1990.22, 141.01, 0.0031),
    (1e7, 6293.64, 445.91, 0.0010),
)  # fmt: skip
#: k_n [dyn/cm], eta_n [dyn s/cm] of the talk's runs of a pair.
RUNS = ((1e3, 100.0), (5e4, 100.0), (5e5, 100.0), (5e4, 0.0), (5e4, 50.0), (5e3, 150.0), (1e5, 150.0))
TRIAL_RANGE, MEASURED_RANGE = (5e3, 1e5), (3e5, 1e6)


def _talk_contact(contact_steps: float, time_step: float = TIME_STEP) -> tuple[float, float]:
    """k_n [dyn/cm], eta_n [dyn s/cm]."""
    k_n, eta_n = design.contact_parameters(TALK_MASS, RESTITUTION, contact_steps * time_step, "zero-overlap")
    return float(k_n) / DYN_CM, float(eta_n) / DYN_CM


def _listed(values: list[float], form: str = ".3g") -> str:
    return ", ".join(f"{value:{form}}" for value in values)


def _terminal_speed(viscosity: float) -> tuple[float, float]:
    speed, re = design.terminal_velocity(DIAMETER, PARTICLE_DENSITY, FLUID_DENSITY, viscosity)
    return float(speed), float(re)


def stiffness_and_time_step() -> Judgement:
    """k_n and eta_n against dt at N_c = 8."""
    steps = [0.25e-3, 0.5e-3, 1e-3]
    k_n, eta_n = (list(column) for column in zip(*(_talk_contact(8, dt) for dt in steps), strict=True))
    slopes = [float(np.polyfit(np.log(steps), np.log(values), 1)[0]) for values in (k_n, eta_n)]
    text = (
        f"At N_c = 8 and e_n = 0.5, k_n is {_listed(k_n)} dyn/cm and eta_n {_listed(eta_n, '.4g')} dyn s/cm at "
        f"dt = {_listed([1e3 * dt for dt in steps])} ms: powers {slopes[0]:.2f} and {slopes[1]:.2f} of dt."
    )
    falls = all(np.diff(k_n) < 0.0) and all(np.diff(eta_n) < 0.0)
    numbers = {"stiffness_power": slopes[0], "damping_power": slopes[1]}
    return Judgement("confirmed" if falls else "contradicted", text, numbers=numbers)


def steps_table() -> Judgement:
    """The table of N_c 8, 10, 12."""
    pairs = [pair for n, *row in STEPS_TABLE for pair in zip(_talk_contact(n), row, strict=True)]
    off = [abs(ours / theirs - 1.0) for ours, theirs in pairs]
    mass = 0.5 * float(design.sphere_mass(DIAMETER, PARTICLE_DENSITY))
    text = (
        f"With e_n = 0.5, dt = 1 ms and m_ij = 0.99025 g, none of which the slide states, the largest deviation is "
        f"{max(off):.1e}; the spheres' own m_ij is {100.0 * (1.0 - mass / TALK_MASS):.3f} % lower."
    )
    numbers = {"largest_deviation": max(off), "nominal_mass_kg": mass}
    return Judgement("conditional" if max(off) < 1e-4 else "contradicted", text, numbers=numbers)


def graphical_table() -> Judgement:
    """The table of k_n 1e2 to 1e7."""
    off = []
    for k_n, critical, damping, time in GRAPHICAL_TABLE:
        etas = [design.damping_from_stiffness(TALK_MASS, e, k_n * DYN_CM, "zero-overlap") for e in (0.0, 0.8)]
        t_c = float(design.contact_time(TALK_MASS, k_n * DYN_CM, etas[1], "zero-overlap"))
        off += [(float(etas[0]) / DYN_CM - critical) / 0.01, (float(etas[1]) / DYN_CM - damping) / 0.01]
        off.append((t_c - time) / 1e-4)
    worst = float(np.max(np.abs(off)))
    text = f"All {len(off)} numbers are met within {worst:.2f} of their last printed digit."
    return Judgement("confirmed" if worst <= 1.0 else "contradicted", text, numbers={"last_digits": worst})


def agreement_of_ranges() -> Judgement:
    """N_c 8 to 12 beside 5e3 to 1e5 dyn/cm."""
    low, high = TRIAL_RANGE
    ends = [
        float(design.contact_steps_for_stiffness(TALK_MASS, RESTITUTION, k * DYN_CM, TIME_STEP, "zero-overlap"))
        for k in (high, low)
    ]
    k_n = {n: _talk_contact(n)[0] for n, *_ in STEPS_TABLE}
    inside = [n for n, k in k_n.items() if low <= k <= high]
    listed = ", ".join(f"{k:.3g} (N_c {n})" for n, k in k_n.items())
    text = (
        f"k_n is {listed} dyn/cm: inside 5e3 to 1e5 only from N_c = {ends[0]:.2f} to {ends[1]:.1f} (e_n 0.5, dt 1 ms), "
        f"which of the three holds for {len(inside)}."
    )
    verdict: Verdict = "confirmed" if len(inside) == len(k_n) else "conditional" if inside else "contradicted"
    return Judgement(verdict, text, numbers={"least_contact_steps": ends[0], "most_contact_steps": ends[1]})


def measured_range() -> Judgement:
    """N_c 8 to 12 beside the measured 3e5 to 1e6 dyn/cm."""
    low, high = MEASURED_RANGE
    k_n = [_talk_contact(n)[0] for n, *_ in STEPS_TABLE]
    steps = [
        float(design.contact_steps_for_stiffness(TALK_MASS, RESTITUTION, k * DYN_CM, TIME_STEP, "zero-overlap"))
        for k in (low, high)
    ]
    inside = sum(low <= k <= high for k in k_n)
    text = (
        f"k_n of N_c 8, 10, 12 is {_listed(k_n)} dyn/cm, {inside} of 3 inside; the measured range is N_c "
        f"{steps[0]:.2f} to {steps[1]:.2f} at e_n 0.5 and dt 1 ms."
    )
    verdict: Verdict = "confirmed" if inside == 3 else "conditional" if inside else "contradicted"
    return Judgement(verdict, text, numbers={"contact_steps_soft": steps[0], "contact_steps_stiff": steps[1]})


def printed_viscosity() -> Judgement:
    """Reynolds number of one sphere with the printed viscosity and with 0.113 Pa s."""
    re = [_terminal_speed(mu)[1] for mu in (PRINTED_VISCOSITY, VISCOSITY)]
    text = (
        f"One sphere settles at Re = {re[0]:.2g} with 0.913 Pa s and at {re[1]:.3g} with 0.113 Pa s; an oil of 962 "
        "kg/m3 and 0.113 Pa s is case E3 of ten Cate et al. (2002)."
    )
    # Drafting needs a wake: an equal pair in Stokes flow falls side by side or in line at one speed.
    numbers = {"reynolds_printed": re[0], "reynolds": re[1]}
    return Judgement("contradicted" if re[0] < 1.0 < re[1] else "confirmed", text, numbers=numbers)


def overdamped_runs() -> Judgement:
    """Damping ratio and restitution of the talk's runs."""
    mass = 0.5 * float(design.sphere_mass(DIAMETER, PARTICLE_DENSITY))
    zeta = [0.5 * eta * DYN_CM / np.sqrt(mass * k * DYN_CM) for k, eta in RUNS]
    e_n = [float(design.restitution(z, "zero-overlap")) for z in zeta]
    listed = "; ".join(
        f"k_n {k:g}, eta_n {eta:g}: zeta {z:.2f}, " + ("no e_n" if z >= 1.0 else f"e_n {e:.2f}")
        for (k, eta), z, e in zip(RUNS, zeta, e_n, strict=True)
    )
    least = {eta: (eta * DYN_CM) ** 2 / (4.0 * mass) / DYN_CM for eta in (100.0, 150.0)}
    text = f"{listed}. It holds for k_n above {least[100.0]:.0f} dyn/cm at eta_n 100 and {least[150.0]:.0f} at 150."
    verdict: Verdict = "conditional" if any(z >= 1.0 for z in zeta) else "confirmed"
    numbers = {f"zeta@k_n={k:g},eta_n={eta:g}": float(z) for (k, eta), z in zip(RUNS, zeta, strict=True)}
    return Judgement(verdict, text, numbers=numbers)


def hertz_time() -> Judgement:
    """Hertz contact time from rubber to glass at 5 cm/s."""
    mass = 0.5 * float(design.sphere_mass(DIAMETER, PARTICLE_DENSITY))
    radius = design.reduced_radius(0.5 * DIAMETER, 0.5 * DIAMETER)
    times = [
        float(design.hertz_contact_time(mass, radius, design.effective_modulus(modulus, 0.3), 0.05))
        for modulus in (1e7, 7e10)
    ]
    text = (
        f"With m_ij squared, as its unit needs, the contact time at 5 cm/s is {times[0]:.1e} s (E = 1e7 Pa) to "
        f"{times[1]:.1e} s (7e10 Pa), Poisson's ratio 0.3."
    )
    numbers = {"contact_time_soft_s": times[0], "contact_time_stiff_s": times[1]}
    return Judgement("confirmed" if times[1] < 1e-8 else "contradicted", text, numbers=numbers)


def overlap_and_speed() -> Judgement:
    """Impact speeds up to which the overlap keeps below 0.5 % d."""
    limit = OVERLAP_LIMIT * DIAMETER
    speeds = {
        n: 100.0 * float(design.impact_speed_for_overlap(RESTITUTION, n * TIME_STEP, limit, "zero-overlap"))
        for n in (8, 10, 12, 15)
    }
    fall = 100.0 * _terminal_speed(VISCOSITY)[0]
    at_fall = [100.0 * OVERLAP_LIMIT * fall / speed for speed in speeds.values()]
    listed = ", ".join(f"{speed:.2f} (N_c {n})" for n, speed in speeds.items())
    text = (
        f"At e_n 0.5 and dt 1 ms the overlap is below 0.5 % d up to impact speeds of {listed} cm/s; at the settling "
        f"speed of one sphere, {fall:.1f} cm/s, it would be {_listed(at_fall)} % d."
    )
    verdict: Verdict = "confirmed" if min(speeds.values()) >= fall else "conditional"
    return Judgement(verdict, text, numbers={f"speed_cm_s@N_c={n}": speed for n, speed in speeds.items()})


def overlap_at_rest() -> Judgement:
    """Overlap under the submerged weight, in the range found by trial and error."""
    weight = design.submerged_weight(DIAMETER, PARTICLE_DENSITY, FLUID_DENSITY)
    static = [100.0 * float(design.static_overlap(k * DYN_CM, weight)) / DIAMETER for k in TRIAL_RANGE]
    softest = float(design.softest_stiffness(weight, OVERLAP_LIMIT * DIAMETER)) / DYN_CM
    text = (
        f"A sphere at rest on another overlaps by {static[0]:.2g} % d at 5e3 and {static[1]:.2g} % at 1e5 dyn/cm: "
        f"below 0.5 % from {softest:.3g} dyn/cm on."
    )
    numbers = {"static_overlap_percent": static[0], "softest_dyn_cm": softest}
    return Judgement("confirmed" if max(static) < 0.5 else "conditional", text, numbers=numbers)


def hard_limit() -> Judgement:
    """Contact time and overlap at the settling speed for small N_c, and what a velocity Verlet makes of e_n."""
    speed, steps = _terminal_speed(VISCOSITY)[0], (8.0, 4.0, 2.0)
    overlap, rebound = [], []
    for n in steps:
        k_n, eta_n = design.contact_parameters(TALK_MASS, RESTITUTION, n * TIME_STEP, "zero-overlap")
        overlap.append(100.0 * float(design.peak_overlap(TALK_MASS, k_n, eta_n, speed)) / DIAMETER)
        rebound.append(design.produced_restitution(RESTITUTION, n, "velocity-verlet"))
    text = (
        f"Contact time and overlap fall with N_c in proportion: {_listed(overlap)} % d at {100.0 * speed:.1f} cm/s for "
        f"N_c 8, 4, 2, zero only in the limit. Integrated step by step (velocity Verlet) e_n = 0.5 becomes "
        + ", ".join(f"{r.least:.2f} to {r.greatest:.2f}" for r in rebound)
        + ": the limit is reached only where the contact has sub-steps or is integrated exactly."
    )
    falls = all(np.diff(overlap) < 0.0)
    numbers = {f"overlap_percent@N_c={n:g}": value for n, value in zip(steps, overlap, strict=True)}
    return Judgement("conditional" if falls else "contradicted", text, numbers=numbers)


def steps_are_enough() -> Judgement:
    """Restitution of explicit Euler, semi-implicit Euler and velocity Verlet at N_c = 8."""
    names = ("explicit-euler", "semi-implicit-euler", "velocity-verlet")
    made = {name: design.produced_restitution(RESTITUTION, 8, name) for name in names}
    listed = "; ".join(f"{name} {r.least:.2f} to {r.greatest:.2f}" for name, r in made.items())
    text = f"With 8 steps in a contact and e_n = 0.5 wanted comes out: {listed}. Exact integration gives 0.50."
    numbers = {f"restitution_{name}": r.mean for name, r in made.items()}
    off = max(abs(r.mean / RESTITUTION - 1.0) for r in made.values())
    return Judgement("confirmed" if off < 0.01 else "conditional", text, numbers=numbers)


def contact_end() -> Judgement:
    """Restitution of the seed's eta_n where attraction is cut off."""
    k_n, eta_n = design.contact_parameters(TALK_MASS, RESTITUTION, 8 * TIME_STEP, "zero-overlap")
    cut = float(design.achieved_restitution(TALK_MASS, k_n, eta_n, "zero-force"))
    text = f"Ended at zero overlap it gives 0.500, and attracts before; ended where the force vanishes, {cut:.3f}."
    same = abs(cut / RESTITUTION - 1.0) < 1e-3
    return Judgement("confirmed" if same else "conditional", text, numbers={"restitution_zero_force": cut})


def dry_for_wet() -> Judgement:
    """Stokes number of an impact at the settling speed, the largest a kiss could have."""
    mass = 0.5 * float(design.sphere_mass(DIAMETER, PARTICLE_DENSITY))
    radius = design.reduced_radius(0.5 * DIAMETER, 0.5 * DIAMETER)
    speed = _terminal_speed(VISCOSITY)[0]
    stokes = float(design.stokes_number(mass, radius, speed, VISCOSITY))
    wet = float(design.wet_restitution(RESTITUTION, stokes, PARTICLE_DENSITY / FLUID_DENSITY))
    text = (
        f"Even an impact at the full settling speed of {100.0 * speed:.1f} cm/s has St = {stokes:.2g}, below the 10 "
        f"from which on spheres rebound in a liquid; e_n = 0.5 becomes {wet:.1g}."
    )
    numbers = {"stokes_number": stokes, "wet_restitution": wet}
    return Judgement("contradicted" if stokes < 10.0 else "confirmed", text, numbers=numbers)


_POWER = "k_n = m_ij (pi^2 + ln^2 e_n)/(N_c dt)^2 and eta_n = -2 m_ij ln e_n/(N_c dt): longer contacts are softer."

#: Claims that need no run.
DESIGN_CLAIMS = (
    Claim("parameters-fall-with-time-step", "k_n and eta_n decrease with the time step.", "Conclusions",
          Computed(stiffness_and_time_step), _POWER),
    Claim("steps-table", "The table of k_n and eta_n for N_c 8, 10, 12.", "Overlap and contact time in DKT",
          Computed(steps_table), "The formulas of the slide before; e_n, dt and m_ij follow from the table itself."),
    Claim("graphical-table", "The table of eta_n, contact time and N_c for k_n from 1e2 to 1e7 dyn/cm.",
          "Experimental/Graphical approach", Computed(graphical_table),
          "The damping column is of e_n = 0.8 and the contact time its own; e_n = 0 is critical damping."),
    Claim("ranges-agree", "N_c of 8 to 12 agrees with 5e3 to 1e5 dyn/cm found by trial and error.",
          "Overlap and contact time in DKT", Computed(agreement_of_ranges), _POWER),
    Claim("measured-stiffness", "N_c of 8 to 12 gives a stiffness as measured, 3e5 to 1e6 dyn/cm.",
          "How to determine k_n and eta_n", Computed(measured_range),
          "A numerical contact is made as long as the time step can resolve, hence softer than the material."),
    Claim("printed-viscosity", "The pair drafts, kisses and tumbles in a fluid of 0.913 Pa s.",
          "Effect of collision parameters on DKT", Computed(printed_viscosity),
          "Drafting needs the wake of inertia: in Stokes flow two equal spheres one above the other fall at one speed. "
          "The printed value is most likely a slip for 0.113."),
    Claim("runs-have-a-restitution", "Each choice of k_n and eta_n has a restitution and a contact time.",
          "Effect of collision parameters on DKT", Computed(overdamped_runs),
          "From eta_n = 2 sqrt(m_ij k_n) on the contact never reaches zero overlap. As k_n varies at fixed eta_n and "
          "eta_n at fixed k_n, e_n differs from run to run besides."),
    Claim("hertz-lower-limit", "Hertz' contact theory gives a lower limit N_c dt of 1e-9 s.",
          "Finding eta_n and k_n from N_c, e_n", Computed(hertz_time),
          "The printed formula has m_ij to the first power, which is no time."),
    Claim("overlap-by-steps", "The overlap is below 0.5 % of the diameter for 8 < N_c < 15.",
          "Overlap and contact time in DKT", Computed(overlap_and_speed),
          "The overlap of a contact is in proportion to impact speed and contact time."),
    Claim("overlap-at-rest", "5e3 to 1e5 dyn/cm keep the overlap below 0.5 % of the diameter.",
          "Refining the range of k_n", Computed(overlap_at_rest),
          "The submerged weight W compresses the spring by W/k_n."),
    Claim("hard-limit", "For very small N_c the scheme approaches a hard sphere, without overlap.",
          "Overlap and contact time in DKT", Computed(hard_limit),
          "At fixed e_n the contact time goes with N_c and the overlap with it."),
    Claim("more-than-one-step", "A contact needs N_c > 1 time steps.", "Soft-sphere model parameters",
          Computed(steps_are_enough), "The error of e_n is that of the integrator, at N_c = 8 still tens of per cent."),
    Claim("restitution-of-damping", "eta_n gives the restitution e_n.", "Soft-sphere model parameters",
          Computed(contact_end),
          "The formula ends the contact at zero overlap, where the dashpot has attracted already."),
    Claim("dry-for-wet-by-speed", "Dry collisions approximate collisions in a viscous fluid.",
          "Soft sphere collision parameters N_c and e_n", Computed(dry_for_wet),
          "Lubrication dissipates the energy of an approach at such Stokes numbers (Gondret et al. 2002)."),
)  # fmt: skip
