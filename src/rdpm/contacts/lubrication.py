"""Lubrication between close surfaces: the part that the grid does not resolve."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rdpm import _core
from rdpm.errors import CaseError

from .rows import Rows, as_bytes, check_layout
from .tangential_lubrication import TangentialLubrication

__all__ = ["LUBRICATION", "Lubrication"]

Floats = NDArray[np.float64]

_NORMAL = ("inverse", "log", "least_gap", "cutoff_gap", "touching_gap", "separation")
_TANGENTIAL = (
    "slip", "slip_cutoff_gap", "slip_touching_gap", "roll", "roll_cutoff_gap", "roll_touching_gap", "largest_rate",
)  # fmt: skip
LUBRICATION = np.dtype([(name, np.float64) for name in _NORMAL + _TANGENTIAL])
"""Coefficients of 1/gap [N s] and ln(1/gap) [N s/m] of a pair, the gap below which the resistance is constant, the
cut-off, and the gap at which the grid resolves touching surfaces [m], the fraction that acts where the surfaces part;
coefficients of ln(1/gap) of slip and of roll, their gaps, the largest rate at which they are slowed [1/s]; zeros: no
lubrication."""
check_layout(LUBRICATION, _core.contact_layouts()["lubrication"], "lubrication")


@dataclass(frozen=True)
class Lubrication:
    r"""Resistance :math:`\lambda(g)-\lambda(g_{res})` to the normal velocity, zero beyond the cut-off.

    :math:`\lambda = 6\pi\mu\,[a_r^2/g + a_i\,g_2(\beta)\ln(1/g)]` with :math:`a_r=a_ia_j/(a_i+a_j)`,
    :math:`\beta=a_j/a_i` and :math:`g_2=\beta(1+7\beta+\beta^2)/(5(1+\beta)^3)`; a wall is
    :math:`\beta\to\infty`. The grid resolves the flow between surfaces a little further apart,
    :math:`g_{res}=g_0+g(1-g_0/g_{cut})`: touching surfaces as if they were :math:`g_0` apart. The resistance is
    constant below the roughness and zero in overlap, where the solids carry the load: the overlap of a softened
    contact is no gap.

    Parameters
    ----------
    viscosity : float, [Pa s]
        Dynamic viscosity of the fluid. > 0.
    cutoff_gap : float, [m]
        Gap to a wall from which on the grid resolves lubrication: a number of cells times the mean spacing. > 0.
    roughness : float, [-]
        Smallest gap as a fraction of the smaller radius, 0 < roughness <= 0.1.
    touching_gap : float, optional, [m]
        Gap as which the grid resolves that of a body touching a wall, :math:`g_0`, 0 < value <= cutoff_gap; cutoff_gap
        when left out: below the cut-off the grid then resolves no more than at it.
    pair_cutoff_gap, pair_touching_gap : float, optional, [m]
        The same between two bodies; those of a wall when left out.
    pair_radius : float, optional, [m]
        Reduced radius :math:`a_r` that these two belong to; for others they go as :math:`a_r^{2/3}`. The same for all
        when left out. > 0.
    separation : float, [-]
        Fraction of the resistance where the surfaces part, 0 to 1: 0 where the liquid breaks instead of pulling.
    tangential : TangentialLubrication, optional
        That of slip and roll; none when left out.

    Raises
    ------
    CaseError
        An argument outside its range.

    References
    ----------
    .. [1] Jeffrey, Onishi, J. Fluid Mech. 139 (1984) 261-290, doi:10.1017/S0022112084000355.
    .. [2] Costa, Boersma, Westerweel, Breugem, Phys. Rev. E 92 (2015) 053012 (constant at small gaps, off in contact).
    .. [3] Cox, Int. J. Multiphase Flow 1 (1974) 343-371, doi:10.1016/0301-9322(74)90019-6 (any two curved surfaces).
    .. [4] Brenner, Chem. Eng. Sci. 16 (1961) 242-251; Cox, Brenner, Chem. Eng. Sci. 22 (1967) 1753-1777.

    Examples
    --------
    >>> lubrication = Lubrication(viscosity=0.1, cutoff_gap=1e-3)
    >>> a = 7.5e-3
    >>> round(float(lubrication.resistance(np.array([1e-4]), a, np.inf)[0] / (6 * np.pi * 0.1 * a)), 2)   # a wall
    67.96
    """

    viscosity: float
    cutoff_gap: float
    roughness: float = 1e-3
    touching_gap: float | None = None
    pair_cutoff_gap: float | None = None
    pair_touching_gap: float | None = None
    pair_radius: float | None = None
    separation: float = 1.0
    tangential: TangentialLubrication | None = None

    def __post_init__(self) -> None:
        for name, upper in (("viscosity", np.inf), ("cutoff_gap", np.inf), ("roughness", 0.1)):
            value = getattr(self, name)
            if not (0.0 < value <= upper and value < np.inf):
                bound = f" and at most {upper:g}" if upper < np.inf else ""
                rule = "must be a finite number above 0" + bound
                raise CaseError(f"lubrication.{name}", value, rule, cure="Correct this value.")

        if not 0.0 <= self.separation <= 1.0:
            rule = "must be at least 0 and at most 1"
            raise CaseError("lubrication.separation", self.separation, rule, cure="Correct this value.")
        for name, cut in (("touching_gap", self.cutoff_gap), ("pair_touching_gap", self._pair[0])):
            value = getattr(self, name)
            if value is not None and not 0.0 < value <= cut:
                raise CaseError(f"lubrication.{name}", value, f"must be above 0 and at most the cut-off, {cut:g} m")

    @property
    def _wall(self) -> tuple[float, float]:
        return self.cutoff_gap, self.touching_gap or self.cutoff_gap

    @property
    def _pair(self) -> tuple[float, float]:
        cut = self.pair_cutoff_gap or self.cutoff_gap
        return cut, self.pair_touching_gap or min(self._wall[1], cut)

    def largest_gap(self, radius: Floats, has_inner_walls: bool = False) -> float:
        """Gap beyond which no lubrication acts between bodies of these radii, (N,), and walls [m]."""
        largest = radius.max(keepdims=True, initial=0.0)
        rows = [self.rows(largest, other) for other in (np.full_like(largest, np.inf), largest)]
        if has_inner_walls:
            rows.append(self.rows_of_inner_walls(largest, np.zeros_like(largest)))
        gaps = ("cutoff_gap", "slip_cutoff_gap", "roll_cutoff_gap")
        return float(max(row[gap].max(initial=0.0) for row in rows for gap in gaps))

    def _gaps(self, radius_i: Floats, radius_j: Floats) -> tuple[Floats, Floats]:
        """Cut-off gap, and that as which the grid resolves touching surfaces, of each pair, (M,), (M,) [m]."""
        is_wall = np.isinf(radius_j)
        scale = np.ones_like(radius_i)
        if self.pair_radius is not None:
            other = np.where(is_wall, radius_i, radius_j)
            scale = np.where(is_wall, 1.0, (radius_i * other / (radius_i + other) / self.pair_radius) ** (2.0 / 3.0))
        cut, touching = (np.where(is_wall, *both) * scale for both in zip(self._wall, self._pair, strict=True))
        return cut, touching

    def rows(self, radius_i: Floats, radius_j: Floats) -> Rows:
        """Coefficients and gaps of each pair.

        Parameters
        ----------
        radius_i, radius_j : ndarray, (M,), [m]
            > 0; ``radius_j`` infinite for a wall.

        Returns
        -------
        ndarray of :data:`LUBRICATION`, (M,)
        """
        t = radius_i / (radius_i + radius_j)  # in terms of 1/(1 + beta) the wall is no special case
        s = np.where(np.isinf(radius_j), 1.0, 1.0 - t)
        factor = 6.0 * np.pi * self.viscosity
        result = np.empty(len(radius_i), LUBRICATION)
        result["inverse"] = factor * (radius_i * s) ** 2
        result["log"] = factor * radius_i * s * (t * t + 7.0 * t * s + s * s) / 5.0
        result["least_gap"] = self.roughness * np.minimum(radius_i, radius_j)
        result["cutoff_gap"], result["touching_gap"] = self._gaps(radius_i, radius_j)
        result["separation"] = self.separation
        for name in _TANGENTIAL:
            result[name] = 0.0
        if self.tangential:
            for name, values in self.tangential.rows(self.viscosity, radius_i * s, np.isinf(radius_j)).items():
                result[name] = values
        return result

    def rows_of_inner_walls(self, radius: Floats, curvature: Floats) -> Rows:
        r"""Coefficients and gaps of spheres and walls within the box.

        The gap between a sphere and a cylinder has two radii, :math:`R_1=1/(1/a+\kappa)` across the axis and
        :math:`R_2=a` along it, and :math:`12\pi\mu\sqrt{R_1R_2}/(1/R_1+1/R_2)` instead of
        :math:`6\pi\mu a^2` [3]_; the logarithmic term is that of a plane. Such a wall is held by markers, as a body is:
        the grid resolves it as it resolves two bodies.

        Parameters
        ----------
        radius : ndarray, (M,), [m]
            > 0.
        curvature : ndarray, (M,), [1/m]
            Of the wall across its axis: 0 of a plane, negative where the sphere is inside; above -1/radius.

        Returns
        -------
        ndarray of :data:`LUBRICATION`, (M,)
        """
        result = self.rows(radius, np.full_like(radius, np.inf))
        across = 1.0 / (1.0 / radius + curvature)
        result["inverse"] = 12.0 * np.pi * self.viscosity * np.sqrt(across * radius) / (1.0 / across + 1.0 / radius)
        scale = np.ones_like(radius) if self.pair_radius is None else (radius / self.pair_radius) ** (2.0 / 3.0)
        result["cutoff_gap"], result["touching_gap"] = (scale * length for length in self._pair)
        if self.tangential:
            for name, values in self.tangential.rows_of_inner_walls(self.viscosity, radius, across).items():
                result[name] = values
        return result

    def resistance(self, gap: Floats, radius_i: float, radius_j: float) -> Floats:
        """Force per approach speed that is added to what the grid resolves.

        Parameters
        ----------
        gap : ndarray, (M,), [m]
            Distance of the surfaces; negative in contact.
        radius_i, radius_j : float, [m]
            > 0; ``radius_j`` infinite for a wall.

        Returns
        -------
        ndarray, (M,), [N s/m]
        """
        return self._resistances(gap, radius_i, radius_j)[:, 0].copy()

    def tangential_resistance(self, gap: Floats, radius_i: float, radius_j: float) -> tuple[Floats, Floats]:
        """Force per speed of slip, and of roll, likewise; see :class:`TangentialLubrication`.

        Returns
        -------
        slip, roll : ndarray, (M,), [N s/m]
        """
        found = self._resistances(gap, radius_i, radius_j)
        return found[:, 1].copy(), found[:, 2].copy()

    def _resistances(self, gap: Floats, radius_i: float, radius_j: float) -> Floats:
        row = self.rows(np.array([radius_i]), np.array([radius_j]))
        gap = np.ascontiguousarray(gap, dtype=np.float64)
        result = np.empty((*gap.shape, 3))
        _core.lubrication_resistance(gap, as_bytes(row), result)
        return result
