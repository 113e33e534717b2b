"""Profile of a roller or pin along its length as the drive defines it: sum of crown, logarithmic relief and end relief."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ltca.arrays import FloatArray
from ltca.contact.length_profile import CircularCrown, EndRelief, LogarithmicRelief, Relief
from ltca.drive.parts import LengthProfile


@dataclass(frozen=True, slots=True, kw_only=True)
class SummedProfile:
    """Profile whose relief is the sum of several, each growing from mid-width to the ends.

    Parameters
    ----------
    length : float
        Length, mm.
    parts : tuple of ltca.contact.length_profile.Relief
        The terms, all of that length.
    """

    length: float
    parts: tuple[Relief, ...]

    def relief(self, y: ArrayLike) -> FloatArray:
        """Return z(y), mm."""
        return np.asarray(sum(part.relief(y) for part in self.parts))

    def overlap_half_length(self, approach: float) -> float:
        """Return the largest |y| ≤ length/2 with z(y) < approach, mm."""
        from scipy.optimize import brentq  # 0.2 s to import; one crown or relief alone has a closed form

        high = min(part.overlap_half_length(approach) for part in self.parts)
        if len(self.parts) == 1 or float(self.relief(high)) <= approach:
            return high
        return float(brentq(lambda y: float(self.relief(y)) - approach, 0.0, high, xtol=1e-15 * high, rtol=1e-15))


def generator_profile(profile: LengthProfile, length: float, radius: float) -> SummedProfile | None:
    """Return the profile of a roller or pin of a contact length and radius in mm, None for a cylinder."""
    if profile.is_cylinder:
        return None
    parts: list[Relief] = []
    if profile.crown_drop > 0.0:
        parts.append(CircularCrown(length=length, crown_radius=length**2 / (8.0 * profile.crown_drop)))
    if profile.logarithmic_factor > 0.0:
        amplitude = 0.00035 * profile.logarithmic_factor
        parts.append(LogarithmicRelief(length=length, diameter=2.0 * radius, amplitude=amplitude))
    if profile.end_relief_length > 0.0 and profile.end_relief_depth > 0.0:
        parts.append(EndRelief(length=length, relief_length=profile.end_relief_length, depth=profile.end_relief_depth))
    return SummedProfile(length=length, parts=tuple(parts))
