"""Design of collision parameters: from what a user knows to stiffness, damping, contact steps, with reasons.

Pure functions in SI units; nothing here runs a simulation. Theory: docs/theory/soft_sphere.md.
"""

from __future__ import annotations

from rdpm.design import front_door
from rdpm.design.adaptive import adaptive_collision, adaptive_overlap, adaptive_stiffness
from rdpm.design.adaptive_design import AdaptiveDesign, adaptive_design
from rdpm.design.cohesion import pull_off_force, sticking_speed
from rdpm.design.dimensionless import (
    added_mass,
    legendre,
    reduced_mass,
    sphere_mass,
    stokes_number,
    terminal_velocity,
    wet_restitution,
)
from rdpm.design.hard_sphere import FiniteContact, finite_contact_error
from rdpm.design.hard_sphere_design import COMPARED_STEPS, HardSphereDesign, hard_sphere_design
from rdpm.design.hertz import (
    effective_modulus,
    hertz_contact_time,
    hertz_overlap,
    rayleigh_time,
    reduced_radius,
)
from rdpm.design.hertz_contact import (
    effective_shear_modulus,
    hertz_damping,
    hertz_duration,
    hertz_peak_overlap,
    hertz_speed,
    hertz_stiffness,
)
from rdpm.design.hertz_design import HertzDesign, hertz_design
from rdpm.design.integrators import produced_restitution
from rdpm.design.overlap import (
    contact_steps_for_stiffness,
    impact_speed_for_overlap,
    largest_contact_time,
    largest_time_step,
    softest_stiffness,
    static_overlap,
    submerged_weight,
)
from rdpm.design.repulsive import (
    closest_gap,
    repulsion_stiffness,
    repulsion_time,
    resting_gap,
    weight_stiffness,
)
from rdpm.design.repulsive_design import RepulsiveDesign, repulsive_design
from rdpm.design.result import Design, Verdict
from rdpm.design.soft_sphere import (
    achieved_restitution,
    contact_parameters,
    contact_time,
    damping_from_stiffness,
    damping_ratio,
    dimensionless_contact_time,
    peak_overlap,
    ratio_from_poisson,
    restitution,
    stiffness_from_overlap,
    tangential_parameters,
    tangential_restitution,
)
from rdpm.design.tangential import sliding_ratio

# the submodule of this name stays importable: `from rdpm.design.soft_sphere import contact_parameters`
soft_sphere = front_door.soft_sphere

__all__ = [
    "COMPARED_STEPS",
    "AdaptiveDesign",
    "Design",
    "FiniteContact",
    "HardSphereDesign",
    "HertzDesign",
    "RepulsiveDesign",
    "Verdict",
    "achieved_restitution",
    "adaptive_collision",
    "adaptive_design",
    "adaptive_overlap",
    "adaptive_stiffness",
    "added_mass",
    "closest_gap",
    "contact_parameters",
    "contact_steps_for_stiffness",
    "contact_time",
    "damping_from_stiffness",
    "damping_ratio",
    "dimensionless_contact_time",
    "effective_modulus",
    "effective_shear_modulus",
    "finite_contact_error",
    "hard_sphere_design",
    "hertz_contact_time",
    "hertz_damping",
    "hertz_design",
    "hertz_duration",
    "hertz_overlap",
    "hertz_peak_overlap",
    "hertz_speed",
    "hertz_stiffness",
    "impact_speed_for_overlap",
    "largest_contact_time",
    "largest_time_step",
    "legendre",
    "peak_overlap",
    "produced_restitution",
    "pull_off_force",
    "ratio_from_poisson",
    "rayleigh_time",
    "reduced_mass",
    "reduced_radius",
    "repulsion_stiffness",
    "repulsion_time",
    "repulsive_design",
    "resting_gap",
    "restitution",
    "sliding_ratio",
    "soft_sphere",
    "softest_stiffness",
    "sphere_mass",
    "static_overlap",
    "sticking_speed",
    "stiffness_from_overlap",
    "stokes_number",
    "submerged_weight",
    "tangential_parameters",
    "tangential_restitution",
    "terminal_velocity",
    "weight_stiffness",
    "wet_restitution",
]
