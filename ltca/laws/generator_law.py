"""The tabulated law of a roller or pin, with the profile along its length that the drive defines."""

from __future__ import annotations

import numpy as np

from ltca.arrays import FloatArray
from ltca.drive.parts import LengthProfile
from ltca.geometry.length_profile import generator_profile
from ltca.laws.contact_law import ContactLaw
from ltca.laws.line_contact import LineContactLaw
from ltca.laws.profiled_line_contact import ProfiledLineContactLaw

LADDER_RATIO = 1.25
"""Ratio of neighbouring ends of the ranges of radii for which tables of profiled parts are made in a batch."""


def law_for_profile(
    profile: LengthProfile,
    *,
    length: float,
    radius: float,
    contact_modulus: float,
    effective_radii: FloatArray,
    on_ladder: bool = False,
) -> ContactLaw:
    """Return the tabulated law of a roller or pin of a length and radius in mm and a contact modulus E* in MPa.

    Of `effective_radii`, mm, at which the law will be evaluated, only the range matters, and only for profiled parts; it is
    rounded outward to powers of `LADDER_RATIO` if `on_ladder`, so that parts that differ little have the same table.
    """
    generator = generator_profile(profile, length, radius)
    if generator is None:
        return LineContactLaw(length, contact_modulus)
    ends = np.array([np.min(effective_radii), np.max(effective_radii)])
    if on_ladder:
        step = np.log(LADDER_RATIO)
        rungs = np.log(ends) / step
        ends = np.exp(step * np.array([np.floor(rungs[0]), np.ceil(rungs[1])]))
    smallest, largest = float(ends[0]), float(ends[1])
    return ProfiledLineContactLaw.for_radii(generator, contact_modulus, smallest, largest)
