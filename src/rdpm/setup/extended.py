"""Rolling friction, twisting friction and cohesion of a case, added to the law of its model."""

from __future__ import annotations

from rdpm.config.case import Case
from rdpm.contacts import ContactLaw, ExtendedContact, Hertz, SoftSphere

__all__ = ["extended"]


def extended(case: Case, law: ContactLaw) -> ContactLaw:
    """Add to a law what the case asks for.

    Parameters
    ----------
    case : Case
    law : ContactLaw
        Of the case's model.

    Returns
    -------
    ContactLaw
        The law itself where nothing is added.
    """
    c = case.contact
    # Other models were refused with these keys.
    if not (c.is_extended and isinstance(law, (SoftSphere, Hertz))):
        return law
    return ExtendedContact(law, c.rolling_friction, c.twisting_friction, c.cohesion, float(c.cohesion_range or 0.0))
