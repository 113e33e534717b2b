"""Profiles of rollers and pins along their length: crown, logarithmic relief, end relief, and their sum as a drive defines it.

Each profile is symmetric about mid-width and gives the relief z(y) ≥ 0, by which it falls short of the cylinder, and the
half-length within which the undeformed bodies overlap at a given approach (no contact can reach beyond it), both in mm.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from ltca.arrays import FloatArray
from ltca.drive.parts import Disc, LengthProfile

ACROSS = np.linspace(-1.0, 1.0, 257)
"""Places along a contact, by half its length, at which bodies that do not yield are looked at for where they touch: what a crown
falls short by is missed by no more than 2e-5 of its drop."""


class Relief(Protocol):
    """Crowning or relief along the width; hashable, since tables are cached by it."""

    def __hash__(self) -> int:
        """Hash of the parameters."""

    @property
    def length(self) -> float:
        """Length of the contact line, mm."""

    def relief(self, y: ArrayLike) -> FloatArray:
        """z(y) at the distance y from mid-width, mm; even in y."""

    def overlap_half_length(self, approach: float) -> float:
        """Largest |y| ≤ length/2 with z(y) < approach, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CircularCrown:
    """Barrel of a large radius along the length: z = y²/(2 R).

    Parameters
    ----------
    length : float
        Length, mm.
    crown_radius : float
        R, mm.
    """

    length: float
    crown_radius: float

    def relief(self, y: ArrayLike) -> FloatArray:
        """z(y), mm."""
        return np.asarray(np.asarray(y, dtype=float) ** 2 / (2.0 * self.crown_radius))

    def overlap_half_length(self, approach: float) -> float:
        """√(2 R δ), at most half the length, mm."""
        return min(0.5 * self.length, float(np.sqrt(2.0 * self.crown_radius * approach)))


@dataclass(frozen=True, slots=True, kw_only=True)
class LogarithmicRelief:
    """Logarithmic profile of ISO 16281:2025: z = amplitude · D · ln(1/(1 − (2y/L)²)).

    Parameters
    ----------
    length : float
        Effective length L, mm.
    diameter : float
        Diameter D of the roller, mm.
    amplitude : float
        0.00035 in ISO 16281:2025 (rollers no longer than 2.5 D).
    """

    length: float
    diameter: float
    amplitude: float = 0.00035

    def relief(self, y: ArrayLike) -> FloatArray:
        """z(y), mm; infinite at and beyond the ends."""
        square = (2.0 * np.asarray(y, dtype=float) / self.length) ** 2
        inside = square < 1.0
        depth = -self.amplitude * self.diameter * np.log1p(-np.where(inside, square, 0.0))
        return np.where(inside, depth, np.inf)

    def overlap_half_length(self, approach: float) -> float:
        """L/2 √(1 − exp(−δ/(amplitude D))), mm."""
        fraction = -np.expm1(-approach / (self.amplitude * self.diameter))
        return 0.5 * self.length * float(np.sqrt(fraction))


@dataclass(frozen=True, slots=True, kw_only=True)
class EndRelief:
    """Cylinder with a parabolic drop at each end: z = depth · ((|y| − y0)/relief_length)² beyond y0.

    Parameters
    ----------
    length : float
        Whole length, mm.
    relief_length : float
        Length of the relieved part at each end, mm, at most half the length.
    depth : float
        Drop at the very end, mm.
    """

    length: float
    relief_length: float
    depth: float

    @property
    def straight_half_length(self) -> float:
        """Half the length left cylindrical, y0, mm."""
        return 0.5 * self.length - self.relief_length

    def relief(self, y: ArrayLike) -> FloatArray:
        """z(y), mm."""
        beyond = np.maximum(np.abs(np.asarray(y, dtype=float)) - self.straight_half_length, 0.0)
        return np.asarray(self.depth * (beyond / self.relief_length) ** 2)

    def overlap_half_length(self, approach: float) -> float:
        """y0 + relief_length √(δ/depth), at most half the length, mm."""
        reach = self.straight_half_length + self.relief_length * float(np.sqrt(approach / self.depth))
        return min(0.5 * self.length, reach)


@dataclass(frozen=True, slots=True, kw_only=True)
class SummedProfile:
    """Profile whose relief is the sum of several, each growing from mid-width to the ends.

    Parameters
    ----------
    length : float
        Length, mm.
    parts : tuple of Relief
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


def has_lead(disc: Disc) -> bool:
    """Return whether the flank of a disc is anything but straight along its width."""
    relieved = disc.lead_relief_length > 0.0 and disc.lead_relief_depth > 0.0
    return bool(relieved or disc.lead_crown_drop != 0.0 or disc.lead_slope != 0.0)


def lead_relief(disc: Disc, z: FloatArray) -> FloatArray:
    """Return by how much the flank falls short at heights above the middle of the disc, mm; negative where metal is left."""
    length = disc.thickness
    total = -disc.lead_slope * z
    if disc.lead_crown_drop > 0.0:
        total = total + disc.lead_crown_drop * (2.0 * z / length) ** 2
    if disc.lead_relief_length > 0.0 and disc.lead_relief_depth > 0.0:
        ends = EndRelief(length=length, relief_length=disc.lead_relief_length, depth=disc.lead_relief_depth)
        total = total + ends.relief(z)
    return np.asarray(total)


def profile_across(profile: LengthProfile, length: float, radius: float) -> FloatArray:
    """Return by how much a roller or pin falls short of a cylinder, mm, at `ACROSS`."""
    found = generator_profile(profile, length, radius)
    return np.zeros(ACROSS.size) if found is None else found.relief(0.5 * length * ACROSS)
