"""Each wrong case is refused by one message with place, value, rule and cure."""

import re

import pytest

from rdpm.cases import shipped_text
from rdpm.config.load import load_case
from rdpm.errors import CaseError

# case, text to replace, new text, the message after the file's name
WRONG = [
    ("dkt", "viscosity =", "viscocity =", ':15: fluid.viscocity: unknown key. Did you mean "viscosity"?'),
    ("dkt", "[domain]", "[domian]", ':8: domian: unknown key. Did you mean "domain"?'),
    ("dkt", "x = ", "w = ", ':10: domain.boundary.w: unknown key. There are: "x", "y", "z".'),
    (
        "dkt",
        '"962 kg/m^3"',
        '"962 kg/m"',
        ':14: fluid.density = "962 kg/m": must be a density (kg/m is not one).',
    ),
    ("dkt", '"962 kg/m^3"', "-3", ":14: fluid.density = -3: must be positive."),
    ("dkt", '"962 kg/m^3"', "0", ":14: fluid.density = 0: must be positive."),
    ("dkt", '"962 kg/m^3"', "nan", ":14: fluid.density = nan: must be a finite number."),
    ("dkt", '"962 kg/m^3"', "1e400", ":14: fluid.density = inf: must be a finite number."),
    (
        "dkt",
        '"962 kg/m^3"',
        "0x" + "f" * 5000,
        ":14: fluid.density = a number of thousands of digits: must be",
    ),
    (
        "dkt",
        '"962 kg/m^3"',
        "true",
        ":14: fluid.density = true: must be a density (true or false is not a number).",
    ),
    ("dkt", '"962 kg/m^3"', '"962"', ':14: fluid.density = "962": must be a density (the unit is missing).'),
    (
        "dkt",
        'density = "962 kg/m^3"',
        "",
        ':13: fluid.density: is missing. Write for example density = "1120 kg/m^3".',
    ),
    (
        "dkt",
        'viscosity = "0.113 Pa s"',
        "",
        ':13: fluid: must have exactly one of "viscosity" and "kinematic_viscosity" (neither is given).',
    ),
    ("dkt", "[fluid]", "[fluid]\nkinematic_viscosity = 1e-6", ":13: fluid: must have exactly one of "),
    (
        "dkt",
        "[fluid]",
        "[fluid]\nbody_force = [1, 0, 0]\npressure_gradient = [1, 0, 0]",
        ':13: fluid: must have at most one of "body_force" and "pressure_gradient" (both are given).',
    ),
    (
        "dkt",
        "[fluid]",
        "[fluid]\nzero_mean_flow = true",
        ":14: fluid.zero_mean_flow = true: must not be true where a",
    ),
    (
        "dkt",
        '["10 cm", "10 cm", "50 cm"]',
        '["10 cm", "50 cm"]',
        ':9: domain.size = ["10 cm", "50 cm"]: must have three components, x, y and z.',
    ),
    ("dkt", '["10 cm", "10 cm", "50 cm"]', '["10 cm", 0, 1]', ":9: domain.size[1] = 0: must be positive."),
    (
        "dkt",
        'z = "wall"',
        'z = "wal"',
        ':10: domain.boundary.z = "wal": must be "periodic" or "wall" or "free-slip" or "inflow-outflow".',
    ),
    (
        "dkt",
        "[fluid]",
        "wall_velocity = { z_upper = [1, 0, 2] }\n[fluid]",
        ":13: domain.wall_velocity.z_upper = [1.0, 0.0, 2.0]: must have no z component",
    ),
    (
        "cloud",
        "[fluid]",
        "wall_velocity = { x_lower = [0, 1, 0] }\n[fluid]",
        ':9: domain.wall_velocity.x_lower = [0.0, 1.0, 0.0]: must be left out where boundary.x = "periodic"',
    ),
    (
        "dkt",
        "[[bodies]]",
        "[bodies]",
        ":17: bodies = a table: must be a list of tables. Write [[bodies]], not",
    ),
    (
        "dkt",
        '"440 mm"',
        '"5 mm"',
        ":21: bodies[0].centers[1] = [0.04985, 0.05, 0.005]: must lie inside the box: body 1 "
        "reaches z = -0.0025 m, the box z = 0 to 0.5 m (it starts beyond the face). Move it by 0.0025 m",
    ),
    (
        "dkt",
        '"440 mm"',
        '"460 mm"',
        ":21: bodies[0].centers[1]: must not overlap: bodies 0 and 1 have a gap of ",
    ),
    (
        "dkt",
        'diameter = "15 mm"',
        'diameter = "15 cm"',
        ":18: bodies[0].diameter = 0.15: must be at most the box along x, 0.1 m",
    ),
    (
        "cloud",
        '"9 cm", "9 cm", "9 cm"',
        '"2 cm", "9 cm", "9 cm"',
        ":15: bodies[0].diameter = 0.015: must be at most "
        "half the periodic box along x, 0.01 m (a body must not meet its own image).",
    ),
    (
        "dkt",
        'diameter = "15 mm"',
        'diameter = ["15 mm"]',
        ":18: bodies[0].diameter: must be one, or one for each of the 2 bodies, not 1.",
    ),
    (
        "dkt",
        "[contact]",
        'velocity = [1, 0, 0]\nmotion = "fixed"\n[contact]',
        ":23: bodies[0].velocity: must be left out where the motion is prescribed",
    ),
    (
        "dkt",
        "[contact]",
        'motion = "still"\n[contact]',
        ':23: bodies[0].motion = "still": must be "free", "fixed" or {',
    ),
    (
        "dkt",
        "[contact]",
        "lattice = { counts = [1, 1, 1], spacing = [1, 1, 1] }\n[contact]",
        ':17: bodies[0]: must have exactly one of "centers", "file", "lattice", "packing" (given are "centers", ',
    ),
    (
        "cloud",
        "counts = [3, 3, 3]",
        "counts = [1000000, 1000, 1]",
        ":21: bodies[0].lattice.counts: must make at most ",
    ),
    ("cloud", "counts = [3, 3, 3]", "counts = [3, 3, 5]", ":20: bodies[0].lattice"),
    (
        "cloud",
        "[bodies.lattice]",
        "[bodies.packing]",
        ":21: bodies[0].packing.counts: unknown key. Did you mean ",
    ),
    (
        "rebound",
        'gap = "1.5 mm"',
        'gab = "1.5 mm"',
        ":24: bodies[0].motion.until.gab: unknown key. Did you mean ",
    ),
    ("rebound", '"4 ms", "8 ms"', '"8 ms", "4 ms"', ":25: bodies[0].motion.velocity.times: must increase."),
    (
        "rebound",
        ', "200 ms"',
        "",
        ":25: bodies[0].motion.velocity: must have as many values as times, not 17 and 16.",
    ),
    ("dkt", "contact_steps = 8", "contact_steps = 3", ":26: contact.contact_steps = 3: must be at least 4."),
    (
        "dkt",
        "contact_steps = 8",
        "stiffness = 1\ncontact_steps = 8",
        ":23: contact: must have contact_steps and "
        "restitution, stiffness and damping, stiffness and restitution, or max_overlap and "
        "impact_speed (given are "
        '"contact_steps", "restitution", "stiffness"). Leave out stiffness',
    ),
    ("dkt", "contact_steps = 8 ", "#", ":23: contact: must have contact_steps and restitution"),
    ("dkt", "restitution = 0.5", "restitution = 1.5", ":25: contact.restitution = 1.5: must be at most 1."),
    (
        "dkt",
        "tangential_ratio",
        "poisson_ratio = 0.3\ntangential_ratio",
        ":23: contact: must have at most one of ",
    ),
    (
        "dkt",
        '"soft-sphere"',
        '"hard-sphere"',
        ':26: contact.contact_steps = 8.0: belongs to model = "soft-sphere" (this contact has model = "hard-sphere"). '
        'Leave it out, or set contact.model = "soft-sphere".',
    ),
    (
        "dkt",
        '"soft-sphere"',
        '"hertz"',
        ':26: contact.contact_steps = 8.0: belongs to model = "soft-sphere" (this contact has model = "hertz"). '
        'Leave it out, or set contact.model = "soft-sphere".',
    ),
    (
        "dkt",
        '"soft-sphere"',
        '"soft-sphere"\nyoungs_modulus = "10 MPa"',
        ':25: contact.youngs_modulus = 10000000.0: belongs to model = "hertz" (this contact has model = '
        '"soft-sphere"). Leave it out, or set contact.model = "hertz".',
    ),
    (
        "dkt",
        "cells_per_diameter = 8",
        "cells_per_diameter = 3",
        ":35: resolution.cells_per_diameter = 3: must be at ",
    ),
    (
        "dkt",
        "cells_per_diameter = 8",
        "",
        ':34: resolution: must have exactly one of "cells_per_diameter" and ',
    ),
    (
        "dkt",
        "cells_per_diameter = 8",
        "cells = [20, 20, 100]",
        ":35: resolution.cells = [20, 20, 100]: must put at "
        "least 4 cells across the smallest body, not 3 in x (the flow around it is not resolved). "
        "Use at least 27",
    ),
    ("dkt", '"4 s"', "0", ":38: time.end = 0: must be positive."),
    ("dkt", 'step = "auto"', 'step = "5 s"', ":39: time.step = 5.0: must not be longer than time.end = 4 s."),
    ("dkt", 'step = "auto"', 'step = "quick"', ':39: time.step = "quick": must be "auto", "adaptive" or a time.'),
    ("dkt", '"10 ms"', "0", ":43: output.table_every = 0: must be positive."),
    ("dkt", '"0.1 s"', "-1", ":44: output.fields_every = -1: must not be negative."),
    ("dkt", "[contact]", "[contact", ":23: must be TOML: "),
    ("dkt", "[contact]", "[contact]\nx = " + "[" * 5000 + "]" * 5000, ": must be TOML of a few levels"),
    (
        "dkt",
        "[contact]",
        "[contact]\nx = " + "1" * 5000,
        ": must be TOML (a number has thousands of digits).",
    ),
]


@pytest.mark.parametrize(("case", "old", "new", "said"), WRONG)
def test_message(case, old, new, said, tmp_path):
    text = shipped_text(case)
    assert old in text
    path = tmp_path / "case.toml"
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(CaseError) as refused:
        load_case(path)
    message = str(refused.value)
    assert message.startswith(f"{path}{said}")
    assert "\n" not in message
    assert message.endswith((".", "?", "]"))
    assert refused.value.exit_code == 2


DICTS = [
    ({}, r"^domain: is missing\. Add \[domain\]"),
    ({"domain": 3, "time": {"end": 1}}, r"^domain = 3: must be a table\.$"),
    ({"domain": {"size": [1, 1, 1]}, "time": {"end": 1}}, r"must have a fluid or bodies"),
    (
        {"domain": {"size": [1, 1, 1]}, "time": {"end": 1}, "bodies": [3]},
        r"^bodies\[0\] = 3: must be a table\.$",
    ),
    ({1: 2}, "must|unknown key|missing"),
]


@pytest.mark.parametrize(("raw", "said"), DICTS)
def test_dict(raw, said):
    with pytest.raises(CaseError) as refused:
        load_case(raw)
    assert re.search(said, str(refused.value))


OVERRIDES = [
    ("fluid.viscosity", "--set fluid.viscosity: must be key=value."),
    ("=3", "--set : must name a key"),
    ("x[=3", "--set x[: must name a key"),
    ("fluid.viscosity=-1", "--set fluid.viscosity = -1: must be positive."),
    ("bodies[0].density=abc", '--set bodies[0].density = "abc": must be a density'),
    ("bodies[3].density=1", "--set bodies[3].density: must be an item that is there, [0] to [0]"),
    ("title.x=3", '--set title.x: must not look for "x" there (title is not a table).'),
    (
        "domain.size.x=3",
        '--set domain.size.x: must not look for "x" there (size is not a table). List items are',
    ),
    ("a.b=3", "--set a: unknown key."),
    ("bodies=3", "--set bodies = 3: must be a list."),
    ("contact={stiffness=1}", "--set contact: must have contact_steps and restitution"),
    (
        "fluid.kinematic_viscosity=1",
        "dkt.toml:13: fluid (with --set fluid.kinematic_viscosity): must have exactly one",
    ),
    (
        "domain.size=[1, 1, 0.1]",
        "dkt.toml:21: bodies[0].centers[0] (with --set domain.size) = [0.05015, 0.05, 0.47]: ",
    ),
    ("time.end=1\nb=2", '--set time.end = "1?b=2": must be a time'),
]


@pytest.mark.parametrize(("override", "said"), OVERRIDES)
def test_override(override, said):
    with pytest.raises(CaseError) as refused:
        load_case("dkt", [override])
    assert str(refused.value).startswith(said)


DRY = {
    "domain": {"size": [1, 1, 1]},
    "time": {"end": 1},
    "bodies": [{"diameter": 0.1, "density": 1, "centers": [[0.5, 0.5, 0.5]]}],
}


@pytest.mark.parametrize(
    ("override", "said"),
    [
        (
            "contact={max_overlap=0.2, impact_speed=1}",
            'contact.max_overlap = 0.2: must be at most 0.05, a fraction of the diameter (a contact that deep is no '
            'sphere\'s). For 0.2 % write 0.002, or "0.2 %".',
        ),
        ("time.step=auto", 'time.step = "auto": must be a time in a case without [fluid]'),
        (
            "contact={stiffness=1, restitution=1, lubrication=true}",
            "contact.lubrication = true: must not be true ",
        ),
        (
            "bodies[0].motion={velocity=[0,0,1], until={gap=1}}",
            "bodies[0].motion.until: must be a time for a lone body",
        ),
    ],
)
def test_dry(override, said):
    raw = {**DRY, "domain": {"size": [1, 1, 1], "boundary": dict.fromkeys("xyz", "periodic")}}
    if "motion" in override:
        raw["contact"] = {"stiffness": 1, "restitution": 1}
    with pytest.raises(CaseError) as refused:
        load_case(raw, [override])
    assert said in str(refused.value)
