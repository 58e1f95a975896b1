"""What a study can measure, draw and claim, by the names that a study file uses.

A measure is a function of one run, from time zero on. It returns columns of the study's table: a flat dict from names
with units (``kiss_time_s``) to numbers or None, always with the same names. A drawing gets the whole study and writes
files into a folder. A claim is a statement with what the table must show for it to hold. To add one, write it and name
it here, or in the table that is imported here.
"""

from __future__ import annotations

from rdpm.studies.claims import CLAIMS
from rdpm.studies.drawings import DRAWINGS
from rdpm.studies.measures import MEASURES

__all__ = ["CLAIMS", "DRAWINGS", "MEASURES"]
