"""State of the fluid and the two halves of its step: predict, project."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm import _core
from rdpm.fluid.diffusion import stages_for
from rdpm.fluid.open_ends import OpenEnds
from rdpm.fluid.slabs import SlabProjection
from rdpm.grid import Grid
from rdpm.parallel.halo import Halo
from rdpm.parallel.ranks import ALONE, Ranks

__all__ = ["Fluid"]

Field = NDArray[np.float64]

#: Planes of scratch a thread that the momentum kernels need.
MOMENTUM_SCRATCH = 9


@dataclass
class Fluid:
    """Velocity and pressure on the staggered grid, advanced by prediction and projection.

    Parameters
    ----------
    grid : Grid
    density : float, [kg/m^3]
    kinematic_viscosity : float, [m^2/s]
    is_explicit : bool
        Diffusion explicit (Adams-Bashforth 2), or by stabilised stages.
    ranks : Ranks
        That share the box, where the grid is of a slab.

    Attributes
    ----------
    u, v, w : ndarray, (nz+2, ny+2, nx+2), [m/s]
        ``u[k, j, i]`` on the face between cells i and i+1, ``v`` between j and j+1, ``w`` between k and k+1.
        Of this rank's slab alone, where several share the box.
    p : ndarray, (nz+2, ny+2, nx+2), [m^2/s^2]
        Pressure over density, without the hydrostatic part.
    tendency : list of three ndarray
        Last step's tendency, what Adams-Bashforth 2 extrapolates with; sources are spread into it.
    """

    grid: Grid
    density: float
    kinematic_viscosity: float
    is_explicit: bool = True
    ranks: Ranks = ALONE
    u: Field = field(init=False)
    v: Field = field(init=False)
    w: Field = field(init=False)
    p: Field = field(init=False)
    increment: Field = field(init=False)
    tendency: list[Field] = field(init=False)
    cfl_rate: float = field(init=False, default=0.0)
    square_sum: float = field(init=False, default=0.0)

    def __post_init__(self) -> None:
        self.u, self.v, self.w, self.p, self.increment = (self.grid.zeros() for _ in range(5))
        self.tendency = [self.grid.zeros() for _ in range(3)]
        self._rate = [] if self.is_explicit else [self.grid.zeros() for _ in range(3)]
        self._last_dt = 0.0
        self._scratch = np.zeros(0)
        self._no_planes: Field = np.zeros((0, *self.grid.shape[1:]))
        self._halo: Halo | None = None
        self._projection: _core.Projection | SlabProjection = _core.Projection(self.grid.core)
        if self.grid.slab is not None:
            self._halo = Halo(self.ranks, self.grid.slab)
            self._projection = SlabProjection(self.grid, self.ranks, self._halo)
        inflow = self.grid.box.inflow
        self._ends = OpenEnds(self.grid, inflow, self.ranks) if inflow is not None else None

    @property
    def velocity(self) -> tuple[Field, Field, Field]:
        """u, v, w."""
        return self.u, self.v, self.w

    @property
    def last_dt(self) -> float:
        """Length of the last step [s]; 0 before the first."""
        return self._last_dt

    @property
    def pressure_offset(self) -> float:
        """Of the pressure on a slab to that of one rank [m^2/s^2]."""
        return self._projection.offset if isinstance(self._projection, SlabProjection) else 0.0

    def set_velocity(self, u: Field | float, v: Field | float, w: Field | float) -> None:
        """Change the velocity: inner cells as given, halos from the boundaries.

        In a box with an inflow it begins with that of time 0, and is made divergence-free.

        Parameters
        ----------
        u, v, w : float or ndarray broadcastable to (nz+2, ny+2, nx+2), [m/s]
            Of the whole box, also where this rank has a slab of it.
        """
        nx, ny, nz = self.grid.cells
        take = slice(None) if self.grid.slab is None else self.grid.slab.take
        for location, (target, value) in enumerate(zip(self.velocity, (u, v, w), strict=True)):
            target[...] = np.broadcast_to(value, (nz + 2, ny + 2, nx + 2))[take]
            _core.fill_halo(self.grid.core, target, location)
        if self._halo is not None:
            self._halo.exchange(up=self.velocity, down=self.velocity)
        if self._ends is not None:
            self._ends.begin(self.velocity)
            self.project(1.0)
            self.p.fill(0.0)
            if isinstance(self._projection, SlabProjection):
                self._projection.offset = 0.0

    def weights(self, dt: float) -> tuple[float, float]:
        """Adams-Bashforth 2 weights of the new and the stored tendency: a and b in eq. (3) of docs/theory/fluid.md.

        Before the first step the stored tendency holds nothing but sources, which then count once.
        """
        if self._last_dt == 0.0:
            return 1.0, 1.0
        ratio = 0.5 * dt / self._last_dt
        return 1.0 + ratio, ratio

    def predict(
        self, dt: float, force: tuple[float, float, float], stages: int | None = None, time: float = 0.0
    ) -> None:
        """Change u, v, w to the velocity before projection, eq. (3) of docs/theory/fluid.md; tendencies are stored.

        Parameters
        ----------
        dt : float, [s]
        force : tuple of float, (3,), [m/s^2]
            Uniform, a unit mass.
        stages : int, optional
            Of the stabilised scheme; as many as the step needs when left out.
        time : float, [s]
            At the beginning of the step; what enters through an open end may depend on it.

        Notes
        -----
        On return only inner faces hold the prediction, and open ends what passes through them; halos and faces on
        walls are set by `project`.
        """
        now, then = self.weights(dt)
        passing = self._ends.coming(self.velocity, time, dt) if self._ends else None
        core, (u, v, w), (su, sv, sw) = self.grid.core, self.velocity, self.tendency
        nu = self.kinematic_viscosity
        stages = stages or stages_for(dt, self.grid.spacing, nu)
        planes = MOMENTUM_SCRATCH if self.is_explicit else max(MOMENTUM_SCRATCH, 3 * (stages - 2))
        size = planes * u[0].size * self.grid.threads
        if self._scratch.size < size:
            self._scratch = np.zeros(size)
        if self.is_explicit:
            _core.momentum_explicit(core, u, v, w, su, sv, sw, self.p, dt, now, then, nu, force, self._scratch)
        else:
            ru, rv, rw = self._rate
            _core.momentum_rate(core, u, v, w, su, sv, sw, ru, rv, rw, self.p, now, then, nu, force, self._scratch)
            others = [(self._no_planes, self._no_planes)] * 3
            if self._halo is not None:
                others = self._halo.deep(self._rate, stages - 1)
            for component, (q, rate, beyond) in enumerate(zip(self.velocity, self._rate, others, strict=True)):
                _core.diffuse_stabilised(core, q, rate, component, dt, nu, stages, self._scratch, *beyond)
        if self._ends and passing:
            self._ends.set(self.velocity, *passing)
        self._last_dt = dt

    def project(self, dt: float) -> None:
        """Change u, v, w to be divergence-free, halos current, and the pressure: eq. (4) of docs/theory/fluid.md."""
        rotational = 0.0 if self.is_explicit else 0.5 * self.kinematic_viscosity
        if isinstance(self._projection, SlabProjection):
            measures = self._projection.project(self.velocity, self.p, self.increment, dt, rotational)
        else:
            measures = self._projection.project(self.grid.core, *self.velocity, self.p, self.increment, dt, rotational)
        self.cfl_rate, self.square_sum = measures

    def largest_divergence(self) -> float:
        """Over the cells [1/s]."""
        return float(self.ranks.table([_core.largest_divergence(self.grid.core, *self.velocity)]).max())

    def cell_values(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Velocity (nz, ny, nx, 3) [m/s] and pressure (nz, ny, nx) [Pa] at the cell centres, single precision.

        Of this rank's slab alone, where several share the box.
        """
        nx, ny, nz = self.grid.cells_here
        velocity = np.empty((nz, ny, nx, 3), np.float32)
        pressure = np.empty((nz, ny, nx), np.float32)
        _core.cell_values(self.grid.core, *self.velocity, self.p, self.density, velocity, pressure)
        if isinstance(self._projection, SlabProjection):
            pressure -= np.float32(self.density * self._projection.offset)
        return velocity, pressure

    def kinetic_energy(self) -> float:
        """Of the fluid after the last projection [J]."""
        dx, dy, dz = self.grid.spacing
        return 0.5 * self.density * self.square_sum * dx * dy * dz

    def state(self) -> dict[str, NDArray[Any]]:
        """All that the next step needs: views of the fields, and scalars."""
        fields = dict(zip(("u", "v", "w"), self.velocity, strict=True)) | {"p": self.p}
        tendencies = {f"tendency_{x}": values for x, values in zip("xyz", self.tendency, strict=True)}
        scalars = {name: np.array(getattr(self, name)) for name in ("cfl_rate", "square_sum", "last_dt", "is_explicit")}
        if isinstance(self._projection, SlabProjection):
            scalars["pressure_offset"] = np.array(self._projection.offset)
        return fields | tendencies | scalars

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Change all fields to what `state` gave; the next step is then bit-identical.

        Where diffusion is now advanced the other way, the stored tendency holds other terms: the next step is then
        a first one.
        """
        names = ("u", "v", "w", "p", "tendency_x", "tendency_y", "tendency_z")
        for target, name in zip((*self.velocity, self.p, *self.tendency), names, strict=True):
            np.copyto(target, state[name])
        offset = float(state.get("pressure_offset", 0.0))
        if isinstance(self._projection, SlabProjection):
            self._projection.offset = offset
        elif offset:
            self.p -= offset
        self.cfl_rate, self.square_sum = float(state["cfl_rate"]), float(state["square_sum"])
        self._last_dt = float(state["last_dt"])
        if bool(state["is_explicit"]) != self.is_explicit:
            self._last_dt = 0.0
            for tendency in self.tendency:
                tendency.fill(0.0)

    @property
    def bytes(self) -> int:
        """Memory of the fields and the solver."""
        arrays = [*self.velocity, self.p, self.increment, *self.tendency, *self._rate, self._scratch]
        return sum(a.nbytes for a in arrays) + int(self._projection.bytes)
