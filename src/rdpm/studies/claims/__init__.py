"""Claims by name, and how they are judged: by rules, against the spread that numerics alone give.

The claims are those of S. Musong, Z.-G. Feng, E. E. Michaelides, The effect of model parameters of the soft-sphere
scheme on particle-particle collisions, NETL Multiphase Flow Conference (2012).
"""

from __future__ import annotations

from rdpm.studies.claims.claim import (
    Alike,
    Approaches,
    Claim,
    Computed,
    Expected,
    Happens,
    Insensitive,
    Judgement,
    Limit,
    Trend,
    Verdict,
)
from rdpm.studies.claims.judging import judge, judge_each
from rdpm.studies.claims.of_study import judge_study
from rdpm.studies.claims.talk_design import DESIGN_CLAIMS
from rdpm.studies.claims.talk_runs import RUN_CLAIMS

__all__ = [
    "CLAIMS",
    "DESIGN_CLAIMS",
    "RUN_CLAIMS",
    "Alike",
    "Approaches",
    "Claim",
    "Computed",
    "Expected",
    "Happens",
    "Insensitive",
    "Judgement",
    "Limit",
    "Trend",
    "Verdict",
    "judge",
    "judge_each",
    "judge_study",
]

#: Name -> claim.
CLAIMS = {claim.id: claim for claim in (*DESIGN_CLAIMS, *RUN_CLAIMS)}
