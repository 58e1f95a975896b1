r"""Dry impacts without gravity: tests 1, 2 and 4 of Chung and Ooi, and the glass spheres of Foerster et al.

*Normal* (tests 1, 2): elastic, two spheres, and one on a rigid wall, against Hertz's theory. *Oblique* (test 4): a
sphere on a wall at 3.9 m/s, from normal to grazing. Granular Matter 13 (2011) 643-656,
doi:10.1007/s10035-011-0277-0. The linear spring has the peak overlap of the Hertz contact; what then differs is due to
the model.

*Glass* (Foerster, Louge, Chang, Allia, Phys. Fluids 6 (1994) 1108-1115): tangential over normal velocities of the
surfaces, before the impact :math:`\Psi_1` and after it :math:`\Psi_2`, both over the normal speed before. A contact
that slides has :math:`\Psi_2=\Psi_1-\tfrac72(1+e)\mu`, one that sticks :math:`\Psi_2=-\beta_0\Psi_1`.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from rdpm import design
from rdpm.contacts import Contacts, HardSphere, Hertz, SoftSphere
from rdpm.contacts.law import ContactLaw
from rdpm.grid import Box
from rdpm.particles.state import Bodies
from rdpm.studies.validation.points import points
from rdpm.studies.validation.result import Chart, Curve, Found, Row, Tell

__all__ = ["glass_spheres", "normal_impact", "oblique_impact"]

Floats = NDArray[np.float64]

ROOM = Box((4.0, 4.0, 4.0))
CHUNG_OOI = "Chung and Ooi 2011"

#: Sub-steps are 1 % of a contact.
NORMAL_BAND = 2e-3

#: The points of test 4 were read from figures: differences are of the largest value of each quantity.
OBLIQUE_BAND = 0.05

#: Foerster et al., glass on glass: e, mu and beta_0.
GLASS = 0.97, 0.092, 0.44

#: What e (0.01), mu (0.006) and beta_0 (0.07) are known to leaves open, at a ratio of 0.4 before where it sticks.
SLIDING_BAND, STICKING_BAND = 3.5 * (1.97 * 0.006 + 0.092 * 0.01), 0.4 * 0.07


def impact(law: ContactLaw, bodies: Bodies, contact_time: float, steps: int = 100) -> tuple[Floats, Floats]:
    """Peak overlap, duration, peak force; overlap and force along z of the last body with time, (steps, 2)."""
    contacts, none = Contacts(bodies, ROOM, law), np.zeros((len(bodies), 3))
    dt, below = 1.2 * contact_time / steps, len(bodies) > 1
    force, overlap = np.zeros(steps), np.zeros(steps)
    for step in range(steps):
        done = contacts.advance(step * dt, dt, none, none)
        force[step] = done.contact_impulse[-1, 2] / dt
        bottom = bodies.position[0, 2] + 0.5 * bodies.diameter[0] if below else 0.0
        overlap[step] = bottom - (bodies.position[-1, 2] - 0.5 * bodies.diameter[-1])
    (episode,) = contacts.take_episodes()
    return np.array([episode["max_overlap_fraction"] * bodies.diameter[0], episode["duration_s"], force.max()]), (
        np.column_stack([overlap, force])
    )


def _head_on(test: str, row: Mapping[str, float]) -> Bodies:
    radius, speed = row["radius_m"], row["speed_m_s"]
    gap = 0.05 * speed * row["contact_time_s"]
    if test == "2":
        place, velocity = [[2.0, 2.0, radius + gap]], [[0.0, 0.0, -speed]]
    else:
        place = [[2.0, 2.0, 2.0], [2.0, 2.0, 2.0 + 2.0 * radius + gap]]
        velocity = [[0.0, 0.0, 0.5 * speed], [0.0, 0.0, -0.5 * speed]]
    count = len(place)
    return Bodies(np.full(count, 2.0 * radius), np.full(count, row["density"]), np.array(place), np.array(velocity))


def normal_impact(quick: bool, tell: Tell) -> Found:
    """Tests 1 and 2: peak overlap, contact time and peak force of Hertz contacts, and of the linear spring as deep."""
    columns = ("radius_m", "youngs_modulus_Pa", "poisson_ratio", "density", "speed_m_s", "contact_time_s")
    names = ("peak overlap", "m"), ("contact time", "s"), ("peak force", "N")
    for test, material in (("1", "glass"), ("1", "limestone"), ("2", "aluminium alloy"), ("2", "magnesium alloy")):
        read = {c: float(points("chung_ooi_normal", "speed_m_s", c, test=test, material=material)[1][0])
                for c in (*columns, "max_overlap_m", "peak_force_N")}  # fmt: skip
        # A rigid wall has the compliance of one body alone: half the modulus of a wall of the same material.
        youngs, speed = read["youngs_modulus_Pa"] * (2.0 if test == "2" else 1.0), read["speed_m_s"]
        models: dict[str, ContactLaw] = {
            "Hertz": Hertz(youngs, read["poisson_ratio"], 1.0, speed),
            "linear": SoftSphere.from_overlap(read["max_overlap_m"] / (2.0 * read["radius_m"]), speed, 1.0),
        }
        for model, law in models.items():
            tell(f"test {test}, {material}, {model}")
            found, curve = impact(law, _head_on(test, read), read["contact_time_s"], 400)
            exact = read["max_overlap_m"], read["contact_time_s"], read["peak_force_N"]
            for (word, unit), value, reference in zip(names, found, exact, strict=True):
                band = NORMAL_BAND if model == "Hertz" else None
                yield Row(f"{word}, test {test}, {material}, {model}", float(value), reference, band, unit, CHUNG_OOI)
            if material == "glass" and model == "Hertz":
                loading = curve[: int(np.argmax(curve[:, 0])) + 1]
            elif material == "glass":
                linear = curve[: int(np.argmax(curve[:, 0])) + 1]
    overlap, force = points("chung_ooi_force", "overlap_m", "force_N")
    yield Row("largest distance from the force curve, test 1, glass, Hertz, of the peak",
              float(np.abs(np.interp(overlap, *loading.T) - force).max() / force.max()), None, 0.02,
              source=CHUNG_OOI)  # fmt: skip
    yield Chart(
        "chung_ooi_force",
        "Two glass spheres at 20 m/s",
        "overlap [um]",
        "force [kN]",
        "Chung and Ooi, test 1, approach; the linear spring has the same peak overlap",
        [Curve("published", 1e6 * overlap, 1e-3 * force, True),
         *(Curve(name, 1e6 * c[c[:, 0] > 0, 0], 1e-3 * c[c[:, 0] > 0, 1])
           for name, c in (("Hertz", loading), ("linear", linear)))],
    )  # fmt: skip


def oblique(law: ContactLaw, radius: float, density: float, speed: float, angle: float, time: float) -> Bodies:
    """A sphere after an impact on the floor at so many degrees from the normal."""
    slope = np.radians(angle)
    velocity = speed * np.array([[np.sin(slope), 0.0, -np.cos(slope)]])
    place = np.array([[2.0, 2.0, radius - 0.02 * velocity[0, 2] * time]])
    ball = Bodies(np.array([2.0 * radius]), np.array([density]), place, velocity)
    impact(law, ball, time)
    return ball


def oblique_impact(quick: bool, tell: Tell) -> Found:
    """Test 4: tangential restitution, angular velocity and rebound angle of the surface against the impact angle."""
    radius, density, speed, e, mu, youngs, poisson = 2.5e-3, 4000.0, 3.9, 0.98, 0.092, 2 * 3.8e11, 0.23
    angles, _ = points("chung_ooi_oblique", "angle_deg", "value", quantity="tangential-restitution")
    hertz = Hertz(youngs, poisson, e, speed * 0.1, friction=mu)
    mass = np.array([design.sphere_mass(2.0 * radius, density)])
    k, eta = hertz.normal(mass, np.array([radius]))
    models: dict[str, list[Floats]] = {"Hertz": [], "linear": []}
    for angle in angles:
        tell(f"{angle:g} degrees")
        normal = speed * float(np.cos(np.radians(angle)))
        time = float(design.hertz_duration(mass[0], k[0], normal, e))
        peak = float(design.hertz_peak_overlap(mass[0], k[0], normal, eta[0])) / (2.0 * radius)
        ratio = design.ratio_from_poisson(poisson)
        linear = SoftSphere.from_overlap(peak, normal, e, friction=mu, tangential_ratio=float(ratio))
        for name, law in (("Hertz", Hertz(youngs, poisson, e, normal, friction=mu)), ("linear", linear)):
            ball = oblique(law, radius, density, speed, angle, 1.3 * time)
            v, w = ball.velocity[0], ball.angular_velocity[0, 1]
            surface = np.degrees(np.arctan2(v[0] - radius * w, v[2]))
            models[name].append(np.array([v[0] / (speed * np.sin(np.radians(angle))), w, surface]))
    words = {
        "tangential-restitution": "tangential restitution [-]",
        "angular-velocity": "angular velocity [rad/s]",
        "rebound-angle": "rebound angle of the surface [deg]",
    }
    for n, (quantity, word) in enumerate(words.items()):
        at, value = points("chung_ooi_oblique", "angle_deg", "value", quantity=quantity)
        curves = [Curve("published", at, value, True)]
        for name, rows in models.items():
            mine = np.array(rows)[:, n]
            away = np.abs(np.interp(at, angles, mine) - value) / np.abs(value).max()
            for where, first, last in (("5 degrees", 0, 7), ("10 to 30 degrees", 7, 32), ("35 to 85 degrees", 32, 90)):
                band = OBLIQUE_BAND if name == "Hertz" and first > 0 else None
                yield Row(f"{word.split(' [')[0]}, {where}, {name}: largest difference",
                          float(away[(at > first) & (at < last)].max()), None, band, source=CHUNG_OOI)  # fmt: skip
            curves.append(Curve(name, angles, mine))
        yield Chart(
            f"chung_ooi_{quantity.replace('-', '_')}",
            "Oblique impact on a wall",
            "impact angle from the normal [deg]",
            word,
            "Chung and Ooi, test 4: aluminium oxide, R = 2.5 mm, 3.9 m/s, mu = 0.092, e = 0.98",
            curves,
        )


def glass_spheres(quick: bool, tell: Tell) -> Found:
    """Foerster's glass: rebound of the surfaces against their approach, three models."""
    e, mu, beta = GLASS
    radius, density, normal, time = 1.59e-3, 2500.0, 1.0, 1e-6
    angle = np.arccos(-beta)  # undamped, tangential over normal phase at the end of the contact, in its second half
    ratio = 2.0 / 7.0 * ((2.0 * np.pi - angle) / np.pi) ** 2
    models: dict[str, ContactLaw] = {
        "hard sphere": HardSphere(restitution=e, friction=mu, tangential_restitution=beta),
        "soft sphere": SoftSphere.from_contact_time(e, time, friction=mu, tangential_ratio=float(ratio)),
        "Hertz": Hertz(7e10, 0.22, e, normal, friction=mu),
    }
    mass = np.array([design.sphere_mass(2.0 * radius, density)])
    k, _ = models["Hertz"].normal(mass, np.array([radius]))  # type: ignore[attr-defined]
    times = {"hard sphere": time, "soft sphere": time,
             "Hertz": float(design.hertz_duration(mass[0], k[0], normal, e))}  # fmt: skip
    approach = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.7, 1.0, 1.5, 2.0])
    exact = np.maximum(-beta * approach, approach - 3.5 * (1.0 + e) * mu)
    curves = [Curve("three parameters, as measured", approach, exact, True)]
    for name, law in models.items():
        tell(name)
        after = []
        for ratio_before in approach:
            total, degrees = float(np.hypot(ratio_before, normal)), float(np.degrees(np.arctan(ratio_before)))
            ball = oblique(law, radius, density, total, degrees, 1.3 * times[name])
            after.append((ball.velocity[0, 0] - radius * ball.angular_velocity[0, 1]) / normal)
        curves.append(Curve(name, approach, np.array(after)))
        away = np.abs(np.array(after) - exact)
        sticking = (
            STICKING_BAND if name == "hard sphere" else None
        )  # its beta_0 is given; theirs follows from the spring
        for where, first, last, band in (("sticking", 0.0, 0.4, sticking), ("sliding", 0.6, 2.1, SLIDING_BAND)):
            yield Row(f"{name}, {where}: largest difference of Psi_2",
                      float(away[(approach > first) & (approach < last)].max()), None, band,
                      source="Foerster et al. 1994")  # fmt: skip
    yield Chart(
        "glass_spheres",
        "Glass spheres, rebound of the surfaces",
        "tangential / normal velocity before",
        "tangential after / normal velocity before",
        "Foerster et al. 1994: e = 0.97, mu = 0.092, beta_0 = 0.44; linear spring with k_t/k_n for that beta_0",
        curves,
    )
