"""Claims of Musong, Feng and Michaelides (2012) that runs decide."""

from __future__ import annotations

from rdpm.design.dimensionless import CRITICAL_STOKES
from rdpm.studies.claims.claim import Alike, Approaches, Claim, Happens, Insensitive, Limit, Trend

__all__ = ["RUN_CLAIMS"]

STIFFNESS, DAMPING, STEPS = "contact.stiffness", "contact.damping", "contact.contact_steps"
LUBRICATION, VISCOSITY, MODEL = "contact.lubrication", "fluid.viscosity", "contact.model"

#: Of the steel sphere whose rebound is measured.
DRY_RESTITUTION = 0.97

#: The talk's runs have no lubrication; its stiffness sweep is at eta_n = 100 dyn s/cm, its damping sweep at k_n = 5e4.
_TALK = {LUBRICATION: False, VISCOSITY: 0.113}
_STIFFNESS_SWEEP = _TALK | {DAMPING: 0.1}
_DAMPING_SWEEP = _TALK | {STIFFNESS: 50.0}
_WINDOW = _TALK | {DAMPING: 0.15}

_PRESSED = (
    "The pair meets at a Stokes number far below 10 and the wake then presses it together: a contact is a load on a "
    "spring rather than an impact. At fixed eta_n a stiffer spring is less damped, and may let the pair part once more."
)
_SINK = "Under a steady load W the overlap is W/k_n."
_HARD_MOTION = ("kiss_time_s", "tumble_start_s", "gap_kiss_total_s", "final_angle_deg")
_MOTION = ("kiss_time_s", "tumble_start_s", "gap_kiss_total_s", "settling_speed_max_m_s", "final_angle_deg")
_CONCLUSIONS, _EFFECT, _STEPS_SLIDE, _MODELS_SLIDE = (
    "Conclusions", "Effect of collision parameters on DKT", "Overlap and contact time in DKT", "Collision models"
)  # fmt: skip

#: Claims that need runs.
RUN_CLAIMS = (
    Claim("kissing-grows-with-stiffness", "Increasing k_n increases kissing: contacts.", _CONCLUSIONS,
          Trend("contact_kisses", STIFFNESS, True), _PRESSED, _STIFFNESS_SWEEP),
    Claim("kissing-grows-with-stiffness-by-gap", "Increasing k_n increases kissing: gaps below 2 % d.", _CONCLUSIONS,
          Trend("gap_kisses", STIFFNESS, True), _PRESSED, _STIFFNESS_SWEEP),
    Claim("kissing-grows-with-fewer-steps", "Decreasing N_c increases kissing: contacts.", _CONCLUSIONS,
          Trend("contact_kisses", STEPS, False), _PRESSED, _TALK),
    Claim("softer-with-less-stiffness", "Collisions get softer as k_n decreases: overlap.", _EFFECT,
          Trend("max_overlap_fraction", STIFFNESS, False), _SINK, _STIFFNESS_SWEEP),
    Claim("longer-with-less-stiffness", "Kissing gets longer as k_n decreases: gap below 2 % d.", _EFFECT,
          Trend("gap_kiss_total_s", STIFFNESS, False), _PRESSED, _STIFFNESS_SWEEP),
    Claim("longer-contact-with-less-stiffness", "Kissing gets longer as k_n decreases: contact.", _EFFECT,
          Trend("contact_kiss_total_s", STIFFNESS, False), _PRESSED, _STIFFNESS_SWEEP),
    Claim("softer-with-less-damping", "Collisions get softer as eta_n decreases: overlap.", _EFFECT,
          Trend("max_overlap_fraction", DAMPING, False),
          "A steady overlap does not depend on eta_n; a dashpot only slows the way to it.", _DAMPING_SWEEP),
    Claim("longer-with-less-damping", "Kissing gets longer as eta_n decreases: gap below 2 % d.", _EFFECT,
          Trend("gap_kiss_total_s", DAMPING, False), _PRESSED, _DAMPING_SWEEP),
    Claim("longer-contact-with-less-damping", "Kissing gets longer as eta_n decreases: contact.", _EFFECT,
          Trend("contact_kiss_total_s", DAMPING, False), _PRESSED, _DAMPING_SWEEP),
    Claim("overlap-in-runs", "The overlap is below 0.5 % of the diameter for 8 < N_c < 15.", _STEPS_SLIDE,
          Limit("max_overlap_fraction", 0.005, True, STEPS, 8.0, 15.0),
          "The overlap is in proportion to impact speed and contact time, and to the load that presses the pair.",
          _TALK, "at the impact speeds and loads of these runs"),
    Claim("insensitive-in-window", "DKT changes insignificantly for 5e3 <= k_n <= 1e5 dyn/cm.",
          "Refining the range of k_n",
          Insensitive(_MOTION, STIFFNESS, 5.0, 100.0),
          "The flow turns the pair; the contact keeps it apart, and acts on the flow by the overlap it lets happen.",
          _WINDOW),
    Claim("hard-limit-overlap", "For small N_c the scheme approaches a hard sphere: overlap.", _STEPS_SLIDE,
          Trend("max_overlap_fraction", STEPS, True),
          "k_n goes with 1/N_c^2, the overlap under a load with its inverse.", _TALK),
    Claim("small-steps-as-hard-sphere", "For small N_c the scheme approaches a hard sphere: kiss and tumble.",
          _STEPS_SLIDE, Approaches(_HARD_MOTION, STEPS, {MODEL: "hard-sphere"}),
          "The pair is pressed together, hardly thrown: both models keep it apart, and the flow does the rest.",
          {LUBRICATION: False}),
    Claim("small-steps-as-hard-sphere-in-a-rebound", "For small N_c the scheme approaches a hard sphere: an impact.",
          _STEPS_SLIDE, Approaches(("wet_restitution",), STEPS, {MODEL: "hard-sphere"}),
          "A hard sphere turns round within one time step, and must turn the fluid about it in the same step; a soft "
          "contact turns both over its N_c steps.",
          {LUBRICATION: False}),
    Claim("models-alike", "The choice of the contact model leaves the kiss and the tumble alone.", _MODELS_SLIDE,
          Alike(_HARD_MOTION), "A contact keeps the pair apart, at its own distance; the flow turns it.",
          {LUBRICATION: False}),
    Claim("models-alike-lubricated", "With lubrication the choice of the contact model leaves them alone.",
          _MODELS_SLIDE, Alike(_HARD_MOTION), "Lubrication takes the impact before the surfaces meet.",
          {LUBRICATION: True}),
    Claim("dry-for-wet-by-stokes", "Dry collisions approximate collisions in a viscous fluid: Stokes number of kisses.",
          "Soft sphere collision parameters N_c and e_n",
          Limit("max_stokes_number", CRITICAL_STOKES, False),
          "Below a Stokes number of 10 the liquid stops the rebound (Gondret et al. 2002): e_n is not seen.",
          {VISCOSITY: 0.113}),
    Claim("dry-for-wet-in-a-rebound", "Dry collisions approximate collisions in a viscous fluid: a rebound from a wall "
          "keeps nine tenths of the dry restitution.", "Soft sphere collision parameters N_c and e_n",
          Limit("wet_restitution", 0.9 * DRY_RESTITUTION, False, "approach_stokes_number"),
          "Near a Stokes number of 10 lubrication takes the whole impact (Gondret et al. 2002); at 1000 the fluid that "
          "moves with the sphere still takes a tenth, in a contact of eight steps.", {LUBRICATION: True}),
    Claim("dry-for-wet-by-lubrication", "Dry collisions approximate collisions in a viscous fluid: lubrication changes "
          "nothing.", "Soft sphere collision parameters N_c and e_n",
          Insensitive(("contact_kisses", "contact_kiss_total_s", "tumble_start_s", "gap_kiss_total_s"), LUBRICATION),
          "Lubrication slows the last approach and the parting, the more the closer the surfaces.",
          {VISCOSITY: 0.113, STIFFNESS: 50.0, DAMPING: 0.1}),
    Claim("tumbles-in-printed-viscosity", "The pair kisses and tumbles in a fluid of 0.913 Pa s.", _EFFECT,
          Happens("tumble_start_s"),
          "At a Reynolds number of 0.3 there is hardly a wake to draft in.", {VISCOSITY: 0.913}),
)  # fmt: skip
