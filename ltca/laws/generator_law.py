"""The tabulated law of a roller or pin, with the profile along its length that the drive defines."""

from __future__ import annotations

import numpy as np

from ltca.arrays import FloatArray
from ltca.contact.length_profile import generator_profile
from ltca.drive.parts import LengthProfile
from ltca.laws.contact_law import ContactLaw
from ltca.laws.line_contact import LineContactLaw
from ltca.laws.profiled_line_contact import ProfiledLineContactLaw


def law_for_profile(
    profile: LengthProfile,
    *,
    length: float,
    radius: float,
    contact_modulus: float,
    effective_radii: FloatArray,
) -> ContactLaw:
    """Return the tabulated law of a roller or pin of a length and radius in mm and a contact modulus E* in MPa.

    Of `effective_radii`, mm, at which the law will be evaluated, only the range matters, and only for profiled parts.
    """
    generator = generator_profile(profile, length, radius)
    if generator is None:
        return LineContactLaw(length, contact_modulus)
    smallest, largest = float(np.min(effective_radii)), float(np.max(effective_radii))
    return ProfiledLineContactLaw.for_radii(generator, contact_modulus, smallest, largest)
