r"""Dry contacts under gravity: the cases DEM01 to DEM04 of the MFIX-DEM verification suite.

A sphere that bounces (DEM01; DEM02 asks for the apex of each bounce, :math:`a+(h_0-a)e_n^{2k}` for rigid bodies), two
compressed spheres between walls (DEM03), and a ball put on a rough plane that slips until it rolls: slip ends at
:math:`\mu gt=\tfrac27u_0` with 5/7 of the speed (DEM04). Garg, Galvin, Li, Pannala, Powder Technol. 220 (2012) 122-137.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rdpm.contacts import Contacts, HardSphere, SoftSphere
from rdpm.contacts.law import ContactLaw
from rdpm.grid import Box
from rdpm.particles.state import Bodies
from rdpm.studies.validation.points import crossing, points
from rdpm.studies.validation.result import Chart, Curve, Found, Row, Tell

__all__ = ["bouncing_sphere", "sliding_ball", "stacked_spheres"]

Floats = NDArray[np.float64]

GRAVITY = 9.81
SOURCE = "MFIX-DEM verification"

#: Touch and end are located; the sub-step is 1 % of a contact, its errors are of second order.
BAND = 1e-3

#: The published motion has five digits and spans 1e-4 m.
STACK_BAND = 5e-7

#: At the end of slip the tangential spring rings a little; its stretch is mu^2 times the static overlap.
ROLLING_BAND = 5e-3


def fall(bodies: Bodies, box: Box, law: ContactLaw, dt: float, steps: int, overlap: float = 0.9) -> tuple[
    Contacts, Floats, Floats
]:  # fmt: skip
    """Move bodies under their weight: their contacts, centres (S + 1, N, 3) and velocities (S + 1, N, 3) with time."""
    contacts = Contacts(bodies, box, law, overlap_limit=overlap)
    weight, none = np.zeros((len(bodies), 3)), np.zeros((len(bodies), 3))
    weight[:, 2] = -GRAVITY * bodies.mass
    centre, velocity = [bodies.position.copy()], [bodies.velocity.copy()]
    for step in range(steps):
        contacts.advance(step * dt, dt, weight, none)
        centre.append(bodies.position.copy())
        velocity.append(bodies.velocity.copy())
    return contacts, np.array(centre), np.array(velocity)


def _dropped(law: ContactLaw, dt: float, steps: int) -> tuple[Contacts, Floats, Floats]:
    ball = Bodies(np.array([0.2]), np.array([2600.0]), np.array([[0.5, 0.5, 0.5]]))
    return fall(ball, Box((1.0, 1.0, 2.0)), law, dt, steps)


def bouncing_sphere(quick: bool, tell: Tell) -> Found:
    """DEM01, DEM02: contact of a dropped sphere with gravity in it; bounces of a rigid one."""
    for stiffness in (1e4, 1e5):
        for e in (1.0, 0.8, 0.6):
            tell(f"k_n {stiffness:g} N/m, e {e:g}")
            law = SoftSphere.from_stiffness(stiffness, restitution=e, ending="zero-overlap")
            contacts, centre, _ = _dropped(law, 1e-3, 750)
            first = contacts.take_episodes()[0]
            top = centre[int((first["start_s"] + first["duration_s"]) / 1e-3) :, 0, 2]
            found = {
                "max_overlap_m": 0.2 * first["max_overlap_fraction"],
                "contact_time_s": first["duration_s"],
                "rebound_speed_m_s": first["rebound_speed_m_s"],
                "apex_m": top[: int(np.argmax(np.diff(top) < 0.0)) + 1].max(),
            }
            words = ("peak overlap", "contact time", "rebound speed", "apex"), ("m", "s", "m/s", "m")
            for (column, value), word, unit in zip(found.items(), *words, strict=True):
                _, known = points("falling_sphere", "k_n", column, k_n=f"{stiffness:.0f}", e_n=f"{e:g}")
                yield Row(f"{word}, soft sphere, k_n {stiffness:g} N/m, e {e:g}", float(value), float(known[0]), BAND,
                          unit, SOURCE)  # fmt: skip
    tell("hard sphere")
    _, centre, _ = _dropped(HardSphere(restitution=0.8), 1e-3, 2500)
    height = centre[:, 0, 2]
    tops = np.flatnonzero((height[1:-1] > height[:-2]) & (height[1:-1] >= height[2:])) + 1
    for bounce, at in enumerate(tops[:4], 1):
        exact = 0.1 + 0.4 * 0.8 ** (2 * bounce)
        yield Row(f"apex after bounce {bounce}, hard sphere, e 0.8", float(height[at]), exact, BAND, "m", SOURCE)


def stacked_spheres(quick: bool, tell: Tell) -> Found:
    """DEM03: distance from the published motion of two spheres squeezed between walls."""
    curves, dt = [], 1e-6
    for e in (1.0, 0.8, 0.6):
        tell(f"e {e:g}")
        place = np.array([[0.05, 0.05, 0.00045], [0.05, 0.05, 0.00135]])
        pair = Bodies(np.full(2, 1e-3), np.array([20000.0, 10000.0]), place)
        law = SoftSphere.from_stiffness(1000.0, restitution=e, ending="zero-overlap")
        _, centre, _ = fall(pair, Box((0.1, 0.1, 0.0018)), law, dt, 1050)
        time = np.linspace(0.0, 1050 * dt, 1051)
        for n, name in enumerate(("lower", "upper")):
            at, height = points("stacked_spheres", "time_s", "height_m", sphere=name, e_n=f"{e:g}")
            known = at <= time[-1]
            distance = np.abs(np.interp(at[known], time, centre[:, n, 2]) - height[known]).max()
            yield Row(f"largest distance from the motion, {name} sphere, e {e:g}", float(distance), None, STACK_BAND,
                      "m", SOURCE)  # fmt: skip
            if n == 0 and e < 1.0:
                curves += [Curve(f"rdpm, e {e:g}", 1e3 * time, 1e3 * centre[:, n, 2]),
                           Curve(f"reference, e {e:g}", 1e3 * at, 1e3 * height, True)]  # fmt: skip
    yield Chart(
        "stacked_spheres",
        "Lower of two spheres between walls",
        "time [ms]",
        "height of the centre [mm]",
        "MFIX-DEM DEM03: d = 1 mm, k_n = 1000 N/m, soft sphere",
        curves,
    )


def _slide(law: ContactLaw, overlap: float, duration: float) -> tuple[float, float, float]:
    """End of slip [s], final speed and final speed of the turning surface over the first speed."""
    d, speed, steps = 1e-3, 0.1, 200
    dt = duration / steps
    ball = Bodies(np.array([d]), np.array([1e4]), np.array([[0.2, 0.5, 0.5 * d - overlap]]))
    ball.velocity[0, 0] = speed
    contacts, slip, spin = Contacts(ball, Box((1.0, 1.0, 1.0)), law), [1.0], 0.0
    weight, none = -GRAVITY * ball.mass[:, None] * [[0.0, 0.0, 1.0]], np.zeros((1, 3))
    for step in range(steps):
        contacts.advance(step * dt, dt, weight, none)
        spin = float(0.5 * d * ball.angular_velocity[0, 1] / speed)
        slip.append(float(ball.velocity[0, 0]) / speed - spin)
    end = crossing(np.linspace(0.0, duration, steps + 1), np.array(slip), 0.01) / 0.99  # it falls on a straight line
    return end, float(ball.velocity[0, 0]) / speed, spin


def sliding_ball(quick: bool, tell: Tell) -> Found:
    """DEM04: end of slip, and the speeds of the rolling ball, soft sphere and hard sphere."""
    stiffness, weight = 1e4, GRAVITY * np.pi / 6.0 * 1e-9 * 1e4
    for mu in (0.2, 0.5, 1.0):
        exact = 2.0 / 7.0 * 0.1 / (mu * GRAVITY)
        models: dict[str, tuple[ContactLaw, float]] = {
            "soft sphere": (
                SoftSphere.from_stiffness(stiffness, restitution=0.8, friction=mu),
                weight / stiffness,
            ),
            "hard sphere": (HardSphere(restitution=0.8, friction=mu, rest_speed=1e-3), 0.0),
        }
        for model, (law, overlap) in models.items():
            tell(f"mu {mu:g}, {model}")
            end, speed, spin = _slide(law, overlap, 2.0 * exact)
            yield Row(f"end of slip, mu {mu:g}, {model}", end, exact, ROLLING_BAND, "s", SOURCE)
            for word, value in (("final speed", speed), ("final omega a", spin)):
                yield Row(f"{word} / first speed, mu {mu:g}, {model}", value, 5 / 7, ROLLING_BAND, source=SOURCE)
