"""Pressure at the ends of contacts by that at mid-length."""

from __future__ import annotations

import numpy as np

from ltca.contact.contact_kind import ContactKind
from ltca.contact.end_pressure import largest_pressure_ratio
from ltca.drive.parts import LengthProfile
from ltca.geometry.length_profile import generator_profile


def test_contacts_of_one_radius_are_those_of_nearly_one():
    """Rollers are all as thick: no range of radii to interpolate over, and none is needed."""
    profile = generator_profile(LengthProfile(crown_drop=0.02), 11.8, 5.0)
    kind = ContactKind(length=11.8, contact_modulus=113e3, generator=profile, symmetric=True, cells=8)
    approach = np.array([[8e-3, 4e-3, -1e-3]])
    same = largest_pressure_ratio(kind, approach, np.full((1, 3), 4.0))
    # Up to a hundredth apart counts as one, and from there on there is a table: 1 and 2 % of ρ are hardly seen.
    near = largest_pressure_ratio(kind, approach, np.array([[4.0, 4.08, 4.0]]))
    np.testing.assert_allclose(same, near, rtol=1e-2)
    assert same[0, 2] == 1.0
    assert np.all(same >= 1.0 - 1e-12)
