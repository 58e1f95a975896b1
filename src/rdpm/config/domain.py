"""The box and what fills it."""

from __future__ import annotations

from typing import Annotated

from pydantic import StrictBool, model_validator

from rdpm.config.declared import Choice, Components, LeftOut, Quantity
from rdpm.config.fields import Model, Vector
from rdpm.config.inflow import Inflow, check_inflow
from rdpm.config.rule import RuleError
from rdpm.conventions import BOUNDARY_KINDS, FACES, BoundaryKind

__all__ = ["Boundary", "Domain", "Fluid", "WallVelocity"]

_KIND = Choice(BOUNDARY_KINDS)
_SPEED = Components(Quantity("m/s"))
_ACCELERATION = Components(Quantity("m/s^2"))


class Boundary(Model):
    """What bounds the box, for each pair of opposite faces.

    Attributes
    ----------
    x, y, z
        A wall has no slip. `inflow-outflow` is for one direction, and needs `domain.inflow`.
    """

    x: Annotated[BoundaryKind, _KIND] = "wall"
    y: Annotated[BoundaryKind, _KIND] = "wall"
    z: Annotated[BoundaryKind, _KIND] = "wall"


class WallVelocity(Model):
    """Velocities of walls that move in their own plane.

    Attributes
    ----------
    x_lower, x_upper, y_lower, y_upper, z_lower, z_upper
        At rest when left out. The component across the wall is zero.
    """

    x_lower: Annotated[Vector | None, _SPEED] = None
    x_upper: Annotated[Vector | None, _SPEED] = None
    y_lower: Annotated[Vector | None, _SPEED] = None
    y_upper: Annotated[Vector | None, _SPEED] = None
    z_lower: Annotated[Vector | None, _SPEED] = None
    z_upper: Annotated[Vector | None, _SPEED] = None


class Domain(Model):
    """A box from the origin, and gravity.

    Attributes
    ----------
    size
        Lengths of the box; kept exactly.
    boundary
        What bounds the box; walls when left out.
    gravity
        Acceleration by gravity.
    wall_velocity
        Velocities of walls that move.
    inflow
        What enters along the direction whose boundary is `inflow-outflow`; as much leaves at its other end.
    """

    size: Annotated[Vector, Components(Quantity("m", gt=0.0))]
    boundary: Boundary = Boundary()
    gravity: Annotated[Vector, _ACCELERATION] = (0.0, 0.0, -9.81)
    wall_velocity: WallVelocity = WallVelocity()
    inflow: Inflow | None = None

    @property
    def inflow_axis(self) -> int | None:
        """Direction of the inflow: 0, 1, 2; None without one."""
        return self.kinds.index("inflow-outflow") if self.inflow is not None else None

    @property
    def kinds(self) -> tuple[BoundaryKind, BoundaryKind, BoundaryKind]:
        """Boundaries along x, y, z."""
        return self.boundary.x, self.boundary.y, self.boundary.z

    @property
    def is_periodic(self) -> tuple[bool, bool, bool]:
        """Whether x, y, z are periodic."""
        x, y, z = (kind == "periodic" for kind in self.kinds)
        return x, y, z

    @property
    def wall_velocities(self) -> tuple[Vector, ...]:
        """Velocity [m/s] of each face, in the order of `FACES`; zero where none is given."""
        return tuple(getattr(self.wall_velocity, face) or (0.0, 0.0, 0.0) for face in FACES)

    @model_validator(mode="after")
    def _is_open_along_the_inflow(self) -> Domain:
        check_inflow(self.kinds, self.inflow)
        return self

    @model_validator(mode="after")
    def _walls_slide(self) -> Domain:
        for n, face in enumerate(FACES):
            velocity = getattr(self.wall_velocity, face)
            if velocity is None:
                continue
            if self.kinds[n // 2] != "wall":
                raise RuleError(
                    f'must be left out where boundary.{face[0]} = "{self.kinds[n // 2]}"',
                    "only a wall moves",
                    f'Set domain.boundary.{face[0]} = "wall".',
                    value=velocity,
                    at=("wall_velocity", face),
                )
            if velocity[n // 2] != 0.0:
                raise RuleError(
                    f"must have no {face[0]} component",
                    "a wall slides in its own plane",
                    f"Set component {n // 2} to 0.",
                    value=velocity,
                    at=("wall_velocity", face),
                )
        return self


class Fluid(Model):
    """An incompressible Newtonian fluid.

    Attributes
    ----------
    density
        Mass a volume.
    viscosity
        Dynamic viscosity; this or `kinematic_viscosity`.
    kinematic_viscosity
        Dynamic viscosity over density; instead of `viscosity`.
    body_force
        Force on a unit mass of fluid, beside gravity (which the hydrostatic pressure carries); this or
        `pressure_gradient`.
    pressure_gradient
        Mean gradient; the flow is driven against it.
    zero_mean_flow
        Whether the mean volume flow of a fully periodic box is kept at zero.
    initial_velocity
        Of the fluid at the start; uniform.
    """

    density: Annotated[float, Quantity("kg/m^3", gt=0.0)]
    viscosity: Annotated[float | None, Quantity("Pa s", gt=0.0)] = None
    kinematic_viscosity: Annotated[float | None, Quantity("m^2/s", gt=0.0)] = None
    body_force: Annotated[Vector | None, _ACCELERATION] = None
    pressure_gradient: Annotated[Vector | None, Components(Quantity("Pa/m"))] = None
    zero_mean_flow: Annotated[
        StrictBool | None, LeftOut("true where free bodies settle in a fully periodic box and no force drives the flow")
    ] = None
    initial_velocity: Annotated[Vector, _SPEED] = (0.0, 0.0, 0.0)

    @model_validator(mode="after")
    def _is_one_fluid(self) -> Fluid:
        if (self.viscosity is None) == (self.kinematic_viscosity is None):
            found = "neither is given" if self.viscosity is None else "both are given"
            raise RuleError('must have exactly one of "viscosity" and "kinematic_viscosity"', found)
        if self.body_force is not None and self.pressure_gradient is not None:
            raise RuleError('must have at most one of "body_force" and "pressure_gradient"', "both are given")
        if self.zero_mean_flow and self.is_driven:
            raise RuleError(
                "must not be true where a force drives the flow",
                "a mean flow is what it drives",
                "Leave one of them out.",
                at=("zero_mean_flow",),
            )
        return self

    @property
    def is_driven(self) -> bool:
        """Whether a body force or a pressure gradient is given."""
        return self.body_force is not None or self.pressure_gradient is not None

    @property
    def mu(self) -> float:
        """Dynamic viscosity [Pa s]."""
        return (
            self.viscosity if self.viscosity is not None else self.density * (self.kinematic_viscosity or 0.0)
        )

    @property
    def nu(self) -> float:
        """Kinematic viscosity [m^2/s]."""
        return self.kinematic_viscosity or self.mu / self.density

    @property
    def acceleration(self) -> Vector:
        """Uniform acceleration [m/s^2] by the body force or the pressure gradient."""
        if self.pressure_gradient is not None:
            x, y, z = (-gradient / self.density for gradient in self.pressure_gradient)
            return x, y, z
        return self.body_force or (0.0, 0.0, 0.0)
