"""Contacts: bodies that touch bodies and walls, resolved in sub-steps of the time step.

Start with ``law.py`` (what a contact law is), ``soft_sphere.py`` (the linear spring-dashpot), ``substeps.py`` (the
motion over one time step), ``hard_sphere.py`` (collisions as impulses) and ``contacts.py`` (what holds them together).
"""

from rdpm.contacts.adaptive import AdaptiveCollisionTime
from rdpm.contacts.contacts import Contacts
from rdpm.contacts.driver import ContactStep
from rdpm.contacts.episodes import EPISODE
from rdpm.contacts.extended import ExtendedContact
from rdpm.contacts.hard_sphere import EventDriver, HardSphere
from rdpm.contacts.hertz import Hertz
from rdpm.contacts.law import ContactLaw
from rdpm.contacts.lubrication import Lubrication
from rdpm.contacts.neighbours import nearest_gaps
from rdpm.contacts.python_law import PairMotion, PythonLaw
from rdpm.contacts.repulsive import Repulsive
from rdpm.contacts.rows import PAIR
from rdpm.contacts.soft_sphere import SoftSphere
from rdpm.contacts.substeps import SubstepDriver
from rdpm.contacts.tangential_lubrication import TangentialLubrication

__all__ = [
    "EPISODE",
    "PAIR",
    "AdaptiveCollisionTime",
    "ContactLaw",
    "ContactStep",
    "Contacts",
    "EventDriver",
    "ExtendedContact",
    "HardSphere",
    "Hertz",
    "Lubrication",
    "PairMotion",
    "PythonLaw",
    "Repulsive",
    "SoftSphere",
    "SubstepDriver",
    "TangentialLubrication",
    "nearest_gaps",
]
