"""Contacts: bodies that touch bodies and walls, resolved in sub-steps of the time step.

Start with ``law.py`` (what a contact law is), ``soft_sphere.py`` (the linear spring-dashpot) and
``substeps.py`` (the motion over one time step).
"""

from rdpm.contacts.episodes import EPISODE
from rdpm.contacts.law import ContactLaw, PairParameters
from rdpm.contacts.lubrication import Lubrication
from rdpm.contacts.neighbours import NO_NEIGHBOUR, nearest_gaps
from rdpm.contacts.soft_sphere import SoftSphere
from rdpm.contacts.substeps import Contacts, ContactStep
from rdpm.contacts.walls import Box

__all__ = [
    "EPISODE",
    "NO_NEIGHBOUR",
    "Box",
    "ContactLaw",
    "ContactStep",
    "Contacts",
    "Lubrication",
    "PairParameters",
    "SoftSphere",
    "nearest_gaps",
]
