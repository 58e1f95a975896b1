"""Every fitted or chosen number of the immersed bodies, their contacts and their lubrication, in one object."""

from __future__ import annotations

from dataclasses import Field, dataclass, field, fields
from typing import Any

__all__ = ["CALIBRATION", "Calibration"]


def _constant(value: float | int | tuple[float, float], unit: str, meaning: str, basis: str, command: str) -> Any:
    return field(default=value, metadata={"unit": unit, "meaning": meaning, "basis": basis, "command": command})


_ARRAYS = "drag of dilute simple-cubic arrays (Zick and Homsy 1982)"
_IMPULSE = "interior momentum after a unit impulse on the markers, 6 to 24 cells a diameter"
_FRACTION = "python benchmarks/interior_fraction.py"
_STOKES = "resolved resistance in Stokes flow, 8 to 16 cells a diameter (Brenner 1961, Maude 1961)"
_NEAR = "rdpm validate near-contact"
_SHEAR = "resolved shear and rotation in Stokes flow, 8 and 16 cells a diameter (O'Neill 1964, Jeffrey and Onishi 1984)"
_NEAR_SHEAR = "rdpm validate near-contact-shear"


@dataclass(frozen=True)
class Calibration:
    """Numbers that no equation gives; `dataclasses.replace` makes a varied one.

    Each field's metadata hold its unit, its meaning, what it was fitted or chosen on, and the command that shows it;
    :meth:`rows` lists them.

    Examples
    --------
    >>> from dataclasses import replace
    >>> replace(CALIBRATION, marker_retraction=0.3).marker_retraction
    0.3
    >>> CALIBRATION.retained_fraction(0.04)
    0.5
    """

    marker_retraction: float = _constant(
        0.33, "cells", "depth of the markers below the surface: the regularised delta spreads their force outwards",
        _ARRAYS, "python benchmarks/retraction.py",
    )  # fmt: skip
    exclusion_near: float = _constant(
        0.5, "cells", "distance to another surface up to which a marker has its least volume",
        "the half width of the delta less the retraction", _NEAR,
    )  # fmt: skip
    exclusion_far: float = _constant(
        2.0, "cells", "distance to another surface from which on a marker has its whole volume",
        "the deltas of two surfaces no longer overlap", _NEAR,
    )  # fmt: skip
    forcing_passes: int = _constant(
        3, "-", "passes of direct forcing a step",
        "the third changes the settling speed by 0.14 %, a fourth by 0.05 %", "rdpm run settling",
    )  # fmt: skip
    relaxation_number: float = _constant(
        0.04, "-", "viscous number nu dt / h^2 at which half of the lagged forcing is retained",
        "drag independent of dt, rebound free of memory", "rdpm validate ten-cate-e3 rebound",
    )  # fmt: skip
    impact_threshold: float = _constant(
        0.02, "-",
        "change of a velocity within a step, over the speed at which its contact began, that makes an impact",
        "first rebound at Stokes number 152", "rdpm validate rebound",
    )  # fmt: skip
    interior_fraction: tuple[float, float] = _constant(
        (0.471, -0.336), "-", "fraction of an impulse on the markers found inside after projection: a + b / (cells a "
        "diameter)", _IMPULSE, _FRACTION,
    )  # fmt: skip
    interior_fraction_rotation: tuple[float, float] = _constant(
        (0.71, -1.07), "-", "the same for an angular impulse, which drives no pressure", _IMPULSE, _FRACTION
    )
    interior_fraction_predicted: tuple[float, float] = _constant(
        (0.702, -0.50), "-", "the same for an impulse before the projection", _IMPULSE, _FRACTION
    )
    contact_fluid_fraction: float = _constant(
        0.3, "-", "fraction of the entrained fluid in the inertia that contacts and lubrication act on",
        "stable from 0.2 to 0.4 at density ratios 0.01 to 10; the whole oscillates", "rdpm validate rebound basset",
    )  # fmt: skip
    substeps_per_contact: int = _constant(
        100, "-", "sub-steps in the shortest contact within range",
        "restitution within 0.1 % of its target from 4 steps a contact on",
        "python -m pytest tests/analytic/test_contact_restitution.py",
    )  # fmt: skip
    wall_activation_gap: float = _constant(
        1.5, "cells", "gap to a wall below which lubrication is corrected", _STOKES, _NEAR
    )
    wall_resolved_gap: float = _constant(
        0.28, "cells", "gap at which the grid sees a body that touches a wall", _STOKES, _NEAR
    )
    pair_activation_gap: float = _constant(
        0.31, "cells", "gap of two bodies below which lubrication is corrected, at `pair_reference_radius`",
        _STOKES, _NEAR,
    )  # fmt: skip
    pair_resolved_gap: float = _constant(
        0.19, "cells", "gap at which the grid sees two touching bodies, at `pair_reference_radius`", _STOKES, _NEAR
    )
    pair_reference_radius: float = _constant(
        2.0, "cells", "reduced radius of pair and tangential gaps: equal spheres of 8 cells a diameter", _STOKES, _NEAR
    )
    wall_slip_gaps: tuple[float, float] = _constant(
        (0.1, 0.02), "cells", "gap to a wall below which lubrication of slip is corrected, and gap at which the grid "
        "sees touching surfaces slip, at `pair_reference_radius`", _SHEAR, _NEAR_SHEAR,
    )  # fmt: skip
    pair_slip_gaps: tuple[float, float] = _constant(
        (0.3, 0.06), "cells", "the same of two bodies", _SHEAR, _NEAR_SHEAR
    )
    roll_gaps: tuple[float, float] = _constant(
        (0.3, 0.11), "cells", "the same of roll, beside walls and of two bodies", _SHEAR, _NEAR_SHEAR
    )

    tangential_rate: float = _constant(
        0.25, "-", "largest rate, times the time step, at which lubrication slows slip and roll",
        "a sphere of half the fluid's density 0.001 a from a wall turns steadily at nu dt / h^2 = 1.5",
        "python -m pytest tests/property/test_light_bodies.py",
    )  # fmt: skip

    def retained_fraction(self, viscous_number: float) -> float:
        """Fraction x / (x + x_0) of the lagged forcing that the next step begins with, x = nu dt / h^2.

        Parameters
        ----------
        viscous_number : float, [-]
            > 0.

        Notes
        -----
        The retained part makes the drag independent of dt where viscosity carries the forced layer away within a step,
        x ~ 1. It is also a memory of 1 + x / x_0 steps: where two surfaces are so close that the grid cannot hold both,
        or a contact reverses a body, a force retained whole outlives its cause. The slip left by the rest is at most
        of order x_0 h / delta of the speed, with the boundary layer delta, whatever dt.
        """
        return viscous_number / (viscous_number + self.relaxation_number)

    def rows(self) -> list[tuple[str, str, str, str, str, str]]:
        """Name, value, unit, meaning, basis and command of each number, for a table."""
        return [_row(one, getattr(self, one.name)) for one in fields(self)]


def _row(one: Field[Any], value: Any) -> tuple[str, str, str, str, str, str]:
    m = one.metadata
    return one.name, str(value), m["unit"], m["meaning"], m["basis"], m["command"]


CALIBRATION = Calibration()
