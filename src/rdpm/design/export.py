"""A designed contact as input of other programs, each parameter's meaning beside it (SI units throughout)."""

from __future__ import annotations

import math
from collections.abc import Callable

from rdpm.design._checks import Ending
from rdpm.design.oscillator import dimensionless_contact_time, restitution
from rdpm.design.result import Design
from rdpm.errors import CaseError

__all__ = ["PROGRAMS", "export"]


def _given_by(design: Design, ending: Ending) -> str:
    """Say what these springs give where a contact ends in this way."""
    zeta = design.damping_ratio
    tau = float(dimensionless_contact_time(zeta, ending))
    if not math.isfinite(tau):
        return "the spheres never part"
    t_c = tau * math.sqrt(design.reduced_mass_kg / design.stiffness_N_m)
    return f"e_n = {float(restitution(zeta, ending)):.6g}, t_c = {t_c:.6g} s"


def _head(design: Design, mark: str, program: str, lines: list[str]) -> list[str]:
    """Open a fragment with the design and the meaning of its parameters."""
    d = design
    known = f"rdpm for {program}, SI: k_n = {d.stiffness_N_m:.9g} N/m, eta_n = {d.damping_N_s_m:.9g} N s/m,"
    mass = f"for a reduced mass m_ij = {d.reduced_mass_kg:.9g} kg (an equal pair's is half a sphere's mass)"
    return [f"{mark} {line}" for line in (known, mass, *lines)]


def _end_note(design: Design, ending: Ending) -> str:
    """Warn where the program ends a contact otherwise than the design does."""
    note = f"A contact ends at {ending} here: {_given_by(design, ending)}."
    if design.ending != ending:
        note += f" The design ends at {design.ending}: design with that of this program instead."
    return note


def _friction(design: Design) -> float:
    """Give Coulomb's coefficient; none given is none."""
    return design.tangential.friction or 0.0


def _damping_factor(design: Design) -> float:
    """Give eta_t/eta_n, which depends on the stiffness ratio alone: sqrt(2/7 k_t/k_n)."""
    return math.sqrt(2.0 / 7.0 * design.tangential.ratio)


def _lammps(design: Design) -> str:
    t, ending = design.tangential, design.ending
    limited = " limit_damping" if ending == "zero-force" else ""
    head = _head(
        design, "#", "LAMMPS", [
            "pair_style granular, normal model hooke: F = k_n delta - eta_n v_n; damping velocity: eta_n",
            "itself [N s/m] (mass_velocity multiplies by m_ij, viscoelastic by m_ij and the contact radius).",
            "linear_history: k_t [N/m], eta_t/eta_n, friction coefficient. limit_damping: no attraction.",
            _end_note(design, ending),
            "fix nve/sphere keeps the half-step force: as semi-implicit Euler, take 50 steps or more.",
            "Source: LAMMPS manual (22Jul2025), pair_style granular: normal, damping, tangential models.",
        ],
    )  # fmt: skip
    line = f"pair_coeff * * hooke {design.stiffness_N_m:.12g} {design.damping_N_s_m:.12g} damping velocity"
    side = (t.stiffness_N_m, _damping_factor(design), _friction(design))
    line += " tangential linear_history " + " ".join(f"{v:.12g}" for v in side)
    return "\n".join([*head, "pair_style granular", line + limited, ""])


def _liggghts(design: Design) -> str:
    t = design.tangential
    limit = "on" if design.ending == "zero-force" else "off"
    head = _head(
        design, "#", "LIGGGHTS", [
            "model hooke/stiffness with absolute_damping on: gamman_abs is eta_n [N s/m] (off, it would be",
            "gamman [1/s], multiplied by m_ij). One value for a pair of types; no factor 2.",
            f"limitForce {limit}. {_end_note(design, design.ending)}",
            "Source: LIGGGHTS-PUBLIC documentation, gran model hooke/stiffness, tangential history.",
        ],
    )  # fmt: skip
    values = (
        ("kn", design.stiffness_N_m), ("kt", t.stiffness_N_m), ("gamman_abs", design.damping_N_s_m),
        ("gammat_abs", t.damping_N_s_m), ("coefficientFriction", _friction(design)),
    )  # fmt: skip
    fixes = [
        f"fix m{i} all property/global {n} peratomtypepair 1 {v:.12g}" for i, (n, v) in enumerate(values, 1)
    ]
    style = "pair_style gran model hooke/stiffness tangential history absolute_damping on"
    return "\n".join(
        [*head, *fixes, f"{style} limitForce {limit} tangential_damping on", "pair_coeff * *", ""]
    )


def _mfix(design: Design) -> str:
    if design.damping_ratio >= 1.0:
        reason = "MFIX-DEM takes a restitution at zero overlap, and there is none"
        raise CaseError("export", "mfix", "needs a damping ratio below 1", reason, "Lower the damping.")
    e = float(restitution(design.damping_ratio, "zero-overlap"))
    head = _head(
        design, "#", "MFIX-DEM", [
            "DES_EN_INPUT becomes eta_n = 2 |ln e| sqrt(m_ij k_n/(pi^2 + ln^2 e)), that of zero overlap,",
            "with the reduced mass of each pair of phases (a wall: the particle's mass). Attraction stays.",
            _end_note(design, "zero-overlap"),
            "KT_FAC = k_t/k_n; DES_ETAT_FAC = eta_t/eta_n; the DEM time step is t_c/50.",
            "Source: MFIX user guide, DEM keywords; its check of the linear spring-dashpot parameters.",
        ],
    )  # fmt: skip
    r, f, mu = design.tangential.ratio, _damping_factor(design), _friction(design)
    lines = ["DES_COLL_MODEL = 'LSD'"]
    for w, k in (("", "KN"), ("_W", "KN_W")):
        lines += [f"{k} = {design.stiffness_N_m:.12g}", f"KT{w}_FAC = {r:.12g}", f"MEW{w} = {mu:.12g}"]
        lines += [f"DES_ETAT{w}_FAC = {f:.12g}"]
    return "\n".join([*head, *lines, f"DES_EN_INPUT(1) = {e:.12g}", f"DES_EN_WALL_INPUT(1) = {e:.12g}", ""])


def _yade(design: Design) -> str:
    t = design.tangential
    angle = math.atan(_friction(design))
    head = _head(
        design, "#", "YADE", [
            "ViscElMat with massMultiply=False: two materials act in series, k = k1 k2/(k1 + k2), so each",
            "carries twice the pair's value; against a material without kn a sphere sees 2 k_n.",
            _end_note(design, "zero-force"),
            "Source: YADE documentation, classes ViscElMat, Ip2_ViscElMat_ViscElMat_ViscElPhys, "
            "Law2_ScGeom_ViscElPhys_Basic.",
        ],
    )  # fmt: skip
    body = ", ".join(
        f"{n}={2.0 * v:.12g}"
        for n, v in (("kn", design.stiffness_N_m), ("cn", design.damping_N_s_m),
                     ("ks", t.stiffness_N_m), ("cs", t.damping_N_s_m))
    )  # fmt: skip
    material = f"O.materials.append(ViscElMat({body}, frictionAngle={angle:.12g}, massMultiply=False))"
    loop = "InteractionLoop([Ig2_Sphere_Sphere_ScGeom()], [Ip2_ViscElMat_ViscElMat_ViscElPhys()],"
    return "\n".join([*head, material, f"interactions = {loop}", "    [Law2_ScGeom_ViscElPhys_Basic()])", ""])


def _mercurydpm(design: Design) -> str:
    t = design.tangential
    head = _head(
        design, "//", "MercuryDPM", [
            "setStiffness and setDissipation are the pair's k_n [N/m] and eta_n [N s/m] themselves; its own",
            "setCollisionTimeAndRestitutionCoefficient(tc, e, m) takes m = 2 m_ij, one of two equal spheres.",
            _end_note(design, "zero-overlap"),
            "Source: MercuryDPM documentation, LinearViscoelasticNormalSpecies, SlidingFrictionSpecies.",
        ],
    )  # fmt: skip
    calls = (
        ("Stiffness", design.stiffness_N_m), ("Dissipation", design.damping_N_s_m),
        ("SlidingStiffness", t.stiffness_N_m), ("SlidingDissipation", t.damping_N_s_m),
        ("SlidingFrictionCoefficient", _friction(design)),
    )  # fmt: skip
    first = "auto species = speciesHandler.copyAndAddObject(LinearViscoelasticSlidingFrictionSpecies());"
    return "\n".join([*head, first, *(f"species->set{n}({v:.12g});" for n, v in calls), ""])


_WRITERS: dict[str, Callable[[Design], str]] = {
    "lammps": _lammps,
    "liggghts": _liggghts,
    "mfix": _mfix,
    "yade": _yade,
    "mercurydpm": _mercurydpm,
}
PROGRAMS = tuple(_WRITERS)
"""Names :func:`export` knows."""


def export(design: Design, program: str) -> str:
    """Write the contact as an input fragment of another program.

    Parameters
    ----------
    design : Design
        From :func:`rdpm.design.soft_sphere`.
    program : {"lammps", "liggghts", "mfix", "yade", "mercurydpm"}

    Returns
    -------
    str
        Commented lines in SI units: mass convention, meaning of the damping, how that program ends a contact
        and what comes out there, and the source in its manual.

    Raises
    ------
    CaseError
        An unknown program, or a contact that it cannot express.

    Notes
    -----
    The LAMMPS fragment is run in the tests; the others follow the manuals they name.

    Examples
    --------
    >>> from rdpm.design import soft_sphere
    >>> text = export(soft_sphere(mass=1e-3, stiffness=100.0, restitution=0.8), "lammps")
    >>> text.splitlines()[-1][:24]
    'pair_coeff * * hooke 100'
    """
    if program not in _WRITERS:
        names = ", ".join(PROGRAMS)
        raise CaseError("export", repr(program), f"must be one of {names}", cure="Name one of these.")
    return _WRITERS[program](design)
