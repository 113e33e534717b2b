"""Harmonics of a sleeve less those of an infinite body: pₙ cos nθ on the inside, at a, and a line force outside, at R.

Michell's stress functions r^±n, r^(2±n), Lamé's for n = 0. The force at θ = 0 is F/2πRL of n = 0, F/πRL of others; displacements
are outward, in a/4μ. Differences from infinite body and full circle fall like (a/R)ⁿ or faster, so few harmonics are enough.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ltca.arrays import FloatArray, freeze

NEGLIGIBLE = 1e-12
"""(a/R)ⁿ below which harmonics are left out."""
MAX_HARMONICS = 600


@dataclass(frozen=True, slots=True, kw_only=True)
class SleeveWall:
    """Harmonics 0, 1, 2 … of a sleeve, displacements in a/4μ."""

    own: FloatArray  # inside by pₙ, less those of the infinite body (n = 1: all of it, without the uniform part)
    across: FloatArray  # inside by the force outside, in F/(aL)
    back: FloatArray  # outside at θ = 0 by pₙ
    outside: float  # there, inward, by the force, in F/(aL), less the half-plane's down to R


@lru_cache(maxsize=256)
def sleeve_wall(kappa: float, ratio: float) -> SleeveWall:
    """Return the harmonics of a sleeve from its κ = 3 − 4ν and a/R < 1."""
    count = int(np.clip(np.ceil(np.log(NEGLIGIBLE) / np.log(ratio)), 8, MAX_HARMONICS))
    own, across, back, outside = (np.zeros(count) for _ in range(4))
    # Of a unit pressure inside, p, and of a unit pressure outside, s: displacements inside and outside, a = 1.
    far = 1.0 / ratio
    # n = 0, Lamé: 2μ u = C (κ − 1) r + D/r, σ = 2 C − D/r².
    d = 1.0 / (1.0 - ratio**2)
    own[0], back[0] = _lame(kappa, d, 0.5 * ratio**2 * d, 1.0) - 2.0, _lame(kappa, d, 0.5 * ratio**2 * d, far)
    force = ratio / (2.0 * np.pi)
    across[0], outside[0] = _lame(kappa, -d, -0.5 * d, 1.0) * force, -_lame(kappa, -d, -0.5 * d, far) * force
    # n = 1: p inside, balanced by p a/R outside.
    own[1], back[1] = _first(kappa, far)
    n = np.arange(2.0, count)
    inner_p, outer_p, inner_s, outer_s = _higher(kappa, n, far)
    force = ratio / np.pi
    own[2:] = inner_p - (kappa / (n - 1.0) + 1.0 / (n + 1.0))
    across[2:], back[2:] = inner_s * force, outer_p
    outside[2:] = (-outer_s - far * (kappa / (n + 1.0) + 1.0 / (n - 1.0))) * force
    # Of the full circle under a line force: Σ over n ≥ 2 of κ/(n + 1) + 1/(n − 1) − (κ + 1)/n = 1 − κ/2, less n = 1.
    circle = (1.0 - 0.5 * kappa - (kappa + 1.0)) / np.pi
    return freeze(SleeveWall(own=own, across=across, back=back, outside=float(outside.sum() + circle)))


def _lame(kappa: float, shrinking: float, uniform: float, r: float) -> float:
    """4μ u at r for σ = 2 C − D/r², C uniform and D shrinking."""
    return 2.0 * (uniform * (kappa - 1.0) * r + shrinking / r)


def _first(kappa: float, far: float) -> tuple[float, float]:
    """4μ u inside and outside for p₁ = 1, by the stress functions r³, 1/r and a force in the middle."""
    places = np.array([1.0, far])
    shear = np.stack([2.0 * places, -2.0 / places**3, 0.5 * (kappa - 1.0) / places])
    normal = np.array([2.0, -2.0, -0.5 * (kappa + 3.0)])
    amounts = np.linalg.solve(np.column_stack([shear, normal]).T, [0.0, 0.0, -1.0])
    moved = np.stack([(kappa - 2.0) * places**2, places**-2.0, 1.0 - kappa * np.log(places)])
    inside, outside = 2.0 * amounts @ moved
    return float(inside), float(outside)


def _higher(kappa: float, n: FloatArray, far: float) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """4μ u inside and outside for pₙ = 1, then for sₙ = 1; functions scaled by the surface where they are largest."""

    def at(r: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Normal stress, shear stress and 2μ u of the four functions, shape (4, n)."""
        growing, falling = (r / far) ** n, r**-n
        square, over = (r / far) ** 2, r**2
        normal = [
            (n - n**2) * growing / r**2,
            (n + 2.0 - n**2) * growing * square / r**2,
            -(n + n**2) * falling / r**2,
            (2.0 - n - n**2) * falling * over / r**2,
        ]
        shear = [
            n * (n - 1.0) * growing / r**2,
            n * (n + 1.0) * growing * square / r**2,
            -n * (n + 1.0) * falling / r**2,
            n * (1.0 - n) * falling * over / r**2,
        ]
        moved = [
            -n * growing / r,
            (kappa - n - 1.0) * growing * square / r,
            n * falling / r,
            (kappa + n - 1.0) * falling * over / r,
        ]
        return np.array(normal), np.array(shear), np.array(moved)

    inside, outside = at(1.0), at(far)
    system = np.stack([inside[0], inside[1], outside[0], outside[1]]).transpose(2, 0, 1)
    right = np.zeros((len(n), 4, 2))
    right[:, 0, 0] = right[:, 2, 1] = -1.0
    amounts = np.linalg.solve(system, right)
    inner, outer = (2.0 * np.einsum("fn,nfk->kn", surface[2], amounts) for surface in (inside, outside))
    return inner[0], outer[0], inner[1], outer[1]
