"""Drawings by the names that a study file uses."""

from __future__ import annotations

from rdpm.studies.drawn_models import draw_models
from rdpm.studies.drawn_pairs import draw_gap, draw_kisses, draw_relative, draw_trajectory, draw_velocity
from rdpm.studies.drawn_sweeps import (
    draw_contacts,
    draw_convergence,
    draw_design,
    draw_restitution,
    draw_videos,
    draw_wet_restitution,
)
from rdpm.studies.pictures import Drawing

__all__ = ["DRAWINGS"]

DRAWINGS = {
    "settling-velocity": Drawing(draw_velocity),
    "trajectory": Drawing(draw_trajectory),
    "relative-position": Drawing(draw_relative),
    "gap": Drawing(draw_gap),
    "kisses": Drawing(draw_kisses),
    "contacts": Drawing(draw_contacts),
    "restitution": Drawing(draw_restitution),
    "wet-restitution": Drawing(draw_wet_restitution),
    "convergence": Drawing(draw_convergence),
    "models": Drawing(draw_models),
    "design-charts": Drawing(draw_design),
    "videos": Drawing(draw_videos, needs_fields=True),
}
