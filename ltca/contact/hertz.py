"""Hertz' line contact (K. L. Johnson, *Contact Mechanics*, 1985, section 4.2) by the load per unit length, N/mm, E* and ρ."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ltca.arrays import FloatArray


def effective_radius(radius_1: float, radius_2: float) -> float:
    """Return 1/(1/r1 + 1/r2), mm; a concave surface has a negative radius, a flat one an infinite one."""
    return 1.0 / (1.0 / radius_1 + 1.0 / radius_2)


def line_half_width(line_load: ArrayLike, effective_radius: ArrayLike, contact_modulus: float) -> FloatArray:
    """Return the half-width b = √(4 q ρ/(π E*)), mm (Johnson Eq. 4.43)."""
    q, radius = np.asarray(line_load, dtype=float), np.asarray(effective_radius, dtype=float)
    return np.asarray(np.sqrt(4.0 * q * radius / (np.pi * contact_modulus)))


def line_peak_pressure(line_load: ArrayLike, effective_radius: ArrayLike, contact_modulus: float) -> FloatArray:
    """Return the peak pressure p0 = √(q E*/(π ρ)), MPa (Johnson Eq. 4.45)."""
    q, radius = np.asarray(line_load, dtype=float), np.asarray(effective_radius, dtype=float)
    return np.asarray(np.sqrt(q * contact_modulus / (np.pi * radius)))
