"""By how much both surfaces of a contact of a drive fall short of straight ones along the width, and where that has kinks."""

from __future__ import annotations

import numpy as np

from fem.drive.contact_kinds import PairKind
from fem.solid_contact.pressing import Relief
from ltca.arrays import FloatArray
from ltca.drive.parts import Drive
from ltca.geometry.length_profile import generator_profile, has_lead, lead_relief


def relief_of(drive: Drive, kind: PairKind) -> tuple[Relief | None, FloatArray]:
    """Return the relief of a kind of contacts at heights above mid-width, mm, None where straight, and its kinks."""
    disc, wheel, bearing = drive.disc, drive.pin_wheel, drive.crank_bearing
    if kind == "hole":
        return None, np.zeros(0)
    if kind != "pin":
        length = drive.roller_length
        profile = generator_profile(bearing.roller_profile, length, bearing.roller_radius)
        kinks = _kinks(length, bearing.roller_profile.end_relief_length)
        return (None if profile is None else profile.relief), kinks
    profile = generator_profile(wheel.pin_profile, disc.thickness, wheel.pin_radius)
    if profile is None and not has_lead(disc):
        return None, np.zeros(0)

    def of_flank(z: FloatArray) -> FloatArray:
        fallen = lead_relief(disc, z)
        return fallen if profile is None else fallen + profile.relief(z)

    return of_flank, _kinks(disc.thickness, disc.lead_relief_length, wheel.pin_profile.end_relief_length)


def _kinks(length: float, *reliefs: float) -> FloatArray:
    inner = np.array([0.5 * length - each for each in reliefs if each > 0.0])
    return np.concatenate([-inner, inner])
