"""A designed contact as input of other programs: parameters, wall, time step, and a run that shows them (SI)."""

from __future__ import annotations

import math
from collections.abc import Callable

from rdpm.design.programs import PROGRAMS as KNOWN
from rdpm.design.programs import Trial, trial
from rdpm.design.result import Design
from rdpm.design.wording import time_text
from rdpm.errors import CaseError

__all__ = ["PROGRAMS", "export"]


def _head(design: Design, run: Trial, mark: str, lines: list[str]) -> list[str]:
    """Open an input with the design, the meaning of its parameters and what comes out."""
    d, there = design, run.there
    program = KNOWN[there.program]
    out = [
        f"rdpm for {program.title}, SI: k_n = {d.stiffness_N_m:.9g} N/m, eta_n = {d.damping_N_s_m:.9g} N s/m",
        f"for a reduced mass m_ij = {d.reduced_mass_kg:.9g} kg (an equal pair's is half a sphere's mass).",
        *lines,
        *_walls(run),
        f"A contact ends at {there.ending} here: e_n = {there.restitution:.6g}, t_c = {there.contact_time:.6g} s.",
    ]
    if there.ending != d.ending and d.restitution is not None:
        out.append(f"The design ends at {d.ending}, with e_n = {d.restitution:.6g}: this program gives the former.")
    e = there.achieved
    out += [
        f"dt = {time_text(there.time_step)}: {there.contact_steps} steps a contact, which give e_n = {e.mean:.3f}, "
        f"{e.least:.3f} to {e.greatest:.3f}",
        "over where in a step the touch falls (semi-implicit Euler in half-step velocities).",
    ]
    if run.is_assumed:
        one = run.spheres[0]
        size = f"{one.diameter_m:.6g} m and {one.density_kg_m3:.6g} kg/m^3"
        out.append(f"Spheres of {size} are assumed for the run: any of this reduced mass do.")
    out += [
        program.tried,
        "The run: two spheres meet head-on, then the second meets a wall; both restitutions are printed."
        if program.tried.startswith("Run")
        else "The run: two spheres meet head-on, then the second meets a wall.",
    ]
    return [f"{mark} {line}" for line in out]


def _walls(run: Trial) -> list[str]:
    """Say the wall's spring of each sphere."""
    out = ["Against a wall the spring goes with the sphere's mass, so that t_c, e_n and overlap are the pair's:"]
    kinds = dict(zip(run.spheres, run.walls, strict=True))
    for body, spring in kinds.items():
        which = "" if len(kinds) == 1 else f" (sphere of {body.diameter_m:.6g} m, {body.density_kg_m3:.6g} kg/m^3)"
        out.append(f"k_n = {spring.normal_stiffness:.9g} N/m, eta_n = {spring.normal_damping:.9g} N s/m{which}.")
    return out


def _friction(design: Design) -> float:
    """Give Coulomb's coefficient; none given is none."""
    return design.tangential.friction or 0.0


def _damping_factor(design: Design) -> float:
    """Give eta_t/eta_n, which depends on the stiffness ratio alone: sqrt(2/7 k_t/k_n)."""
    return math.sqrt(2.0 / 7.0 * design.tangential.ratio)


def _molecular_setup(run: Trial, style: str, kinds: int, units: str) -> list[str]:
    """Open a run of LAMMPS or LIGGGHTS: a box, two spheres."""
    a, b = run.spheres
    far = 4.0 * max(a.diameter_m, b.diameter_m)
    lines = ["units si", f"atom_style {style}", "atom_modify map array", "boundary f f f", "newton off"]
    lines += ["comm_modify vel yes" if style == "sphere" else "communicate single vel yes"]
    lines += [
        f"region box block {-far:.9g} {far:.9g} {-far:.9g} {far:.9g} {-far:.9g} {far:.9g}{units}",
        f"create_box {kinds} box",
        *(f"create_atoms 1 single {x:.15g} 0 0{units}" for x in run.places),
        *(f"set atom {n} diameter {s.diameter_m:.12g} density {s.density_kg_m3:.12g}"
          for n, s in enumerate(run.spheres, 1)),
    ]  # fmt: skip
    return lines


def _molecular_run(run: Trial, units: str) -> list[str]:
    """Close a run of LAMMPS or LIGGGHTS: motion, and the restitutions of pair and wall."""
    return [
        f"neighbor {0.2 * min(s.diameter_m for s in run.spheres):.9g} bin",
        "fix motion all nve/sphere",
        "group first id 1", "group second id 2",
        f"velocity first set {run.speeds[0]:.15g} 0 0{units}",
        f"velocity second set {run.speeds[1]:.15g} 0 0{units}",
        f"run {run.steps[0]}",
        f"variable pair equal (vx[2]-vx[1])/{run.impact_speed:.15g}",
        'print "restitution of the pair ${pair}"',
        "variable now equal vx[2]", "variable before equal ${now}",
        f"run {run.steps[1]}",
        "variable wall equal -vx[2]/v_before",
        'print "restitution at the wall ${wall}"',
    ]  # fmt: skip


_COPY, _END = "--- the contact", "--- a run that shows it"


def _lammps(design: Design, run: Trial) -> str:
    limited = " limit_damping" if run.there.ending == "zero-force" else ""
    head = _head(
        design, run, "#", [
            "pair_style granular, normal model hooke: F = k_n delta - eta_n v_n; damping velocity: eta_n",
            "itself [N s/m] (mass_velocity multiplies by m_ij, viscoelastic by m_ij and the contact radius).",
            "linear_history: k_t [N/m], eta_t/eta_n, friction coefficient. limit_damping: no attraction.",
            "Source: LAMMPS manual (22Jul2025), pair_style granular: normal, damping, tangential models.",
        ],
    )  # fmt: skip
    f, mu = _damping_factor(design), _friction(design)
    k, eta, k_t, _ = run.pair
    w, w_eta, w_t, _ = run.walls[1]

    def model(normal: float, damping: float, tangential: float) -> str:
        tangent = f"tangential linear_history {tangential:.12g} {f:.12g} {mu:.12g}"
        return f"hooke {normal:.12g} {damping:.12g} damping velocity {tangent}{limited}"

    return "\n".join([
        *head, *_molecular_setup(run, "sphere", 1, ""),
        f"# {_COPY}",
        "pair_style granular", f"pair_coeff * * {model(k, eta, k_t)}",
        f"fix wall all wall/gran granular {model(w, w_eta, w_t)} xplane NULL {run.wall:.15g}",
        f"timestep {run.there.time_step:.12g}",
        f"# {_END}", *_molecular_run(run, ""), "",
    ])  # fmt: skip


def _liggghts(design: Design, run: Trial) -> str:
    limit = "on" if run.there.ending == "zero-force" else "off"
    head = _head(
        design, run, "#", [
            "model hooke/stiffness with absolute_damping on: gamman_abs is eta_n [N s/m] (off, it would be",
            "gamman [1/s], multiplied by m_ij). One value for a pair of types; no factor 2.",
            "Type 1: the spheres; type 2: the wall. limitForce on: no attraction.",
            "Source: LIGGGHTS-PUBLIC documentation, gran model hooke/stiffness, tangential history.",
        ],
    )  # fmt: skip
    (k, eta, k_t, eta_t), (w, w_eta, w_t, w_eta_t) = run.pair, run.walls[1]
    mu = _friction(design)
    values = (
        ("kn", k, w), ("kt", k_t, w_t), ("gamman_abs", eta, w_eta), ("gammat_abs", eta_t, w_eta_t),
        ("coefficientFriction", mu, mu),
    )  # fmt: skip
    fixes = [
        f"fix m{i} all property/global {n} peratomtypepair 2 {p:.12g} {q:.12g} {q:.12g} {p:.12g}"
        for i, (n, p, q) in enumerate(values, 1)
    ]
    model, options = "model hooke/stiffness tangential history", f"absolute_damping on limitForce {limit}"
    options += " tangential_damping on"
    return "\n".join([
        *head, *_molecular_setup(run, "granular", 2, " units box"),
        f"# {_COPY}",
        *fixes, f"pair_style gran {model} {options}", "pair_coeff * *",
        f"fix wall all wall/gran {model} primitive type 2 xplane {run.wall:.15g} {options}",
        f"timestep {run.there.time_step:.12g}",
        f"# {_END}", *_molecular_run(run, " units box"), "",
    ])  # fmt: skip


def _mfix(design: Design, run: Trial) -> str:
    head = _head(
        design, run, "#", [
            "DES_EN_INPUT becomes eta_n = 2 |ln e| sqrt(m_ij k_n/(pi^2 + ln^2 e)), that of zero overlap,",
            "with the reduced mass of each pair of phases (a wall: the particle's mass). Attraction stays.",
            "KT_FAC = k_t/k_n; DES_ETAT_FAC = eta_t/eta_n; MFIX takes dt = t_c/DTSOLID_FACTOR by itself.",
            "Source: MFiX user guide, DEM keywords; its check of the linear spring-dashpot parameters.",
        ],
    )  # fmt: skip
    e, r, f, mu = run.there.restitution, design.tangential.ratio, _damping_factor(design), _friction(design)
    phases = list(dict.fromkeys(run.spheres))
    lines = ["DES_COLL_MODEL = 'LSD'"]
    for w, k, spring in (("", "KN", run.pair), ("_W", "KN_W", run.walls[1])):
        lines += [f"{k} = {spring.normal_stiffness:.12g}", f"KT{w}_FAC = {r:.12g}", f"MEW{w} = {mu:.12g}"]
        lines += [f"DES_ETAT{w}_FAC = {f:.12g}"]
    lines += [f"DES_EN_INPUT({n}) = {e:.12g}" for n in range(1, len(phases) * (len(phases) + 1) // 2 + 1)]
    lines += [f"DES_EN_WALL_INPUT({n}) = {e:.12g}" for n in range(1, len(phases) + 1)]
    lines += ["DES_INTG_METHOD = 'EULER'", f"DTSOLID_FACTOR = {run.there.contact_steps}"]
    d = max(s.diameter_m for s in run.spheres)
    shift = 2.0 * d
    time = sum(run.steps) * run.there.time_step
    box = [f"{c}_MIN = 0.0  {c}_MAX = {size:.12g}  {n}MAX = 4" for c, size, n in
           (("X", run.wall + shift, "I"), ("Y", 4 * d, "J"), ("Z", 4 * d, "K"))]  # fmt: skip
    solids = [
        f"SOLIDS_MODEL({n}) = 'DEM'  D_P0({n}) = {s.diameter_m:.12g}  RO_S0({n}) = {s.density_kg_m3:.12g}"
        for n, s in enumerate(phases, 1)
    ]
    rows = [
        f"# {x + shift:.12g} {2 * d:.12g} {2 * d:.12g} {0.5 * s.diameter_m:.12g} {s.density_kg_m3:.12g} {u:.12g} 0 0"
        for s, x, u in zip(run.spheres, run.places, run.speeds, strict=True)
    ]
    setup = [
        "RUN_NAME = 'PAIR'", "RUN_TYPE = 'NEW'", "UNITS = 'SI'", f"TIME = 0.0  TSTOP = {time:.9g}",
        f"DT = {0.1 * time:.9g}  DT_MIN = {1e-4 * time:.9g}  DT_MAX = {0.1 * time:.9g}",
        "COORDINATES = 'CARTESIAN'", *box, "RO_G0 = 0.0", "MU_G0 = 1.8E-5",
        "MOMENTUM_X_EQ(0) = .FALSE.  MOMENTUM_Y_EQ(0) = .FALSE.  MOMENTUM_Z_EQ(0) = .FALSE.",
        "ENERGY_EQ = .FALSE.  SPECIES_EQ(0) = .FALSE.", "GRAVITY_X = 0.0  GRAVITY_Y = 0.0  GRAVITY_Z = 0.0",
        f"MMAX = {len(phases)}", *solids, "GENER_PART_CONFIG = .FALSE.", "PARTICLES = 2",
        f"RES_DT = {time:.9g}", "WRITE_VTK_FILES = .TRUE.", "VTK_FILEBASE(1) = 'PAIR_P'  VTK_DATA(1) = 'P'",
        f"VTK_DT(1) = {0.02 * time:.9g}  VTK_PART_VEL(1) = .TRUE.",
        f"VTK_X_W(1) = 0.0  VTK_X_E(1) = {run.wall + shift:.12g}  VTK_Y_S(1) = 0.0  VTK_Y_N(1) = {4 * d:.12g}",
        f"VTK_Z_B(1) = 0.0  VTK_Z_T(1) = {4 * d:.12g}",
        f"IC_X_W(1) = 0.0  IC_X_E(1) = {run.wall + shift:.12g}  IC_Y_S(1) = 0.0  IC_Y_N(1) = {4 * d:.12g}",
        f"IC_Z_B(1) = 0.0  IC_Z_T(1) = {4 * d:.12g}  IC_EP_G(1) = 1.0", "NODESI = 1  NODESJ = 1  NODESK = 1",
        "# particle_input.dat, without the marks: x y z radius density u v w", *rows,
    ]  # fmt: skip
    return "\n".join([*head, f"# {_COPY}", *lines, f"# {_END}: mfix.dat", *setup, ""])


def _yade(design: Design, run: Trial) -> str:
    head = _head(
        design, run, "#", [
            "ViscElMat: two materials act in series, k = k1 k2/(k1 + k2), and both must have a kn. Each sphere",
            "carries k_n m/m_ij (twice the pair's for equal spheres), which is what it shows to a stiff wall.",
            "Source: YADE documentation, classes ViscElMat, Ip2_ViscElMat_ViscElMat_ViscElPhys, "
            "Law2_ScGeom_ViscElPhys_Basic.",
        ],
    )  # fmt: skip
    angle = math.atan(_friction(design))

    def material(name: str, density: float, factor: float, spring: tuple[float, ...]) -> str:
        body = ", ".join(f"{n}={factor * v:.12g}" for n, v in zip(("kn", "cn", "ks", "cs"), spring, strict=True))
        return (
            f"O.materials.append(ViscElMat({body}, frictionAngle={angle:.12g}, density={density:.12g}, "
            f"label='{name}'))"
        )

    names = ("first", "second") if run.spheres[0] != run.spheres[1] else ("sphere", "sphere")
    kinds = dict(zip(names, zip(run.spheres, run.walls, strict=True), strict=True))
    stiff = tuple(v or 1.0 for v in run.walls[1])
    return "\n".join([
        *head,
        "# yade -n -x FILE.py",
        f"# {_COPY}",
        *(material(name, body.density_kg_m3, 1.0, spring) for name, (body, spring) in kinds.items()),
        material("wall", run.spheres[1].density_kg_m3, 1e6, stiff),
        "collider = InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb()])",
        "interactions = InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()],",
        "    [Ip2_ViscElMat_ViscElMat_ViscElPhys()], [Law2_ScGeom_ViscElPhys_Basic()])",
        "O.engines = [ForceResetter(), collider, interactions, NewtonIntegrator(damping=0)]",
        f"O.dt = {run.there.time_step:.12g}",
        f"# {_END}",
        *(f"O.bodies.append(sphere(({x:.15g}, 0, 0), {0.5 * s.diameter_m:.12g}, material='{n}'))"
          for n, s, x in zip(names, run.spheres, run.places, strict=True)),
        f"O.bodies.append(wall(({run.wall:.15g}, 0, 0), axis=0, material='wall'))",
        *(f"O.bodies[{n}].state.vel = ({v:.15g}, 0, 0)" for n, v in enumerate(run.speeds)),
        "first, second = O.bodies[0].state, O.bodies[1].state",
        f"O.run({run.steps[0]}, True)",
        f"print('restitution of the pair', (second.vel[0] - first.vel[0]) / {run.impact_speed:.15g})",
        "before = second.vel[0]",
        f"O.run({run.steps[1]}, True)",
        "print('restitution at the wall', -second.vel[0] / before)", "",
    ])  # fmt: skip


def _mercurydpm(design: Design, run: Trial) -> str:
    mu = _friction(design)
    head = _head(
        design, run, "//", [
            "setStiffness and setDissipation are the pair's k_n [N/m] and eta_n [N s/m] themselves; its own",
            "setCollisionTimeAndRestitutionCoefficient(tc, e, m) takes m = 2 m_ij, one of two equal spheres.",
            "Source: MercuryDPM documentation, LinearViscoelasticNormalSpecies, SlidingFrictionSpecies.",
        ],
    )  # fmt: skip
    kind = "LinearViscoelasticSlidingFrictionSpecies"
    densities = dict.fromkeys(s.density_kg_m3 for s in run.spheres)
    names = [f"sphere{n}" for n in range(len(densities))]
    named = dict(zip(densities, names, strict=True))

    def calls(species: str, spring: tuple[float, ...]) -> list[str]:
        words = ("Stiffness", "Dissipation", "SlidingStiffness", "SlidingDissipation")
        values = [*zip(words, spring, strict=True), ("SlidingFrictionCoefficient", mu)]
        return [f"    {species}->set{n}({v:.12g});" for n, v in values]

    lines: list[str] = []
    for density, name in named.items():
        lines += [f"    auto {name} = speciesHandler.copyAndAddObject({kind}());"]
        lines += [f"    {name}->setDensity({density:.12g});"]
        lines += calls(name, run.pair)
    lines += [f"    auto wall = speciesHandler.copyAndAddObject({kind}());", "    wall->setDensity(1.0);"]
    lines += calls("wall", run.walls[1])
    second = named[run.spheres[1].density_kg_m3]
    pairs = [(a, b, run.pair) for i, a in enumerate(names) for b in names[i + 1 :]] + [(second, "wall", run.walls[1])]
    for a, b, spring in pairs:
        lines += calls(f"speciesHandler.getMixedObject({a}, {b})", spring)
    far = 4.0 * max(s.diameter_m for s in run.spheres)
    setup = [
        f"    setTimeStep({run.there.time_step:.12g});", f"    // {_END}", '    setName("pair");',
        f"    setTimeMax({sum(run.steps) * run.there.time_step:.12g});",
        f"    setMin(Vec3D({-far:.9g}, {-far:.9g}, {-far:.9g}));",
        f"    setMax(Vec3D({run.wall:.15g}, {far:.9g}, {far:.9g}));",
        "    InfiniteWall plane;", "    plane.setSpecies(wall);",
        f"    plane.set(Vec3D(1, 0, 0), Vec3D({run.wall:.15g}, 0, 0));", "    wallHandler.copyAndAddObject(plane);",
    ]  # fmt: skip
    for s, x, v in zip(run.spheres, run.places, run.speeds, strict=True):
        setup += [
            "    {", "      SphericalParticle p;", f"      p.setSpecies({named[s.density_kg_m3]});",
            f"      p.setRadius({0.5 * s.diameter_m:.12g});", f"      p.setPosition(Vec3D({x:.15g}, 0, 0));",
            f"      p.setVelocity(Vec3D({v:.15g}, 0, 0));", "      particleHandler.copyAndAddObject(p);", "    }",
        ]  # fmt: skip
    return "\n".join([
        *head, "#include <Mercury3D.h>", f"#include <Species/{kind}.h>", "#include <Walls/InfiniteWall.h>",
        "class Pair : public Mercury3D {", "  void setupInitialConditions() override {", f"    // {_COPY}",
        *lines, *setup, "  }", "};", "int main() {", "  Pair problem;", "  problem.solve();", "}", "",
    ])  # fmt: skip


_WRITERS: dict[str, Callable[[Design, Trial], str]] = {
    "lammps": _lammps,
    "liggghts": _liggghts,
    "mfix": _mfix,
    "yade": _yade,
    "mercurydpm": _mercurydpm,
}
PROGRAMS = tuple(_WRITERS)
"""Names :func:`export` knows."""


def export(design: Design, program: str) -> str:
    """Write the contact as an input of another program: two spheres that meet, then one and a wall.

    Parameters
    ----------
    design : Design
        From :func:`rdpm.design.soft_sphere`.
    program : {"lammps", "liggghts", "mfix", "yade", "mercurydpm"}

    Returns
    -------
    str
        A whole input in SI units, the lines of the contact marked. Its comments say mass convention, meaning of the
        damping, wall values, how that program ends a contact and what comes out there, its time step, what was
        run and what only read.

    Raises
    ------
    CaseError
        An unknown program, or a contact that it cannot express.

    Notes
    -----
    The inputs of LAMMPS, LIGGGHTS and YADE are run in the tests where these programs are installed.

    Examples
    --------
    >>> from rdpm.design import soft_sphere
    >>> text = export(soft_sphere(mass=1e-3, stiffness=100.0, restitution=0.8), "lammps")
    >>> next(line for line in text.splitlines() if line.startswith("pair_coeff"))[:24]
    'pair_coeff * * hooke 100'
    """
    if program not in _WRITERS:
        names = ", ".join(PROGRAMS)
        raise CaseError("export", repr(program), f"must be one of {names}", cure="Name one of these.")
    return _WRITERS[program](design, trial(design, program))
