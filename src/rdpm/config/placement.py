"""Groups of bodies as a table of single bodies: lattices, random packings, and whether all of them fit."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from rdpm.config.bodies import MAX_BODIES, BodyGroup, Lattice, Motion, Packing
from rdpm.config.domain import Domain
from rdpm.config.overlaps import first_overlap, wrapped
from rdpm.config.packing import place_at_random
from rdpm.config.rule import Path, RuleError
from rdpm.config.walls import Wall

__all__ = ["BodyTable", "expand"]

Floats = NDArray[np.float64]

_TOUCH = (
    1e-9  # share of a diameter: bodies written as touching may overlap by the round-off of their coordinates
)


@dataclass(frozen=True)
class BodyTable:
    """All bodies of a case, one row each; ids are the row numbers.

    Attributes
    ----------
    diameter : ndarray, (N,), [m]
    density : ndarray, (N,), [kg/m^3]
    position : ndarray, (N, 3), [m]
        Along a periodic direction wrapped into the box.
    velocity, angular_velocity : ndarray, (N, 3), [m/s], [rad/s]
        At the start; of a prescribed motion, its own.
    motion : tuple of "free", "fixed" or Motion, (N,)
    group : ndarray of int, (N,)
        Place in the case's list of groups.
    """

    diameter: Floats
    density: Floats
    position: Floats
    velocity: Floats
    angular_velocity: Floats
    motion: tuple[Literal["free", "fixed"] | Motion, ...]
    group: NDArray[np.int64]

    def __len__(self) -> int:
        return int(self.diameter.size)


@lru_cache(maxsize=4)  # a case is checked, planned and run on the same table
def expand(groups: tuple[BodyGroup, ...], domain: Domain, walls: tuple[Wall, ...] = ()) -> BodyTable:
    """Place the bodies of all groups and check that they fit.

    Raises
    ------
    RuleError
        A body outside the box, two that overlap, more than fit; it names them by id.
    """
    counts = [_count(group, domain) for group in groups]
    if sum(counts) > MAX_BODIES:
        raise RuleError(f"must be at most {MAX_BODIES} bodies, not {sum(counts)}", at=("bodies",))
    members = list(zip(range(len(groups)), groups, counts, strict=True))
    group = np.repeat(np.arange(len(groups)), counts)
    diameter = _joined([_each(g.diameter, n, "diameter", i) for i, g, n in members])
    density = _joined([_each(g.density, n, "density", i) for i, g, n in members])
    velocity = _joined([_velocity(g, n, i, "velocity").ravel() for i, g, n in members]).reshape(-1, 3)
    angular_velocity = _joined([_velocity(g, n, i, "angular_velocity").ravel() for i, g, n in members]).reshape(-1, 3)
    _check_sizes(diameter, group, domain)
    position = _positions(diameter, group, groups, domain, walls)
    for array in (diameter, density, position, velocity, angular_velocity, group):
        array.setflags(write=False)
    motion = tuple(g.motion for _, g, n in members for _ in range(n))
    return BodyTable(diameter, density, position, velocity, angular_velocity, motion, group)


def _positions(
    diameter: Floats,
    group: NDArray[np.int64],
    groups: tuple[BodyGroup, ...],
    domain: Domain,
    walls: tuple[Wall, ...],
) -> Floats:
    """Centres, wrapped into the box: the given ones, then the packings between them."""
    box, periodic = np.array(domain.size), np.array(domain.is_periodic)
    position = np.full((len(diameter), 3), np.nan)
    for i, g in enumerate(groups):
        if g.packing is None:
            position[group == i] = g.centers if g.centers is not None else _lattice(g.lattice)
    _check_inside(position, diameter, group, groups, domain)
    position = wrapped(position, box, periodic)
    surfaces = tuple(wall.surface for wall in walls)
    for i, g in enumerate(groups):
        if g.packing is None:
            continue
        mine, others = group == i, np.isfinite(position[:, 0])
        obstacles = (position[others], diameter[others])
        gap, seed = g.packing.min_gap, g.packing.seed
        try:
            position[mine] = place_at_random(diameter[mine], box, periodic, gap, seed, obstacles, surfaces)
        except RuleError as problem:
            raise problem.below("bodies", i, "packing") from None
    _check_apart(position, diameter, group, groups, domain)
    _check_walls(position, diameter, group, groups, domain, walls)
    return position


def _joined(parts: list[Floats]) -> Floats:
    return np.concatenate(parts) if parts else np.zeros(0)


def _count(group: BodyGroup, domain: Domain) -> int:
    if group.centers is not None:
        return len(group.centers)
    if group.lattice is not None:
        return group.lattice.count
    packing = group.packing or Packing(count=1)
    if packing.count is not None:
        return packing.count
    if isinstance(group.diameter, tuple):
        return len(group.diameter)
    # in logarithms, as sizes may lie sixty decades apart
    log_ratio = np.log(np.array(domain.size)).sum() - np.log(np.pi / 6.0) - 3.0 * np.log(group.diameter)
    return max(1, round(min((packing.solid_fraction or 0.0) * float(np.exp(min(log_ratio, 100.0))), 1e12)))


def _each(value: float | tuple[float, ...], count: int, name: str, i: int) -> Floats:
    if isinstance(value, tuple) and len(value) != count:
        raise RuleError(
            f"must be one, or one for each of the {count} bodies, not {len(value)}", at=("bodies", i, name)
        )
    return np.broadcast_to(np.asarray(value, dtype=np.float64), (count,))


def _velocity(group: BodyGroup, count: int, i: int, name: Literal["velocity", "angular_velocity"]) -> Floats:
    given: Any = getattr(group, name)
    if isinstance(group.motion, Motion):
        given = group.motion.velocity_at(0.0) if name == "velocity" else group.motion.rotation_at(0.0)
    if isinstance(given[0], tuple) and len(given) != count:
        raise RuleError(
            f"must be one, or one for each of the {count} bodies, not {len(given)}", at=("bodies", i, name)
        )
    return np.array(np.broadcast_to(np.asarray(given, dtype=np.float64), (count, 3)))


def _lattice(lattice: Lattice | None) -> Floats:
    if lattice is None:
        return np.zeros((0, 3))
    axes = [
        np.arange(count) * spacing for count, spacing in zip(lattice.counts, lattice.spacing, strict=True)
    ]
    z, y, x = np.meshgrid(*axes[::-1], indexing="ij")  # x runs fastest
    origin = lattice.origin if lattice.origin is not None else tuple(0.5 * s for s in lattice.spacing)
    points = np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1) + origin
    if lattice.jitter > 0.0:
        points += lattice.jitter * np.random.default_rng(lattice.seed).uniform(-1.0, 1.0, points.shape)
    return points


def _place(groups: tuple[BodyGroup, ...], group: NDArray[np.int64], body: int) -> Path:
    """Where in the case a body stands."""
    i = int(group[body])
    if groups[i].centers is None:
        return ("bodies", i, "lattice" if groups[i].lattice is not None else "packing")
    return ("bodies", i, "centers", body - int(np.searchsorted(group, i)))


def _check_sizes(diameter: Floats, group: NDArray[np.int64], domain: Domain) -> None:
    for axis, (length, kind) in enumerate(zip(domain.size, domain.kinds, strict=True)):
        most = 0.5 * length if kind == "periodic" else length
        for body in np.flatnonzero(diameter > most * (1.0 + _TOUCH))[:1]:
            half = "half the periodic box" if kind == "periodic" else "the box"
            why = (
                "a body must not meet its own image"
                if kind == "periodic"
                else "it does not fit between the faces"
            )
            raise RuleError(
                f"must be at most {half} along {'xyz'[axis]}, {most:g} m",
                why,
                "Enlarge domain.size, or shrink the body.",
                value=float(diameter[body]),
                at=("bodies", int(group[body]), "diameter"),
            )


def _check_inside(
    position: Floats,
    diameter: Floats,
    group: NDArray[np.int64],
    groups: tuple[BodyGroup, ...],
    domain: Domain,
) -> None:
    for axis, (length, kind) in enumerate(zip(domain.size, domain.kinds, strict=True)):
        reach = 0.0 * diameter if kind == "periodic" else 0.5 * diameter
        with np.errstate(invalid="ignore"):  # bodies of a packing have no place yet
            low, high = position[:, axis] - reach, position[:, axis] + reach
            outside = np.flatnonzero((low < -_TOUCH * diameter) | (high > length + _TOUCH * diameter))
        if outside.size:
            body, name = int(outside[0]), "xyz"[axis]
            end = low[body] if low[body] < 0.0 else high[body]
            what = f"body {body}" if kind != "periodic" else f"the centre of body {body}"
            raise RuleError(
                f"must lie inside the box: {what} reaches {name} = {end:.6g} m, the box {name} = 0 to "
                f"{length:g} m",
                "it starts beyond the face",
                f"Move it by {max(-end, end - length):.3g} m, or enlarge domain.size.",
                value=tuple(float(f"{c:.6g}") for c in position[body]),
                at=_place(groups, group, body),
            )


def _check_apart(
    position: Floats,
    diameter: Floats,
    group: NDArray[np.int64],
    groups: tuple[BodyGroup, ...],
    domain: Domain,
) -> None:
    found = first_overlap(position, diameter, np.array(domain.size), np.array(domain.is_periodic), _TOUCH)
    if found is not None:
        i, j, gap = found
        raise RuleError(
            f"must not overlap: bodies {i} and {j} have a gap of {gap:.3g} m",
            "a contact must start with a touch",
            f"Move them {-gap:.3g} m apart.",
            at=_place(groups, group, j),
        )


def _check_walls(
    position: Floats,
    diameter: Floats,
    group: NDArray[np.int64],
    groups: tuple[BodyGroup, ...],
    domain: Domain,
    walls: tuple[Wall, ...],
) -> None:
    period = np.where(domain.is_periodic, domain.size, 0.0)
    for n, wall in enumerate(walls):
        gap = wall.surface.distance(position, period)[0] - 0.5 * diameter
        beyond = np.flatnonzero(gap < -_TOUCH * diameter)
        if beyond.size:
            body = int(beyond[0])
            raise RuleError(
                f"must not overlap wall {n}: body {body} has a gap of {gap[body]:.3g} m",
                "bodies start on the side of a wall where they stay",
                "Move it, or turn the wall's normal, or change its side.",
                value=tuple(float(f"{c:.6g}") for c in position[body]),
                at=_place(groups, group, body),
            )
