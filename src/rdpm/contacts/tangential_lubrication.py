"""Tangential lubrication between close surfaces: what the grid does not resolve of their slip and of their roll."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rdpm.errors import CaseError

__all__ = ["TangentialLubrication"]

Floats = NDArray[np.float64]

#: Of pi mu a_r ln(1/gap): resistance to slip, and to roll.
SLIP, ROLL = 2.0, 6.0 / 5.0


@dataclass(frozen=True)
class TangentialLubrication:
    r"""Resistances to the slip of two surfaces against each other and to their roll through the gap together.

    With the surface velocities :math:`p_i, p_j` at the gap, as they are where the line of centres rests, slip is
    :math:`p_i-p_j` and roll :math:`p_i+p_j`. Their resistances are :math:`2\pi\mu a_r\ln(1/g)` and
    :math:`\frac65\pi\mu a_r\ln(1/g)`: together the logarithmic terms of :math:`Y^A, Y^B, Y^C` of any two spheres [1]_
    and of a sphere and a wall [2]_. The resolved part is taken off as along the normal, each with its own two lengths.
    Twist about the line of centres is left out: its term, :math:`g\ln g`, vanishes in a narrow gap.

    Parameters
    ----------
    wall_slip, pair_slip, roll : tuple of two floats, [m]
        Gap from which on the grid resolves it, and gap as which the grid resolves touching surfaces: 0 < the second
        <= the first. `pair_slip` holds for walls within the box too, `roll` for all.
    radius : float, [m]
        Reduced radius :math:`a_r` that they belong to; for others they go as :math:`a_r^{2/3}`. > 0.
    largest_rate : float, [1/s]
        Rate at which slip and roll are slowed at most, resistance over inertia: a bound for bodies so light that the
        fluid, coupled once a step, could not follow. None when left out. > 0.

    Raises
    ------
    CaseError
        An argument outside its range.

    References
    ----------
    .. [1] Jeffrey, Onishi, J. Fluid Mech. 139 (1984) 261-290, doi:10.1017/S0022112084000355.
    .. [2] Goldman, Cox, Brenner, Chem. Eng. Sci. 22 (1967) 637-651, doi:10.1016/0009-2509(67)80047-2.

    Examples
    --------
    >>> tangential = TangentialLubrication((1e-4, 2e-5), (2e-4, 6e-5), (3e-4, 1e-4), radius=2e-3)
    >>> row = tangential.rows(0.1, np.array([2e-3]), np.array([False]))
    >>> float(row["slip"][0] / row["roll"][0]), float(row["slip_cutoff_gap"][0])
    (1.6666666666666667, 0.0002)
    """

    wall_slip: tuple[float, float]
    pair_slip: tuple[float, float]
    roll: tuple[float, float]
    radius: float
    largest_rate: float = np.inf

    def __post_init__(self) -> None:
        if not 0.0 < self.radius < np.inf:
            rule = "must be a finite number above 0"
            raise CaseError("lubrication.tangential.radius", self.radius, rule, cure="Correct this value.")
        if not self.largest_rate > 0.0:
            raise CaseError("lubrication.tangential.largest_rate", self.largest_rate, "must be above 0")
        for name in ("wall_slip", "pair_slip", "roll"):
            cutoff, touching = getattr(self, name)
            if not 0.0 < touching <= cutoff < np.inf:
                rule = "must be two gaps, the second above 0 and at most the first"
                raise CaseError(f"lubrication.tangential.{name}", (cutoff, touching), rule, cure="Correct them.")

    def rows(self, viscosity: float, radius: Floats, is_wall: NDArray[np.bool_]) -> dict[str, Floats]:
        """Fields of :data:`rdpm.contacts.lubrication.LUBRICATION`.

        Parameters
        ----------
        viscosity : float, [Pa s]
        radius : ndarray, (M,), [m]
            Reduced; that of the body at a wall.
        is_wall : ndarray of bool, (M,)
            Whether it is a face of the box.
        """
        scale = (radius / self.radius) ** (2.0 / 3.0)
        slip = [np.where(is_wall, *both) * scale for both in zip(self.wall_slip, self.pair_slip, strict=True)]
        viscous = np.pi * viscosity * radius
        return {
            "slip": SLIP * viscous, "slip_cutoff_gap": slip[0], "slip_touching_gap": slip[1],
            "roll": ROLL * viscous, "roll_cutoff_gap": self.roll[0] * scale, "roll_touching_gap": self.roll[1] * scale,
            "largest_rate": np.full_like(radius, self.largest_rate),
        }  # fmt: skip

    def rows_of_inner_walls(self, viscosity: float, radius: Floats, across: Floats) -> dict[str, Floats]:
        r"""Of a gap with two radii, :math:`R_1` across the wall's axis and the body's own, :math:`R_2`, along it.

        :math:`a_r=\sqrt{R_1R_2}`, and instead of 6/5 the mean of :math:`6R_2/(3R_2+2R_1)` across and
        :math:`6R_1/(3R_1+2R_2)` along: both are within 21 % of it for a tube of twice the body's radius.
        """
        result = self.rows(viscosity, np.sqrt(across * radius), np.zeros(radius.shape, np.bool_))
        mean = 3.0 * radius / (3.0 * radius + 2.0 * across) + 3.0 * across / (3.0 * across + 2.0 * radius)
        return result | {"roll": result["roll"] * mean / ROLL}
