"""Profiles of rollers and pins along their length, and leads of flanks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ltca.arrays import FloatArray
from ltca.drive.parts import Disc, LengthProfile

ACROSS = np.linspace(-1.0, 1.0, 257)
"""Places along a contact, by half its length, at which rigid bodies may touch: they miss 2e-5 of the drop of a crown."""
LOGARITHMIC = 0.00035
"""Amplitude of the logarithmic profile by the diameter of the roller (ISO 16281:2025, rollers no longer than 2.5 diameters)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Relief:
    """Profile by which a body falls short of the cylinder: crown, logarithmic relief and a parabolic drop at each end, summed.

    It is z = y²/(2 R) + A ln(1/(1 − (2y/L)²)) + d ((|y| − y0)/l)² beyond y0 = L/2 − l, at the distance y from mid-width, mm.
    """

    length: float  # L of the contact line
    crown_radius: float = np.inf  # R
    logarithm: float = 0.0  # A
    end_length: float = 0.0  # l of the relieved part at each end, at most half the length
    end_depth: float = 0.0  # d, the drop at the very end

    def relief(self, y: ArrayLike) -> FloatArray:
        """z(y), mm; a logarithmic one is infinite at and beyond the ends."""
        place = np.asarray(y, dtype=float)
        total = place**2 / (2.0 * self.crown_radius)
        if self.logarithm > 0.0:
            square = (2.0 * place / self.length) ** 2
            inside = square < 1.0
            total = total + np.where(inside, -self.logarithm * np.log1p(-np.where(inside, square, 0.0)), np.inf)
        if self._has_ends:
            beyond = np.maximum(np.abs(place) - (0.5 * self.length - self.end_length), 0.0)
            total = total + self.end_depth * (beyond / self.end_length) ** 2
        return np.asarray(total)

    def overlap_half_length(self, approach: float) -> float:
        """Largest |y| ≤ length/2 with z(y) < approach, mm: within it the undeformed bodies overlap."""
        reaches = []
        if self.crown_radius < np.inf:
            reaches.append(np.sqrt(2.0 * self.crown_radius * approach))
        if self.logarithm > 0.0:
            reaches.append(0.5 * self.length * np.sqrt(-np.expm1(-approach / self.logarithm)))
        if self._has_ends:
            straight = 0.5 * self.length - self.end_length
            reaches.append(straight + self.end_length * np.sqrt(approach / self.end_depth))
        high = min([0.5 * self.length, *map(float, reaches)])
        if len(reaches) <= 1 or float(self.relief(high)) <= approach:
            return high
        from scipy.optimize import brentq  # 0.2 s to import; one term alone has a closed form

        return float(brentq(lambda y: float(self.relief(y)) - approach, 0.0, high, xtol=1e-15 * high, rtol=1e-15))

    @property
    def _has_ends(self) -> bool:
        return self.end_length > 0.0 and self.end_depth > 0.0


def generator_profile(profile: LengthProfile, length: float, radius: float) -> Relief | None:
    """Return the profile of a roller or pin of a contact length and radius in mm, None for a cylinder."""
    if profile.is_cylinder:
        return None
    return Relief(
        length=length,
        crown_radius=length**2 / (8.0 * profile.crown_drop) if profile.crown_drop > 0.0 else np.inf,
        logarithm=LOGARITHMIC * profile.logarithmic_factor * 2.0 * radius,
        end_length=profile.end_relief_length,
        end_depth=profile.end_relief_depth,
    )


def has_lead(disc: Disc) -> bool:
    """Return whether the flank of a disc is anything but straight along its width."""
    relieved = disc.lead_relief_length > 0.0 and disc.lead_relief_depth > 0.0
    return bool(relieved or disc.lead_crown_drop != 0.0 or disc.lead_slope != 0.0)


def lead_relief(disc: Disc, z: FloatArray) -> FloatArray:
    """Return by how much the flank falls short at heights above the middle of the disc, mm; negative where metal is left."""
    length = disc.thickness
    ends = Relief(length=length, end_length=disc.lead_relief_length, end_depth=disc.lead_relief_depth)
    return np.asarray(-disc.lead_slope * z + disc.lead_crown_drop * (2.0 * z / length) ** 2 + ends.relief(z))


def profile_across(profile: LengthProfile, length: float, radius: float) -> FloatArray:
    """Return by how much a roller or pin falls short of a cylinder, mm, at `ACROSS`."""
    found = generator_profile(profile, length, radius)
    return np.zeros(ACROSS.size) if found is None else found.relief(0.5 * length * ACROSS)
