"""Closed forms of round bodies in plane elasticity, the references of wheel pins, rollers and races.

Kolosov's potentials φ = A ln z + Σ aₙ zⁿ, ψ = −κ A ln z + Σ bₙ zⁿ (Muskhelishvili, *Some Basic Problems of the Mathematical
Theory of Elasticity*, § 56–60): four coefficients for the harmonics ±m, which held circle and load give.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import FloatArray

RESOLUTION = 60.0
"""Number of harmonics times half-width over radius: the truncated rest falls with the cube, to 1e-6 of the approach."""
NARROW = 0.01
"""Half-width over radius below which the approach follows the logarithm of the width, but for some 0.3 (b/R)²."""


def compressed_cylinder(radius: float, half_width: float) -> float:
    """Return the yield of a cylinder at each of two opposite loads, ln(4R/b) − 3/4 of the unit (Johnson, Eq. 5.57, less 1/4)."""
    return float(np.log(4.0 * radius / half_width) - 0.75)


def held_ring_approach(inner: float, outer: float, half_width: float, kolosov: float, angle: FloatArray) -> FloatArray:
    """Return approaches at angles, rad, from a patch on a ring held inside, as multiple of 2(1 − ν²)/(πEt); lengths in mm.

    Load and measure are as in coefficient files; Kolosov's constant is 3 − 4ν in plane strain, (3 − ν)/(1 + ν) in plane stress.
    """
    width, ratio = max(half_width / outer, NARROW), inner / outer
    count = max(int(RESOLUTION / width), 64)
    order = np.arange(1, count + 1)
    weight = _weights(width, count + 2)
    # Everything in units of 1 N/mm, the outer radius and 2G; a newton pushes along −x at angle 0.
    load = -weight / (2.0 * np.pi)
    level = _level(ratio, kolosov, load[1])
    plus, minus = _harmonics(ratio, kolosov, order, load)
    seen = level * weight[1] + (np.cos(np.outer(angle, order)) @ (plus * weight[order + 1] + minus * weight[order - 1]))
    # Displacements over 2G, and the unit is (κ + 1)/(2π) over 2G for a newton each millimetre.
    narrower = np.where(np.abs(angle) < width, np.log(width * outer / half_width), 0.0)
    return np.asarray(narrower - seen * 2.0 * np.pi / (kolosov + 1.0))


def _weights(width: float, count: int) -> FloatArray:
    """Means of cos(kt) over a semi-elliptic patch, 2 J₁(kb)/(kb), for k = 0 … count."""
    from scipy.special import j1

    argument = width * np.arange(1, count + 1)
    return np.concatenate([[1.0], 2.0 * j1(argument) / argument])


def _level(ratio: float, kolosov: float, load: float) -> float:
    """Harmonic 0 of the displacement at the outer circle, which the load squeezes evenly."""
    # κ a r − a r − b/r = 0 where it is held, 2a + b = load outside.
    uniform = load / (2.0 + (kolosov - 1.0) * ratio**2)
    return uniform * (kolosov - 1.0) * (1.0 - ratio**2)


def _harmonics(
    ratio: float, kolosov: float, order: NDArray[np.int_], load: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Harmonics +m and −m of the displacement at the outer circle."""
    m = order.astype(float)
    # Unknown: a of 1 + m and b of m − 1 by powers of the outer radius, a of 1 − m and b of −m − 1 by those of the inner.
    inside = ratio**m

    def row(*entries: FloatArray | float, first: tuple[float, float, float, float]) -> FloatArray:
        """Factors of the unknowns, shape (orders, 4); of the first harmonic two unknowns are others."""
        found = np.stack([np.broadcast_to(entry, m.shape) for entry in entries], axis=-1)
        # In the place of a of 0 stands A ln z, in that of b of 0 a shift of the whole.
        found[0] = first
        return found

    held_plus = row(kolosov * ratio * inside, 0.0, m - 1.0, -1.0, first=(kolosov * ratio**2, 0.0, -1.0, -1.0))
    held_minus = row(
        -(1.0 + m) * ratio * inside, -inside / ratio, kolosov, 0.0,
        first=(-2.0 * ratio**2, 1.0, 2.0 * kolosov * np.log(ratio), 0.0),
    )  # fmt: skip
    pulled_plus = row(
        (1.0 + m) * (1.0 - m), 1.0 - m, (1.0 - m) * inside / ratio, 0.0, first=(0.0, 0.0, 1.0 + kolosov, 0.0)
    )
    pulled_minus = row(
        1.0 + m, 0.0, (1.0 - m) * (1.0 + m) * inside / ratio, (m + 1.0) * ratio * inside,
        first=(2.0, 0.0, 2.0, 2.0 * ratio**2),
    )  # fmt: skip
    moved_plus = row(kolosov, 0.0, (m - 1.0) * inside / ratio, -ratio * inside, first=(kolosov, 0.0, -1.0, -(ratio**2)))
    moved_minus = row(-(1.0 + m), -1.0, kolosov * inside / ratio, 0.0, first=(-2.0, 1.0, 0.0, 0.0))
    system = np.stack([held_plus, held_minus, pulled_plus, pulled_minus], axis=-2)
    # Tractions of harmonic k are those of the patch's weight of k − 1: its direction is that of its middle.
    nothing = np.zeros_like(m)
    right = np.stack([nothing, nothing, load[order - 1], load[order + 1]], axis=-1)
    found = np.linalg.solve(system, right[..., None])[..., 0]
    return np.sum(moved_plus * found, axis=-1), np.sum(moved_minus * found, axis=-1)
