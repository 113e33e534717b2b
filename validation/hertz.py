"""Reference solutions of smooth elastic contact: line contact of finite length, stresses below it, elliptical point contact.

Sources: K. L. Johnson, *Contact Mechanics* (1985), sections 4.2 (lines and ellipses), 5.6 (bodies with a datum);
E. McEwen, Phil. Mag. 40 (1949) 454 (stresses); G. Lundberg, Forsch. Ing.-Wes. 10 (1939) 201 (finite strip).
Loads of line contacts are per unit length, N/mm; E* is the contact modulus, ρ the effective radius. Half-width and peak pressure
of a line are in `ltca.contact.hertz`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ltca.arrays import FloatArray


def line_load(half_width: ArrayLike, effective_radius: ArrayLike, contact_modulus: float) -> FloatArray:
    """Return the load per length q = π E* b²/(4ρ), N/mm."""
    b, radius = np.asarray(half_width, dtype=float), np.asarray(effective_radius, dtype=float)
    return np.asarray(np.pi * contact_modulus * b**2 / (4.0 * radius))


def strip_approach(
    line_load: ArrayLike, half_width: ArrayLike, length: ArrayLike, contact_modulus: float
) -> tuple[FloatArray, FloatArray]:
    """Return the approach of two half-spaces at mid-length of a long strip and its mean along it, mm.

    The pressure is that of Hertz across and even along the strip.

    At mid-length δ = q/(π E*) (2 ln(2L/b) + 1) (Lundberg's 1.1932 + ln(L/b), twice); averaged over the length
    δ = q/(π E*) (2 ln(4L/b) − 1). In a real contact the approach is even along the length, and between the two; the mean is
    an upper bound of the approach at given load since the even load is only one of the admissible ones.
    """
    q, b, strip = (np.asarray(value, dtype=float) for value in (line_load, half_width, length))
    scale = q / (np.pi * contact_modulus)
    mid = scale * (2.0 * np.log(2.0 * strip / b) + 1.0)
    mean = scale * (2.0 * np.log(4.0 * strip / b) - 1.0)
    return np.asarray(mid), np.asarray(mean)


@dataclass(frozen=True, slots=True, kw_only=True)
class PlaneStress2D:
    """Stresses in the plane of a line contact, compression negative, MPa.

    Attributes
    ----------
    across, depthwise, shear : ndarray
        σx along the surface, σz into the body, τxz.
    """

    across: FloatArray
    depthwise: FloatArray
    shear: FloatArray

    @property
    def max_shear(self) -> FloatArray:
        """Largest shear stress in the plane, MPa."""
        return np.asarray(np.hypot(0.5 * (self.across - self.depthwise), self.shear))


def line_contact_stress(x: ArrayLike, depth: ArrayLike, half_width: float, peak_pressure: float) -> PlaneStress2D:
    """Return stresses below a Hertz line contact in closed form (McEwen; Johnson Eq. 4.49).

    The place x along the surface, the depth ≥ 0 and the half-width b are in mm, the peak pressure p0 in MPa.

    Examples
    --------
    The largest shear stress is 0.300 p0 at a depth of 0.786 b:

    >>> float(line_contact_stress(0.0, 0.786, 1.0, 1.0).max_shear.round(3))
    0.3
    """
    across, z = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(depth, dtype=float))
    b = half_width
    s = b**2 - across**2 + z**2
    root = np.hypot(s, 2.0 * across * z)
    # m² = ½(root + s), n² = ½(root − s), m n = |x| z: take the larger from the sum, the smaller by division.
    large = np.sqrt(0.5 * (root + np.abs(s)))
    safe = np.where(large > 0.0, large, 1.0)
    small = np.where(large > 0.0, np.abs(across) * z / safe, 0.0)
    m = np.where(s >= 0.0, large, small)
    n = np.where(s >= 0.0, small, large) * np.sign(across)
    both = m**2 + n**2
    ratio = np.where(both > 0.0, (z**2 + n**2) / np.where(both > 0.0, both, 1.0), 1.0)
    shear_ratio = np.where(both > 0.0, (m**2 - z**2) / np.where(both > 0.0, both, 1.0), 0.0)
    scale = -peak_pressure / b
    return PlaneStress2D(
        across=scale * (m * (1.0 + ratio) - 2.0 * z),
        depthwise=scale * m * (1.0 - ratio),
        shear=scale * n * shear_ratio,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class PointContact:
    """Hertz contact over an ellipse.

    Attributes
    ----------
    load : float
        Normal load, N.
    approach : float
        Approach, mm.
    half_axis_long, half_axis_short : float
        Half axes of the contact ellipse, mm.
    peak_pressure : float
        Pressure at the centre, MPa.
    """

    load: float
    approach: float
    half_axis_long: float
    half_axis_short: float
    peak_pressure: float

    @property
    def energy(self) -> float:
        """∫ F dδ = 2/5 F δ, N·mm, since F grows like δ^1.5."""
        return 0.4 * self.load * self.approach


def solve_point_contact(
    approach: float, radius_small: float, radius_large: float, contact_modulus: float
) -> PointContact:
    """Return the elliptical Hertz contact of separation x²/(2 R_small) + y²/(2 R_large) at an approach δ > 0; mm, E* in MPa.

    Johnson Eq. 4.26: with p0 = 3F/(2πab), e² = 1 − b²/a²,
    A = p0 b (K−E)/(E* e² a²), B = p0 b ((a²/b²)E − K)/(E* e² a²), δ = p0 b K/E*, A = 1/(2 R_large), B = 1/(2 R_small).
    Radii that are not positive and in order are refused (ValueError).
    """
    from scipy.optimize import brentq  # 0.2 s to import; line contacts do without
    from scipy.special import ellipe, ellipk

    if not 0.0 < radius_small <= radius_large:
        raise ValueError(f"need 0 < radius_small <= radius_large, got {radius_small} and {radius_large}")
    if radius_large / radius_small < 1.0 + 1e-9:
        side = float(np.sqrt(approach * radius_small))
        peak = 2.0 * contact_modulus * side / (np.pi * radius_small)
        load = 2.0 / 3.0 * peak * np.pi * side**2
        return PointContact(load=load, approach=approach, half_axis_long=side, half_axis_short=side, peak_pressure=peak)

    def curvature_mismatch(log_ratio: float) -> float:
        square = np.exp(-2.0 * log_ratio)
        first, second = ellipk(1.0 - square), ellipe(1.0 - square)
        return float(np.log((second / square - first) / (first - second)) - np.log(radius_large / radius_small))

    # a/b lies between (R_large/R_small)^½ and R_large/R_small.
    log_radii = float(np.log(radius_large / radius_small))
    log_ratio = brentq(curvature_mismatch, 0.3 * log_radii, 1.1 * log_radii, xtol=1e-14)
    ratio = float(np.exp(-log_ratio))
    parameter = 1.0 - ratio**2
    first, second = float(ellipk(parameter)), float(ellipe(parameter))
    long = float(np.sqrt(2.0 * radius_large * approach * (first - second) / (first * parameter)))
    short = long * ratio
    peak = approach * contact_modulus / (short * first)
    return PointContact(
        load=2.0 / 3.0 * np.pi * long * short * peak,
        approach=approach,
        half_axis_long=long,
        half_axis_short=short,
        peak_pressure=peak,
    )
